// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/live_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "triskin/layout/rest.hpp"

namespace triskin::skin {
namespace {

using wire::ModuleState;

// A spaced cell consists of the sign of the module, four characters and a space.
constexpr std::size_t kSpacedColumns = 6, kCloseColumns = 5, kDigitColumns = 2;
constexpr std::size_t kGapColumns = 3;

// Returns four characters that name the fault of a module; empty if there is none.
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

// The digit shows tenths of the range.
std::string digit(double counts) {
  return fmt::format("{:.0f}", std::clamp(std::floor(10.0 * counts / layout::kRestCounts), 0.0, 9.0));
}

// Counts the characters that a line takes on the screen: colour codes count nothing, and a code point counts one.
std::size_t shown_columns(std::string_view line) {
  std::size_t columns = 0;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '\033') {
      k = line.find('m', k);
      if (k == std::string_view::npos) break;
    } else if ((static_cast<unsigned char>(line[k]) & 0xC0U) != 0x80U) {
      ++columns;
    }
  }
  return columns;
}

void append_right_of(std::vector<std::string>& lines, const std::vector<std::string>& block, std::size_t column) {
  if (lines.size() < block.size()) lines.resize(block.size());
  for (std::size_t k = 0; k < block.size(); ++k) {
    lines[k].append(column - shown_columns(lines[k]), ' ');
    lines[k] += block[k];
  }
}

std::size_t columns_of(const std::vector<std::string>& lines) {
  std::size_t wide = 0;
  for (const std::string& line : lines) wide = std::max(wide, shown_columns(line));
  return wide;
}

// Arranges blocks in rows, as many side by side as fit into `columns` (0: no limit).
std::vector<std::string> side_by_side(const std::vector<std::vector<std::string>>& blocks, std::size_t columns) {
  std::vector<std::string> all, row;
  std::size_t used = 0;
  for (const auto& block : blocks) {
    const std::size_t wide = columns_of(block);
    if (!row.empty() && columns > 0 && used + kGapColumns + wide > columns) {
      std::ranges::move(row, std::back_inserter(all));
      row.clear();
      used = 0;
    }
    const std::size_t at = row.empty() ? 0 : used + kGapColumns;
    append_right_of(row, block, at);
    used = at + wide;
  }
  std::ranges::move(row, std::back_inserter(all));
  return all;
}

// Returns the background of a cell from the 256 colours of terminals.
int colour_of(double counts, bool trouble) {
  struct Step {
    double from_counts;
    int colour;
  };
  constexpr int kTrouble = 90, kRest = 236;  // In the palette of terminals these are purple and dark grey.
  constexpr std::array<Step, 4> kSteps{{{50.0 * layout::kCountsPerKpa, 160},
                                        {20.0 * layout::kCountsPerKpa, 172},
                                        {7.0 * layout::kCountsPerKpa, 34},
                                        {TouchMap::kPressed_counts, 22}}};
  if (trouble) return kTrouble;
  for (const Step& step : kSteps) {
    if (counts >= step.from_counts) return step.colour;
  }
  return kRest;
}

}  // namespace

LiveMonitor::LiveMonitor(const design::Design& design, const design::KnownRest& rest,
                         design::SkinCalibration calibration)
    : design_(design),
      touches_(design, rest),
      calibration_(std::move(calibration)),
      modules_(design.layout.modules.size()) {}

std::vector<SkinContact> LiveMonitor::contacts() const {
  return contacts_of(touches_, design_, calibration_);
}

double LiveMonitor::force_n() const {
  double sum_n = 0.0;
  if (!calibration_.complete()) return sum_n;
  for (const PressedTaxel& t : touches_.pressed()) sum_n += calibration_.force_n({t.module, t.taxel}, t.change_counts);
  return sum_n;
}

design::OffRest LiveMonitor::off_rest() const {
  design::OffRest off;
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    if (!modules_[k].heard || !trouble_of(modules_[k].state).empty()) continue;
    const auto change = touches_.change(layout::ModuleId{k});
    if (*std::ranges::min_element(change) > -TouchMap::kPressed_counts) continue;
    off.modules.push_back(design::number_of(design_, static_cast<int>(k)));
    off.taxels += static_cast<int>(
        std::ranges::count_if(change, [](double c) { return std::abs(c) >= TouchMap::kPressed_counts; }));
  }
  return off;
}

const std::vector<design::RoutedModule>& LiveMonitor::modules_of(layout::PatchIndex patch) const {
  return design_.patches.at(static_cast<std::size_t>(patch)).modules;
}

void LiveMonitor::add(const session::ModuleSample& frame) {
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

double LiveMonitor::rate_hz(layout::PatchIndex patch) const {
  double sum = 0.0;
  for (const auto& routed : modules_of(patch)) sum += modules_[static_cast<std::size_t>(routed.node)].rate_hz;
  return modules_of(patch).empty() ? 0.0 : sum / static_cast<double>(modules_of(patch).size());
}

int LiveMonitor::faults(layout::PatchIndex patch) const {
  return static_cast<int>(std::ranges::count_if(modules_of(patch), [&](const auto& routed) {
    const Module& m = modules_[static_cast<std::size_t>(routed.node)];
    return m.heard && !trouble_of(m.state).empty();
  }));
}

int LiveMonitor::unheard(layout::PatchIndex patch) const {
  return static_cast<int>(std::ranges::count_if(
      modules_of(patch), [&](const auto& routed) { return !modules_[static_cast<std::size_t>(routed.node)].heard; }));
}

std::string LiveMonitor::cell(layout::ModuleId module, PressureUnit unit, bool colour, CellForm form) const {
  const Module& m = modules_[static_cast<std::size_t>(module)];
  const auto change = touches_.change(module);
  const double counts = std::max(0.0, *std::ranges::max_element(change));
  double kpa = 0.0;
  for (std::size_t t = 0; t < change.size() && calibration_.complete(); ++t)
    kpa = std::max(kpa, calibration_.pressure_kpa({module, layout::TaxelIndex{t}}, change[t]));
  const std::string_view trouble = m.heard ? trouble_of(m.state) : "  --";
  std::string text = design_.layout.modules[static_cast<std::size_t>(module)].tile.up ? "▲" : "▼";
  if (unit == PressureUnit::kModule && form != CellForm::kDigit)
    text += fmt::format("{:4}", module);
  else if (form == CellForm::kDigit)
    text += !m.heard ? "-" : !trouble.empty() ? "!" : digit(counts);
  else
    text += trouble.empty() ? number(counts, kpa, unit) : std::string(trouble);
  if (colour) text = fmt::format("\033[48;5;{}m{}\033[0m", colour_of(counts, !trouble.empty()), text);
  return form == CellForm::kSpaced ? text + " " : text;
}

std::vector<std::string> LiveMonitor::island_picture(const Rows& rows, PressureUnit unit, bool colour,
                                                     std::size_t columns) const {
  int first = std::numeric_limits<int>::max(), last = std::numeric_limits<int>::min();
  for (const auto& [j, cells] : rows) {
    first = std::min(first, cells.begin()->first);
    last = std::max(last, cells.rbegin()->first);
  }
  const auto cells_wide = static_cast<std::size_t>(last - first + 1);
  const CellForm form = columns == 0 || kSpacedColumns * cells_wide <= columns ? CellForm::kSpaced
                        : kCloseColumns * cells_wide <= columns                ? CellForm::kClose
                                                                               : CellForm::kDigit;
  const std::size_t each = form == CellForm::kSpaced  ? kSpacedColumns
                           : form == CellForm::kClose ? kCloseColumns
                                                      : kDigitColumns;
  const bool is_cut = columns > 0 && each * cells_wide > columns;
  const int end = is_cut ? first + static_cast<int>((columns - 1) / each) : last + 1;
  std::vector<std::string> lines;
  for (const auto& [j, cells] : rows) {
    std::string line;
    int column = first;
    for (const auto& [at, module] : cells) {
      if (at >= end) break;
      line.append(static_cast<std::size_t>(at - column) * each, ' ');
      line += cell(module, unit, colour, form);
      column = at + 1;
    }
    if (cells.rbegin()->first >= end) line += "…";
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<std::string> LiveMonitor::picture(layout::PatchIndex patch, PressureUnit unit, bool colour,
                                              int columns) const {
  // A column is half a side of a module: the up triangle of lattice cell (i, j) has its centre at 2i + j + 1, the down
  // one at 2i + j + 2.
  std::map<int, Rows> islands;
  for (const auto& routed : modules_of(patch)) {
    const auto& placed = design_.layout.modules[static_cast<std::size_t>(routed.node)];
    islands[placed.island][placed.tile.j][2 * placed.tile.i + placed.tile.j + (placed.tile.up ? 1 : 2)] =
        layout::ModuleId{routed.node};
  }
  const auto width = static_cast<std::size_t>(std::max(0, columns));
  std::vector<std::vector<std::string>> blocks;
  for (const auto& [island, rows] : islands) {
    blocks.push_back(island_picture(rows, unit, colour, width));
    if (islands.size() > 1) blocks.back().insert(blocks.back().begin(), fmt::format("island {}", island));
  }
  return side_by_side(blocks, width);
}

}  // namespace triskin::skin
