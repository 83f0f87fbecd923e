// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/health.hpp"

namespace triskin::board {

/// After this many crashes without a minute of work between them, the loader gives up on an image. It starts the other
/// one if that is valid; after as many more crashes, or without another image, it waits for a host that brings a better
/// one.
inline constexpr std::uint32_t kMaxCrashesInRow = 5;

/// These data in RAM survive a reset; power-up clears them. The loader and the application, which may be of different
/// versions, share them, so fields are only ever appended, and `magic` changes when a field changes its meaning.
struct Survivor {
  std::uint32_t magic;
  std::uint32_t dfu_request;     ///< The mark asks the loader to become a DFU device.
  std::uint32_t reset_pressed;   ///< With the mark, a reset by the pin is the second one of a double reset.
  std::uint32_t running;         ///< The mark says that an application was started and has not ended on purpose.
  std::uint32_t reset_flags;     ///< RCC_CSR had this value after the last reset.
  std::uint32_t crashes_in_row;  ///< An application that has worked for a minute sets it to 0.
  std::uint32_t crashes;         ///< Crashes are counted from power-up.
  std::uint32_t crashes_seen;    ///< The loader has seen this many crashes.
  std::uint32_t uptime_ms;       ///< The application writes its uptime here once per second.
  wire::ClockState clock;        ///< The clock is the choice of start_clocks().
  wire::Crash crash;             ///< The last crash has the cause kNone if there was none.
  /// Not 0: the option bytes were written since power-up. They count from the next one on, so their register shows the
  /// old ones after each reset until then.
  std::uint32_t options_written;
};

/// Returns the one in RAM. Before open_survivor() its contents are arbitrary.
[[nodiscard]] Survivor& survivor();

/// Must be the loader's first action after each reset: initializes the survivor after power-up, reads and clears the
/// reset flags, and counts a crash. The application calls it too, because a debugger may have started it.
void open_survivor();

/// Notes that the loader is about to start an application, so that a crash counts from now on.
void note_application_starts();
/// Returns true when the reset pin was pressed a second time before end_double_reset(). Call it once after a reset.
[[nodiscard]] bool take_double_reset();
/// Makes the next reset by the pin the first of two.
void end_double_reset();

/// Records a crash of the running image and resets the controller.
[[noreturn]] void fail(wire::CrashCause cause);

}  // namespace triskin::board
