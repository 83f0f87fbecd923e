// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// A name for formats that take letters, digits, `_` and the characters of `also` only: topics, identifiers of
/// simulators, files. A text of these is its own name. In any other, each other byte becomes `_`, and eight hexadecimal
/// digits of FNV-1a over the text follow, so that different texts have different names ("left arm", "left-arm" and
/// "left_arm"; "左腕" and "右腕"); a text that ends like that gets them too. `if_empty` stands for "".
[[nodiscard]] std::string ascii_name(std::string_view text, std::string_view also, std::string_view if_empty);

/// The name of a cover in topics and frames of ROS (skin/NAME/raw, skin_NAME): that of ascii_name, and a leading digit
/// gets a "p" before it.
[[nodiscard]] std::string part_name(std::string_view text);
/// Returns true for what stands in topics and frames as it is, so for every result of part_name(): letters, digits and
/// `_`, and no digit at the beginning.
[[nodiscard]] bool is_part_name(std::string_view text);

}  // namespace triskin
