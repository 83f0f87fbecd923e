// SPDX-License-Identifier: GPL-3.0-or-later
// Measures error against effort of what the device side computes: clocks, compensation in fixed point, calibration.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bench.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/logic/sampling/compensation.hpp"
#include "triskin/session/clock_filter.hpp"
#include "triskin/skin/calibrate.hpp"

namespace triskin::cli {
namespace {

using nlohmann::json;

std::uint64_t whole(double us) {
  return static_cast<std::uint64_t>(us);
}

double percentile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

// Box and Muller, because the library's distribution is another one on each compiler.
double normal(Dice& dice) {
  return std::sqrt(-2.0 * std::log(1.0 - dice.unit())) * std::cos(2.0 * M_PI * dice.unit());
}

// Sixteen modules at 54 Hz for two minutes; the controller's clock is 80 ppm fast, each frame takes 100 µs and up to
// `jitter_us` more, and a request is answered every `answer_s`.
json clock(double jitter_us, double answer_s, std::uint64_t seed) {
  constexpr double kPpm = 80.0, kMin_us = 100.0, kEnd_us = 120e6, kSettled_us = 20e6;
  Dice dice(seed);
  session::ClockFilter filter;
  std::vector<double> errors, bounds;
  double last_us = 0.0, next_us = 0.0, outside = 0.0;
  const auto shown = [](double link_us) { return whole(70e6 + (link_us - 3e6) * (1.0 + kPpm * 1e-6)); };
  const auto arrival = [&](double sent_us) { return sent_us + kMin_us + jitter_us * dice.unit(); };
  const double start = processor_s();
  std::int64_t samples = 0;
  for (double t = 3e6; t < kEnd_us; t += 1e6 / (54.0 * 16.0), ++samples) {
    if (t >= next_us) {
      const double made = arrival(t), received = std::max(arrival(made), last_us);
      filter.exchanged(whole(t), shown(made), whole(received));
      last_us = received;
      next_us = t + answer_s * 1e6;
    }
    last_us = std::max(last_us, arrival(t));
    filter.arrived(shown(t), whole(last_us));
    const session::LinkTime time = filter.at(shown(t), whole(last_us));
    if (t < kSettled_us || time.error_us == session::LinkTime::kUnbounded) continue;
    const double error = std::abs(static_cast<double>(time.link_us) - t);
    errors.push_back(error);
    bounds.push_back(time.error_us);
    outside += error > time.error_us + 1.0 ? 1.0 : 0.0;  // Both times are whole microseconds.
  }
  return {{"series", "clock"},
          {"jitter_us", jitter_us},
          {"answer_s", answer_s},
          {"seed", seed},
          {"samples", samples},
          {"judged", errors.size()},
          {"median_us", percentile(errors, 0.5)},
          {"worst_us", percentile(errors, 1.0)},
          {"bound_us", percentile(bounds, 0.5)},
          {"outside_bound", outside},
          {"processor_s", processor_s() - start}};
}

// The formula of compensation.hpp in real numbers.
class RealCompensation {
 public:
  explicit RealCompensation(const std::array<double, layout::kTaxelsPerModule>& gain) : gain_(gain) {}
  double add(std::size_t t, double raw, double pads, bool is_pad) {
    const double steady = raw - (is_pad ? 0.0 : gain_[t] * pads);
    if (!started_[t]) baseline_[t] = steady;
    started_[t] = true;
    const double change = steady - baseline_[t];
    if (std::abs(change) < fw::Compensation::kTouch && !is_pad)
      baseline_[t] += change / (1 << fw::Compensation::kFollow);
    return std::clamp(32768.0 + change, 0.0, 65535.0);
  }

 private:
  std::array<double, layout::kTaxelsPerModule> gain_, baseline_{};
  std::array<bool, layout::kTaxelsPerModule> started_{};
};

// Compares 12 outputs a reading over `readings` readings of drift, noise and touches.
json fixed_point(int readings, std::uint64_t seed) {
  Dice dice(seed);
  fw::Compensation fixed;
  std::array<double, layout::kTaxelsPerModule> gain{}, level{};
  for (std::size_t t = 0; t < gain.size(); ++t) {
    const auto bits = static_cast<std::int16_t>(dice.below(65536) - 32768);
    fixed.set_gain(t, bits);
    gain[t] = bits / 16384.0;
    level[t] = 10'000.0 + 40'000.0 * dice.unit();
  }
  RealCompensation real(gain);
  const auto is_pad = [](std::size_t t) {
    return std::ranges::find(fw::Compensation::kPads, t) != fw::Compensation::kPads.end();
  };
  double first_pads = 0.0, touch = 0.0, warm = 0.0, worst = 0.0, sum = 0.0, fixed_s = 0.0, real_s = 0.0;
  std::vector<fw::Compensation::Taxels> raws(static_cast<std::size_t>(readings));
  for (int k = 0; k < readings; ++k) {
    warm = 2'000.0 * std::sin(k / 3'000.0);
    if (k % 500 == 0) touch = k % 1000 == 0 ? 0.0 : 6'000.0 * (dice.unit() - 0.5);
    for (std::size_t t = 0; t < gain.size(); ++t) {
      const double value = level[t] + warm + (is_pad(t) ? 0.0 : touch) + 3.0 * normal(dice);
      raws[static_cast<std::size_t>(k)][t] = static_cast<std::uint16_t>(std::clamp(std::lround(value), 1L, 65534L));
    }
  }
  std::vector<fw::Compensation::Taxels> outputs(raws.size());
  std::vector<std::array<double, layout::kTaxelsPerModule>> reals(raws.size());
  double start = processor_s();
  for (std::size_t k = 0; k < raws.size(); ++k) {
    fixed.add(raws[k], layout::kAllTaxels);
    outputs[k] = fixed.output();
  }
  fixed_s = processor_s() - start;
  start = processor_s();
  for (std::size_t k = 0; k < raws.size(); ++k) {
    double pads = 0.0;
    for (const auto pad : fw::Compensation::kPads)
      pads += raws[k][pad] / static_cast<double>(fw::Compensation::kPads.size());
    if (k == 0) first_pads = pads;
    for (std::size_t t = 0; t < gain.size(); ++t) reals[k][t] = real.add(t, raws[k][t], pads - first_pads, is_pad(t));
  }
  real_s = processor_s() - start;
  for (std::size_t k = 0; k < raws.size(); ++k) {
    for (std::size_t t = 0; t < gain.size(); ++t) {
      const double error = std::abs(outputs[k][t] - reals[k][t]);
      worst = std::max(worst, error);
      sum += error;
    }
  }
  return {{"series", "fixed point"},
          {"readings", readings},
          {"seed", seed},
          {"worst_counts", worst},
          {"mean_counts", sum / (12.0 * readings)},
          {"processor_s", fixed_s},
          {"ratio_to_double", fixed_s / std::max(real_s, 1e-9)}};
}

// A taxel of 10 counts a kPa is calibrated by `steps` pressures of 0 … 20 kPa with `samples` samples each. One has
// noise of 3 counts, each step a settling error of 2 counts, which no number of samples lowers. 2,000 draws.
json calibration(int steps, int samples, std::uint64_t seed) {
  constexpr double kTrue = -10.0, kNoise = 3.0, kSettling = 2.0;
  constexpr int kDraws = 2'000;
  Dice dice(seed);
  double square = 0.0;
  int inside = 0, fitted = 0;
  const double start = processor_s();
  for (int d = 0; d < kDraws; ++d) {
    std::vector<skin::CalibrationPoint> points;
    for (int s = 0; s < steps; ++s) {
      const double kpa = 20.0 * s / (steps - 1);
      const double error = kSettling * normal(dice) + kNoise / std::sqrt(static_cast<double>(samples)) * normal(dice);
      points.push_back({kpa, 40'000.0 + kTrue * kpa + error, static_cast<double>(samples)});
    }
    const auto line = skin::fit_sensitivity(points);
    if (!line) continue;
    ++fitted;
    const double off = std::abs(line->sensitivity.counts_per_kpa) / std::abs(kTrue) - 1.0;
    square += off * off;
    inside += std::abs(off) * 100.0 <= line->sensitivity.error_percent * (1.0 + off) ? 1 : 0;
  }
  return {{"series", "calibration"},
          {"steps", steps},
          {"samples", samples},
          {"seed", seed},
          {"draws", kDraws},
          {"fitted", fitted},
          {"rms_percent", 100.0 * std::sqrt(square / fitted)},
          {"inside_bound", static_cast<double>(inside) / fitted},
          {"processor_s", processor_s() - start}};
}

json rows(const BenchOptions&, Output&) {
  json result = json::array();
  for (const double jitter_us : {100.0, 1'000.0, 10'000.0}) {
    for (const double answer_s : {0.25, 1.0, 4.0, 16.0}) result.push_back(clock(jitter_us, answer_s, 20));
  }
  for (const int readings : {100, 1'000, 10'000, 100'000, 1'000'000}) {
    result.push_back(fixed_point(readings, 21));
  }
  for (const int steps : {3, 5, 9, 17}) {
    for (const int samples : {1, 10, 100}) result.push_back(calibration(steps, samples, 22));
  }
  return result;
}

const BenchSubject kDevice("device", "clocks, fixed point and calibration: error against effort", rows);

}  // namespace
}  // namespace triskin::cli
