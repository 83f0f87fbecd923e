// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/taxel_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace triskin::skin {
namespace {

constexpr std::array kBlocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};

const char* block_of(double part) {
  return kBlocks.at(static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * (kBlocks.size() - 1) + 0.5));
}

}  // namespace

void TaxelTrace::step(const LiveMonitor& monitor) {
  const auto pressed = monitor.touches().pressed();
  if (!is_held_ && !pressed.empty() && (pressed.front().module != module_ || pressed.front().taxel != taxel_)) {
    module_ = pressed.front().module;
    number_ = design::number_of(monitor.design(), module_);
    taxel_ = pressed.front().taxel;
    counts_.clear();
  }
  if (module_ < 0) return;
  counts_.push_back(std::max(0.0, monitor.touches().change(module_).at(static_cast<std::size_t>(taxel_))));
  if (counts_.size() > kMaxSteps) counts_.pop_front();
}

std::vector<std::string> TaxelTrace::lines(std::size_t columns, double step_s) const {
  if (counts_.empty() || columns == 0) return {};
  const std::size_t shown = std::min(columns, counts_.size());
  const auto first = counts_.end() - static_cast<std::ptrdiff_t>(shown);
  const double max = std::max(TouchMap::kPressed_counts, *std::max_element(first, counts_.end()));
  std::string plot;
  std::for_each(first, counts_.end(), [&](double counts) { plot += block_of(counts / max); });
  return {fmt::format("module {} taxel {}{}, last {:.0f} s, up to {:.0f} counts", number_, taxel_,
                      is_held_ ? " (held)" : "", static_cast<double>(shown) * step_s, max),
          plot};
}

}  // namespace triskin::skin
