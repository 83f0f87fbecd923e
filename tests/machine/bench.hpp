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

/// File of the built image; absent without the cross compiler.
[[nodiscard]] std::filesystem::path firmware(const char* name);

/// A board of firmware/board/stm32g474/boards: its images, and where it has what.
struct BenchBoard {
  std::filesystem::path (*file)(const char* name);
  BoardPins pins;
};
/// The board that all tests use that say nothing of another one.
[[nodiscard]] BenchBoard nucleo_board();
/// The board for installed iCub patches: one SCL, no USB.
[[nodiscard]] BenchBoard icub_patch_board();

/// The image filled up to blocks of 32 frames with eight bytes, as the loader acknowledges them.
[[nodiscard]] std::vector<std::uint8_t> whole_blocks(const ElfImage& image);

/// A patch of `modules` modules (four a line) for node 1.
[[nodiscard]] layout::PatchImage patch(int modules);

/// Module k of patch(): line k % 4, address k / 4.
/// Four lines with sixteen modules, flash with loader and application, and a tester on the CAN bus.
[[nodiscard]] inline int wanted_slot() {
  const char* wanted = std::getenv("TRISKIN_SLOT");
  return wanted != nullptr && std::string_view(wanted) == "b" ? 1 : 0;
}

/// The whole suite runs with another behaviour of the converters with its name (kBehaviours) in TRISKIN_CHIP.
[[nodiscard]] inline const scene::Ad7147Behaviour& wanted_behaviour() {
  const char* wanted = std::getenv("TRISKIN_CHIP");
  return behaviour_named(wanted != nullptr ? wanted : "");
}

/// … and with SCL rising as slowly as TRISKIN_RISE_NS says, where a test says nothing of its own.
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
  /// All chips behave so. Before power-up.
  void behave(const scene::Ad7147Behaviour& behaviour);
  [[nodiscard]] SkinLine& line_of(int module) { return lines[static_cast<std::size_t>(module % 4)]; }
  [[nodiscard]] SkinModule& module_at(int module) {
    return *line_of(module).modules[static_cast<std::size_t>(module / 4)];
  }
  /// Extended session and security access.
  void unlock();
  [[nodiscard]] std::uint64_t now_us() const { return on_posix ? posix_us : machine->now_us(); }
  void run_for(std::uint64_t us);
  void deliver(const wire::CanFrame& frame) { on_posix ? posix->receive(frame) : machine->receive(frame); }
  /// Puts a table into flash as if it had been activated.
  void store_table(const layout::PatchImage& image, std::uint32_t sequence = 1);
  /// Downloads a table and activates it; true: the controller says that it is active.
  bool flash_table(const layout::PatchImage& image);
  /// FD11 and FD12; empty: the controller does not answer, or has nothing to say.
  std::optional<wire::BoardHealth> health();
  std::optional<wire::Crash> crash();
  /// FD09: the running image has confirmed itself.
  bool confirmed();
  /// One UDS request over ISO-TP; the response, empty after so much silence.
  std::vector<std::uint8_t> request(const std::vector<std::uint8_t>& bytes, std::uint64_t patience_us = 200'000);
  /// All modules are looked for anew: two at one address are told apart then.
  void self_test();
  /// Loader frames.
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
  std::vector<wire::CanFrame> frames;  ///< sent by the controller
  VcdTrace* trace = nullptr;
  std::uint64_t crystal_hz = 8'000'000;
  std::uint64_t crystal_fails_at_us = ~std::uint64_t{0};
  bool boot_pin_high = true;
  Disturbances disturbances;
  std::uint32_t scl_rise_ns = wanted_rise_ns();
  /// Slot of the application: 0 is A. The whole suite runs from B with TRISKIN_SLOT=b in the environment.
  int running_slot = wanted_slot();
  bool watch_reads = false;  ///< loads from a busy bank stall, too
  bool on_posix = false;     ///< board/posix instead of the image in the machine; power_up() looks
  std::unique_ptr<Machine> machine;
  TablesFlash tables{flash};
  std::unique_ptr<sim::VirtualController> posix;
  std::uint64_t posix_us = 0;
};

}  // namespace triskin::machine
