// SPDX-License-Identifier: GPL-3.0-or-later
// Speed against error of the placement: vertices, area, ε; and the ratio to R4 with the paper's Algorithm 1 in CGAL.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <random>

#include "bench.hpp"
#include "triskin/geometry/paper_algorithm.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/geometry/polygon_io.hpp"

namespace triskin::cli {
namespace {

using geometry::Placement;
using geometry::Polygon;
using Clock = std::chrono::steady_clock;
using Random = std::mt19937_64;
constexpr int kMostRuns = 5;
constexpr double kRepeatedFor_s = 0.5;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}
double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Star-shaped outlines: each radius by itself, or a few waves; the seed is the row's own, so that each row can be
// repeated alone.
Polygon outline(bool rough, int vertices, double area_cm2) {
  Random random(static_cast<std::uint64_t>(vertices) * 100003u + static_cast<std::uint64_t>(area_cm2));
  std::array<double, 6> size{}, phase{};
  for (std::size_t k = 0; k < size.size(); ++k) {
    size[k] = uniform(random, 0.0, 0.3) / static_cast<double>(k + 1);
    phase[k] = uniform(random, 0.0, 2.0 * M_PI);
  }
  Polygon p;
  for (int k = 0; k < vertices; ++k) {
    const double angle = 2.0 * M_PI * k / vertices;
    double r = rough ? uniform(random, 0.75, 1.25) : 1.0;
    for (std::size_t w = 0; !rough && w < size.size(); ++w)
      r += size[w] * std::cos(static_cast<double>(w + 1) * angle + phase[w]);
    p.outer.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  const double scale = std::sqrt(area_cm2 * 100.0 / geometry::polygon_area(p));
  for (auto& v : p.outer) v *= scale;
  return geometry::normalize_polygon(std::move(p), "bench outline");
}

// Mean time of one evaluation over a sample of R4's placements.
template <class Evaluate>
double mean_seconds(int sample, Evaluate evaluate) {
  Random random(4);
  const auto start = Clock::now();
  for (int k = 0; k < sample; ++k) {
    evaluate(Placement{uniform(random, 0, geometry::kSide_mm), uniform(random, 0, geometry::kHeight_mm),
                       M_PI / 180.0 * (k % 60)});
  }
  return since(start) / sample;
}

geometry::PlacementOptions count_only(double limit_s) {
  geometry::PlacementOptions options;
  options.time_limit_s = limit_s;
  options.threads = 1;
  options.largest_clearance = false;
  return options;
}

// A hill of contact likelihood in the middle, as wide as the outline.
geometry::WeightMap hill(double area_cm2) {
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
                       const geometry::PlacementOptions& options) {
  const Polygon p = outline(rough, vertices, area_cm2);
  // The least of some runs: the others measure what else the machine does.
  geometry::PlacementResult r = geometry::place(p, options);
  double seconds = r.seconds, total = r.seconds;
  for (int k = 1; k < kMostRuns && total < kRepeatedFor_s; ++k) {
    r = geometry::place(p, options);
    seconds = std::min(seconds, r.seconds);
    total += r.seconds;
  }
  // Of weights the gap is relative.
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
          {"seconds", seconds}};
}

// R4 with CGAL takes minutes to hours: its time is the mean of a sample of its placements times their number.
void add_baseline(nlohmann::json& row, int sample) {
  const Polygon p = outline(row["outline"] == "rough", row["vertices"], row["area_cm2"]);
  const double cgal_s =
      mean_seconds(sample, [&](const Placement& at) { return geometry::paper_algorithm1(p, at, false); });
  const double exact_s = mean_seconds(std::max(3, sample / 10),
                                      [&](const Placement& at) { return geometry::paper_algorithm1(p, at, true); });
  geometry::PlacementOptions r4;
  r4.method = geometry::PlacementMethod::kR4;
  const geometry::PlacementResult own = geometry::place(p, r4);
  const double r4_s = cgal_s * geometry::r4_evaluations();
  row["cgal_evaluation_s"] = cgal_s;
  row["cgal_exact_evaluation_s"] = exact_s;
  row["evaluation_s"] = own.seconds / static_cast<double>(own.evaluations);
  row["r4_modules"] = own.modules;
  row["r4_cgal_s"] = r4_s;
  row["r4_cgal_exact_s"] = exact_s * geometry::r4_evaluations();
  row["r4_cgal_extrapolated_from"] = sample;
  row["ratio_to_r4_cgal_exact"] = exact_s * geometry::r4_evaluations() / row["seconds"].get<double>();
  row["ratio_to_r4_cgal"] = r4_s / row["seconds"].get<double>();
}

nlohmann::json placement_rows(const BenchOptions& options, Output& output) {
  nlohmann::json rows = nlohmann::json::array();
  const auto sink = output.progress();
  const geometry::PlacementOptions count = count_only(options.quick ? 4.0 : 60.0);
  const auto add = [&](const char* series, bool rough, int vertices, double area_cm2,
                       const geometry::PlacementOptions& wanted) {
    report(sink, "bench placement", -1.0, series);
    rows.push_back(measure(series, rough, vertices, area_cm2, wanted));
  };
  const auto with = [&](auto&& change) {
    geometry::PlacementOptions wanted = count;
    change(wanted);
    return wanted;
  };
  for (const bool rough : {false, true}) {
    add("baseline", rough, 80, 757, count);
    add_baseline(rows.back(), options.quick ? 40 : 400);
    // What else can be asked for; the baseline, which asks for none of it, pays for none of it.
    add("clearance", rough, 80, 757, with([](auto& o) { o.largest_clearance = true; }));
    add("deficit", rough, 80, 757, with([](auto& o) { o.deficit = true; }));
    add("connected", rough, 80, 757, with([](auto& o) { o.connected = true; }));
    add("weights", rough, 80, 757,
        with([](auto& o) { o.weights = std::make_shared<const geometry::WeightMap>(hill(757)); }));
    add("hexagons", rough, 80, 757, with([](auto& o) { o.shape = geometry::TileShape::kHexagon; }));
    add("gap 2 mm", rough, 80, 757, with([](auto& o) { o.gap_mm = 2.0; }));
    for (const int n : options.quick ? std::vector{20, 80, 200} : std::vector{20, 40, 80, 200, 500, 1000, 2000, 5000})
      add("vertices", rough, n, 757, count);
    for (const double a :
         options.quick ? std::vector{57., 300., 1050.} : std::vector{57., 300., 1050., 3000., 10000., 50000.})
      add("area", rough, 80, a, count);
  }
  for (const double e : {1e-2, 1e-4, 1e-6, 1e-8})
    add("tolerance", true, 40, 300, with([e](auto& o) { o.tolerance_mm = e; }));
  return rows;
}

const BenchSubject kPlacement("placement", placement_rows);

}  // namespace
}  // namespace triskin::cli
