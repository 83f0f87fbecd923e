// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <vector>

#include "triskin/layout/module.hpp"
#include "triskin/scene/ad7147.hpp"
#include "triskin/scene/i2c_line.hpp"
#include "triskin/scene/scene.hpp"
#include "triskin/scene/switched_hardware.hpp"

namespace triskin::scene {

// The electrical side of a taxel, in converter counts. A pad under pressure gains capacitance; with the pad at the
// converter's negative input the result falls, as the iCub skin's does.
inline constexpr double kRestCounts = -8000.0;
inline constexpr double kCountsPerKpa = 150.0;

/// A contact with its reach: which taxels of which modules it can press.
struct Touch {
  int id = 0;
  Contact contact;
  [[nodiscard]] double pressure_kpa(const design::Vec3& at_mm, std::uint64_t at_us) const;
};

/// The pads of one module as its converter sees them.
class ModuleSkin final : public CapacitanceSource {
 public:
  ModuleSkin(const Scene& scene, int module, int rotation);
  [[nodiscard]] double counts(int cin, std::uint64_t at_us) const override;

  void add(const Touch& touch);
  void remove(int touch_id);
  void saturate(int taxel) { state_[static_cast<std::size_t>(taxel)] = State::kSaturated; }
  void freeze(int taxel) { state_[static_cast<std::size_t>(taxel)] = State::kFrozen; }
  /// Whether a touch of that contact can reach a pad.
  [[nodiscard]] bool reached_by(const Contact& contact) const;

 private:
  enum class State : std::uint8_t { kHealthy, kSaturated, kFrozen };
  std::array<design::Vec3, layout::kTaxelsPerModule> position_mm_;
  std::array<State, layout::kTaxelsPerModule> state_{};
  std::array<double, layout::kTaxelsPerModule> rest_counts_{};
  std::vector<const Touch*> touches_;
  std::uint64_t seed_;
  double noise_counts_;
  double drift_counts_per_us_;
};

/// All modules of a scene on the lines of their controllers. Not thread-safe.
class Skin {
 public:
  /// `switched` outlives the skin; its chips sit where the registers of its modules put them.
  explicit Skin(const Scene& scene, SwitchedHardware* switched = nullptr);
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  /// Line 0..3 of a patch.
  [[nodiscard]] I2cLineModel& line(int patch, int line);
  /// Puts a finger on the skin; returns its id.
  int press(const Contact& contact);
  /// Takes it away. Samples before `now_us` keep seeing it; it may be forgotten after a second.
  void release(int id, std::uint64_t now_us);
  [[nodiscard]] std::size_t modules() const { return modules_.size(); }

 private:
  void place_chips(const Scene& scene, SwitchedHardware* switched);
  void attach(Ad7147& chip, int module, int patch, SwitchedHardware& switched);
  void apply(const Fault& fault);
  void forget(std::uint64_t before_us);

  std::deque<ModuleSkin> modules_;
  std::vector<std::unique_ptr<Ad7147>> chips_;
  std::vector<std::array<I2cLineModel, 4>> lines_;
  std::list<Touch> touches_;
  int next_touch_ = 1;
};

}  // namespace triskin::scene
