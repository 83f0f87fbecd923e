// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace triskin::sheet {

/// What the QR code of a page of the assembly sheet says: `triskin:DESIGNID/PATCH/PAGE`, where DESIGNID has 16
/// hexadecimal digits and PATCH is `-` on a page that belongs to no single patch.
struct PageCode {
  std::uint64_t design_id = 0;
  int patch = -1;  ///< It indexes Design::patches; −1 stands for none.
  int page = 1;    ///< Pages are counted from 1.
  bool operator==(const PageCode&) const = default;
};

/// The text of a code. Cost: constant.
[[nodiscard]] std::string text_of(const PageCode& code);

/// True when `text` begins as the text of a code does, so that no file is meant.
[[nodiscard]] bool is_page_code(std::string_view text);

/// The code that `text` states; empty when it is none: another prefix, no 16 digits, a patch or page that is no number
/// (patch 0 … 65535, page 1 … 65535), or anything behind it. Cost: constant.
[[nodiscard]] std::optional<PageCode> read_page_code(std::string_view text);

}  // namespace triskin::sheet
