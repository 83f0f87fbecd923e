// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// A controller's log consists of lines of text, which become frames for the readers that asked for them (FD13). See
/// docs/diagnose.md.
namespace triskin::wire {

/// Levels rank the importance of a line. A reader that asks for one level also gets the levels before it.
enum class LogLevel : std::uint8_t { kOff, kError, kWarning, kInformation, kDebug };

inline constexpr std::size_t kMaxLogText = 96;
inline constexpr std::uint32_t kLogBase = 0x18E4FF00;  ///< The node address is added to this identifier.

struct LogLine {
  LogLevel level = LogLevel::kInformation;
  std::uint8_t number = 0;    ///< Lines are numbered modulo 256; a gap shows that lines were lost.
  std::uint32_t time_ms = 0;  ///< The time starts when the controller starts.
  std::uint8_t size = 0;      ///< Only this many bytes of `text` are valid.
  std::array<char, kMaxLogText> text{};

  [[nodiscard]] constexpr std::string_view view() const { return {text.data(), size}; }
  /// Compares the content without the unused bytes behind the text.
  constexpr bool operator==(const LogLine& o) const {
    return level == o.level && number == o.number && time_ms == o.time_ms && view() == o.view();
  }
};

/// Identifier FD13 carries this value: lines up to `wanted` go to the port from which the request came, until the
/// controller restarts.
struct LogSetting {
  static constexpr std::uint16_t kId = did::kLog;
  static constexpr std::size_t kMinBytes = 2, kMaxBytes = kMinBytes;
  LogLevel wanted = LogLevel::kOff;
  /// The image contains lines up to this level; the field is ignored when the value is written.
  LogLevel compiled = LogLevel::kOff;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(wire_number(wanted));
    out.u8(wire_number(compiled));
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (an unknown level).
  [[nodiscard]] static constexpr Result<LogSetting> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto wanted = checked_enum(bytes[0], LogLevel::kDebug), compiled = checked_enum(bytes[1], LogLevel::kDebug);
    if (!wanted || !compiled) return std::unexpected(Status::kOutOfRange);
    return LogSetting{*wanted, *compiled};
  }
  bool operator==(const LogSetting&) const = default;
};
static_assert(kLengthsAsInTable<LogSetting>);

namespace log_frame {
inline constexpr std::uint8_t kFirst = 0x80, kLast = 0x40, kCounterMask = 0x3F;
inline constexpr std::size_t kFirstHead = 7, kNextHead = 1;
/// A frame over USB carries 48 bytes, which is the shortest limit among the ports.
inline constexpr std::uint8_t kMaxBytes = 48;
/// Frames with 8 bytes or more can only have these lengths.
inline constexpr std::array<std::uint8_t, 7> kSizes{8, 12, 16, 20, 24, 32, 48};
}  // namespace log_frame

/// Splits a line into frames. The first one has flags and counter (1), level (1), number of the line (1), time (4) and
/// text; the following ones have flags, counter and text. Zeros fill up an FD frame.
class LogEncoder {
 public:
  /// Returns the next frame of `line`, at most `frame_bytes` (8, or 48 and more for FD) long. A repeated call returns
  /// the same frame.
  [[nodiscard]] constexpr CanFrame frame(const LogLine& line, std::uint8_t node, std::uint8_t frame_bytes) const {
    CanFrame f;
    f.id = kLogBase | node;
    f.extended = true;
    f.fd = f.bit_rate_switch = frame_bytes > 8;
    const std::size_t count = text_in(line, frame_bytes);
    ByteWriter w(f.data);
    const bool last = at_ + count == line.size;
    w.u8(static_cast<std::uint8_t>((begun_ ? 0 : log_frame::kFirst) | (last ? log_frame::kLast : 0) | counter_));
    if (!begun_) {
      w.u8(wire_number(line.level));
      w.u8(line.number);
      w.le32(line.time_ms);
    }
    for (std::size_t k = at_; k < at_ + count; ++k) w.u8(static_cast<std::uint8_t>(line.text[k]));
    f.size = static_cast<std::uint8_t>(w.size());
    if (f.fd) f.size = *std::ranges::find_if(log_frame::kSizes, [&](std::uint8_t s) { return s >= w.size(); });
    return f;
  }
  /// Notes that the frame was sent. Returns true if it was the last one of the line.
  [[nodiscard]] constexpr bool sent(const LogLine& line, std::uint8_t frame_bytes) {
    at_ += text_in(line, frame_bytes);
    begun_ = true;
    counter_ = (counter_ + 1) & log_frame::kCounterMask;
    if (at_ < line.size) return false;
    abandon();
    return true;
  }
  /// Drops the rest of the line, so that the next frame begins a new one.
  constexpr void abandon() {
    at_ = 0;
    begun_ = false;
  }

 private:
  [[nodiscard]] constexpr std::size_t text_in(const LogLine& line, std::uint8_t frame_bytes) const {
    const std::size_t room = std::min(frame_bytes, log_frame::kMaxBytes);
    return std::min<std::size_t>(line.size - at_, room - (begun_ ? log_frame::kNextHead : log_frame::kFirstHead));
  }
  std::size_t at_ = 0;
  bool begun_ = false;
  std::uint8_t counter_ = 0;
};

/// Joins the frames of one controller into lines.
class LogDecoder {
 public:
  /// Returns the line that `frame` completes, or nothing. Frames of another kind are ignored; a line with a missing
  /// frame is dropped and shows as a gap in the numbers.
  constexpr std::optional<LogLine> add(const CanFrame& frame) {
    const bool is_log = frame.extended && (frame.id & ~0xFFU) == kLogBase && frame.size >= 1;
    if (!is_log) return std::nullopt;
    const std::uint8_t flags = frame.data[0];
    const bool first = (flags & log_frame::kFirst) != 0, follows = (flags & log_frame::kCounterMask) == next_;
    next_ = (flags + 1) & log_frame::kCounterMask;
    whole_ = first ? begin(frame) : whole_ && follows;
    if (!whole_) return std::nullopt;
    take_text(frame.payload().subspan(first ? log_frame::kFirstHead : log_frame::kNextHead));
    if ((flags & log_frame::kLast) == 0) return std::nullopt;
    whole_ = false;
    return line_;
  }

 private:
  constexpr bool begin(const CanFrame& frame) {
    if (frame.size < log_frame::kFirstHead) return false;
    ByteReader r(frame.payload().subspan(1));
    const auto level = checked_enum(r.u8(), LogLevel::kDebug);
    line_ = LogLine{};
    if (!level) return false;
    line_.level = *level;
    line_.number = r.u8();
    line_.time_ms = r.le32();
    return true;
  }
  constexpr void take_text(Bytes bytes) {
    for (const std::uint8_t b : bytes) {
      if (b != 0 && line_.size < kMaxLogText) line_.text[line_.size++] = static_cast<char>(b);
    }
  }
  LogLine line_;
  bool whole_ = false;
  std::uint8_t next_ = 0;
};

}  // namespace triskin::wire
