// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/revise_design.hpp"

#include <algorithm>
#include <numeric>

#include "kept_wiring.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

bool keeps_limits(const design::PlacedModule& m, const design::LayoutLimits& limits) {
  return m.center_gap_mm <= limits.center_gap_mm && m.edge_lift_mm <= limits.lift_mm &&
         m.edge_depth_mm <= limits.depth_mm && m.overrun_mm <= limits.overrun_mm && m.keep_out_mm <= limits.overrun_mm;
}

// Takes over the modules of the older design that fit on the new surface; returns their ids by those in the older
// design.
std::vector<int> take_over(const design::Design& old, design::Design& d) {
  const mesh::Surface surface(d.surface);
  const auto regions = regions_of(surface, d);
  d.layout = old.layout;
  d.layout.numbers = design::all_numbers(old.layout);
  d.next_number = design::next_number(old);
  d.layout.jumpers.clear();
  d.layout.refused.clear();
  std::vector<bool> gone;
  for (design::PlacedModule& m : d.layout.modules) {
    lattice::measure_on_surface(surface, m, d.layout.corner_cut_mm, regions.get());
    gone.push_back(!keeps_limits(m, d.limits));
  }
  std::vector<int> new_id = lattice::remove_modules(d.layout, gone);
  design::set_numbers(d.layout, std::move(d.layout.numbers));
  lattice::number_islands(d.layout);
  return new_id;
}

}  // namespace

RevisedDesign revise_design(const design::Design& old, design::Design part, const GrowAroundOptions& options,
                            const ProgressSink& progress) {
  part.limits = old.limits;
  part.price = old.price;
  part.seed = old.seed;
  part.kinds = old.kinds;
  Revision revision;
  revision.new_id = take_over(old, part);
  std::vector<int> all(part.layout.modules.size());
  std::iota(all.begin(), all.end(), 0);
  EditedDesign grown = grow_around(part, all, options, progress);
  for (int& id : revision.new_id) id = id < 0 ? -1 : grown.new_id[at(id)];
  revision.added = std::move(grown.added);
  design::Design& d = grown.design;
  d.layout.jumpers.clear();
  const double seconds = d.report.seconds;
  const mesh::Surface surface(d.surface);
  revision.kept_patches = wire_around(old, d, surface, regions_of(surface, d).get(), revision.new_id, progress);
  d.report.seconds = seconds;
  return {std::move(grown.design), std::move(revision)};
}

}  // namespace triskin::pipeline
