// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/diagnostics/log.hpp"

namespace triskin::fw {

LogText& LogText::text(std::string_view text) {
  for (const char c : text) {
    if (line_.size < wire::kMaxLogText) line_.text[line_.size++] = c;
  }
  return *this;
}

LogText& LogText::decimal(std::uint32_t value) {
  std::array<char, 10> digits{};
  std::size_t at = digits.size();
  do {
    digits[--at] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  return text({digits.data() + at, digits.size() - at});
}

LogText& LogText::address(std::uint32_t value) {
  std::array<char, 9> digits{'@'};
  for (std::size_t k = digits.size(); k-- > 1; value >>= 4) digits[k] = "0123456789abcdef"[value & 0xF];
  return text({digits.data(), digits.size()});
}

wire::LogLine& Log::begin(wire::LogLevel level, std::uint64_t now_us) {
  wire::LogLine& line = lines_[count_ % kLines];
  line.level = level;
  line.number = static_cast<std::uint8_t>(count_);
  line.time_ms = static_cast<std::uint32_t>(now_us / 1000);
  line.size = 0;
  return line;
}

const wire::LogLine* Log::next(Reader& reader) const {
  if (count_ - reader.at > kLines) reader.at = count_ - kLines;
  for (; reader.at != count_; ++reader.at) {
    const wire::LogLine& line = lines_[reader.at % kLines];
    if (line.level <= reader.level) return &line;
  }
  return nullptr;
}

}  // namespace triskin::fw
