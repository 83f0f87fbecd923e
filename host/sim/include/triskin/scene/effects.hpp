// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

/// Effects of the surroundings on the pads, each with its own source file (docs/effects.md). What a scene does not name
/// is not computed.
namespace triskin::scene {

/// A quantity over virtual time: linear between points, constant before the first and after the last.
struct TimedValue {
  std::uint64_t at_us = 0;
  double value = 0.0;
};
/// Value at a time; 0 without points. `points`: times do not fall. Cost: O(log points).
[[nodiscard]] double value_at(const std::vector<TimedValue>& points, std::uint64_t at_us);

/// The soft dielectric spreads each contact, and a taxel is the mean over its electrode (mechanics::Footprint).
struct LayerEffect {
  double thickness_mm = 2.0, poisson = 0.3, electrode_mm = 4.0;
};

/// Warming raises the capacitance of every pad of a module alike, also of the pads that measure it.
struct TemperatureEffect {
  std::vector<TimedValue> celsius;
  double counts_per_degree = 20.0;
};
/// Counts that the pads have gained since virtual time 0.
[[nodiscard]] double temperature_counts(const TemperatureEffect& effect, std::uint64_t at_us);

/// Moisture in the fabric raises the permittivity; each taxel takes it up differently, and the temperature pads lie
/// under the same fabric.
struct HumidityEffect {
  std::vector<TimedValue> percent;
  double counts_per_percent = 10.0;
  double spread = 0.2;  ///< half range of the taxels' response as a share of it
};
/// Counts that a pad has gained since virtual time 0. `unit`: where the taxel lies in the range, −1 … 1.
[[nodiscard]] double humidity_counts(const HumidityEffect& effect, double unit, std::uint64_t at_us);

/// Traces run beside each other on a module: a pad gains a share of what the other pads of its module gain by pressure.
struct CrosstalkEffect {
  double share = 0.01;
};
/// Counts that a pad gains. `own`, `sum`: gains by pressure of the pad, and of all pads of the module.
[[nodiscard]] double crosstalk_counts(const CrosstalkEffect& effect, double own, double sum);

/// Bursts of electromagnetic interference: for their time samples have further noise.
struct EmiBurst {
  std::uint64_t from_us = 0, length_us = 0;
  std::uint64_t every_us = 0;  ///< 0: once
  double counts = 0.0;         ///< standard deviation
};
/// Standard deviation of the noise of all bursts together at a time, counts.
[[nodiscard]] double emi_deviation_counts(const std::vector<EmiBurst>& bursts, std::uint64_t at_us);

/// Effects that a scene names.
struct PadEffects {
  std::optional<LayerEffect> layer;
  std::optional<TemperatureEffect> temperature;
  std::optional<HumidityEffect> humidity;
  std::optional<CrosstalkEffect> crosstalk;
  std::vector<EmiBurst> emi;
  /// True: a sample has to look at one of them; the layer acts on contacts only.
  [[nodiscard]] bool act_on_samples() const { return temperature || humidity || crosstalk || !emi.empty(); }
};

}  // namespace triskin::scene
