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
     .boot_pin = "BOOT0"},
}};

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
      {"probe-rs",
       fmt::format("probe-rs download --chip {} --chip-erase --binary-format hex {}.hex", board.part, file)},
      {"pyOCD", fmt::format("pyocd flash --target {} --erase chip {}.hex", target, file)},
      {"st-flash", fmt::format("st-flash erase && st-flash --reset write {}.bin 0x08000000", file)},
      {"STM32CubeProgrammer", fmt::format("STM32_Programmer_CLI -c port=SWD mode=UR -e all -w {}.hex -v -rst", file)},
  };
}

}  // namespace triskin::deploy
