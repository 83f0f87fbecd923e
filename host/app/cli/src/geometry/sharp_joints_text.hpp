// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/check/design_rules.hpp"

namespace triskin::cli {

/// Says why `fabricate` has no boards for a design with such joints, and what changes that.
inline void report_sharp_joints(const check::DesignReport& report, Output& output) {
  nlohmann::json list = nlohmann::json::array();
  for (const check::SharpJoint& j : report.sharp_joints) {
    list.push_back(
        {{"modules", j.module}, {"bend_rad", j.bend_rad}, {"limit_rad", j.limit_rad}, {"cable", j.has_cable}});
  }
  output.result["sharp_joints"] = std::move(list);
  if (report.sharp_joints.empty()) return;
  const auto degrees = [](double rad) { return rad * 180.0 / std::numbers::pi; };
  const check::SharpJoint& worst = report.sharp_joints.front();
  const bool all_cables = std::ranges::all_of(report.sharp_joints, &check::SharpJoint::has_cable);
  output.say(fmt::format(
      "fabricate has no boards for this design: {} too sharp, the worst of modules {} and {} with {:.1f}°, where the "
      "board bends by {:.1f}°{}. {}",
      report.sharp_joints.size() == 1 ? "one joint is" : counted(report.sharp_joints.size(), "joint") + " are",
      worst.module[0], worst.module[1], degrees(worst.bend_rad), degrees(worst.limit_rad),
      worst.has_cable ? " beside a cable" : "",
      all_cables ? "Give a place for the entry on a flatter side or at the rim (entry in --regions)"
                 : "design --fold-rad 0.87 makes one with boards"));
}

}  // namespace triskin::cli
