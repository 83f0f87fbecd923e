// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/revise_design.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "keep_numbers.hpp"
#include "triskin/base/index.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/routing/jumpers.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

bool keeps_limits(const design::PlacedModule& m, const design::LayoutLimits& limits) {
  return m.center_gap_mm <= limits.center_gap_mm && m.edge_lift_mm <= limits.lift_mm &&
         m.edge_depth_mm <= limits.depth_mm && m.overrun_mm <= limits.overrun_mm && m.keep_out_mm <= limits.overrun_mm;
}

// Takes over the modules of the older design that fit on the new surface; returns their new ids.
std::vector<int> take_over(const design::Design& old, design::Design& d) {
  const mesh::Surface surface(d.surface);
  const auto regions = regions_of(surface, d);
  d.layout = old.layout;
  d.layout.jumpers.clear();
  d.layout.refused.clear();
  std::vector<bool> gone;
  for (design::PlacedModule& m : d.layout.modules) {
    lattice::measure_on_surface(surface, m, d.layout.corner_cut_mm, regions.get());
    gone.push_back(!keeps_limits(m, d.limits));
  }
  std::vector<int> new_id = lattice::remove_modules(d.layout, gone);
  keep_numbers(d.layout, new_id);
  lattice::number_islands(d.layout);
  return new_id;
}

// Returns the same jumper between the new ids among the places, with its cable measured on the new surface.
std::optional<design::Jumper> jumper_now(const design::Jumper& was, const std::vector<int>& new_id,
                                         const std::vector<design::Jumper>& places) {
  for (design::Jumper place_now : places) {
    const std::array<int, 2> ends{new_id[at(was.node[0])], new_id[at(was.node[1])]};
    if (place_now.node == ends && place_now.side == was.side) return place_now;
    if (place_now.node == std::array{ends[1], ends[0]} && place_now.side == std::array{was.side[1], was.side[0]})
      return place_now;
  }
  return std::nullopt;
}

// Keeps the patches whose modules and joints are unchanged.
class PatchKeeper {
 public:
  PatchKeeper(const design::Design& old, const design::Design& now, const std::vector<int>& new_id,
              std::vector<design::Jumper> places)
      : old_(old), now_(now), new_id_(new_id), places_(std::move(places)), wiring_(design::wiring_of(old)) {}

  routing::KeptWiring kept(std::vector<int>& new_patch) {
    routing::KeptWiring kept;
    for (std::size_t p = 0; p < old_.patches.size(); ++p) {
      std::vector<design::Jumper> jumpers;
      const bool stays = has_modules(old_.patches[p]) && has_joints(old_.patches[p]) && has_jumpers(p, jumpers);
      kept.patches.push_back(stays ? renamed(old_.patches[p]) : design::Patch{});
      if (stays) kept.jumpers.insert(kept.jumpers.end(), jumpers.begin(), jumpers.end());
      new_patch.push_back(stays ? static_cast<int>(p) : -1);
    }
    return kept;
  }

 private:
  [[nodiscard]] bool has_modules(const design::Patch& patch) const {
    return std::ranges::all_of(patch.modules, [&](const auto& m) { return new_id_[at(m.node)] >= 0; });
  }
  // Only joints to modules of the same patch count; those to others may change.
  [[nodiscard]] bool has_joints(const design::Patch& patch) const {
    const int index = wiring_[at(patch.modules.front().node)].patch;
    return std::ranges::all_of(patch.modules, [&](const auto& m) {
      for (std::size_t s = 0; s < 3; ++s) {
        const int was = old_.layout.modules[at(m.node)].neighbour[s];
        if (was < 0 || wiring_[at(was)].patch != index) continue;
        if (now_.layout.modules[at(new_id_[at(m.node)])].neighbour[s] != new_id_[at(was)]) return false;
      }
      return true;
    });
  }
  [[nodiscard]] bool has_jumpers(std::size_t patch, std::vector<design::Jumper>& jumpers) const {
    for (const design::Jumper& jumper : old_.layout.jumpers) {
      if (wiring_[at(jumper.node[0])].patch != static_cast<int>(patch)) continue;
      const auto now = jumper_now(jumper, new_id_, places_);
      if (!now) return false;
      jumpers.push_back(*now);
    }
    return true;
  }
  [[nodiscard]] design::Patch renamed(design::Patch patch) const {
    const auto rename = [&](int& node) { node = node < 0 ? node : new_id_[at(node)]; };
    rename(patch.entry);
    for (design::RoutedModule& m : patch.modules) {
      rename(m.node);
      rename(m.parent);
    }
    for (auto& joint : patch.cut_joints) std::ranges::for_each(joint, rename);
    return patch;
  }

  const design::Design& old_;
  const design::Design& now_;
  const std::vector<int>& new_id_;
  std::vector<design::Jumper> places_;
  std::vector<design::ModuleWiring> wiring_;
};

// Free places that no new patch filled are removed, so later patches moved up.
void follow_gaps(const design::Design& old, const design::Design& now, Revision& revision) {
  const auto wiring = design::wiring_of(now);
  for (std::size_t p = 0; p < revision.new_patch.size(); ++p) {
    int& index = revision.new_patch[p];
    if (index >= 0) index = wiring[at(revision.new_id[at(old.patches[p].modules.front().node)])].patch;
  }
}

}  // namespace

design::Design revise_design(const design::Design& old, design::Design part, const GrowAroundOptions& options,
                             Revision& revision, const ProgressSink& progress) {
  part.limits = old.limits;
  part.price = old.price;
  part.seed = old.seed;
  part.kinds = old.kinds;
  revision = {take_over(old, part), {}, {}};
  std::vector<int> all(part.layout.modules.size());
  std::iota(all.begin(), all.end(), 0);
  EditedDesign grown = grow_around(part, all, options, progress);
  revision.added = std::move(grown.added);
  design::Design& d = grown.design;
  const mesh::Surface surface(d.surface);
  const auto regions = regions_of(surface, d);
  const std::vector<design::Jumper> places = routing::find_jumpers(surface, d.layout, d.limits);
  const routing::KeptWiring kept = PatchKeeper(old, d, revision.new_id, places).kept(revision.new_patch);
  const double seconds = d.report.seconds;
  wire(d, surface, regions.get(), places, progress, nullptr, &kept);
  d.report.seconds = seconds;
  follow_gaps(old, d, revision);
  return std::move(d);
}

}  // namespace triskin::pipeline
