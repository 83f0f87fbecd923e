// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/session/controller.hpp"
#include "triskin/wire/health.hpp"

namespace triskin::device {

/// What a controller says about its own board. Both are empty with firmware that does not know them.
struct BoardReport {
  std::optional<wire::BoardHealth> health;
  std::optional<wire::Crash> crash;  ///< empty: nothing stopped it since its faults were cleared
};

/// Asks one controller. Throws DeviceError as every request does.
[[nodiscard]] BoardReport report_board(Controller& controller);

/// A place in a source file; empty strings where the image does not say.
struct CodePlace {
  std::string function, line;  ///< The line is `file:number`.
};

/// Function and line of an address in an image with debug information, by addr2line of the ARM tools or of LLVM. Throws
/// InputError when the file is no image or none of these programs is installed.
[[nodiscard]] CodePlace code_place(const std::filesystem::path& elf, std::uint32_t address);

/// "was stopped by a stack overflow after 3.2 s in …": a sentence about a crash, its subject is the controller. `elf`
/// as for board_remarks(). Throws InputError as code_place() does.
[[nodiscard]] std::string crash_text(const wire::Crash& crash, const std::filesystem::path& elf = {});

/// `text` with function and line in place of each address that a log names (`@0800abcd`). Throws InputError as
/// code_place() does. Cost: a process for each address.
[[nodiscard]] std::string name_places(const std::string& text, const std::filesystem::path& elf);

/// Sentences about what is not as it should be: the clock, a crash, CAN errors, the flash, the stack; none: all is
/// well. `elf`: the image that crashed, to name function and line; empty: addresses only.
[[nodiscard]] std::vector<std::string> board_remarks(const BoardReport& report, const std::filesystem::path& elf = {});

/// "8 MHz crystal", or where the clock comes from instead.
[[nodiscard]] std::string clock_text(const wire::ClockState& clock);

}  // namespace triskin::device
