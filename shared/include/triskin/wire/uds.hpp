// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/identifiers.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/module_state.hpp"
#include "triskin/wire/sampling.hpp"

/// Host and firmware share the services and codes of the diagnostics (ISO 14229-1), with their identifiers and
/// enumerations. docs/protocol.md explains them.
namespace triskin::wire {

namespace service {
inline constexpr std::uint8_t kSession = 0x10, kReset = 0x11, kClearFaults = 0x14, kReadFaults = 0x19, kRead = 0x22,
                              kSecurity = 0x27, kWrite = 0x2E, kRoutine = 0x31, kDownload = 0x34, kUpload = 0x35,
                              kTransfer = 0x36, kTransferExit = 0x37, kTesterPresent = 0x3E, kNegative = 0x7F;
inline constexpr std::uint8_t kPositive = 0x40;  ///< A positive response carries the number of the service plus this.
}  // namespace service

/// ISO 14229-1 defines these negative response codes.
namespace nrc {
inline constexpr std::uint8_t kServiceNotSupported = 0x11, kSubFunctionNotSupported = 0x12, kWrongLength = 0x13,
                              kConditionsNotCorrect = 0x22, kSequenceError = 0x24, kOutOfRange = 0x31,
                              kSecurityDenied = 0x33, kInvalidKey = 0x35, kAttemptsExceeded = 0x36, kKeysLocked = 0x37,
                              kUploadNotAccepted = 0x70, kProgrammingFailure = 0x72, kWrongBlock = 0x73,
                              kPending = 0x78, kSubFunctionNotInSession = 0x7E, kServiceNotInSession = 0x7F;
}

/// Download and upload (0x34, 0x35) access these memory areas with a 4-byte address and a 4-byte size.
namespace memory {
inline constexpr std::uint32_t kInactiveTable = 0x00010000, kActiveTable = 0x00020000;
/// Service 0x36 carries 64 bytes of data in each block, with a counter.
inline constexpr std::uint16_t kMaxBlockBytes = 66;
}  // namespace memory

/// Normal fixed addressing (ISO 15765-2) uses 29-bit identifiers: 0x18DA‹target›‹source›.
inline constexpr std::uint8_t kTesterAddress = 0xF1;
inline constexpr std::uint32_t kPhysicalBase = 0x18DA0000, kFunctionalId = 0x18DB33F1;
/// Returns the identifier of a frame from `source` to `target` (normal fixed addressing).
[[nodiscard]] constexpr std::uint32_t physical_id(std::uint8_t target, std::uint8_t source) {
  return kPhysicalBase | static_cast<std::uint32_t>(target) << 8 | source;
}

inline constexpr std::uint64_t kP2_us = 50'000, kP2Star_us = 5'000'000, kS3_us = 5'000'000;
/// After three wrong keys in a row a controller gives no seed for this long, or until it is reset.
inline constexpr std::uint64_t kKeyLock_us = 10'000'000;

/// Computes the security access key for a seed on both sides. It prevents accidents, not attacks.
[[nodiscard]] constexpr std::uint32_t security_key(std::uint32_t seed) {
  std::uint32_t x = seed ^ 0x5453'4B4EU;
  x ^= x << 13;
  x ^= x >> 17;
  x ^= x << 5;
  return x;
}

}  // namespace triskin::wire
