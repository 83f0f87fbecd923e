// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// Reports the health of the board (FD11) and its last crash (FD12); see docs/protocol.md.
namespace triskin::wire {

/// The controller tried to use its crystal with this result.
enum class Crystal : std::uint8_t {
  kUsed,         ///< The crystal was measured, is in the list, and drives every clock.
  kSilent,       ///< The crystal does not start: it is missing, broken, or badly loaded.
  kNotMeasured,  ///< The crystal runs, but its edges did not reach the timer that measures them.
  kUnknown,      ///< The crystal runs at a frequency that is not in the list.
  kNoLock,       ///< The PLL did not lock to the crystal.
  kNoPll,        ///< The PLL does not lock to the internal oscillator either.
  kNotSaid,      ///< An older loader started the clocks but did not report on them.
};

/// The controller's clock comes from the crystal with Crystal::kUsed, otherwise from the internal oscillator (± 1 %).
struct ClockState {
  Crystal crystal = Crystal::kNotSaid;
  std::uint8_t crystal_mhz = 0;  ///< Zero means that the internal oscillator is used.
  /// The loader measures the crystal against the internal oscillator; 0 means that it did not.
  std::uint16_t measured_khz = 0;
  bool operator==(const ClockState&) const = default;
};

/// Several of these bits of BoardHealth::reset_cause can be set at once.
namespace reset_cause {
inline constexpr std::uint8_t kPower = 1, kPin = 2, kSoftware = 4, kWatchdog = 8, kOptions = 16;
}  // namespace reset_cause

/// BoardHealth::can_state has these bits.
namespace can_state {
inline constexpr std::uint8_t kWarning = 1, kErrorPassive = 2, kBusOff = 4;
}  // namespace can_state

/// Identifier FD11 carries this value. Counters start at the last reset and wrap around to 0 after the largest value of
/// their type.
struct BoardHealth {
  static constexpr std::uint16_t kId = did::kBoardHealth;
  static constexpr std::size_t kMinBytes = 54, kMaxBytes = kMinBytes;
  ClockState clock;
  std::uint8_t reset_cause = 0;                              ///< The bits of wire::reset_cause explain the last reset.
  std::uint16_t findings = 0;                                ///< The bits are listed in docs/bring_up.md.
  std::uint8_t crashes_in_row = 0;                           ///< One minute without a crash resets this counter.
  std::uint8_t can_send_errors = 0, can_receive_errors = 0;  ///< ISO 11898-1 defines both error counters.
  std::uint8_t can_state = 0;                                ///< The bits are those of wire::can_state.
  /// The CAN controller reports this code: 0 means no error, 7 means none since the last reading.
  std::uint8_t can_last_error = 0;
  std::uint32_t bus_offs = 0;
  std::uint32_t can_lost = 0;  ///< The counter shows received frames for which there was no room.
  /// The counter shows how often the CAN controller could not access its message RAM.
  std::uint16_t can_ram_failures = 0;
  /// The ECC of the flash repaired one wrong bit in the first case and only detected two in the second.
  std::uint32_t ecc_corrected = 0, ecc_detected = 0;
  std::uint32_t flash_errors = 0;  ///< The counter includes refused erase and program operations.
  std::uint32_t worst_loop_us = 0, worst_interrupt_us = 0;
  /// The second value is the part of the stack that was never written to.
  std::uint16_t stack_bytes = 0, stack_free_bytes = 0;
  std::uint16_t idle_permille = 0;  ///< The idle share refers to the time since the last reset.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(wire_number(clock.crystal));
    out.u8(clock.crystal_mhz);
    out.le16(clock.measured_khz);
    out.u8(reset_cause);
    out.le16(findings);
    for (const std::uint8_t v : {crashes_in_row, can_send_errors, can_receive_errors, can_state, can_last_error})
      out.u8(v);
    out.le32(bus_offs);
    out.le32(can_lost);
    out.le16(can_ram_failures);
    for (const std::uint32_t v : {ecc_corrected, ecc_detected, flash_errors, worst_loop_us, worst_interrupt_us})
      out.le32(v);
    for (const std::uint16_t v : {stack_bytes, stack_free_bytes, idle_permille}) out.le16(v);
    for (int k = 0; k < 6; ++k) out.u8(0);
  }
  /// Decodes the wire format and ignores the last six bytes, which are reserved. Errors: kBadLength, kOutOfRange (an
  /// unknown state of the crystal).
  [[nodiscard]] static constexpr Result<BoardHealth> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    BoardHealth h;
    const auto crystal = checked_enum(r.u8(), Crystal::kNotSaid);
    if (!crystal) return std::unexpected(crystal.error());
    h.clock.crystal = *crystal;
    h.clock.crystal_mhz = r.u8();
    h.clock.measured_khz = r.le16();
    h.reset_cause = r.u8();
    h.findings = r.le16();
    for (std::uint8_t* v :
         {&h.crashes_in_row, &h.can_send_errors, &h.can_receive_errors, &h.can_state, &h.can_last_error})
      *v = r.u8();
    h.bus_offs = r.le32();
    h.can_lost = r.le32();
    h.can_ram_failures = r.le16();
    for (std::uint32_t* v :
         {&h.ecc_corrected, &h.ecc_detected, &h.flash_errors, &h.worst_loop_us, &h.worst_interrupt_us})
      *v = r.le32();
    for (std::uint16_t* v : {&h.stack_bytes, &h.stack_free_bytes, &h.idle_permille}) *v = r.le16();
    return h;
  }
  bool operator==(const BoardHealth&) const = default;
};
static_assert(kLengthsAsInTable<BoardHealth>);

/// The controller can stop for these reasons.
enum class CrashCause : std::uint8_t {
  kNone,
  kFault,          ///< The processor refused an instruction or an access to memory.
  kStackOverflow,  ///< The stack left its memory.
  kWatchdog,       ///< The main loop did not run for two seconds.
  kClock,          ///< The crystal stopped, or no clock started.
  kInterrupt,      ///< An interrupt arrived for which there is no handler.
  kProgram,        ///< The program stopped itself, by calling a null function or by leaving main.
};

/// Identifier FD12 carries this value. It survives resets in RAM and power failures in the fault memory. If there was
/// no crash, the cause is kNone.
struct Crash {
  static constexpr std::uint16_t kId = did::kCrash;
  static constexpr std::size_t kMinBytes = 44, kMaxBytes = kMinBytes;
  CrashCause cause = CrashCause::kNone;
  bool while_erasing = false;    ///< Erasing a page stalls reads of the same flash bank.
  std::uint16_t exception = 0;   ///< The processor numbers its exceptions; 0 means that the main loop was running.
  std::uint32_t pc = 0, lr = 0;  ///< Both are addresses within the image at `origin`; 0 means unknown.
  std::uint32_t sp = 0;          ///< The stack pointer has the value from before the fault.
  /// The processor's registers CFSR and HFSR explain the fault.
  std::uint32_t fault_status = 0, hard_fault_status = 0;
  /// Access to this address failed if fault_status marks it as valid; otherwise it is 0.
  std::uint32_t address = 0;
  std::uint32_t uptime_ms = 0;
  std::uint32_t firmware_version = 0;
  std::uint32_t origin = 0;  ///< The image that crashed was linked for this address.
  std::uint32_t number = 0;  ///< Crashes are counted from power-up.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(wire_number(cause));
    out.u8(while_erasing ? 1 : 0);
    out.le16(exception);
    for (const std::uint32_t v :
         {pc, lr, sp, fault_status, hard_fault_status, address, uptime_ms, firmware_version, origin, number})
      out.le32(v);
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (an unknown cause).
  [[nodiscard]] static constexpr Result<Crash> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    Crash c;
    const auto cause = checked_enum(r.u8(), CrashCause::kProgram);
    const auto erasing = checked_bool(r.u8());
    if (!cause || !erasing) return std::unexpected(Status::kOutOfRange);
    c.cause = *cause;
    c.while_erasing = *erasing;
    c.exception = r.le16();
    for (std::uint32_t* v : {&c.pc, &c.lr, &c.sp, &c.fault_status, &c.hard_fault_status, &c.address, &c.uptime_ms,
                             &c.firmware_version, &c.origin, &c.number})
      *v = r.le32();
    return c;
  }
  bool operator==(const Crash&) const = default;
};
static_assert(kLengthsAsInTable<Crash>);

}  // namespace triskin::wire
