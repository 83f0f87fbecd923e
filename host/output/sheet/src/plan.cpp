// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/sheet/plan.hpp"

#include <algorithm>
#include <limits>

#include "pages.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::sheet {
namespace {

using design::Vec3;

struct CornerPlace {
  int module = -1, corner = 0;
  Vec3 at_mm{0, 0, 0};
};

const CornerPlace& farthest_from(const Vec3& from, const std::vector<CornerPlace>& corners) {
  return *std::ranges::max_element(corners, {}, [&](const CornerPlace& c) { return (c.at_mm - from).norm(); });
}

// Chooses two corners of an island far apart: with both in place the whole island is in place.
std::array<Anchor, 2> anchors_of(const std::vector<CornerPlace>& corners, const std::vector<Landmark>& landmarks) {
  if (corners.empty()) return {};
  Vec3 middle(0, 0, 0);
  for (const CornerPlace& c : corners) middle += c.at_mm / static_cast<double>(corners.size());
  const CornerPlace& first = farthest_from(middle, corners);
  const CornerPlace& second = farthest_from(first.at_mm, corners);
  return {Anchor{first.module, first.corner, fix_of(landmarks, first.at_mm)},
          Anchor{second.module, second.corner, fix_of(landmarks, second.at_mm)}};
}

std::vector<std::array<Anchor, 2>> all_anchors(const design::Design& design, const std::vector<Landmark>& landmarks) {
  int islands = design.layout.islands;
  for (const auto& m : design.layout.modules) islands = std::max(islands, m.island + 1);
  std::vector<std::vector<CornerPlace>> corners(static_cast<std::size_t>(islands));
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const auto& m = design.layout.modules[k];
    const design::Outline outline = design::outline_of(m.corner_mm, design.layout.corner_cut_mm);
    // Takes the remaining end of corner c at side c, which is each second point if corners are cut.
    for (int c = 0; c < 3; ++c)
      corners[static_cast<std::size_t>(m.island)].push_back(
          {static_cast<int>(k), c, outline.point[static_cast<std::size_t>(c) * (outline.size / 3)]});
  }
  std::vector<std::array<Anchor, 2>> anchors;
  for (const auto& list : corners) anchors.push_back(anchors_of(list, landmarks));
  return anchors;
}

void number_pages(Plan& plan) {
  for (std::size_t p = 0; p < plan.pages.size(); ++p) {
    for (const IslandPage& island : plan.pages[p].islands) {
      for (const int id : island.modules) plan.page_of_module[static_cast<std::size_t>(id)] = static_cast<int>(p) + 1;
    }
  }
}

}  // namespace

double bend_radius_of_depth(double depth_mm) {
  // The sagitta of a chord gives R = c²/(8 s) for s much smaller than c.
  return depth_mm > 0.0 ? design::kSide_mm * design::kSide_mm / (8.0 * depth_mm)
                        : std::numeric_limits<double>::infinity();
}

Plan plan_of(const design::Design& design, Paper paper, const design::SupplyModel& supply) {
  if (design.layout.modules.empty())
    throw InputError(
        "export: the design has no module, so that there is nothing to build; make it again with triskin design");
  Plan plan;
  plan.sides = sides_of(design);
  plan.wiring = design::wiring_of(design);
  plan.landmarks = landmarks_of(design.surface);
  plan.anchors = all_anchors(design, plan.landmarks);
  plan.supply = supply;
  plan.supply_v.resize(design.layout.modules.size(), supply.supply_v);
  for (const design::Patch& patch : design.patches) {
    const std::vector<double> volts = design::supply_voltages_v(design, patch, supply);
    for (std::size_t k = 0; k < volts.size(); ++k)
      plan.supply_v.at(static_cast<std::size_t>(patch.modules[k].node)) = volts[k];
  }
  plan.page_of_module.resize(design.layout.modules.size());
  const auto put_together = [&] {
    auto text = text_pages(design, plan, paper);
    auto islands = island_pages(design, paper);
    plan.pages.clear();
    plan.pages.push_back(
        {.kind = PageKind::kOverview, .title = "The part from its six sides", .size_mm = text_size_mm(paper)});
    plan.pages.push_back({.kind = PageKind::kKey, .title = "How to read this sheet", .size_mm = text_size_mm(paper)});
    std::ranges::move(text, std::back_inserter(plan.pages));
    std::ranges::move(islands, std::back_inserter(plan.pages));
    number_pages(plan);
  };
  put_together();
  put_together();  // The numbers of the pages are known only now.
  return plan;
}

}  // namespace triskin::sheet
