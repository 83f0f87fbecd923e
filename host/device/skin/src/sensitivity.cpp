// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/skin/calibrate.hpp"

namespace triskin::skin {
namespace {

// Returns the two-sided 95 % quantile of Student's t for 1 or more degrees of freedom; beyond the table it is the limit
// for many.
double student_t(std::size_t freedom) {
  constexpr std::array kTable{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                              2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086};
  return freedom <= kTable.size() ? kTable[freedom - 1] : kTable.back();
}

double number_of(std::string_view text, const std::string& place) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    throw InputError(
        fmt::format("{}: \"{}\" is no number; each line is a time in s, a comma and a pressure in kPa", place, text));
  return value;
}

}  // namespace

std::optional<SensitivityLine> fit_sensitivity(std::span<const CalibrationPoint> points) {
  std::set<double> pressures;
  double weight = 0.0, mean_kpa = 0.0, mean_counts = 0.0;
  for (const CalibrationPoint& p : points) {
    pressures.insert(p.pressure_kpa);
    weight += p.samples;
    mean_kpa += p.samples * p.pressure_kpa;
    mean_counts += p.samples * p.value_counts;
  }
  if (pressures.size() < 3) return std::nullopt;
  mean_kpa /= weight;
  mean_counts /= weight;
  double sxx = 0.0, sxy = 0.0;
  for (const CalibrationPoint& p : points) {
    sxx += p.samples * (p.pressure_kpa - mean_kpa) * (p.pressure_kpa - mean_kpa);
    sxy += p.samples * (p.pressure_kpa - mean_kpa) * (mean_counts - p.value_counts);
  }
  const double slope = sxy / sxx;
  // Pressures so close that the square of their difference is no number (1e-160 kPa) tell no slope.
  if (!(slope > 0.0) || !std::isfinite(slope)) return std::nullopt;
  SensitivityLine line{{.counts_per_kpa = slope}, mean_counts + slope * mean_kpa};
  double squares = 0.0;
  for (const CalibrationPoint& p : points) {
    const double off = p.value_counts - (line.rest_counts - slope * p.pressure_kpa);
    squares += p.samples * off * off;
  }
  const std::size_t freedom = points.size() - 2;
  const double slope_error = std::sqrt(squares / static_cast<double>(freedom) / sxx);
  line.sensitivity.error_percent = 100.0 * student_t(freedom) * slope_error / slope;
  const auto rest = std::ranges::find(points, 0.0, &CalibrationPoint::pressure_kpa);
  if (rest != points.end()) line.rest_counts = rest->value_counts;
  for (const CalibrationPoint& p : points) {
    const double shown_kpa = (line.rest_counts - p.value_counts) / slope;
    line.sensitivity.residual_kpa = std::max(line.sensitivity.residual_kpa, std::abs(shown_kpa - p.pressure_kpa));
  }
  return line;
}

std::vector<PressureStep> pressure_steps(std::span<const double> pressures_kpa,
                                         std::span<const layout::ModuleId> modules) {
  constexpr std::array kWhole{layout::ModuleId::none()};
  std::vector<PressureStep> steps{{}};
  for (const layout::ModuleId module : modules.empty() ? std::span<const layout::ModuleId>(kWhole) : modules) {
    for (const double kpa : pressures_kpa) steps.push_back({kpa, module});
  }
  return steps;
}

PressureRamp::PressureRamp(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string all = read_text(file);
  note_ = note_of_open_line(all, name);
  std::istringstream text(all);
  std::string line;
  std::getline(text, line);
  std::erase_if(line, [](char c) { return c == ' ' || c == '\r'; });
  if (line != "time_s,kpa" && line != "unix_s,kpa")
    throw InputError(
        fmt::format("{}: line 1: must be \"time_s,kpa\" (times of the link, as of a scene) or "
                    "\"unix_s,kpa\" (s since 1970)",
                    name));
  by_calendar_ = line == "unix_s,kpa";
  for (int number = 2; std::getline(text, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string place = fmt::format("{}: line {}", name, number);
    const std::size_t comma = line.find(',');
    const double time_s = number_of(std::string_view(line).substr(0, comma), place);
    const double kpa = number_of(comma == std::string::npos ? "" : std::string_view(line).substr(comma + 1), place);
    if (!points_.empty() && time_s <= points_.back().first)
      throw InputError(fmt::format("{}: the time does not rise; sort the lines by time", place));
    if (kpa < 0.0) throw InputError(fmt::format("{}: a pressure below 0; give kPa above that of the air", place));
    points_.emplace_back(time_s, kpa);
  }
  if (points_.size() < 2) throw InputError(name + ": needs two lines of times and pressures at least");
}

double PressureRamp::max_kpa() const {
  double most = 0.0;
  for (const auto& [time_s, kpa] : points_) most = std::max(most, kpa);
  return most;
}

std::optional<double> PressureRamp::kpa(double time_s) const {
  if (time_s < first_s() || time_s > last_s()) return std::nullopt;
  const auto next = std::ranges::upper_bound(points_, time_s, {}, &std::pair<double, double>::first);
  if (next == points_.end()) return points_.back().second;
  const auto& [last_s, last_kpa] = *std::prev(next);
  return last_kpa + (time_s - last_s) / (next->first - last_s) * (next->second - last_kpa);
}

}  // namespace triskin::skin
