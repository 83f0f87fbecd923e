// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/hardware/ad7147.hpp"
#include "triskin/hardware/i2c_line.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/hardware/switched_hardware.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/mechanics/footprint.hpp"

namespace triskin::hardware {

/// Pressure of 1 kPa adds this many converter counts to a taxel, within Effects::sensitivity_spread. The capacitance of
/// its electrode lies in the range that the scene's effects allow (Effects::electrode_least_pf) and differs for each
/// taxel.
using layout::kCountsPerKpa;

/// A touch is a contact together with the taxels that it can press, by module.
struct Touch {
  int id = 0;
  Contact contact;
  std::uint64_t released_us = kForever;  ///< lifted before the end of the contact
  /// The layer spreads the contact by this footprint; null applies Hertz' pressure at the middle of each taxel.
  const mechanics::Footprint* footprint = nullptr;
  /// Pressure on the skin at a point (mesh frame, mm) and virtual time, kPa; 0 outside the contact.
  [[nodiscard]] double pressure_kpa(const design::Vec3& at_mm, std::uint64_t at_us) const;
};

/// The converter of a module sees these pads. Equal scenes give equal electrodes.
class ModuleSkin final : public CapacitanceSource {
 public:
  /// Makes module `module` (id in the design), turned by `rotation` 0..2. It copies what it needs from the scene.
  ModuleSkin(const Scene& scene, layout::ModuleId module, int rotation);
  [[nodiscard]] double counts(int cin, std::uint64_t at_us) const override;
  [[nodiscard]] bool is_stuck(int cin, std::uint64_t at_us) const override;
  /// Returns the capacitance of taxel 0..11 in counts, without touch, drift and noise.
  [[nodiscard]] double rest_counts(layout::TaxelIndex taxel) const {
    return rest_counts_[static_cast<std::size_t>(taxel)];
  }

  /// Returns the response of taxel 0..11 to 1 kPa in counts.
  [[nodiscard]] double counts_per_kpa(layout::TaxelIndex taxel) const {
    return counts_per_kpa_[static_cast<std::size_t>(taxel)];
  }

  /// Adds a contact that may press the pads; it must outlive its presence here.
  void add(const Touch& touch);
  /// Removes a contact; it has no effect when the contact is not there.
  void remove(int touch_id);
  /// Sets taxel 0..11 to an end of its range from virtual time `from_us` until `until_us`, exclusive.
  void saturate(layout::TaxelIndex taxel, std::uint64_t from_us = 0, std::uint64_t until_us = kForever) {
    broken_.push_back({static_cast<std::size_t>(taxel), true, from_us, until_us});
  }
  /// Lets all pads gain `counts_per_s` from virtual time `from_us` until `until_us`, as a drifting chip shows it.
  void drift(double counts_per_s, std::uint64_t from_us, std::uint64_t until_us) {
    drifts_.push_back({counts_per_s * 1e-6, from_us, until_us});
  }
  /// Freezes taxel 0..11 at its rest value from virtual time `from_us` until `until_us`, exclusive.
  void freeze(layout::TaxelIndex taxel, std::uint64_t from_us = 0, std::uint64_t until_us = kForever) {
    broken_.push_back({static_cast<std::size_t>(taxel), false, from_us, until_us});
  }
  /// Moves the taxels to `position_mm` from virtual time `from_us` on; calls must be in the order of time.
  void turn(std::uint64_t from_us, const std::array<design::Vec3, layout::kTaxelsPerModule>& position_mm) {
    turns_.push_back({from_us, position_mm});
  }
  /// Puts every pad under `kpa` from `at_us` on, in addition to the contacts.
  void pressurize(double kpa, std::uint64_t at_us) { pressure_.step(at_us, kpa); }
  /// Sets the pads so that the converter reads `counts` once the controller has found offsets for layout::kRestCounts;
  /// nothing else then affects them.
  void show(const std::array<double, layout::kTaxelsPerModule>& counts) { shown_counts_ = counts; }
  /// Returns true if the contact can ever press a pad of this module, acting `beyond_mm` farther than its radius.
  [[nodiscard]] bool reached_by(const Contact& contact, double beyond_mm = 0.0) const;

 private:
  struct BrokenTaxel {
    std::size_t taxel;
    bool saturated;  // False means that the taxel is frozen.
    std::uint64_t from_us, until_us;
  };
  struct Drift {
    double counts_per_us;
    std::uint64_t from_us, until_us;
  };
  struct Turn {
    std::uint64_t from_us;
    std::array<design::Vec3, layout::kTaxelsPerModule> position_mm;
  };
  [[nodiscard]] const design::Vec3& position_mm(std::size_t taxel, std::uint64_t at_us) const;
  [[nodiscard]] double pressure_counts(std::size_t taxel, std::uint64_t at_us) const;
  [[nodiscard]] double effect_counts(std::size_t taxel, double by_pressure, std::uint64_t at_us) const;
  std::array<design::Vec3, layout::kTaxelsPerModule> position_mm_;
  std::vector<BrokenTaxel> broken_;
  std::vector<Turn> turns_;
  std::array<double, layout::kTaxelsPerModule> rest_counts_{}, counts_per_kpa_{};
  PressureCurve pressure_;
  std::optional<std::array<double, layout::kTaxelsPerModule>> shown_counts_;
  std::vector<const Touch*> touches_;
  std::uint64_t seed_;
  double noise_counts_;
  double drift_counts_per_us_;
  std::vector<Drift> drifts_;
  std::shared_ptr<const PadEffects> effects_;  // Null means that no effect acts on samples.
};

/// The skin connects all modules of a scene to the lines of their controllers. Not thread-safe.
class Skin {
 public:
  /// Builds chips and lines with the faults of the scene. `switched` (null: strapped modules) must outlive the skin;
  /// the registers of its modules decide where its chips are.
  explicit Skin(const Scene& scene, SwitchedHardware* switched = nullptr);
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  /// Returns line 0..3 of patch `patch` (0-based).
  [[nodiscard]] I2cLineModel& line(layout::PatchIndex patch, int line);
  /// Puts a finger on the skin and returns its id, ≥ 1. Cost: one test per module.
  int press(const Contact& contact);
  /// Lifts the finger `id` at virtual time `now_us`; it has no effect when the finger is gone. Earlier samples still
  /// see it.
  void release(int id, std::uint64_t now_us);
  /// Puts every pad of a module (−1: all modules) under `kpa` from virtual time `now_us` on, in addition to the
  /// contacts. Throws std::out_of_range for a module that does not exist. Cost: O(modules).
  void pressurize(layout::ModuleId module, double kpa, std::uint64_t now_us);
  /// Calls ModuleSkin::show of a module. Throws std::out_of_range.
  void show(layout::ModuleId module, const std::array<double, layout::kTaxelsPerModule>& counts) {
    modules_.at(static_cast<std::size_t>(module)).show(counts);
  }
  [[nodiscard]] std::size_t modules() const { return modules_.size(); }
  /// Returns the converter of module 0 … modules() − 1. Throws std::out_of_range.
  [[nodiscard]] const Ad7147& chip(layout::ModuleId id) const { return *chips_.at(static_cast<std::size_t>(id)); }
  /// Returns the pads of module 0 … modules() − 1. Throws std::out_of_range.
  [[nodiscard]] const ModuleSkin& module(layout::ModuleId id) const {
    return modules_.at(static_cast<std::size_t>(id));
  }

 private:
  void turn_modules(const Scene& scene);
  void place_chips(const Scene& scene, SwitchedHardware* switched);
  void brown_out(const SupplyEffect& supply, const design::Design& design);
  void silence_slow_lines(const EdgeEffect& edges, const design::Design& design);
  void apply(const Fault& fault);
  void forget(std::uint64_t before_us);

  std::deque<ModuleSkin> modules_;
  std::vector<std::unique_ptr<Ad7147>> chips_;
  std::vector<std::array<I2cLineModel, 4>> lines_;
  std::optional<mechanics::Footprint> footprint_;
  std::list<Touch> touches_;
  int next_touch_ = 1;
};

}  // namespace triskin::hardware
