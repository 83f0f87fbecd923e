// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/edit_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "choose_layout.hpp"
#include "kept_wiring.hpp"
#include "later_steps.hpp"
#include "seconds_since.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/lattice/add_module.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/routing/jumpers.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

// A growth that begins late still gets this share of the limit.
constexpr double kMinGrowthShare = 0.1;
constexpr std::string_view kMirroredSuffix = "_mirrored";

void require_module(const design::Design& d, int id) {
  const auto count = static_cast<int>(d.layout.modules.size());
  if (id < 0 || id >= count)
    throw InputError(fmt::format("there is no module {}; the design has 0 … {}", id, count - 1));
}

// Measures the layout and makes jumpers, controllers, wiring and report.
void finish(design::Design& d, const mesh::Surface& surface, const mesh::SurfaceRegions* regions,
            Clock::time_point start, const ProgressSink& progress) {
  lattice::measure(surface, d.layout, regions);
  wire(d, surface, regions, routing::find_jumpers(surface, d.layout, d.limits), progress);
  d.report.seconds = seconds_since(start);
}

// Marks each id that is named or, with `others`, that is not.
std::vector<bool> marked(const design::Design& d, const std::vector<int>& ids, bool others = false) {
  std::vector<bool> mark(d.layout.modules.size(), others);
  for (const int id : ids) {
    require_module(d, id);
    mark[static_cast<std::size_t>(id)] = !others;
  }
  return mark;
}

// Returns the number of one more module; Design::next_number is set.
int new_number(design::Design& d) {
  design::require_fitting_number(d, d.next_number);
  return d.next_number++;
}

// Gives numbers to the modules behind those that have one.
void number_new_modules(design::Design& d) {
  while (d.layout.numbers.size() < d.layout.modules.size()) d.layout.numbers.push_back(new_number(d));
}

// Returns the module and side beside which a place lies, in a layout whose islands still have their old numbers.
BesideModule resolved(const NewPlace& place, const design::Design& old, const design::ModuleLayout& layout,
                      const std::vector<int>& new_id) {
  if (const auto* beside = std::get_if<BesideModule>(&place)) {
    const int id = new_id.at(static_cast<std::size_t>(beside->module));
    if (id < 0) {
      throw InputError(
          fmt::format("module {} is removed; nothing can be added beside it", design::number_of(old, beside->module)));
    }
    return {id, beside->side};
  }
  const auto& [island, tile] = std::get<TileOfIsland>(place);
  const std::string name = fmt::format("island {}: tile {}/{}/{}", island, tile.i, tile.j, tile.up ? "up" : "down");
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    if (layout.modules[k].island != island || layout.modules[k].tile != tile) continue;
    const design::ModuleNumber there = design::number_of(layout, static_cast<int>(k));
    throw InputError(there.value >= design::next_number(old)
                         ? name + " is already filled: a module was just added there"
                         : fmt::format("{} is already filled: module {} is there", name, there));
  }
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    const design::PlacedModule& m = layout.modules[k];
    for (int s = 0; m.island == island && s < 3; ++s) {
      if (design::across(m.tile, s).tile == tile && m.neighbour[static_cast<std::size_t>(s)] < 0)
        return {static_cast<int>(k), s};
    }
  }
  throw InputError(name + " lies beside no free side of a module of the island");
}

std::string text_of(const NewPlace& place, const design::Design& old) {
  if (const auto* beside = std::get_if<BesideModule>(&place))
    return fmt::format("side {} of module {}", beside->side, design::number_of(old, beside->module));
  const auto& [island, tile] = std::get<TileOfIsland>(place);
  return fmt::format("tile {}/{}/{} of island {}", tile.i, tile.j, tile.up ? "up" : "down", island);
}

// What a limit forbids, as a person would say it; the measured value follows. `other` names a module, or nothing.
std::string words_of(const std::string& limit, const std::string& other) {
  const std::string joint = other.empty() ? "the joint" : "the joint with " + other;
  if (limit == "penetration_mm") return fmt::format("it would overlap {} by", other.empty() ? "another module" : other);
  if (limit == "overrun_mm") return "it would stick out past an edge by";
  if (limit == "lift_mm") return "its sides would stand off the surface by";
  if (limit == "depth_mm") return "its sides would sink into the surface by";
  if (limit == "center_gap_mm") return "its centre would be off the surface by";
  if (limit == "hinge_gap_mm") return joint + " would gape by";
  if (limit == "edge_error_mm") return joint + " would be stretched by";
  if (limit == "fold_rad") return joint + " would fold by";
  return limit + " would be";
}

// Writes "it would stick out past an edge by 4.90 mm (limit 0.49), …".
std::string text_of(const std::vector<lattice::BrokenLimit>& broken, const EditedDesign& result) {
  std::string text;
  for (const lattice::BrokenLimit& b : broken) {
    const std::string other = b.other < 0 ? ""
                              : std::ranges::count(result.added, b.other) > 0
                                  ? "a module that was just added"
                                  : fmt::format("module {}", design::number_of(result.design, b.other));
    text += fmt::format("{}{} {:.2f} {} (limit {:.2f})", text.empty() ? "" : ", ", words_of(b.limit, other), b.measured,
                        std::string_view(b.limit).ends_with("_rad") ? "rad" : "mm", b.allowed);
  }
  return text;
}

void add_one(const NewPlace& place, const design::Design& old, const mesh::Surface& surface,
             const mesh::SurfaceRegions* regions, EditedDesign& result) {
  design::Design& d = result.design;
  const BesideModule at = resolved(place, old, d.layout, result.new_id);
  const auto broken = lattice::add_module(surface, d.limits, regions, d.layout, at.module, at.side);
  if (!broken.empty()) {
    throw InputError(
        fmt::format("No module fits at {}, even shifted slightly: {}", text_of(place, old), text_of(broken, result)));
  }
  number_new_modules(d);
  result.added.push_back(static_cast<int>(d.layout.modules.size()) - 1);
}

// Assigns kinds by place to the modules from number `first` on; the others keep theirs. Regions that name modules or
// islands by their old numbers have already been applied.
void give_kinds(design::Design& d, std::size_t first) {
  std::erase_if(d.kinds.regions, [](const auto& r) { return !design::is_place(r.region); });
  design::assign_kinds_by_place(d.kinds, d.layout, first);
}

EditedDesign unchanged(const design::Design& design) {
  EditedDesign result{design, std::vector<int>(design.layout.modules.size()), {}, {}};
  std::iota(result.new_id.begin(), result.new_id.end(), 0);
  return result;
}

// Grows layouts around the kept modules until `end_s` of the budget.
std::vector<design::ModuleLayout> grown_around(const design::Design& d, const mesh::Surface& surface,
                                               const mesh::SurfaceRegions* regions,
                                               const std::vector<design::PlacedModule>& kept,
                                               const GrowAroundOptions& options, const TimeBudget& budget, double end_s,
                                               const ProgressSink& progress) {
  lattice::SurfaceLatticeOptions lattice;
  lattice.seed = d.seed;
  lattice.iterations = options.iterations;
  lattice.threads = options.threads;
  lattice.price = d.price;
  lattice.corner_cut_mm = d.layout.corner_cut_mm;
  lattice.kept = kept;
  lattice.regions = regions;
  const auto solver = mesh::solver_mesh_of(surface, d.limits, mesh::kSolverDeviation_mm, options.threads);
  lattice.solver = solver ? &*solver : nullptr;
  lattice.time_limit_s =
      std::max(kMinGrowthShare * options.time_limit_s, (end_s - budget.used_s()) / (1.0 + lattice::kFrontTimeShare));
  return lattice::grow_front(surface, d.limits, lattice, progress);
}

// Returns the layout of the design and those of the search. Pricing the first one tells how long the steps after the
// growth will take.
std::vector<WiredLayout> choices_around(const design::Design& d, const mesh::Surface& surface,
                                        const mesh::SurfaceRegions* regions,
                                        const std::vector<design::PlacedModule>& kept, const GrowAroundOptions& options,
                                        TimeBudget& budget, const ProgressSink& progress) {
  routing::RoutingOptions routing = routing_options(d);
  routing.threads = options.threads;
  const double begin_s = budget.used_s();
  std::vector<WiredLayout> choices{priced(surface, d.layout, d.limits, routing, regions)};
  reserve_later_steps(budget, budget.used_s() - begin_s, options.threads);
  std::vector<design::ModuleLayout> grown = budget.run("growth", 1.0, [&](double end_s) {
    return grown_around(d, surface, regions, kept, options, budget, end_s, progress);
  });
  report(progress, kPricingStep, -1.0, counted(grown.size(), "layout"));
  budget.run(kPricingStep, 1.0, [&](double end_s) {
    routing.give_up = give_up_at(budget, end_s, options.iterations);
    std::ranges::move(priced(surface, std::move(grown), d.limits, routing, regions, options.threads),
                      std::back_inserter(choices));
  });
  return choices;
}

// Returns, by module of `now`, the module of `old` at the same place, −1 where there is none.
std::vector<int> modules_at_same_place(const design::ModuleLayout& old, const design::ModuleLayout& now) {
  const auto place = [](const design::PlacedModule& m) {
    std::array<double, 9> at{};
    for (std::size_t k = 0; k < 9; ++k) at[k] = m.corner_mm[k / 3][static_cast<int>(k % 3)];
    return at;
  };
  std::map<std::array<double, 9>, int> id_at;
  for (std::size_t id = 0; id < old.modules.size(); ++id) id_at.emplace(place(old.modules[id]), static_cast<int>(id));
  std::vector<int> same;
  for (const design::PlacedModule& m : now.modules) {
    const auto found = id_at.find(place(m));
    same.push_back(found == id_at.end() ? -1 : found->second);
  }
  return same;
}

// Modules that another layout has at the same place keep their numbers; the others get new ones.
void take_over_numbers(const design::Design& old, design::Design& taken) {
  const std::vector<int> same = modules_at_same_place(old.layout, taken.layout);
  taken.next_number = design::next_number(old);
  std::vector<std::pair<int, std::size_t>> order;  // number, module
  for (std::size_t k = 0; k < same.size(); ++k)
    order.emplace_back(same[k] < 0 ? new_number(taken) : design::number_of(old, same[k]).value, k);
  std::ranges::sort(order);
  std::vector<int> numbers, now(order.size());
  for (const auto& [number, k] : order) {
    now[k] = static_cast<int>(numbers.size());
    numbers.push_back(number);
  }
  std::vector<design::PlacedModule> modules;
  for (const auto& [number, k] : order) {
    modules.push_back(taken.layout.modules[k]);
    for (int& n : modules.back().neighbour) n = n < 0 ? -1 : now[static_cast<std::size_t>(n)];
  }
  taken.layout.modules = std::move(modules);
  design::set_numbers(taken.layout, std::move(numbers));
}

}  // namespace

design::Design take_alternative(const design::Design& design, int index, const ProgressSink& progress) {
  const auto start = Clock::now();
  if (index < 0 || index >= static_cast<int>(design.alternatives.size())) {
    throw InputError(
        design.alternatives.empty() ? std::string("the design has no alternatives; make it again with triskin design")
        : design.alternatives.size() == 1
            ? fmt::format("There is no alternative {}; the only one is 0.", index)
            : fmt::format("There is no alternative {}; there are 0 … {}.", index, design.alternatives.size() - 1));
  }
  design::Design taken = design;
  const mesh::Surface surface(taken.surface);
  taken.layout = taken.alternatives[static_cast<std::size_t>(index)].layout;
  taken.taken = index;
  take_over_numbers(design, taken);
  design::assign_kinds_by_place(taken.kinds, taken.layout);
  finish(taken, surface, regions_of(surface, taken).get(), start, progress);
  return taken;
}

EditedDesign edit_design(const design::Design& design, const LayoutEdit& edit, const ProgressSink& progress) {
  const auto start = Clock::now();
  const std::vector<bool> gone = marked(design, edit.remove);
  for (const NewPlace& place : edit.add) {
    if (const auto* beside = std::get_if<BesideModule>(&place)) require_module(design, beside->module);
  }
  EditedDesign result{design, {}, {}, {}};
  design::Design& d = result.design;
  const mesh::Surface surface(d.surface);
  d.next_number = design::next_number(d);
  d.layout.numbers = design::all_numbers(d.layout);
  result.new_id = lattice::remove_modules(d.layout, gone);
  d.layout.jumpers.clear();
  d.layout.refused.clear();
  d.taken = -1;
  const auto regions = regions_of(surface, d);
  for (const NewPlace& place : edit.add) add_one(place, design, surface, regions.get(), result);
  if (d.layout.modules.empty()) throw InputError("no module would be left; a design needs one");
  give_kinds(d, d.layout.modules.size() - result.added.size());
  design::set_numbers(d.layout, std::move(d.layout.numbers));
  lattice::number_islands(d.layout);
  lattice::measure(surface, d.layout, regions.get());
  result.kept_patches = wire_around(design, d, surface, regions.get(), result.new_id, progress);
  d.report.seconds = seconds_since(start);
  return result;
}

EditedDesign grow_around(const design::Design& design, const std::vector<int>& kept, const GrowAroundOptions& options,
                         const ProgressSink& progress) {
  const auto start = Clock::now();
  TimeBudget budget(options.time_limit_s);
  const std::vector<bool> searched = marked(design, kept, true);
  EditedDesign result{design, {}, {}, {}};
  design::Design& d = result.design;
  const mesh::Surface surface(d.surface);
  const auto regions = regions_of(surface, d);
  d.next_number = design::next_number(d);
  design::ModuleLayout fixed = d.layout;
  fixed.numbers = design::all_numbers(d.layout);
  result.new_id = lattice::remove_modules(fixed, searched);
  d.layout.jumpers.clear();
  std::vector<WiredLayout> choices =
      choices_around(d, surface, regions.get(), fixed.modules, options, budget, progress);
  const auto best = std::ranges::max_element(choices, std::less{}, &WiredLayout::value);
  const std::size_t count = best->layout.modules.size();
  d.alternatives = front_of(choices);
  for (design::Alternative& a : d.alternatives) a.layout.numbers.clear();  // They get theirs when they are taken.
  const auto same = std::ranges::find(d.alternatives, count, [](const auto& a) { return a.layout.modules.size(); });
  d.taken = same == d.alternatives.end() ? -1 : static_cast<int>(same - d.alternatives.begin());
  if (best == choices.begin()) {
    result.new_id = unchanged(design).new_id;
  } else {
    for (std::size_t id = fixed.modules.size(); id < count; ++id) result.added.push_back(static_cast<int>(id));
  }
  d.layout = best->layout;
  d.layout.jumpers.clear();
  if (best != choices.begin()) {
    give_kinds(d, fixed.modules.size());
    d.layout.numbers = fixed.numbers;
    number_new_modules(d);
    design::set_numbers(d.layout, std::move(d.layout.numbers));
  }
  lattice::number_islands(d.layout);
  lattice::measure(surface, d.layout, regions.get());
  result.kept_patches = wire_around(design, d, surface, regions.get(), result.new_id, progress);
  d.report.seconds = seconds_since(start);
  return result;
}

EditedDesign mirror_design(const design::Design& design, const design::MirrorPlane& plane,
                           const ProgressSink& progress) {
  const auto start = Clock::now();
  EditedDesign result = unchanged(design);
  design::Design& d = result.design;
  if (d.name.ends_with(kMirroredSuffix))
    d.name.resize(d.name.size() - kMirroredSuffix.size());
  else
    d.name += kMirroredSuffix;
  d.surface = design::mirrored(d.surface, plane);
  if (d.side) d.side->part = design::mirrored(d.side->part, plane);
  for (design::PlacedPiece& piece : d.pieces) piece = design::turned_over(std::move(piece));
  d.layout = design::mirrored(d.layout, plane);
  for (design::Alternative& a : d.alternatives) a.layout = design::mirrored(a.layout, plane);
  d.regions = design::mirrored(d.regions, plane);
  d.kinds = design::mirrored(d.kinds, plane);
  const mesh::Surface surface(d.surface);
  finish(d, surface, regions_of(surface, d).get(), start, progress);
  return result;
}

}  // namespace triskin::pipeline
