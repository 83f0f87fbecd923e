// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "triskin/layout/patch_image.hpp"
#include "triskin/machine/machine.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::machine {

/// A line with up to four converters at register level: identity, configuration that a power dip clears, twelve results that count up
/// with each conversion sequence. Small on purpose: the tests know every value that must come out.
class TestLine final : public sim::I2cBus {
 public:
  static constexpr std::uint64_t kSequence_us = 36'900;
  struct Chip {
    bool present = true;
    std::uint16_t id = 0x1472;
    std::array<std::uint16_t, 0x100> regs{};
    std::uint64_t restart_us = 0;  ///< writing power control restarts the sequence
  };
  std::array<Chip, 4> chips;
  bool sda_held = false, scl_held = false;
  int frees_after_pulses = 0;
  int pulses = 0, stops = 0;
  std::uint64_t bytes = 0;

  void dip(std::size_t chip) { chips[chip].regs = {}; }
  bool start(std::uint8_t address_byte, std::uint64_t now_us) override;
  bool write(std::uint8_t byte, std::uint64_t now_us) override;
  std::uint8_t read(bool acknowledge, std::uint64_t now_us) override;
  void stop(std::uint64_t now_us) override;
  [[nodiscard]] bool scl() const override { return !scl_held; }
  [[nodiscard]] bool sda() const override { return !sda_held; }
  void pulse_scl(std::uint64_t now_us) override;
  /// What stage `stage` of a chip gives at a time: the number of the sequence, chip and stage in one value.
  [[nodiscard]] std::uint16_t expected(std::size_t chip, int stage, std::uint64_t now_us) const;

 private:
  Chip* selected_ = nullptr;
  std::size_t index_ = 0;
  std::uint16_t pointer_ = 0;
  int position_ = 0;
  bool reading_ = false;
};

[[nodiscard]] inline std::filesystem::path firmware(const char* name) { return std::filesystem::path(TRISKIN_FIRMWARE) / name; }

/// The image filled up to blocks of 32 frames with eight bytes, as the loader acknowledges them.
[[nodiscard]] std::vector<std::uint8_t> whole_blocks(const ElfImage& image);

/// A patch of `modules` modules (four a line) for node 1.
[[nodiscard]] layout::PatchImage patch(int modules);

/// Four lines, flash with loader and application, and a tester on the CAN bus.
class Bench : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(firmware("triskin_app_a.elf"))) GTEST_SKIP() << "no firmware image: install gcc-arm-none-eabi and build again";
    flash.store(read_elf(firmware("triskin_loader.elf")));
    application = read_elf(firmware("triskin_app_a.elf"));
    flash.store_application(application, 0x3C000, 1);
  }
  void power_up();
  void run_for(std::uint64_t us) { machine->run_until(machine->now_us() + us); }
  /// Puts a table into flash as if it had been activated.
  void store_table(const layout::PatchImage& image, std::uint32_t sequence = 1);
  /// One UDS request over ISO-TP; the response, empty after 200 ms of silence.
  std::vector<std::uint8_t> request(const std::vector<std::uint8_t>& bytes);
  /// Loader frames.
  void send(std::uint32_t id, std::span<const std::uint8_t> data);
  [[nodiscard]] std::uint32_t budget(std::uint32_t offset) const { return machine->read_word(application.symbols.at("triskin_budget") + offset); }
  void expect_no_violation() const {
    for (const Violation& v : machine->violations()) ADD_FAILURE() << v.at_us << " us: " << v.what;
  }

  std::array<TestLine, 4> lines;
  FlashChip flash;
  ElfImage application;
  std::vector<wire::CanFrame> frames;  ///< sent by the controller
  VcdTrace* trace = nullptr;
  bool crystal_works = true;
  std::unique_ptr<Machine> machine;
};

}  // namespace triskin::machine
