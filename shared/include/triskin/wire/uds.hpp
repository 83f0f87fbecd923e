// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// Diagnostics (ISO 14229-1): services, identifiers and codes that host and firmware share. docs/protocol.md explains
/// them.
namespace triskin::wire {

inline constexpr std::uint16_t kWireVersion = 1;  ///< a host that meets another may only identify, read and update

namespace service {
inline constexpr std::uint8_t kSession = 0x10, kReset = 0x11, kClearFaults = 0x14, kReadFaults = 0x19, kRead = 0x22,
                              kSecurity = 0x27, kWrite = 0x2E, kRoutine = 0x31, kDownload = 0x34, kUpload = 0x35,
                              kTransfer = 0x36, kTransferExit = 0x37, kTesterPresent = 0x3E, kNegative = 0x7F;
inline constexpr std::uint8_t kPositive = 0x40;  ///< added to the service in a positive response
}  // namespace service

namespace session {
inline constexpr std::uint8_t kDefault = 0x01, kProgramming = 0x02, kExtended = 0x03;
}

/// Negative response codes.
namespace nrc {
inline constexpr std::uint8_t kServiceNotSupported = 0x11, kSubFunctionNotSupported = 0x12, kWrongLength = 0x13,
                              kConditionsNotCorrect = 0x22, kSequenceError = 0x24, kOutOfRange = 0x31,
                              kSecurityDenied = 0x33, kInvalidKey = 0x35, kAttemptsExceeded = 0x36,
                              kUploadNotAccepted = 0x70, kProgrammingFailure = 0x72, kWrongBlock = 0x73,
                              kPending = 0x78, kSubFunctionNotInSession = 0x7E, kServiceNotInSession = 0x7F;
}

/// Data identifiers.
namespace did {
inline constexpr std::uint16_t kActiveSession = 0xF186, kSerialNumber = 0xF18C, kPartNumber = 0xF190,
                               kHardware = 0xF191, kFirmware = 0xF195;
inline constexpr std::uint16_t kHello = 0xFD00;         ///< wire version, layout version, firmware version, limits
inline constexpr std::uint16_t kNodeAddress = 0xFD01;   ///< 1 byte; written with security access
inline constexpr std::uint16_t kActiveTable = 0xFD02;   ///< status, sequence, design id, CRC, modules
inline constexpr std::uint16_t kModuleStates = 0xFD03;  ///< per module of the table: state, where it was found
inline constexpr std::uint16_t kStatistics = 0xFD04;    ///< samples, bus errors, recoveries
inline constexpr std::uint16_t kStream = 0xFD05;        ///< StreamMode, 1 byte
inline constexpr std::uint16_t kLineStates = 0xFD06;    ///< per line: stuck, recoveries
inline constexpr std::uint16_t kTopology = 0xFD07;      ///< modules and joints as found (wire/topology.hpp)
inline constexpr std::uint16_t kRoute = 0xFD08;         ///< what the route keeper did, and the tree that is active
inline constexpr std::uint16_t kImageState = 0xFD09;  ///< slot that runs, confirmed, sequence, bytes, CRC of its record
inline constexpr std::uint16_t kSampling =
    0xFD0A;  ///< Decimation, every n-th sequence, TaxelOutput; 1 byte each; reset by power-up
inline constexpr std::uint16_t kLiveTaxels = 0xFD10;  ///< per module: validity, 12 × 16 bit
inline constexpr std::uint16_t kFreezeTime = 0xFD21,
                               kFreezeSample = 0xFD22;  ///< of a fault: ms since power-up, sample; 32 bit
}  // namespace did

namespace routine {
inline constexpr std::uint16_t kDiscover = 0x0201, kSelfTest = 0x0202, kCalibrate = 0x0203, kReroute = 0x0204,
                               kActivate = 0x0205;
}

/// Memory areas of download and upload (0x34, 0x35): 4-byte address, 4-byte size.
namespace memory {
inline constexpr std::uint32_t kInactiveTable = 0x00010000, kActiveTable = 0x00020000;
inline constexpr std::uint16_t kMaxBlockBytes = 66;  ///< 0x36 with counter: 64 bytes of data a block
}  // namespace memory

/// What the controller sends by itself.
enum class StreamMode : std::uint8_t { kOff = 0, kIcub = 1, kFull = 2 };

/// Readings that the converter adds up for one result: more of them, less noise and fewer samples. As in its power
/// control.
enum class Decimation : std::uint8_t { k256 = 0, k128 = 1, k64 = 2 };

/// What a taxel's 16 bits are.
enum class TaxelOutput : std::uint8_t {
  kRaw = 0,          ///< the converter's result
  kCompensated = 1,  ///< 0x8000 at rest; baseline and temperature taken away
};

/// What is known about a module of the table. The numbers are part of the wire version.
enum class ModuleState : std::uint8_t {
  kUnknown = 0,
  kOk = 1,
  kAbsent = 2,             ///< nobody answers at its line and address
  kWrongId = 3,            ///< answers with another device id
  kLostConfiguration = 4,  ///< configuration read back differs; was written again
  kSaturated = 5,          ///< a taxel at the end of its range
  kFrozen = 6,             ///< a taxel that does not change by a single count
  kLineStuck = 7,          ///< its line is held low
  kDuplicate = 8,          ///< two chips answer at its address
};

/// 29-bit identifiers of normal fixed addressing (ISO 15765-2): 0x18DA‹target›‹source›.
inline constexpr std::uint8_t kTesterAddress = 0xF1;
inline constexpr std::uint32_t kPhysicalBase = 0x18DA0000, kFunctionalId = 0x18DB33F1;
[[nodiscard]] constexpr std::uint32_t physical_id(std::uint8_t target, std::uint8_t source) {
  return kPhysicalBase | static_cast<std::uint32_t>(target) << 8 | source;
}

inline constexpr std::uint64_t kP2_us = 50'000, kP2Star_us = 5'000'000, kS3_us = 5'000'000;

/// Key of security access for a seed: keeps accidents out, not attackers; both sides compute it from here.
[[nodiscard]] constexpr std::uint32_t security_key(std::uint32_t seed) {
  std::uint32_t x = seed ^ 0x5453'4B4EU;
  x ^= x << 13;
  x ^= x >> 17;
  x ^= x << 5;
  return x;
}

}  // namespace triskin::wire
