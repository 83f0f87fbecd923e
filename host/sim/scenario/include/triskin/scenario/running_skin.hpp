// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "triskin/design/rest_values.hpp"
#include "triskin/hardware/virtual_skin.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::scenario {

/// A running skin is a simulated skin in operation: its boards have their tables, its rest values are known, power is
/// switched on at time
/// 0 of the scene, and the samples of all modules are streamed. Flashing and taking the rest values happen before that,
/// while nothing touches the skin, but with the permanent faults. Everything is in memory and in virtual time, and
/// equal scenes give equal samples. Not thread-safe.
class RunningSkin {
 public:
  using OnSample = std::function<void(const session::ModuleSample&)>;
  using OnFrame = std::function<void(const wire::CanFrame&, std::uint64_t at_us)>;

  /// Both handlers are called inside the constructor and run_until(); either may be empty. `on_frame` gets every frame
  /// of the controllers with the virtual time of its arrival. Throws InputError for a scene whose bus cannot carry the
  /// stream, DeviceError when a controller does not accept its table.
  RunningSkin(hardware::Scene scene, OnSample on_sample, OnFrame on_frame);
  ~RunningSkin();
  RunningSkin(const RunningSkin&) = delete;
  RunningSkin& operator=(const RunningSkin&) = delete;

  /// Runs until virtual time `until_us`. Throws as session::Stream::run_until.
  void run_until(std::uint64_t until_us);
  [[nodiscard]] std::uint64_t now_us() const;
  /// Returns the simulated hardware, so that it can be touched while it runs.
  [[nodiscard]] hardware::VirtualSkin& hardware();
  /// Returns the counts of the untouched taxels, by module.
  [[nodiscard]] const design::RestValues& rest() const { return rest_; }

 private:
  struct Bench;
  design::RestValues rest_;
  std::unique_ptr<Bench> bench_;
};

/// Returns by how many counts each taxel of a sample reads below rest, less what the temperature pads of its module do;
/// 0 for taxels that are above it, invalid, or measure temperature.
[[nodiscard]] std::array<double, layout::kTaxelsPerModule> changes_of(const session::ModuleSample& sample,
                                                                      const design::RestValues& rest);

/// Returns the area of skin in mm² that a pressure taxel represents.
[[nodiscard]] double taxel_area_mm2(double corner_cut_mm);

/// Returns the force in N on a module whose taxels changed by `change_counts`, at the nominal sensitivity of the
/// simulation; changes below the threshold of a touch do not count. `taxel` selects one taxel; −1 means all.
[[nodiscard]] double force_n(const std::array<double, layout::kTaxelsPerModule>& change_counts, double corner_cut_mm,
                             layout::TaxelIndex taxel = layout::TaxelIndex::none());

}  // namespace triskin::scenario
