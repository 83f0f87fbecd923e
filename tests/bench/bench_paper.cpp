// SPDX-License-Identifier: GPL-3.0-or-later
// Repeats Table I of the reference paper: its R1 … R7 and the certified search on nets of its five parts, and how the
// time of each heuristic grows with the number of vertices.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>

#include "bench.hpp"
#include "bench_outlines.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/paper/heuristics.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::cli {
namespace {

namespace fs = std::filesystem;
using design::Polygon;
using placement::paper::Heuristic;
using json = nlohmann::json;

// Gives a column of Table I, the polygon's area and, as far as the paper reveals it, its number of vertices: 20 for LH;
// for the others the time of R4 over that of R3, which is |V| in the formulas.
struct PaperPart {
  const char* name;
  const char* net;  // The data folder has this file for the same region and size.
  double area_cm2;
  int vertices;
  int cracks;  // The generated net has this many cracks.
  double crack_depth;
  std::array<int, 7> modules;  // The index is the method, R1 … R7.
  std::array<double, 7> seconds;
};
constexpr std::array<PaperPart, 5> kParts{{
    {"LH", "LH_hipwing_v1", 57, 20, 3, 0.4, {8, 8, 6, 9, 8, 8, 8}, {9, 2, 2, 34, 17, 2, 17}},
    {"LUA", "LUA_upperarm_half_v1", 139, 74, 5, 0.7, {9, 8, 8, 10, 9, 7, 9}, {172, 154, 159, 11726, 5925, 108, 5925}},
    {"RUF", "RUF_forearm_v2", 279, 135, 6, 0.6, {34, 37, 37, 38, 37, 34, 37}, {206, 301, 316, 42795, 306, 229, 21256}},
    {"UT",
     "UT_torso_v1",
     757,
     113,
     6,
     0.5,
     {133, 138, 138, 142, 138, 138, 141},
     {290, 359, 371, 41773, 348, 291, 20939}},
    {"LT", "LT_root_v2", 1050, 18, 0, 0.0, {230, 231, 230, 232, 231, 231, 231}, {37, 9, 9, 157, 9, 8, 87}},
}};

constexpr std::array kHeuristics{Heuristic::kR1, Heuristic::kR2, Heuristic::kR3, Heuristic::kR4,
                                 Heuristic::kR5, Heuristic::kR6, Heuristic::kR7};

std::string name_of(Heuristic h) {
  return "R" + std::to_string(static_cast<int>(h));
}

// Takes the largest island of another unfolder's net, because the paper places one polygon.
Polygon largest_island(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw InputError("bench paper: cannot read " + file.string());
  const json islands = json::parse(in).at("islands");
  Polygon largest;
  for (const auto& island : islands) {
    Polygon p;
    for (const auto& ring : island.at("rings")) {
      std::vector<design::Vec2> points;
      for (const auto& q : ring) points.emplace_back(q.at(0).get<double>(), q.at(1).get<double>());
      (p.outer.empty() ? p.outer : p.holes.emplace_back()) = std::move(points);
    }
    if (largest.outer.empty() || placement::polygon_area(p) > placement::polygon_area(largest)) largest = std::move(p);
  }
  if (largest.outer.empty()) throw InputError("bench paper: " + file.string() + " holds no island");
  return placement::normalize_polygon(std::move(largest), file.filename().string());
}

class PaperRows {
 public:
  PaperRows(const BenchOptions& options, Output& output)
      : data_(options.data), quick_(options.quick), sink_(output.progress()) {}

  json run() {
    for (const PaperPart& part : kParts) table_one(part);
    for (const int vertices : {10, 20, 40, 80}) growth(vertices);
    return std::move(rows_);
  }

 private:
  // Uses the net of the data folder if it exists, and a generated one of the paper's area and number of vertices.
  void table_one(const PaperPart& part) {
    const fs::path file = fs::path(data_) / "blender" / (std::string(part.net) + ".json");
    if (!data_.empty() && fs::exists(file)) compare(part, part.net, largest_island(file));
    compare(part, "generated", cracked_outline(part.vertices, part.area_cm2, part.cracks, part.crack_depth));
  }

  void compare(const PaperPart& part, const char* net, const Polygon& p) {
    const json about{{"series", "table I"}, {"part", part.name}, {"net", net}, {"paper_area_cm2", part.area_cm2}};
    for (std::size_t k = 0; k < kHeuristics.size(); ++k) {
      json& row = add(about, p, kHeuristics[k]);
      row["paper_modules"] = part.modules[k];
      row["paper_uncovered"] = 1.0 - part.modules[k] * design::kModuleArea_mm2 / (100.0 * part.area_cm2);
      row["paper_seconds"] = part.seconds[k];
    }
    certified(about, p);
  }

  void growth(int vertices) {
    const Polygon p = bench_outline(false, vertices, 757);
    const json about{{"series", "growth"}, {"part", "smooth outline"}, {"net", "generated"}};
    for (const Heuristic h : kHeuristics) add(about, p, h);
    certified(about, p);
  }

  // Runs one heuristic with the fast Algorithm 1, to its end or on a sample of its pairs of vertices.
  json& add(const json& about, const Polygon& p, Heuristic heuristic) {
    const auto vertices = static_cast<std::int64_t>(p.outer.size());
    report(sink_, "bench paper", -1.0, about.at("part").get<std::string>() + " " + name_of(heuristic));
    placement::paper::HeuristicOptions options;
    const std::int64_t all = placement_count(heuristic, vertices);
    // A placement takes about 0.2 µs per vertex.
    const std::int64_t to_the_end = (quick_ ? 15'000'000 : 100'000'000) / vertices,
                       sample = (quick_ ? 4'000'000 : 20'000'000) / vertices;
    if (vertices > kVerticesToTheEnd && all > to_the_end) options.pair_step = all / sample + 1;
    const double start = processor_s();
    const auto best = algorithm2(p, std::span(&heuristic, 1), options, {.reject_pierced = true});
    const double seconds = processor_s() - start,
                 whole = static_cast<double>(all) / static_cast<double>(best.evaluations);
    json& row = put(about, p, name_of(heuristic), best.modules);
    row["placements"] = all;
    row["extrapolated"] = options.pair_step > 1;
    row["placements_evaluated"] = best.evaluations;
    row["seconds"] = seconds * whole;
    row["cgal_seconds"] = cgal_evaluation_s(p, heuristic) * static_cast<double>(all);
    return row;
  }

  // Returns the mean time of Algorithm 1 with CGAL over some placements of the heuristic.
  [[nodiscard]] double cgal_evaluation_s(const Polygon& p, Heuristic heuristic) const {
    const std::int64_t all = placement_count(heuristic, static_cast<std::int64_t>(p.outer.size()));
    const std::int64_t step = std::max<std::int64_t>(1, all / (quick_ ? 5 : 20));
    std::int64_t seen = 0;
    int evaluated = 0;
    double seconds = 0.0;
    produce_placements(heuristic, p, {}, [&](const placement::paper::PivotedPlacement& at) {
      if (seen++ % step != 0) return true;
      const double start = processor_s();
      (void)placement::paper::algorithm1_cgal(p, at);
      seconds += processor_s() - start;
      return ++evaluated < 20;
    });
    return seconds / evaluated;
  }

  void certified(const json& about, const Polygon& p) {
    report(sink_, "bench paper", -1.0, about.at("part").get<std::string>() + " certified");
    placement::PlacementOptions options;
    options.threads = 1;
    options.largest_clearance = false;
    options.time_limit_s = quick_ ? 4.0 : 60.0;
    const double start = processor_s();
    const placement::PlacementResult r = placement::place(p, options);
    const double seconds = processor_s() - start;
    json& row = put(about, p, "certified", r.modules);
    row["placements"] = r.evaluations;
    row["extrapolated"] = false;
    row["seconds"] = seconds;
    row["proved"] = r.proved;
  }

  json& put(const json& about, const Polygon& p, const std::string& method, int modules) {
    const double area_mm2 = placement::polygon_area(p), covered_mm2 = modules * design::kModuleArea_mm2;
    json row = about;
    row["vertices"] = p.outer.size();
    row["area_cm2"] = 0.01 * area_mm2;
    row["method"] = method;
    row["modules"] = modules;
    row["covered_cm2"] = 0.01 * covered_mm2;
    row["uncovered"] = 1.0 - covered_mm2 / area_mm2;
    return rows_.emplace_back(std::move(row));
  }

  static constexpr std::int64_t kVerticesToTheEnd = 80;

  std::string data_;
  bool quick_;
  ProgressSink sink_;
  json rows_ = json::array();
};

json paper_rows(const BenchOptions& options, Output& output) {
  return PaperRows(options, output).run();
}

const BenchSubject kPaper("paper", "Table I of the reference paper: R1 … R7 and the certified search", paper_rows);

}  // namespace
}  // namespace triskin::cli
