// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "triskin/base/files.hpp"
#include "triskin/base/utf8.hpp"

namespace triskin {
namespace {

enum class ByteOrder { kNone, kLittle, kBig };

unsigned byte_of(std::string_view bytes, std::size_t k) {
  return static_cast<unsigned char>(bytes[k]);
}

// In UTF-16, every other byte of an English letter is zero.
ByteOrder order_by_zeros(std::string_view bytes) {
  const std::size_t n = std::min<std::size_t>(bytes.size() / 2, 40);
  std::size_t even = 0, odd = 0;
  for (std::size_t k = 0; k < n; ++k) {
    even += bytes[2 * k] == '\0' ? 1 : 0;
    odd += bytes[2 * k + 1] == '\0' ? 1 : 0;
  }
  if (odd == n && even == 0) return ByteOrder::kLittle;
  return even == n && odd == 0 ? ByteOrder::kBig : ByteOrder::kNone;
}

ByteOrder order_of(std::string_view bytes) {
  constexpr std::string_view kUtf32("\xFF\xFE\0\0", 4);
  if (bytes.size() < 4 || bytes.starts_with(kUtf32)) return ByteOrder::kNone;
  if (bytes.starts_with("\xFF\xFE")) return ByteOrder::kLittle;
  if (bytes.starts_with("\xFE\xFF")) return ByteOrder::kBig;
  return order_by_zeros(bytes);
}

bool is_high_half(unsigned c) {
  return c >= 0xD800 && c < 0xDC00;
}
bool is_low_half(unsigned c) {
  return c >= 0xDC00 && c < 0xE000;
}

void use_line_feeds(std::string& text) {
  std::size_t to = text.find('\r');
  if (to == std::string::npos) return;
  for (std::size_t from = to; from < text.size(); ++from) {
    const bool is_return = text[from] == '\r';
    text[to++] = is_return ? '\n' : text[from];
    if (is_return && from + 1 < text.size() && text[from + 1] == '\n') ++from;
  }
  text.resize(to);
}

}  // namespace

std::string without_utf16(std::string bytes) {
  const ByteOrder order = order_of(bytes);
  if (order == ByteOrder::kNone) return bytes;
  const auto unit = [&](std::size_t k) {
    const unsigned first = byte_of(bytes, k), second = byte_of(bytes, k + 1);
    return order == ByteOrder::kLittle ? first | second << 8 : first << 8 | second;
  };
  constexpr unsigned kMark = 0xFEFF;
  std::string out;
  for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
    const unsigned c = unit(k);
    if (c == kMark && k == 0) continue;
    const bool is_pair = is_high_half(c) && k + 3 < bytes.size() && is_low_half(unit(k + 2));
    if (is_pair) {
      append_utf8(out, 0x10000 + ((c - 0xD800) << 10) + (unit(k + 2) - 0xDC00));
      k += 2;
    } else {
      append_utf8(out, c);
    }
  }
  return out;
}

std::string plain_text(std::string bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string text = without_utf16(std::move(bytes));
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  use_line_feeds(text);
  return text;
}

std::string read_text(const std::filesystem::path& path) {
  return plain_text(read_file(path));
}

std::string note_of_open_line(std::string_view text, std::string_view name) {
  if (text.empty() || text.ends_with('\n') || text.ends_with('\r')) return {};
  return fmt::format(
      "{}: ends without a line end: if the file was cut, its last number may be another one and more may be missing",
      name);
}

}  // namespace triskin
