// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/session/controller.hpp"
#include "triskin/wire/health.hpp"

namespace triskin::diagnose {

/// A controller reports on its own board. Both fields are empty with firmware that does not support them.
struct BoardReport {
  std::optional<wire::BoardHealth> health;
  std::optional<wire::Crash> crash;  ///< Empty means that nothing stopped the controller since its faults were cleared.
};

/// Asks one controller. Throws DeviceError as every request does.
[[nodiscard]] BoardReport report_board(session::Controller& controller);

/// A place in a source file has empty strings if the image does not contain it.
struct CodePlace {
  std::string function, line;  ///< The line is written as `file:number`.
};

/// Returns function and line of an address in an image with debug information, by addr2line of the ARM tools or of
/// LLVM. Throws InputError when the file is not an image or none of these programs is installed.
[[nodiscard]] CodePlace code_place(const std::filesystem::path& elf, std::uint32_t address);

/// Describes a crash as the rest of a sentence whose subject is the controller: "was stopped by a stack overflow after
/// 3.2 s in …". `elf` as for board_remarks(). Throws InputError as code_place() does.
[[nodiscard]] std::string crash_text(const wire::Crash& crash, const std::filesystem::path& elf = {});

/// Replaces each address that a log names in `text` (`@0800abcd`) by function and line. Throws InputError as
/// code_place() does. Cost: a process for each address.
[[nodiscard]] std::string name_places(const std::string& text, const std::filesystem::path& elf);

/// Returns a sentence about each problem of the clock, CAN, flash or stack and about a crash; none means that all is
/// well. `elf` is the image that crashed and serves to name function and line; if it is empty, only addresses are
/// given.
[[nodiscard]] std::vector<std::string> board_remarks(const BoardReport& report, const std::filesystem::path& elf = {});

/// Names the source of the clock: "8 MHz crystal", or what replaces it.
[[nodiscard]] std::string clock_text(const wire::ClockState& clock);

}  // namespace triskin::diagnose
