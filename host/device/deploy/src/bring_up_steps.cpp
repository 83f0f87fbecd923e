// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "triskin/deploy/bring_up.hpp"

namespace triskin::deploy {
namespace {

BringUpStep option_bytes(const BringUpBoard& board) {
  if (board.two_banks)
    return {3, "Read the option bytes (FLASH_OPTR, 0x40022020).", "bits 22, 26, 27 and 7…0",
            "DBANK (22) = 1, RDP (7…0) = AA",
            "DBANK = 0: set it, which needs a mass erase; RDP not AA: the firmware cannot set the options"};
  return {3, "Read the option bytes (FLASH_OPTR, 0x40022020).", "bits 26, 27 and 7…0", "RDP (7…0) = AA",
          "RDP not AA: the firmware cannot set the options"};
}

BringUpStep boot_options(const BringUpBoard& board) {
  const bool idle_bus = board.boot_pin.find("CAN") != std::string_view::npos;
  return {4, "Set nSWBOOT0 = 0, nBOOT0 = 1 and BOR_LEV = 4 (the lines of step 5 do), cycle the power, read again.",
          "FLASH_OPTR", "0xFBEFFCAA on a new chip",
          fmt::format("otherwise {} starts the ROM's loader and the board looks dead",
                      idle_bus ? "an idle CAN bus" : fmt::format("{} that is high", board.boot_pin))};
}

BringUpStep programming(const BringUpBoard& board) {
  const std::string_view crystal = board.measures_crystal ? "16: the crystal" : "16: the crystal, if X3 is fitted";
  return {5,
          "Erase the chip and program the factory file.",
          "triskin_budget by the debugger",
          fmt::format("loops counts up, findings is 0 or 4{}", board.measures_crystal ? "" : " (16 without X3)"),
          fmt::format("{}2 or 32: cycle the power; 8: read protected; {}; loops stands: triskin_survivor has the "
                      "crash record",
                      board.two_banks ? "1: DBANK; " : "", crystal),
          programmer_lines(board)};
}

BringUpStep crystal(const BringUpBoard& board) {
  constexpr std::string_view kLook = "what triskin discover says of it, or OSC_OUT with a 1:10 probe";
  if (board.measures_crystal)
    return {6, "Look at the crystal.", std::string(kLook), "its frequency, within 2 %",
            "silent: missing, broken or badly loaded; unknown: an overtone; the firmware runs from the RC oscillator "
            "then, do not ship"};
  return {6, "Look at the crystal X3 (8 MHz); the board is delivered without it.", std::string(kLook),
          "8 MHz is used, within 2 %",
          "silent: missing, broken or badly loaded; the firmware runs from the RC oscillator then, do not ship; a chip "
          "that does not measure its crystal runs too fast or too slow with another one"};
}

BringUpStep can_bus(const BringUpBoard& board) {
  return {7, fmt::format("Connect CAN{}, 120 Ω at both ends.", board.can_fd ? "" : " (classic frames, 1 Mbit/s)"),
          "controllers that answer, versions, frames of a second",
          "every controller answers, with an address of its own",
          fmt::format("nothing is sent: step 5; never acknowledged: H and L swapped, termination, bit rate{}",
                      board.can_fd ? "; errors in the data phase only: the transceiver is too slow" : "")};
}

}  // namespace

std::array<BringUpStep, 12> bring_up_steps(const BringUpBoard& board) {
  return {{
      {1, "Power the board, nothing flashed.", "3.3 V at the chip, supply current", "3.3 V ± 3 %, below 30 mA",
       "0 V: the supply; above 100 mA: a short, find it before going on"},
      {2, "Attach a debugger (SWD).", "id of the chip, size of its flash",
       fmt::format("id {} ({}), 512 KB of flash", board.chip_id, board.chip),
       "no answer: SWDIO, SWCLK, NRST; a part of 128 or 256 KB cannot be used"},
      option_bytes(board),
      boot_options(board),
      programming(board),
      crystal(board),
      can_bus(board),
      {8, board.usb ? "Plug in USB." : "This board has no USB.", "controllers that answer over it",
       "enumerates and answers",
       "no pull-up at D+: the firmware does not run; resets again and again: D+ and D− swapped"},
      {9, "Look at SCL and SDA of each line.", "rise time from 30 to 70 % (scope); lines held low, recoveries",
       "high, at most 300 ns; no line held low that is used",
       "low: short or no pull-up; slower than 300 ns: stronger pull-up or less cable"},
      {10, "Connect the converters.", "what answers at each address, with which id",
       "each module of the design answers, and nothing else",
       "no answer: address straps, a part without -1 (it speaks SPI), VDRIVE; SDA stays low: the converter's supply"},
      {11, "Write the tables and verify.", "findings of triskin verify", "none",
       "the table of findings in docs/diagnose.md says which strap, joint or part"},
      {12, "Watch the samples; nothing touches the skin.", "rate, noise, rest value and offset of each taxel",
       "every module streams, each taxel rests in the middle third, noise below 10 counts RMS",
       "outside the middle third: the electrode has less than 2 or more than 18 pF, is open or shorted; noise: supply "
       "or ground of the module"},
  }};
}

namespace {

std::string failure_text(const StepReport& r, const BringUpStep& step) {
  std::string text = fmt::format("\n## Step {}\n\nMeasured: {}. Should be: {}. Otherwise: {}.\n", r.number,
                                 step.measures, step.expects, step.otherwise);
  for (const ProgrammerLine& line : step.commands) text += fmt::format("\n- {}: `{}`", line.programmer, line.command);
  if (!step.commands.empty()) text += "\n";
  return text;
}

}  // namespace

std::string to_markdown(const std::vector<StepReport>& reports, std::string_view link_name, const BringUpBoard& board) {
  const std::array<BringUpStep, 12> steps = bring_up_steps(board);
  std::string text =
      fmt::format("# Bring-up report\n\nBoard: {}. Link: {}\n\n| step | do | outcome | found |\n|---|---|---|---|\n",
                  board.name, link_name);
  for (const StepReport& r : reports) {
    const BringUpStep& step = steps.at(static_cast<std::size_t>(r.number - 1));
    text += fmt::format("| {} | {} | {} | {} |\n", r.number, step.does, kStepOutcomeNames.name(r.outcome), r.found);
  }
  for (const StepReport& r : reports) {
    if (r.outcome == StepOutcome::kFailed) text += failure_text(r, steps.at(static_cast<std::size_t>(r.number - 1)));
  }
  return text;
}

}  // namespace triskin::deploy
