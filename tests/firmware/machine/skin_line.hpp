// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "triskin/hardware/ad7147.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/sim/i2c_bus.hpp"

namespace triskin::machine {

/// Gives each of the twelve pads of a test module a level, in converter counts; with `ramp` all fall by one count in
/// 200 µs as well, so that a reading tells when it was converted.
struct PadSource final : hardware::CapacitanceSource {
  static constexpr double kRamp_us = 200.0;
  static constexpr int kRampCounts = 8192;
  std::array<double, 13> level{};
  double drift_per_s = 0.0;
  bool ramp = false;
  [[nodiscard]] double counts(int cin, std::uint64_t at_us) const override;
};

/// Simulates one module: a converter of host/sim/hardware (register level, stage by stage, noise and oscillator error
/// of the data sheet) and its faults.
struct SkinModule {
  PadSource source;
  std::unique_ptr<hardware::Ad7147> chip;
  hardware::Ad7147Behaviour behaviour{};
  std::uint8_t address = 0;  ///< The straps select the address, 0..3.
  bool present = true;
  std::uint16_t frozen = 0;  ///< Bit t makes taxel t keep `frozen_value`.
  std::array<std::uint16_t, layout::kTaxelsPerModule> frozen_value{};
};

/// A burst of twelve results on the line, timed by the clock of the bus.
struct Burst {
  std::uint8_t address = 0;
  std::uint64_t start_us = 0, stop_us = 0;
};

/// Simulates one line with modules, as the controller's pins see it. All events on it are counted.
class SkinLine final : public sim::I2cBus {
 public:
  std::vector<std::unique_ptr<SkinModule>> modules;
  bool sda_held = false, scl_held = false;
  bool pull_ups = true;        ///< These resistors pull the line up; without any it floats and reads as anything.
  int frees_after_pulses = 0;  ///< Zero means that the line never becomes free.
  int pulses = 0, stops = 0;
  std::uint64_t bytes = 0;
  std::uint64_t origin_us = 0;       ///< This is subtracted from the caller's time.
  std::uint64_t first_start_us = 0;  ///< The time is the caller's; 0 means that there was none yet.
  std::vector<Burst> bursts;

  SkinModule& add(std::uint8_t address, int index, std::uint16_t device_id = hardware::Ad7147::kDeviceId);
  /// Puts another chip in its place, with registers at their reset values.
  static void exchange(SkinModule& m, std::uint16_t device_id, int index);
  /// Gives each taxel another electrode of 2 … 18 pF; equal seeds give equal ones.
  static void solder_electrodes(SkinModule& m, unsigned seed);
  void dip(SkinModule& m, std::uint64_t now_us) { m.chip->write_register(0, 1U << 10, now_us - origin_us); }
  void freeze(SkinModule& m, int taxel, std::uint64_t now_us);

  bool start(std::uint8_t address_byte, std::uint64_t now_us) override;
  bool write(std::uint8_t byte, std::uint64_t now_us) override;
  std::uint8_t read(bool acknowledge, std::uint64_t now_us) override;
  void stop(std::uint64_t now_us) override;
  [[nodiscard]] bool scl() const override { return !scl_held && (!floats() || floating_level()); }
  [[nodiscard]] bool sda() const override { return !sda_held && (!floats() || floating_level()); }
  void controller_pulls_up(bool on) override { weak_pull_ups_ = on; }
  void pulse_scl(std::uint64_t now_us) override;

 private:
  [[nodiscard]] bool floats() const { return !pull_ups && !weak_pull_ups_; }
  // A wire that nothing pulls picks up whatever is near it, so each look at it may find another level.
  [[nodiscard]] bool floating_level() const { return (floating_() & 1) != 0; }
  mutable std::mt19937 floating_{20261127};
  bool weak_pull_ups_ = false;
  std::vector<SkinModule*> selected_;
  std::uint8_t address_ = 0;
  std::uint16_t register_ = 0;
  int position_ = 0, transaction_bytes_ = 0;
  bool in_transaction_ = false;
  std::uint64_t started_us_ = 0;
};

}  // namespace triskin::machine
