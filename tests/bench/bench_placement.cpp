// SPDX-License-Identifier: GPL-3.0-or-later
// Measures speed against error of the placement: vertices, area, ε; and the ratio to the paper's R4 with its Algorithm
// 1 in CGAL.
#include <algorithm>
#include <array>
#include <cmath>

#include "bench.hpp"
#include "bench_outlines.hpp"
#include "triskin/placement/paper/heuristics.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::cli {
namespace {

namespace paper = placement::paper;
using design::Polygon;
constexpr int kMaxRuns = 5;
constexpr double kRepeatedFor_s = 0.5;

placement::PlacementOptions count_only(double limit_s) {
  placement::PlacementOptions options;
  options.time_limit_s = limit_s;
  options.threads = 1;
  options.largest_clearance = false;
  return options;
}

// The contact likelihood has a hill in the middle, as wide as the outline.
placement::WeightMap hill(double area_cm2) {
  constexpr int kPoints = 33;
  const double width = std::sqrt(100.0 * area_cm2), step = 2.0 * width / (kPoints - 1);
  std::vector<std::vector<double>> rows(kPoints, std::vector<double>(kPoints));
  for (int r = 0; r < kPoints; ++r) {
    for (int c = 0; c < kPoints; ++c) {
      const double x = (step * c - width) / width, y = (step * r - width) / width;
      rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = std::exp(-2.0 * (x * x + y * y));
    }
  }
  return {{-width, -width}, step, rows};
}

nlohmann::json measure(const char* series, bool rough, int vertices, double area_cm2,
                       const placement::PlacementOptions& options) {
  const Polygon p = bench_outline(rough, vertices, area_cm2);
  // We take the least of some runs, because the others include other work of the machine.
  double seconds = 1e300, processor = 1e300, total = 0.0;
  placement::PlacementResult r;
  for (int k = 0; k < kMaxRuns && total < kRepeatedFor_s; ++k) {
    const double start = processor_s();
    r = placement::place(p, options);
    processor = std::min(processor, processor_s() - start);
    seconds = std::min(seconds, r.seconds);
    total += r.seconds;
  }
  // The gap of weights is relative.
  const double gap = options.weights ? r.weight_bound / r.weight - 1.0 : r.upper_bound - r.modules;
  return {{"series", series},
          {"outline", rough ? "rough" : "smooth"},
          {"vertices", vertices},
          {"area_cm2", area_cm2},
          {"tolerance_mm", options.tolerance_mm},
          {"modules", r.modules},
          {"upper_bound", r.upper_bound},
          {"gap", gap},
          {"proved", r.proved},
          {"cells", r.cells},
          {"seconds", seconds},
          {"processor_s", processor}};
}

// A 361-gon of radius 60 mm − m around 24 tiles; six of their corners do not fit, so it holds 18 (by hand).
nlohmann::json hair(double missing_mm, placement::PlacementOptions options) {
  Polygon disc;
  for (int k = 0; k < 361; ++k)
    disc.outer.push_back((60.0 - missing_mm) *
                         design::Vec2(std::cos(2 * M_PI * k / 361), std::sin(2 * M_PI * k / 361)));
  options.tolerance_mm = 1e-7;
  options.time_limit_s = 0.0;  // No limit, so that cells are the same in each run.
  const double start = processor_s();
  const placement::PlacementResult r = placement::place(disc, options);
  return {{"series", "hair"},
          {"missing_mm", missing_mm},
          {"tolerance_mm", options.tolerance_mm},
          {"modules", r.modules},
          {"upper_bound", r.upper_bound},
          {"gap", r.upper_bound - r.modules},
          {"proved", r.proved},
          {"cells", r.cells},
          {"processor_s", processor_s() - start}};
}

// Times the paper's Algorithm 1 with CGAL on every `step`-th placement of its R4.
struct CgalTime {
  std::int64_t evaluated = 0, differ = 0;  // The second number counts results that differ from the fast Algorithm 1.
  double evaluation_s = 0.0;
};
CgalTime time_cgal(const Polygon& p, std::int64_t step, const paper::CgalUse& use) {
  paper::Algorithm1 fast(p);
  CgalTime t;
  std::int64_t seen = 0;
  produce_placements(paper::Heuristic::kR4, p, {}, [&](const paper::PivotedPlacement& at) {
    if (seen++ % step != 0) return true;
    const double start = processor_s();
    const std::size_t modules = algorithm1_cgal(p, at, use).size();
    t.evaluation_s += processor_s() - start;
    ++t.evaluated;
    t.differ += modules == static_cast<std::size_t>(fast.count(at)) ? 0 : 1;
    return true;
  });
  t.evaluation_s /= static_cast<double>(t.evaluated);
  return t;
}

// Runs the paper's R4 (docs/paper.md) beside the search: with the fast Algorithm 1 to its end, with CGAL and inexact
// constructions to its end unless quick, else extrapolated from a sample of its placements. Processor time is measured,
// so that other work of the machine does not count; the search has the least of some runs.
void add_baseline(nlohmann::json& row, bool quick) {
  const Polygon p = bench_outline(row["outline"] == "rough", row["vertices"], row["area_cm2"]);
  const double start = processor_s();
  const paper::BestPlacement r4 = algorithm2(p, std::array{paper::Heuristic::kR4});
  const double fast_s = processor_s() - start, search_s = row["processor_s"];
  row["r4_modules"] = r4.modules;
  row["r4_placements"] = r4.evaluations;
  row["r4_s"] = fast_s;
  row["evaluation_s"] = fast_s / static_cast<double>(r4.evaluations);
  const auto add = [&](const std::string& name, std::int64_t sample, const paper::CgalUse& use) {
    const CgalTime t = time_cgal(p, std::max<std::int64_t>(1, r4.evaluations / sample), use);
    const double whole_s = t.evaluation_s * static_cast<double>(r4.evaluations);
    row["r4_" + name + "_s"] = whole_s;
    row["r4_" + name + "_evaluated"] = t.evaluated;
    row["r4_" + name + "_extrapolated"] = t.evaluated < r4.evaluations;
    row["r4_" + name + "_differ"] = t.differ;
    row[name + "_evaluation_s"] = t.evaluation_s;
    row["ratio_to_r4_" + name] = whole_s / search_s;
  };
  add("cgal", quick ? 400 : r4.evaluations, {});
  add("cgal_exact", quick ? 100 : 10'000, {.exact_constructions = true});
  add("cgal_sides_first", quick ? 400 : 10'000, {.sides_first = true});
  add("cgal_exact_sides_first", quick ? 100 : 10'000, {.exact_constructions = true, .sides_first = true});
}

nlohmann::json placement_rows(const BenchOptions& options, Output& output) {
  nlohmann::json rows = nlohmann::json::array();
  const auto sink = output.progress();
  const placement::PlacementOptions count = count_only(60.0);
  const auto add = [&](const char* series, bool rough, int vertices, double area_cm2,
                       const placement::PlacementOptions& wanted) {
    report(sink, "bench placement", -1.0, series);
    rows.push_back(measure(series, rough, vertices, area_cm2, wanted));
  };
  const auto with = [&](auto&& change) {
    placement::PlacementOptions wanted = count;
    change(wanted);
    return wanted;
  };
  for (const bool rough : {false, true}) {
    add("baseline", rough, 80, 757, count);
    add_baseline(rows.back(), options.quick);
    // These rows ask for further results; the baseline asks for none of them and does not pay for them.
    add("clearance", rough, 80, 757, with([](auto& o) { o.largest_clearance = true; }));
    add("deficit", rough, 80, 757, with([](auto& o) { o.deficit = true; }));
    add("connected", rough, 80, 757, with([](auto& o) { o.connected = true; }));
    add("weights", rough, 80, 757,
        with([](auto& o) { o.weights = std::make_shared<const placement::WeightMap>(hill(757)); }));
    add("hexagons", rough, 80, 757, with([](auto& o) { o.shape = placement::TileShape::kHexagon; }));
    add("gap 2 mm", rough, 80, 757, with([](auto& o) { o.gap_mm = 2.0; }));
    for (const int n : {20, 40, 80, 200, 500, 1000, 2000, 5000}) add("vertices", rough, n, 757, count);
    for (const double a : {57., 300., 1050., 3000., 10000., 50000.}) {
      if (options.quick && a > 1e4) continue;
      add("area", rough, 80, a, count);
    }
  }
  for (const double missing_mm : {0.3, 0.03, 0.003, 3e-4}) {
    rows.push_back(hair(missing_mm, count));
  }
  for (const double limit_s : {0.05, 0.2, 0.8, 2.0}) {
    add("anytime", true, 200, 10000, with([limit_s](auto& o) { o.time_limit_s = limit_s; }));
    rows.back()["limit_s"] = limit_s;
  }
  for (const double e : {1e-2, 1e-4, 1e-6, 1e-8})
    add("tolerance", true, 40, 300, with([e](auto& o) { o.tolerance_mm = e; }));
  return rows;
}

const BenchSubject kPlacement("placement", "certified placement: time against outline size, ratio to R4",
                              placement_rows);

}  // namespace
}  // namespace triskin::cli
