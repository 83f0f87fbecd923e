// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_reader.hpp"

namespace triskin::hardware {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;

constexpr double kMaxCounts = 1e4;

// Reads a number that has a default.
void take(const JsonValue& v, const char* key, double low, double high, double& value) {
  if (has(v, key)) value = number_in(v[key], low, high);
}

std::vector<TimedValue> read_points(const JsonValue& list, const char* key, double low, double high) {
  std::vector<TimedValue> points;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const JsonValue v = list.at(k);
    only_scene_keys(v, {"at_s", key});
    points.push_back({scene_time_us(v["at_s"]), number_in(v[key], low, high)});
    if (k > 0 && points[k].at_us < points[k - 1].at_us) v["at_s"].fail("is earlier than the point before");
  }
  if (points.empty()) list.fail("has no point; give at least one");
  return points;
}

LayerEffect read_layer(const JsonValue& v) {
  only_scene_keys(v, {"thickness_mm", "poisson", "electrode_mm"});
  LayerEffect e;
  take(v, "thickness_mm", 0.2, 10.0, e.thickness_mm);
  take(v, "poisson", 0.0, 0.495, e.poisson);
  take(v, "electrode_mm", 0.5, 10.0, e.electrode_mm);
  return e;
}

TemperatureEffect read_temperature(const JsonValue& v) {
  only_scene_keys(v, {"points", "counts_per_degree"});
  TemperatureEffect e;
  e.celsius = read_points(v["points"], "celsius", -40.0, 125.0);
  take(v, "counts_per_degree", -kMaxCounts, kMaxCounts, e.counts_per_degree);
  return e;
}

HumidityEffect read_humidity(const JsonValue& v) {
  only_scene_keys(v, {"points", "counts_per_percent", "spread"});
  HumidityEffect e;
  e.percent = read_points(v["points"], "percent", 0.0, 100.0);
  take(v, "counts_per_percent", -kMaxCounts, kMaxCounts, e.counts_per_percent);
  take(v, "spread", 0.0, 1.0, e.spread);
  return e;
}

SupplyEffect read_supply(const JsonValue& v) {
  only_scene_keys(v, {"points", "cable_ohm", "joint_ohm", "module_ma", "brown_out_v"});
  constexpr double kMaxVolts = 6.0, kMaxOhm = 1e3, kMaxMilliampere = 100.0;
  SupplyEffect e;
  e.volts = read_points(v["points"], "volts", 0.0, kMaxVolts);
  take(v, "cable_ohm", 0.0, kMaxOhm, e.cable_ohm);
  take(v, "joint_ohm", 0.0, kMaxOhm, e.joint_ohm);
  take(v, "module_ma", 0.0, kMaxMilliampere, e.module_ma);
  take(v, "brown_out_v", 0.0, kMaxVolts, e.brown_out_v);
  return e;
}

EdgeEffect read_edges(const JsonValue& v) {
  only_scene_keys(v, {"pull_up_ohm", "extra_pf", "settling_us"});
  EdgeEffect e;
  take(v, "pull_up_ohm", 100.0, 1e6, e.pull_up_ohm);
  take(v, "extra_pf", 0.0, 1e6, e.extra_pf);
  take(v, "settling_us", 0.01, 100.0, e.settling_us);
  return e;
}

EmiBurst read_burst(const JsonValue& v) {
  only_scene_keys(v, {"at_s", "for_s", "every_s", "counts"});
  EmiBurst b;
  if (has(v, "at_s")) b.from_us = scene_time_us(v["at_s"]);
  b.length_us = scene_time_us(v["for_s"]);
  if (has(v, "every_s")) {
    b.every_us = scene_time_us(v["every_s"]);
    if (b.every_us < b.length_us) v["every_s"].fail("is shorter than for_s: the burst would never end");
  }
  b.counts = number_in(v["counts"], 0.0, kMaxCounts);
  return b;
}

}  // namespace

PadEffects read_pad_effects(const JsonValue& v) {
  PadEffects e;
  if (has(v, "layer")) e.layer = read_layer(v["layer"]);
  if (has(v, "temperature")) e.temperature = read_temperature(v["temperature"]);
  if (has(v, "humidity")) e.humidity = read_humidity(v["humidity"]);
  if (has(v, "crosstalk")) e.crosstalk = CrosstalkEffect{number_in(v["crosstalk"], 0.0, 0.5)};
  if (has(v, "supply")) e.supply = read_supply(v["supply"]);
  if (has(v, "edges")) e.edges = read_edges(v["edges"]);
  if (has(v, "emi")) {
    const JsonValue list = v["emi"];
    for (std::size_t k = 0; k < list.size(); ++k) e.emi.push_back(read_burst(list.at(k)));
  }
  return e;
}

}  // namespace triskin::hardware
