// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// Identifier FD03 and routine 0202 report the states of modules; see docs/protocol.md.
namespace triskin::wire {

/// The controller distinguishes these states of a module of its table. The numbers are part of the wire version.
enum class ModuleState : std::uint8_t {
  kUnknown = 0,            ///< The module has not been checked yet.
  kOk = 1,                 ///< The module works as it should.
  kAbsent = 2,             ///< No chip answers at the module's line and address.
  kWrongId = 3,            ///< The chip answers with another device id.
  kLostConfiguration = 4,  ///< The configuration read back was not the one written, so it was written again.
  kSaturated = 5,          ///< A taxel is at the end of its range.
  kFrozen = 6,             ///< A taxel does not change by a single count, which a working one does by its noise.
  kLineStuck = 7,          ///< The module's line is held low.
  kDuplicate = 8,          ///< Two chips answer at the module's address.
};
inline constexpr std::size_t kModuleStateCount = 9;
inline constexpr ModuleState kFirstFaultState = ModuleState::kAbsent;  ///< States from here on are faults.

/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<ModuleState> to_module_state(std::uint8_t number) {
  return checked_enum(number, ModuleState::kDuplicate);
}

/// Identifier FD03 carries the state of each module, in the order of the table.
struct ModuleStates {
  static constexpr std::uint16_t kId = did::kModuleStates;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = layout::kMaxModules;
  std::uint8_t count = 0;  ///< Valid values are 0 to kMaxModules.
  std::array<ModuleState, layout::kMaxModules> state{};

  /// Returns the states of the modules, indexed by the row of the table.
  [[nodiscard]] constexpr std::span<const ModuleState> rows() const { return std::span(state).first(count); }
  /// Appends the state of the next row; the caller makes sure that there is room.
  constexpr void add(ModuleState s) { state[count++] = s; }
  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    for (const ModuleState s : rows()) out.u8(wire_number(s));
  }
  /// Decodes the wire format. Errors: kBadLength (more than kMaxModules), kOutOfRange (no such state).
  [[nodiscard]] static constexpr Result<ModuleStates> decode(Bytes bytes) {
    if (bytes.size() > kMaxBytes) return std::unexpected(Status::kBadLength);
    ModuleStates states;
    for (const std::uint8_t number : bytes) {
      const auto state = to_module_state(number);
      if (!state) return std::unexpected(state.error());
      states.add(*state);
    }
    return states;
  }
  bool operator==(const ModuleStates&) const = default;
};
static_assert(kLengthsAsInTable<ModuleStates>);

/// Routine 0202 returns whether every module was tested, and the states that it found.
struct SelfTestResult {
  static constexpr std::uint16_t kId = routine::kSelfTest;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1 + ModuleStates::kMaxBytes;
  bool done = false;
  ModuleStates modules;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(done ? 1 : 0);
    modules.encode(out);
  }
  /// Decodes the wire format. Errors: kTooShort, kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<SelfTestResult> decode(Bytes bytes) {
    if (bytes.empty()) return std::unexpected(Status::kTooShort);
    const auto done = checked_bool(bytes[0]);
    if (!done) return std::unexpected(done.error());
    const auto modules = ModuleStates::decode(bytes.subspan(1));
    if (!modules) return std::unexpected(modules.error());
    return SelfTestResult{*done, *modules};
  }
  bool operator==(const SelfTestResult&) const = default;
};
static_assert(kResultAsInTable<SelfTestResult>);

}  // namespace triskin::wire
