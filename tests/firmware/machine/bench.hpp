// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "behaviours.hpp"
#include "skin_line.hpp"
#include "tables_flash.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/machine/machine.hpp"
#include "triskin/sim/virtual_controller.hpp"
#include "triskin/wire/health.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::machine {

/// Returns the file of the built image; absent without the cross compiler.
[[nodiscard]] std::filesystem::path firmware(const char* name);

/// Describes a board of firmware/board: its images, and its pins.
struct BenchBoard {
  std::filesystem::path (*file)(const char* name);
  BoardPins pins;
  Chip chip = Chip::kStm32g474;
  bool fd = true;  ///< False means that its CAN block knows classic frames only.
};
/// Tests use this board unless they name another one.
[[nodiscard]] BenchBoard nucleo_board();
/// The board for installed iCub patches has one SCL and no USB.
[[nodiscard]] BenchBoard icub_patch_board();
/// The board with the other chip, an STM32L452, has four lines and no USB.
[[nodiscard]] BenchBoard nucleo_l452re_board();
/// The same chip with USB, CAN and line 1 at other pins (tests/firmware/machine/boards/l452_usb).
[[nodiscard]] BenchBoard l452_usb_board();

/// Pads the image to blocks of 32 frames with eight bytes, as the loader acknowledges them.
[[nodiscard]] std::vector<std::uint8_t> whole_blocks(const ElfImage& image);

/// Makes a patch of `modules` modules (four per line) for node 1.
[[nodiscard]] layout::PatchImage patch(int modules);

/// Module k of patch() is at line k % 4, address k / 4. The bench has four lines with sixteen modules, flash with
/// loader and application, and a tester on the CAN bus.
[[nodiscard]] inline int wanted_slot() {
  const char* wanted = std::getenv("TRISKIN_SLOT");
  return wanted != nullptr && std::string_view(wanted) == "b" ? 1 : 0;
}

/// The variable TRISKIN_CHIP runs the whole suite with the behaviour of the converters that has this name
/// (kBehaviours).
[[nodiscard]] inline const hardware::Ad7147Behaviour& wanted_behaviour() {
  const char* wanted = std::getenv("TRISKIN_CHIP");
  return behaviour_named(wanted != nullptr ? wanted : "");
}

/// The variable TRISKIN_RISE_NS sets the rise time of SCL for tests that do not set it themselves.
[[nodiscard]] inline std::uint32_t wanted_rise_ns() {
  const char* wanted = std::getenv("TRISKIN_RISE_NS");
  return wanted != nullptr ? static_cast<std::uint32_t>(std::atoi(wanted)) : 0;
}

class Bench : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(board.file("triskin_app_a.elf")))
      GTEST_SKIP() << "no firmware image: install gcc-arm-none-eabi and build again";
    for (int k = 0; k < layout::kMaxModules; ++k)
      lines[static_cast<std::size_t>(k % layout::kLines)].add(static_cast<std::uint8_t>(k / layout::kLines), k);
    behave(wanted_behaviour());
    flash.program_file(board.file(running_slot == 0 ? "triskin_factory.hex" : "triskin_factory_b.hex"));
    // The board was brought up (docs/bring_up.md).
    flash.options = (flash.options & ~(1U << 26 | 7U << 8)) | 4U << 8;
    application = read_elf(board.file(running_slot == 0 ? "triskin_app_a.elf" : "triskin_app_b.elf"));
  }
  void power_up(bool will_be_cut = false);
  /// Sets the behaviour of all chips; must be called before power-up.
  void behave(const hardware::Ad7147Behaviour& behaviour);
  [[nodiscard]] SkinLine& line_of(int module) { return lines[static_cast<std::size_t>(module % 4)]; }
  [[nodiscard]] SkinModule& module_at(int module) {
    return *line_of(module).modules[static_cast<std::size_t>(module / 4)];
  }
  /// Opens an extended session with security access.
  void unlock();
  [[nodiscard]] std::uint64_t now_us() const { return on_posix ? posix_us : machine->now_us(); }
  void run_for(std::uint64_t us);
  void deliver(const wire::CanFrame& frame) { on_posix ? posix->receive(frame) : machine->receive(frame); }
  /// Puts a table into flash as if it had been activated.
  void store_table(const layout::PatchImage& image, std::uint32_t sequence = 1);
  /// Downloads a table and activates it; returns true if the controller confirms that it is active.
  bool flash_table(const layout::PatchImage& image);
  /// Reads FD11 and FD12; empty if the controller does not answer or has nothing to report.
  std::optional<wire::BoardHealth> health();
  std::optional<wire::Crash> crash();
  /// Reads from FD09 whether the running image has confirmed itself.
  bool confirmed();
  /// Sends one UDS request over ISO-TP and returns the response; empty after this much silence.
  std::vector<std::uint8_t> request(const std::vector<std::uint8_t>& bytes, std::uint64_t patience_us = 200'000);
  /// Searches all modules anew, which tells two at one address apart.
  void self_test();
  /// Sends frames of the loader.
  void send(std::uint32_t id, std::span<const std::uint8_t> data);
  [[nodiscard]] std::uint32_t budget(std::uint32_t offset) const {
    return machine->read_word(application.symbols.at("triskin_budget") + offset);
  }
  void expect_no_violation() const {
    for (const Violation& v : machine->violations()) ADD_FAILURE() << v.at_us << " us: " << v.what;
  }

  BenchBoard board = nucleo_board();
  std::array<SkinLine, layout::kLines> lines;
  FlashChip flash;
  ElfImage application;
  std::vector<wire::CanFrame> frames;  ///< The controller sent these frames.
  VcdTrace* trace = nullptr;
  Profile* profile = nullptr;
  std::uint64_t crystal_hz = 8'000'000;
  std::uint64_t crystal_fails_at_us = ~std::uint64_t{0};
  bool boot_pin_high = true;
  Disturbances disturbances;
  ChipSpread spread;
  std::uint32_t scl_rise_ns = wanted_rise_ns();
  /// The application runs from this slot, 0 for A. With TRISKIN_SLOT=b in the environment the whole suite runs from B.
  int running_slot = wanted_slot();
  bool watch_reads = false;  ///< Loads from a busy bank then stall, too.
  bool on_posix = false;     ///< True runs board/posix instead of the image in the machine; power_up() reads it.
  std::unique_ptr<Machine> machine;
  TablesFlash tables{flash};
  std::unique_ptr<sim::VirtualController> posix;
  std::uint64_t posix_us = 0;
};

}  // namespace triskin::machine
