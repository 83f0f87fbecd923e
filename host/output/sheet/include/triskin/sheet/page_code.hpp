// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace triskin::sheet {

/// The QR code of a page of the assembly sheet reads `triskin:DESIGNID/PATCH/PAGE`, where DESIGNID has 16 hexadecimal
/// digits and PATCH is `-` on a page that belongs to no single patch.
struct PageCode {
  std::uint64_t design_id = 0;
  int patch = -1;  ///< The index refers to Design::patches; −1 stands for none.
  int page = 1;    ///< Pages are counted from 1.
  bool operator==(const PageCode&) const = default;
};

/// Returns the text of a code. Cost: constant.
[[nodiscard]] std::string text_of(const PageCode& code);

/// Returns true when `text` begins like the text of a code, so that no file is meant.
[[nodiscard]] bool is_page_code(std::string_view text);

/// Reads the code in `text`; empty when it is none: another prefix, no 16 digits, a patch or page that is no number
/// (patch 0 … 65535, page 1 … 65535), or further text behind it. Cost: constant.
[[nodiscard]] std::optional<PageCode> read_page_code(std::string_view text);

}  // namespace triskin::sheet
