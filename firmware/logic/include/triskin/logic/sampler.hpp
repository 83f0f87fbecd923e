// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// What is known about one module of the table.
struct ModuleSample {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::array<std::uint16_t, layout::kTaxelsPerModule> raw{};
  std::array<std::uint16_t, layout::kTaxelsPerModule> baseline{};
  std::uint16_t valid = 0;        ///< bit t: taxel t was read in the last cycle and is inside its range
  bool has_baseline = false;
};

/// What answers on a line, whether the table knows it or not.
struct LineScan {
  std::uint8_t answers = 0;   ///< bit a: a chip acknowledges at address a
  std::uint8_t wrong_id = 0;  ///< bit a: and its device id is not an AD7147's
  bool stuck = false;
  bool done = false;
};

/// Drives one line: finds, configures and reads its chips one after the other, all by interrupts of time: step() never waits.
/// A stuck line is recovered at most three times, then left alone for a second; the other lines do not notice.
class LineSampler {
 public:
  static constexpr std::uint32_t kPeriod_us = ad7147::kSequence_us;
  static constexpr int kMaxRecoveries = 3;
  static constexpr std::uint64_t kStuckPause_us = 1'000'000;
  static constexpr std::uint32_t kVerifyEvery = 16;  ///< cycles between two looks at a chip's configuration

  /// Forgets everything and starts anew with the modules of this line.
  void begin(I2cLine& line, std::uint8_t line_index, const layout::PatchImage& table, std::span<ModuleSample> samples,
             std::uint64_t now_us);
  /// Also without a table: reports what answers at the four addresses.
  void request_scan() {
    scan_ = {};
    scan_requested_ = true;
  }
  /// Advances. True when a cycle over all modules of the line has ended in this step.
  bool step(std::uint64_t now_us);
  [[nodiscard]] const LineScan& scan() const { return scan_; }
  [[nodiscard]] std::uint32_t recoveries() const { return recoveries_; }
  [[nodiscard]] std::uint32_t bus_errors() const { return bus_errors_; }
  /// When step() has something to do; max while a transfer is under way (the line reports its own end).
  [[nodiscard]] std::uint64_t next_event_us() const;

 private:
  enum class Job : std::uint8_t { kIdle, kScan, kIdentify, kConfigure, kVerify, kRead };
  struct Slot {
    std::uint8_t module = 0, address = 0;
    bool configured = false;
  };

  void start_cycle(std::uint64_t now_us);
  void start_slot();
  void start_scan_step();
  bool finish(Status status, std::uint64_t now_us);
  bool finish_job(Status status);
  void store_results(ModuleSample& sample);
  bool next_slot();
  void handle_stuck(std::uint64_t now_us);
  [[nodiscard]] std::uint8_t chip_address() const;

  I2cLine* line_ = nullptr;
  std::span<ModuleSample> samples_;
  std::array<Slot, layout::kAddressesPerLine> slots_{};
  std::size_t slot_count_ = 0, slot_ = 0;
  Ad7147 chip_;
  Job job_ = Job::kIdle;
  int configure_step_ = 0;
  std::uint8_t scan_address_ = 0;
  bool scan_requested_ = false;
  LineScan scan_;
  std::uint64_t next_cycle_us_ = 0;
  std::uint32_t cycle_ = 0, recoveries_ = 0, bus_errors_ = 0;
  int recoveries_in_row_ = 0;
};

}  // namespace triskin::fw
