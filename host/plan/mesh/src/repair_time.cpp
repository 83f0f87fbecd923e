// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <cmath>

#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

RepairTime::RepairTime(const ExtractOptions& options)
    : clock_s_(options.clock_s ? options.clock_s : steady_s),
      whole_s_(options.repair_s),
      end_s_(clock_s_() + options.repair_s) {}

IsLate RepairTime::part(double share) const {
  const double end_s = std::min(end_s_, clock_s_() + share * whole_s_);
  return [clock_s = clock_s_, end_s] { return clock_s() >= end_s; };
}

unsigned RepairTime::cpu_s(double share) const {
  return static_cast<unsigned>(std::max(1.0, std::ceil(share * whole_s_)));
}

}  // namespace triskin::mesh
