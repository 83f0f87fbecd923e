// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// These settings (FD05, FD0A) decide how a controller samples, and what it sends unasked. See docs/protocol.md.
namespace triskin::wire {

/// The controller sends samples unasked in one of these formats.
enum class StreamMode : std::uint8_t {
  kOff = 0,
  kIcub = 1,  ///< A taxel has 8 bits, as on an iCub skin board.
  kFull = 2,  ///< A taxel has 16 bits, so the frames need CAN FD.
};

/// The converter adds up this many readings for one result, as in its power control register. More readings mean less
/// noise but fewer samples.
enum class Decimation : std::uint8_t { k256 = 0, k128 = 1, k64 = 2 };

/// Returns the time in µs in which a converter runs its twelve stages (data sheet table 11): the nominal time between
/// two samples.
[[nodiscard]] constexpr std::uint32_t sequence_us(Decimation d) {
  constexpr std::array<std::uint32_t, 3> kTimes{36'900, 18'400, 9'200};
  return kTimes[static_cast<std::size_t>(d)];
}

/// The 16 bits of a taxel can have one of these meanings.
enum class TaxelOutput : std::uint8_t {
  kRaw = 0,          ///< The stream carries the converter's result.
  kCompensated = 1,  ///< The stream carries 0x8000 at rest, because baseline and temperature are subtracted.
};

/// Decides at which moment a converter is read.
enum class SamplingTiming : std::uint8_t {
  kTracked = 0,  ///< The controller reads in the window in which all twelve results belong to one sequence.
  /// A timer triggers each nominal sequence, as on installed iCub boards, so results of two sequences may mix.
  kTimer = 1,
};

/// Converts a number from the wire. Errors: kOutOfRange.
[[nodiscard]] constexpr Result<StreamMode> to_stream_mode(std::uint8_t number) {
  return checked_enum(number, StreamMode::kFull);
}
/// Returns how many readings the converter adds up for one result: 256, 128 or 64.
[[nodiscard]] constexpr int readings_added(Decimation d) {
  return 256 >> static_cast<int>(d);
}

/// Converts a number from the wire. Errors: kOutOfRange.
[[nodiscard]] constexpr Result<Decimation> to_decimation(std::uint8_t number) {
  return checked_enum(number, Decimation::k64);
}
/// Converts a number from the wire. Errors: kOutOfRange.
[[nodiscard]] constexpr Result<TaxelOutput> to_taxel_output(std::uint8_t number) {
  return checked_enum(number, TaxelOutput::kCompensated);
}

/// Identifier FD05 carries this value.
struct StreamSetting {
  static constexpr std::uint16_t kId = did::kStream;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  StreamMode mode = StreamMode::kOff;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(wire_number(mode)); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<StreamSetting> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto mode = to_stream_mode(bytes[0]);
    if (!mode) return std::unexpected(mode.error());
    return StreamSetting{*mode};
  }
  bool operator==(const StreamSetting&) const = default;
};
static_assert(kLengthsAsInTable<StreamSetting>);

/// Identifier FD0A carries this value; the defaults apply after power-up. The fourth byte is omitted while it has its
/// default value, because older hosts and firmware know only three.
struct SamplingSetting {
  static constexpr std::uint16_t kId = did::kSampling;
  static constexpr std::size_t kMinBytes = 3, kMaxBytes = 4;
  Decimation decimation = Decimation::k256;
  std::uint8_t every = 1;  ///< Each n-th sequence is read, with n from 1 to 255.
  TaxelOutput output = TaxelOutput::kRaw;
  SamplingTiming timing = SamplingTiming::kTracked;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(wire_number(decimation));
    out.u8(every);
    out.u8(wire_number(output));
    if (timing != SamplingTiming::kTracked) out.u8(wire_number(timing));
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<SamplingSetting> decode(Bytes bytes) {
    if (bytes.size() < kMinBytes || bytes.size() > kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto decimation = to_decimation(bytes[0]);
    const auto output = to_taxel_output(bytes[2]);
    const auto timing = checked_enum(bytes.size() > kMinBytes ? bytes[3] : std::uint8_t{0}, SamplingTiming::kTimer);
    if (!decimation || !output || !timing || bytes[1] == 0) return std::unexpected(Status::kOutOfRange);
    return SamplingSetting{*decimation, bytes[1], *output, *timing};
  }
  bool operator==(const SamplingSetting&) const = default;
};
static_assert(kLengthsAsInTable<SamplingSetting>);

}  // namespace triskin::wire
