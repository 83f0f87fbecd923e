// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/live_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

namespace triskin::device {
namespace {

using wire::ModuleState;

constexpr std::size_t kCellColumns = 6;  // Room for the sign of the module, four characters and a space.

// Four characters that say what is wrong with a module; empty: nothing.
std::string_view trouble_of(ModuleState state) {
  switch (state) {
    case ModuleState::kOk:
      return {};
    case ModuleState::kUnknown:
      return " ...";
    case ModuleState::kAbsent:
      return "gone";
    case ModuleState::kWrongId:
      return " id?";
    case ModuleState::kLostConfiguration:
      return "rset";
    case ModuleState::kSaturated:
      return " sat";
    case ModuleState::kFrozen:
      return "froz";
    case ModuleState::kLineStuck:
      return "line";
    case ModuleState::kDuplicate:
      return "dupl";
  }
  return " bad";
}

std::string number(double counts, double kpa, PressureUnit unit) {
  if (unit == PressureUnit::kKpa) return kpa < 99.95 ? fmt::format("{:4.1f}", kpa) : fmt::format("{:4.0f}", kpa);
  if (unit == PressureUnit::kPercent) return fmt::format("{:3.0f}%", 100.0 * counts / layout::kRestCounts);
  return counts < 9999.5 ? fmt::format("{:4.0f}", counts) : fmt::format("{:3.0f}k", counts / 1000.0);
}

// Background of a cell, of the 256 colours of terminals.
int colour_of(double counts, bool trouble) {
  struct Step {
    double from_counts;
    int colour;
  };
  constexpr int kTrouble = 90, kRest = 236;  // These colours are purple and dark grey.
  constexpr std::array<Step, 4> kSteps{
      {{8'000.0, 160}, {3'000.0, 172}, {1'000.0, 34}, {TouchMap::kPressed_counts, 22}}};
  if (trouble) return kTrouble;
  for (const Step& step : kSteps) {
    if (counts >= step.from_counts) return step.colour;
  }
  return kRest;
}

}  // namespace

LiveMonitor::LiveMonitor(const design::Design& design, const design::RestValues& rest,
                         design::SkinCalibration calibration)
    : design_(design),
      touches_(design, rest),
      calibration_(std::move(calibration)),
      modules_(design.layout.modules.size()) {}

double LiveMonitor::force_n() const {
  double sum_n = 0.0;
  if (!calibration_.complete()) return sum_n;
  for (const PressedTaxel& t : touches_.pressed()) sum_n += calibration_.force_n(t.module, t.taxel, t.change_counts);
  return sum_n;
}

const std::vector<design::RoutedModule>& LiveMonitor::modules_of(int patch) const {
  return design_.patches.at(static_cast<std::size_t>(patch)).modules;
}

void LiveMonitor::add(const ModuleSample& frame) {
  touches_.add(frame);
  Module& m = modules_[static_cast<std::size_t>(frame.module)];
  m.state = frame.sample.state;
  m.heard = true;
  ++m.samples;
}

void LiveMonitor::close_period(double seconds) {
  for (Module& m : modules_) {
    m.rate_hz = static_cast<double>(m.samples) / seconds;
    m.samples = 0;
  }
}

double LiveMonitor::rate_hz(int patch) const {
  double sum = 0.0;
  for (const auto& routed : modules_of(patch)) sum += modules_[static_cast<std::size_t>(routed.node)].rate_hz;
  return modules_of(patch).empty() ? 0.0 : sum / static_cast<double>(modules_of(patch).size());
}

int LiveMonitor::faults(int patch) const {
  return static_cast<int>(std::ranges::count_if(modules_of(patch), [&](const auto& routed) {
    const Module& m = modules_[static_cast<std::size_t>(routed.node)];
    return m.heard && !trouble_of(m.state).empty();
  }));
}

int LiveMonitor::unheard(int patch) const {
  return static_cast<int>(std::ranges::count_if(
      modules_of(patch), [&](const auto& routed) { return !modules_[static_cast<std::size_t>(routed.node)].heard; }));
}

std::string LiveMonitor::cell(int module, PressureUnit unit, bool colour) const {
  const Module& m = modules_[static_cast<std::size_t>(module)];
  const auto change = touches_.change(module);
  const double counts = std::max(0.0, *std::ranges::max_element(change));
  double kpa = 0.0;
  for (std::size_t t = 0; t < change.size() && calibration_.complete(); ++t)
    kpa = std::max(kpa, calibration_.pressure_kpa(module, static_cast<int>(t), change[t]));
  const std::string_view trouble = m.heard ? trouble_of(m.state) : "  --";
  const char* sign = design_.layout.modules[static_cast<std::size_t>(module)].tile.up ? "▲" : "▼";
  const std::string text = sign + (trouble.empty() ? number(counts, kpa, unit) : std::string(trouble));
  return colour ? fmt::format("\033[48;5;{}m{}\033[0m ", colour_of(counts, !trouble.empty()), text) : text + " ";
}

std::vector<std::string> LiveMonitor::picture(int patch, PressureUnit unit, bool colour) const {
  // Columns count half sides of a module: the up triangle of lattice cell (i, j) has its centre at 2i + j + 1, the
  // down one at 2i + j + 2.
  std::map<int, std::map<int, int>, std::greater<>> rows;  // Keyed by j, then by column: module.
  for (const auto& routed : modules_of(patch)) {
    const auto& tile = design_.layout.modules[static_cast<std::size_t>(routed.node)].tile;
    rows[tile.j][2 * tile.i + tile.j + (tile.up ? 1 : 2)] = routed.node;
  }
  int first = 1 << 30;
  for (const auto& [j, cells] : rows) first = std::min(first, cells.begin()->first);
  std::vector<std::string> lines;
  for (const auto& [j, cells] : rows) {
    std::string line;
    int column = first;
    for (const auto& [at, module] : cells) {
      line.append(static_cast<std::size_t>(at - column) * kCellColumns, ' ');
      line += cell(module, unit, colour);
      column = at + 1;
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace triskin::device
