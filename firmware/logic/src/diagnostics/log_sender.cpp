// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/diagnostics/log_sender.hpp"

#include <algorithm>

namespace triskin::fw {
namespace {

std::string_view name_of(wire::LogLevel level) {
  switch (level) {
    case wire::LogLevel::kError:
      return "error: ";
    case wire::LogLevel::kWarning:
      return "warning: ";
    case wire::LogLevel::kDebug:
      return "debug: ";
    default:
      return "";
  }
}

}  // namespace

void LogSender::set(wire::LogLevel level, std::uint8_t frame_bytes) {
  reader_ = {level, 0};
  frame_bytes_ = frame_bytes;
  encoder_.abandon();
}

std::uint64_t LogSender::next_us(const Log& log) const {
  Log::Reader reader = reader_;
  return log.next(reader) != nullptr ? next_us_ : UINT64_MAX;
}

// A line that was overwritten while it was being sent is abandoned; the next one begins with a first frame.
void LogSender::step(const Log& log, CanPort& port, std::uint8_t node, std::uint64_t now_us) {
  constexpr std::uint64_t kPace_us = 1'000;
  const wire::LogLine* line = now_us >= next_us_ ? log.next(reader_) : nullptr;
  if (line == nullptr) return;
  next_us_ = now_us + kPace_us;
  if (begun_at_ != reader_.at) encoder_.abandon();
  begun_at_ = reader_.at;
  if (!port.send(encoder_.frame(*line, node, frame_bytes_))) return;
  if (encoder_.sent(*line, frame_bytes_)) ++reader_.at;
}

// Writes seconds with three decimal places, right-aligned.
void SerialLog::begin(const wire::LogLine& line) {
  std::uint32_t rest = line.time_ms;
  std::array<char, 12> time{};
  time.fill(' ');
  for (std::size_t k = time.size() - 1, place = 0; k-- > 0 && (rest != 0 || place < 5); ++place) {
    if (place == 3) {
      time[k] = '.';
      continue;
    }
    time[k] = static_cast<char>('0' + rest % 10);
    rest /= 10;
  }
  size_ = at_ = 0;
  for (const std::string_view part :
       {std::string_view(time.data(), time.size()), name_of(line.level), line.view(), std::string_view("\r\n")}) {
    std::ranges::copy(part, text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += part.size();
  }
}

bool SerialLog::waits(const Log& log) const {
  Log::Reader reader = reader_;
  return port_ != nullptr && (at_ < size_ || log.next(reader) != nullptr);
}

void SerialLog::step(const Log& log) {
  if (port_ == nullptr) return;
  for (;;) {
    for (; at_ < size_; ++at_) {
      if (!port_->send(static_cast<std::uint8_t>(text_[at_]))) return;
    }
    const wire::LogLine* line = log.next(reader_);
    if (line == nullptr) return;
    begin(*line);
    ++reader_.at;
  }
}

}  // namespace triskin::fw
