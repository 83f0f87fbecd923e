// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "corner_cut_option.hpp"
#include "triskin/cli/command.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/host/error.hpp"
#include "triskin/host/files.hpp"

namespace triskin::cli {
namespace {

using geometry::PlacementMethod;

struct Options {
  std::string polygon;
  std::string proof;
  std::string weights;
  std::vector<int> node{0, 0};
  geometry::PlacementOptions placement;
};

// Coverage both ways: of the whole triangles, and of what is left of them.
void add_cut(const geometry::PlacementResult& r, double area_mm2, const Options& options, Output& output) {
  const double cut = options.placement.corner_cut_mm;
  const double whole = r.modules * design::kModuleArea_mm2 / area_mm2,
               left = r.modules * design::module_area_mm2(cut) / area_mm2;
  output.result["corner_cut_mm"] = cut;
  output.result["coverage"] = whole;
  output.result["coverage_cut"] = left;
  output.say(fmt::format("corners cut by {:g} mm: coverage {:.1f} % of whole triangles, {:.1f} % of cut modules", cut,
                         100.0 * whole, 100.0 * left));
  say_cut_pads(cut, output);
}

int run(const Options& options, Output& output) {
  const geometry::Polygon polygon = geometry::read_polygon(options.polygon);
  const geometry::PlacementResult r = geometry::place(polygon, options.placement, output.progress());
  output.result = {
      {"modules", r.modules},
      {"upper_bound", r.upper_bound},
      {"proved", r.proved},
      {"clearance_mm", r.clearance_mm},
      {"clearance_bound_mm", r.clearance_bound_mm},
      {"tolerance_mm", r.tolerance_mm},
      {"placement", {{"x_mm", r.placement.x_mm}, {"y_mm", r.placement.y_mm}, {"theta_rad", r.placement.theta_rad}}},
      {"evaluations", r.evaluations},
      {"cells", r.cells},
      {"search_seconds", r.search_seconds},
      {"seconds", r.seconds}};
  if (options.placement.corner_cut_mm > 0.0) add_cut(r, geometry::polygon_area(polygon), options, output);
  nlohmann::json tiles = nlohmann::json::array();
  for (const geometry::Tile& t : r.tiles) tiles.push_back({{"i", t.i}, {"j", t.j}, {"up", t.up}});
  for (std::size_t k = 0; k < r.tile_weights.size(); ++k) tiles[k]["weight"] = r.tile_weights[k];
  output.result["tiles"] = std::move(tiles);
  if (r.pivoted) {
    const geometry::Vec2& pivot = polygon.outer.at(static_cast<std::size_t>(r.pivoted->vertex));
    output.result["pivoted_placement"] = {{"x_mm", r.pivoted->x_mm},
                                          {"y_mm", r.pivoted->y_mm},
                                          {"theta_rad", r.pivoted->theta_rad},
                                          {"vertex", r.pivoted->vertex},
                                          {"pivot_mm", {pivot.x(), pivot.y()}}};
  }
  if (options.placement.weights) {
    output.result["weight"] = r.weight;
    output.result["weight_bound"] = r.weight_bound;
  }
  if (options.placement.deficit) {
    output.result["deficit_mm"] = r.deficit_mm ? nlohmann::json(*r.deficit_mm) : nlohmann::json();
    output.result["deficit_bound_mm"] = r.deficit_bound_mm;
  }
  if (!options.proof.empty()) write_output(options.proof, geometry::proof_text(polygon, r));
  if (!output.json()) {
    output.say(fmt::format("{} modules, upper bound {}{}; clearance {:.4f} mm at tolerance {:g} mm", r.modules,
                           r.upper_bound, r.proved ? " (proved optimal)" : "", r.clearance_mm, r.tolerance_mm));
    output.say(fmt::format("placement x {:.6f} mm, y {:.6f} mm, theta {:.9f} rad; {} cells, {:.3f} s", r.placement.x_mm,
                           r.placement.y_mm, r.placement.theta_rad, r.cells, r.seconds));
    if (options.placement.weights)
      output.say(fmt::format("weight {:.6g}, none above {:.6g}", r.weight, r.weight_bound));
    if (r.deficit_mm)
      output.say(
          fmt::format("one module more would fit if every side gave way by {:.4f} mm, not by less than {:.4f} mm",
                      *r.deficit_mm, r.deficit_bound_mm));
  }
  return 0;
}

void add_method(CLI::App& app, Options& options) {
  geometry::PlacementOptions& placement = options.placement;
  static const std::map<std::string, PlacementMethod> kMethods{{"bnb", PlacementMethod::kBranchAndBound},
                                                               {"r1", PlacementMethod::kR1},
                                                               {"r2", PlacementMethod::kR2},
                                                               {"r3", PlacementMethod::kR3},
                                                               {"r4", PlacementMethod::kR4},
                                                               {"r5", PlacementMethod::kR5},
                                                               {"r6", PlacementMethod::kR6},
                                                               {"r7", PlacementMethod::kR7},
                                                               {"scan-edges", PlacementMethod::kScanEdges},
                                                               {"scan-slides", PlacementMethod::kScanSlides},
                                                               {"scan-shifts", PlacementMethod::kScanShifts},
                                                               {"scan-angles", PlacementMethod::kScanAngles},
                                                               {"scan-edge-angles", PlacementMethod::kScanEdgeAngles},
                                                               {"random", PlacementMethod::kRandom},
                                                               {"descent", PlacementMethod::kDescent}};
  app.add_option("--method", placement.method,
                 "bnb (certified); r1 … r7, the heuristics of the reference paper (docs/paper.md); scan-edges, "
                 "scan-slides, scan-shifts, scan-angles, scan-edge-angles, random, descent (docs/placement.md)")
      ->transform(one_of(kMethods));
  app.add_option("--line-deg", placement.paper.line_deg, "the generating line of r2 … r7: 0, 60 or 300")
      ->check(CLI::IsMember({0, 60, 300}))
      ->capture_default_str();
  app.add_option("--node", options.node, "the grid node I J of r2 … r7")->expected(2)->capture_default_str();
  app.add_option(
         "--draws", placement.paper.draws,
         "random draws of r1 (in all), r5 (places a placement of r2), r6 (angles a vertex), r7 (places a pair); "
         "0: 1000, 1, 2, half the vertices")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("POLYGON", options.polygon, "GeoJSON or WKT polygon in mm, holes allowed")->required();
  add_method(app, options);
  app.add_option("--tolerance-mm", options.placement.tolerance_mm, "a module may stand over by this much")
      ->capture_default_str();
  static const std::map<std::string, geometry::TileShape> kShapes{{"triangle", geometry::TileShape::kTriangle},
                                                                  {"square", geometry::TileShape::kSquare},
                                                                  {"hexagon", geometry::TileShape::kHexagon}};
  app.add_option("--shape", options.placement.shape, "modules with sides of 30 mm: triangle, square or hexagon")
      ->transform(one_of(kShapes));
  app.add_option("--gap-mm", options.placement.gap_mm, "free space between facing sides of modules")
      ->capture_default_str();
  add_corner_cut(app, options.placement.corner_cut_mm);
  app.add_option("--time-limit-s", options.placement.time_limit_s, "0: none")->capture_default_str();
  app.add_flag("!--no-clearance", options.placement.largest_clearance,
               "do not look for the placement with the largest clearance");
  app.add_flag("--connected", options.placement.connected, "the most modules that hang together by sides (method bnb)");
  app.add_option(
      "--weights", options.weights,
      "JSON raster or regions of what a module is worth by its place, less what it weighs (docs/placement.md): "
      "the largest sum, not number (method bnb)");
  app.add_flag("--deficit", options.placement.deficit,
               "also how far the sides of modules must give way for one module more (method bnb)");
  app.add_option("--proof", options.proof, "write a log that check-proof accepts or rejects (method bnb)");
  app.add_option("--threads", options.placement.threads, "0: all cores; the answer does not depend on it")
      ->check(CLI::Range(0, 1024));
  app.add_option("--seed", options.placement.seed, "for the random heuristics")->capture_default_str();
}

const Registration kPlace{{
    "place",
    "place a polygon on the isometric grid so that as many modules as possible lie wholly inside",
    "triskin place outline.geojson --method bnb --json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_options(app, *options);
      return [options](Output& output) {
        options->placement.keep_proof = !options->proof.empty();
        options->placement.paper.node = {options->node[0], options->node[1]};
        const bool exact = options->placement.method == PlacementMethod::kBranchAndBound;
        if (options->placement.keep_proof && !exact) throw InputError("--proof: only --method bnb proves its answer");
        if (!options->weights.empty())
          options->placement.weights =
              std::make_shared<const geometry::WeightMap>(geometry::read_weight_map(options->weights));
        if (options->placement.deficit && !exact) throw InputError("--deficit: only --method bnb can tell");
        return run(*options, output);
      };
    },
}};

}  // namespace
}  // namespace triskin::cli
