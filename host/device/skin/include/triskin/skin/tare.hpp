// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/skin/touch_map.hpp"

namespace triskin::skin {

/// Takes new rest values of a cover while its samples arrive. Nothing may touch the skin during this time. Not
/// thread-safe.
class Tare {
 public:
  /// Every tare ends at the latest after this time of the link.
  static constexpr std::uint64_t kLimit_us = 2'000'000;
  enum class State {
    kIdle,        ///< No tare has begun.
    kRunning,     ///< Samples are still missing.
    kDone,        ///< Every taxel that gives valid samples has its new rest value.
    kIncomplete,  ///< The time is over, and some taxels gave fewer than TouchMap::kRestSamples valid samples.
    kNoSample,    ///< The time is over, and no valid sample arrived.
  };

  /// `touches` must outlive the tare; it has `modules` modules.
  Tare(TouchMap& touches, std::size_t modules) : touches_(touches), heard_(modules), valid_(modules) {}
  /// Starts a tare, again if one is running. `now_us` is the time of the link.
  void begin(std::uint64_t now_us);
  /// Notes a sample that `touches` has received. Call it for every sample, even while no tare is running, because a
  /// tare waits for the modules that were heard before.
  void add(const session::ModuleSample& sample);
  /// Decides at time `now_us` of the link whether the tare has ended, and returns its state. Cost: linear in taxels
  /// while one is running.
  State step(std::uint64_t now_us);
  /// Returns the state as of the last step().
  [[nodiscard]] State state() const { return state_; }
  /// Counts the taxels that gave a valid sample since begin().
  [[nodiscard]] std::uint32_t taxels() const;

 private:
  [[nodiscard]] bool all_heard() const;

  TouchMap& touches_;
  std::vector<bool> heard_;           // An entry is true once the module gave a valid sample.
  std::vector<std::uint16_t> valid_;  // Bit t of a module's entry is set once taxel t was valid since begin().
  std::uint64_t begun_us_ = 0;
  State state_ = State::kIdle;
};

}  // namespace triskin::skin
