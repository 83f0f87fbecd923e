// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/health.hpp"

namespace triskin::board {

/// Crashes without a minute of work between them after which the loader leaves an image: for the other one when it is
/// valid, and after as many more, or without another one, for a host that brings a better one.
inline constexpr std::uint32_t kMaxCrashesInRow = 5;

/// Data in the RAM that survives a reset; power-up clears it. The loader and the application, which may be of
/// different versions, share it: fields are only ever appended, and `magic` changes when one changes its meaning.
struct Survivor {
  std::uint32_t magic;
  std::uint32_t dfu_request;     ///< a mark: the loader becomes a DFU device
  std::uint32_t reset_pressed;   ///< a mark: a reset by the pin now is the second one of a double reset
  std::uint32_t running;         ///< a mark: an application was started and has not ended on purpose
  std::uint32_t reset_flags;     ///< RCC_CSR as the last reset left it
  std::uint32_t crashes_in_row;  ///< set to 0 by an application that has worked for a minute
  std::uint32_t crashes;         ///< number since power-up
  std::uint32_t crashes_seen;    ///< number of crashes that the loader has seen
  std::uint32_t uptime_ms;       ///< uptime of the application in its last second
  wire::ClockState clock;        ///< what start_clocks() chose
  wire::Crash crash;             ///< the last one; its cause is kNone when there was none
};

/// The one in the RAM. Before open_survivor() it may hold anything.
[[nodiscard]] Survivor& survivor();

/// Once after each reset, first of all in the loader: makes the survivor of a power-up, takes and clears the reset
/// flags, counts a crash. Called by the application, too: it may have been started by a debugger.
void open_survivor();

/// The loader says so before it jumps: a crash counts from now on.
void note_application_starts();
/// True when the reset pin was pressed twice: the second time before end_double_reset(). Asked once after a reset.
[[nodiscard]] bool take_double_reset();
/// Makes the next reset by the pin the first of two.
void end_double_reset();

/// Crash records of the image that runs; each resets the controller.
[[noreturn]] void fail(wire::CrashCause cause);

}  // namespace triskin::board
