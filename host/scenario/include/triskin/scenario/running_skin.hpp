// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "triskin/design/rest_values.hpp"
#include "triskin/scene/virtual_skin.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::scenario {

/// A simulated skin at work: its boards have their tables, its rest values are known, power comes at time 0 of the
/// scene, and the samples of all modules are streamed. The boards are flashed and the rest values are taken before
/// that, while nothing touches the skin, with those faults that are there for good. Everything is in memory and in
/// virtual time, and equal scenes give equal samples. Not thread-safe.
class RunningSkin {
 public:
  using OnSample = std::function<void(const device::ModuleSample&)>;
  using OnFrame = std::function<void(const wire::CanFrame&, std::uint64_t at_us)>;

  /// Both handlers are called inside the constructor and run_until(); either may be empty. `on_frame` gets every frame
  /// of the controllers with the virtual time at which it came. Throws InputError for a scene whose bus cannot carry
  /// the stream, DeviceError when a controller does not take its table.
  RunningSkin(scene::Scene scene, OnSample on_sample, OnFrame on_frame);
  ~RunningSkin();
  RunningSkin(const RunningSkin&) = delete;
  RunningSkin& operator=(const RunningSkin&) = delete;

  /// Runs until virtual time `until_us`. Throws as device::Stream::run_until.
  void run_until(std::uint64_t until_us);
  [[nodiscard]] std::uint64_t now_us() const;
  /// The simulated hardware, to touch it while it runs.
  [[nodiscard]] scene::VirtualSkin& hardware();
  /// Counts of the taxels that nothing touches, by module.
  [[nodiscard]] const design::RestValues& rest() const { return rest_; }

 private:
  struct Bench;
  design::RestValues rest_;
  std::unique_ptr<Bench> bench_;
};

/// How many counts each taxel of a sample reads below rest; 0 for taxels that are above it, invalid, or measure
/// temperature.
[[nodiscard]] std::array<double, layout::kTaxelsPerModule> changes_of(const device::ModuleSample& sample,
                                                                      const design::RestValues& rest);

/// Skin that a pressure taxel stands for, mm².
[[nodiscard]] double taxel_area_mm2(double corner_cut_mm);

/// Force on a module whose taxels changed by `change_counts`, N, at the nominal sensitivity of the simulation: those
/// below the threshold of a touch do not count. `taxel`: that one alone; −1: all.
[[nodiscard]] double force_n(const std::array<double, layout::kTaxelsPerModule>& change_counts, double corner_cut_mm,
                             int taxel = -1);

}  // namespace triskin::scenario
