// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "triskin/design/patch.hpp"

/// These effects of the surroundings act on the pads and chips; each has its own source file (docs/simulation.md). An
/// effect that the scene does not name costs no time.
namespace triskin::hardware {

/// Describes a quantity over virtual time: linear between points, constant before the first and after the last.
struct TimedValue {
  std::uint64_t at_us = 0;
  double value = 0.0;
};
/// Returns the value at a time, or 0 without points. The times of `points` never decrease. Cost: O(log points).
[[nodiscard]] double value_at(const std::vector<TimedValue>& points, std::uint64_t at_us);

/// The soft dielectric spreads each contact, and a taxel averages over its electrode (mechanics::Footprint).
struct LayerEffect {
  double thickness_mm = 2.0, poisson = 0.3, electrode_mm = 4.0;
};

/// Warming raises the capacitance of all pads of a module equally, including the pads that measure temperature.
struct TemperatureEffect {
  std::vector<TimedValue> celsius;
  double counts_per_degree = 20.0;
};
/// Returns the counts that the pads have gained since virtual time 0.
[[nodiscard]] double temperature_counts(const TemperatureEffect& effect, std::uint64_t at_us);

/// Moisture in the fabric raises its permittivity. Each taxel responds differently, and the temperature pads lie under
/// the same fabric.
struct HumidityEffect {
  std::vector<TimedValue> percent;
  double counts_per_percent = 10.0;
  double spread = 0.2;  ///< The responses of the taxels differ by up to ± this share.
};
/// Returns the counts gained since virtual time 0. `unit`, −1 … 1, gives the taxel's place in the range.
[[nodiscard]] double humidity_counts(const HumidityEffect& effect, double unit, std::uint64_t at_us);

/// Parallel traces of a module couple: a pad gains a share of the counts that pressure gives the module's other pads.
struct CrosstalkEffect {
  double share = 0.01;
};
/// Returns the counts added to a pad. `own` and `sum` are the gains by pressure of the pad and of all pads.
[[nodiscard]] double crosstalk_counts(const CrosstalkEffect& effect, double own, double sum);

/// Samples have additional noise during a burst of electromagnetic interference.
struct EmiBurst {
  std::uint64_t from_us = 0, length_us = 0;
  std::uint64_t every_us = 0;  ///< Zero means that the burst occurs once.
  double counts = 0.0;         ///< The noise has this standard deviation.
};
/// Returns the standard deviation in counts of the combined noise of all bursts at a time.
[[nodiscard]] double emi_deviation_counts(const std::vector<EmiBurst>& bursts, std::uint64_t at_us);

/// Every joint and the cable of a patch drop some of the supply, so the modules at the ends of the tree brown out
/// first.
struct SupplyEffect {
  std::vector<TimedValue> volts;  ///< The supply is given where the cable begins.
  double cable_ohm = 0.1;         ///< Supply and ground of the cable together.
  double joint_ohm = 0.05;        ///< Supply and ground of one joint together.
  double module_ma = 1.0;         ///< Every module draws this current.
  /// Below this voltage a chip does not answer, and forgets its configuration. The AD7147 is specified from 2.6 V on
  /// (data sheet rev. E, table 1).
  double brown_out_v = 2.6;
};
/// Returns the voltage that is lost between the cable's beginning and each module of the patch, in the order of
/// patch.modules. Each conductor carries the current of all modules behind it. Cost: modules times depth of the tree.
[[nodiscard]] std::vector<double> supply_drops_v(const SupplyEffect& effect, const design::Patch& patch);

/// A chip has no sufficient supply from `from_us` until `until_us`, exclusive.
struct Outage {
  std::uint64_t from_us = 0, until_us = 0;
};
/// Returns when a module that loses `drop_v` browns out, in order. An outage that does not end lasts until the largest
/// time. Cost: linear in the points.
[[nodiscard]] std::vector<Outage> outages_of(const SupplyEffect& effect, double drop_v);

/// The pull-up charges a line that is longer or wetter than its design too slowly. Where a 1 does not reach the high
/// level while the clock is low it arrives as 0, so no chip of the line recognises its address.
struct EdgeEffect {
  double pull_up_ohm = 1000.0;
  double extra_pf = 0.0;  ///< Every line has this much more than its design computes (LineElectrical::capacitance_pf).
  /// A data bit has this long to reach its level: the clock is low for 1.3 µs at 400 kHz, less 0.1 µs of set-up time
  /// (I2C-bus specification UM10204, table 10: t_LOW, t_SU;DAT).
  double settling_us = 1.2;
};
/// Returns how long a line takes from 0 to 70 % of the supply.
[[nodiscard]] double rise_to_high_us(const EdgeEffect& effect, double capacitance_pf);

/// An effect is empty unless the scene names it.
struct PadEffects {
  std::optional<LayerEffect> layer;
  std::optional<TemperatureEffect> temperature;
  std::optional<HumidityEffect> humidity;
  std::optional<CrosstalkEffect> crosstalk;
  std::vector<EmiBurst> emi;
  std::optional<SupplyEffect> supply;
  std::optional<EdgeEffect> edges;
  /// Returns true if sampling must compute an effect; the layer acts on contacts, supply and
  /// edges on chips only.
  [[nodiscard]] bool act_on_samples() const { return temperature || humidity || crosstalk || !emi.empty(); }
};

}  // namespace triskin::hardware
