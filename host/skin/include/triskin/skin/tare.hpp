// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/skin/touch_map.hpp"

namespace triskin::device {

/// Takes the rest values of a cover anew while its samples arrive. Nothing may touch the skin meanwhile. Not
/// thread-safe.
class Tare {
 public:
  /// Every tare ends after this time of the link at the latest.
  static constexpr std::uint64_t kLimit_us = 2'000'000;
  enum class State {
    kIdle,        ///< none has begun
    kRunning,     ///< samples are still missing
    kDone,        ///< every taxel that gives valid samples has its new rest value
    kIncomplete,  ///< the time is over, and some taxels gave fewer than TouchMap::kRestSamples valid samples
    kNoSample,    ///< the time is over, and no valid sample arrived
  };

  /// `touches` outlives it and has `modules` modules.
  Tare(TouchMap& touches, std::size_t modules) : touches_(touches), heard_(modules), valid_(modules) {}
  /// Begins, also when one is running. `now_us`: time of the link.
  void begin(std::uint64_t now_us);
  /// Takes a sample that `touches` has received; call it for each, also while no tare is running: a module that was
  /// heard before is waited for.
  void add(const ModuleSample& sample);
  /// Decides at time `now_us` of the link whether the tare has ended, and returns its state. Cost: linear in taxels
  /// while one is running.
  State step(std::uint64_t now_us);
  /// State at the last step().
  [[nodiscard]] State state() const { return state_; }
  /// Taxels with a valid sample since begin().
  [[nodiscard]] std::uint32_t taxels() const;

 private:
  [[nodiscard]] bool all_heard() const;

  TouchMap& touches_;
  std::vector<bool> heard_;           // Indexed by module: it gave a valid sample at any time.
  std::vector<std::uint16_t> valid_;  // Indexed by module: taxels that were valid since begin().
  std::uint64_t begun_us_ = 0;
  State state_ = State::kIdle;
};

}  // namespace triskin::device
