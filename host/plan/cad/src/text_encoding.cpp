// SPDX-License-Identifier: GPL-3.0-or-later
#include "text_encoding.hpp"

#include <fmt/format.h>
#include <iconv.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>

#include "triskin/base/utf8.hpp"

namespace triskin::cad {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

unsigned byte_at(std::string_view text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0;
}

// Returns the length of the UTF-8 character that begins at `at`; 0 if none does.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const unsigned first = byte_at(text, at);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : (first & 0xF0U) == 0xE0       ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte_at(text, at + k) & 0xC0U) != 0x80) return 0;
  }
  return length;
}

char32_t utf8_value(std::string_view text, std::size_t at, std::size_t length) {
  constexpr std::array<unsigned, 5> kMask{0, 0x7F, 0x1F, 0x0F, 0x07};
  char32_t value = byte_at(text, at) & kMask[length];
  for (std::size_t k = 1; k < length; ++k) value = value << 6 | (byte_at(text, at + k) & 0x3FU);
  return value;
}

// Converts bytes of another character set to UTF-8; returns nothing if the C library does not know the set or the bytes
// do not belong to it.
std::optional<std::string> converted(std::string_view bytes, const char* set) {
  const iconv_t converter = ::iconv_open("UTF-8", set);
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  std::string in(bytes), out(bytes.size() * 4 + 8, '\0');
  char *from = in.data(), *to = out.data();
  std::size_t in_left = in.size(), out_left = out.size();
  const bool is_done = ::iconv(converter, &from, &in_left, &to, &out_left) != static_cast<std::size_t>(-1);
  ::iconv_close(converter);
  if (!is_done) return std::nullopt;
  out.resize(out.size() - out_left);
  return out;
}

std::string latin1(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) append_utf8(out, static_cast<unsigned char>(c));
  return out;
}

std::string raw_text(std::string_view raw, RawEncoding encoding) {
  if (encoding == RawEncoding::kUtf8) return std::string(raw);
  const auto text = encoding == RawEncoding::kGbk ? converted(raw, "GB18030") : std::nullopt;
  return text ? *text : latin1(raw);
}

std::optional<char32_t> hex_value(std::string_view text, std::size_t at, std::size_t digits) {
  if (at + digits > text.size()) return std::nullopt;
  std::uint32_t value = 0;
  const char* end = text.data() + at + digits;
  const auto [rest, error] = std::from_chars(text.data() + at, end, value, 16);
  return error == std::errc{} && rest == end ? std::optional<char32_t>(value) : std::nullopt;
}

// Resolves the escapes of one string.
class Unescaper {
 public:
  explicit Unescaper(std::string_view text) : text_(text) {}

  std::string run() {
    while (at_ < text_.size()) {
      if (text_[at_] != '\\' || !escape()) {
        if (text_.substr(at_).starts_with("''")) ++at_;
        if (byte_at(text_, at_) >= 0x20 && text_[at_] != 0x7F) out_ += text_[at_];
        ++at_;
      }
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool is_next(std::string_view word) const { return text_.substr(at_).starts_with(word); }
  bool escape() {
    if (is_next("\\\\")) return put(U'\\', 2);
    if (is_next("\\N\\") || is_next("\\F\\")) return put(U' ', 3);
    if (is_next("\\X2\\")) return wide(4);
    if (is_next("\\X4\\")) return wide(8);
    if (is_next("\\X\\")) {
      const auto value = hex_value(text_, at_ + 3, 2);
      return value && put(*value, 5);
    }
    if (is_next("\\S\\") && at_ + 3 < text_.size()) return shifted();
    if (is_next("\\P") && at_ + 3 < text_.size() && text_[at_ + 3] == '\\') {
      page_ = text_[at_ + 2];
      at_ += 4;
      return true;
    }
    return false;
  }
  bool put(char32_t c, std::size_t length) {
    if (c >= 0x20) append_utf8(out_, c);
    at_ += length;
    return true;
  }
  // \S\d stands for d with its highest bit set, in the page of ISO 8859 that \PA\ … \PI\ chose.
  bool shifted() {
    const char high = static_cast<char>(byte_at(text_, at_ + 3) | 0x80U);
    const std::string set = fmt::format("ISO-8859-{}", page_ - 'A' + 1);
    const auto text = converted({&high, 1}, set.c_str());
    out_ += text ? *text : latin1({&high, 1});
    at_ += 4;
    return true;
  }
  bool wide(std::size_t digits) {
    std::size_t at = at_ + 4;
    std::string text;
    char32_t high = 0;
    for (; !text_.substr(at).starts_with("\\X0\\"); at += digits) {
      const auto value = hex_value(text_, at, digits);
      if (!value) return false;
      if (*value >= 0xD800 && *value < 0xDC00) {
        high = *value;
      } else if (*value >= 0xDC00 && *value < 0xE000 && high != 0) {
        append_utf8(text, 0x10000 + ((high - 0xD800) << 10) + (*value - 0xDC00));
        high = 0;
      } else if (*value >= 0x20) {
        append_utf8(text, *value);
      }
    }
    out_ += text;
    at_ = at + 4;
    return true;
  }

  std::string_view text_;
  std::string out_;
  std::size_t at_ = 0;
  char page_ = 'A';
};

}  // namespace

RawEncoding guess_encoding(std::string_view bytes) {
  std::size_t pairs = 0, lone = 0;
  bool is_utf8 = true;
  for (std::size_t at = 0; at < bytes.size();) {
    if (byte_at(bytes, at) < 0x80) {
      ++at;
      continue;
    }
    const std::size_t length = utf8_length(bytes, at);
    is_utf8 = is_utf8 && length > 0;
    const bool is_pair = byte_at(bytes, at) >= 0x81 && byte_at(bytes, at + 1) >= 0xA1;
    ++(is_pair ? pairs : lone);
    at += is_utf8 ? length : is_pair ? 2 : 1;
  }
  if (is_utf8) return RawEncoding::kUtf8;
  return pairs > lone ? RawEncoding::kGbk : RawEncoding::kLatin1;
}

std::string decode_step_string(std::string_view raw, RawEncoding encoding) {
  return Unescaper(raw_text(raw, encoding)).run();
}

std::string encode_step_string(std::string_view utf8) {
  std::string out;
  for (std::size_t at = 0; at < utf8.size();) {
    const std::size_t length = utf8_length(utf8, at);
    const char32_t c = length == 0 ? kReplacement : utf8_value(utf8, at, length);
    if (c == U'\'' || c == U'\\')
      out += std::string(2, static_cast<char>(c));
    else if (c < 0x80)
      out += static_cast<char>(c);
    else
      out += fmt::format("{}{:0{}X}\\X0\\", c < 0x10000 ? "\\X2\\" : "\\X4\\", static_cast<std::uint32_t>(c),
                         c < 0x10000 ? 4 : 8);
    at += std::max<std::size_t>(1, length);
  }
  return out;
}

}  // namespace triskin::cad
