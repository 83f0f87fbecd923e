// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "triskin/base/error.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/deploy/bring_up.hpp"

namespace triskin::deploy {

namespace {

constexpr std::array<BringUpBoard, 3> kBoards{{
    {.name = "nucleo_g474re", .chip = "STM32G474", .chip_id = "0x469", .part = "STM32G474RETx", .build = "firmware"},
    {.name = "icub_patch",
     .chip = "STM32G474",
     .chip_id = "0x469",
     .part = "STM32G474RETx",
     .build = "icub_patch",
     .usb = false,
     .boot_pin = "BOOT0"},
    {.name = "nucleo_l452re",
     .chip = "STM32L452",
     .chip_id = "0x462",
     .part = "STM32L452RETx",
     .build = "nucleo_l452re",
     .two_banks = false,
     .measures_crystal = false,
     .can_fd = false,
     .usb = false,
     .boot_pin = "BOOT0",
     .st_flash_writes_options = false},
}};

// The option bytes of a new chip with nSWBOOT0 = 0 and BOR_LEV = 4.
constexpr std::string_view kOptions = "0xFBEFFCAA";

// What a programmer without a command of its own for option bytes writes: unlock the flash, then the option bytes;
// value; start. Registers of FLASH by the last two digits of their addresses.
struct RegisterWrite {
  std::string_view offset, value;
};
constexpr std::array<RegisterWrite, 6> kOptionWrites{{{"08", "0x45670123"},
                                                      {"08", "0xCDEF89AB"},
                                                      {"0C", "0x08192A3B"},
                                                      {"0C", "0x4C5D6E7F"},
                                                      {"20", kOptions},
                                                      {"14", "0x00020000"}}};
constexpr std::string_view kLoadOptions = "0x08000000";  // CR.OBL_LAUNCH resets the chip.

std::string probe_rs(std::string_view part, std::string_view file) {
  std::string writes;
  for (const RegisterWrite& w : kOptionWrites) writes += fmt::format("\"{} {}\" ", w.offset, w.value);
  return fmt::format(
      "probe-rs download --chip {0} --chip-erase --binary-format hex {1}.hex && for w in {2}\"14 {3}\"; do probe-rs "
      "write "
      "--chip {0} b32 0x400220$w; done; probe-rs reset --chip {0}",
      part, file, writes, kLoadOptions);
}

std::string pyocd(std::string_view target, std::string_view file) {
  std::string writes;
  for (const RegisterWrite& w : kOptionWrites)
    writes += fmt::format(" -c \"write32 0x400220{} {}\"", w.offset, w.value);
  return fmt::format(
      "pyocd flash --target {0} --erase chip {1}.hex && pyocd cmd --target {0} -c \"reset halt\"{2} -c \"sleep 100\" "
      "-c "
      "\"write32 0x40022014 {3}\"; pyocd reset --target {0}",
      target, file, writes, kLoadOptions);
}

std::string st_flash(const BringUpBoard& board, std::string_view file) {
  const std::string options =
      board.st_flash_writes_options ? fmt::format(" && st-flash --area=option write {}", kOptions) : "";
  return fmt::format("st-flash erase && st-flash write {}.bin 0x08000000{} && st-flash reset", file, options);
}

}  // namespace

std::span<const BringUpBoard> bring_up_boards() {
  return kBoards;
}

const BringUpBoard& bring_up_board(std::string_view name) {
  std::string names;
  for (const BringUpBoard& board : bring_up_boards()) {
    if (board.name == name) return board;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", board.name);
  }
  throw InputError(fmt::format("no board is called '{}'; choose one of {}", name, names));
}

std::vector<ProgrammerLine> programmer_lines(const BringUpBoard& board) {
  const std::string folder = "firmware/board/" + lower_case(board.chip), target = lower_case(board.part);
  const std::string file = fmt::format("build/{}/bin/triskin_factory", board.build);
  return {
      {"OpenOCD", fmt::format("openocd -f {}/openocd.cfg -c \"triskin_program {}.hex\"", folder, file)},
      {"probe-rs", probe_rs(board.part, file)},
      {"pyOCD", pyocd(target, file)},
      {"st-flash", st_flash(board, file)},
      {"STM32CubeProgrammer",
       fmt::format(
           "STM32_Programmer_CLI -c port=SWD mode=UR -e all -w {}.hex -v -ob nSWBOOT0=0 nBOOT0=1 BOR_LEV=4 -rst",
           file)},
  };
}

}  // namespace triskin::deploy
