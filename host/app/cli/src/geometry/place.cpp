// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <set>

#include "command.hpp"
#include "corner_cut_option.hpp"
#include "mesh_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/placement/lattices.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::cli::place_command {
namespace {

using placement::PlacementMethod;

struct Options {
  std::string polygon;
  std::string proof;
  std::string weights;
  std::string output;
  UnitOption unit;
  int piece = -1;  // A negative number, −1, selects all pieces of the net.
  std::vector<int> node{0, 0};
  std::string lattices;  // "auto" or a number; empty: one lattice, whose optimum is proved.
  int steps = 0;
  placement::PlacementOptions placement;
};

// A number that is displayed as 0 must not have a sign.
double without_sign_of_zero(double value, double least) {
  return std::abs(value) < least ? 0.0 : value;
}

// Reports the coverage of the whole triangles, and of the triangles with cut corners.
void add_cut(const placement::PlacementResult& r, double area_mm2, const Options& options, Output& output,
             nlohmann::json& result) {
  const double cut = options.placement.corner_cut_mm;
  const double whole = r.modules * design::kModuleArea_mm2 / area_mm2,
               left = r.modules * design::module_area_mm2(cut) / area_mm2;
  result["corner_cut_mm"] = cut;
  result["coverage"] = whole;
  result["coverage_cut"] = left;
  output.say(fmt::format("corners cut by {:g} mm: coverage {:.1f} % of whole triangles, {:.1f} % of cut modules", cut,
                         100.0 * whole, 100.0 * left));
  say_cut_pads(cut, output);
}

nlohmann::json tiles_json(const placement::PlacementResult& r) {
  nlohmann::json tiles = nlohmann::json::array();
  for (const design::Tile& t : r.tiles) tiles.push_back({{"i", t.i}, {"j", t.j}, {"up", t.up}});
  for (std::size_t k = 0; k < r.tile_weights.size(); ++k) tiles[k]["weight"] = r.tile_weights[k];
  return tiles;
}

nlohmann::json pivoted_json(const auto& placement, const design::Vec2& pivot) {
  return {{"x_mm", placement.x_mm},
          {"y_mm", placement.y_mm},
          {"theta_rad", placement.theta_rad},
          {"vertex", placement.vertex},
          {"pivot_mm", {pivot.x(), pivot.y()}}};
}

nlohmann::json result_of(const design::Polygon& polygon, const placement::PlacementResult& r, const Options& options,
                         Output& output) {
  nlohmann::json result = {
      {"modules", r.modules},
      {"upper_bound", r.upper_bound},
      {"proved", r.proved},
      {"stopped", std::string(placement::kSearchStopNames.name(r.stopped))},
      {"modules_within_bound", r.modules_within_bound},
      {"bound_inset_mm", -0.5 * r.tolerance_mm},
      {"clearance_mm", r.clearance_mm},
      {"clearance_bound_mm", r.clearance_bound_mm},
      {"tolerance_mm", r.tolerance_mm},
      {"placement", {{"x_mm", r.placement.x_mm}, {"y_mm", r.placement.y_mm}, {"theta_rad", r.placement.theta_rad}}},
      {"evaluations", r.evaluations},
      {"cells", r.cells},
      {"search_seconds", r.search_seconds},
      {"seconds", r.seconds}};
  if (options.placement.corner_cut_mm > 0.0) add_cut(r, placement::polygon_area(polygon), options, output, result);
  result["tiles"] = tiles_json(r);
  if (r.pivoted)
    result["pivoted_placement"] =
        pivoted_json(*r.pivoted, polygon.outer.at(static_cast<std::size_t>(r.pivoted->vertex)));
  if (options.placement.weights) {
    result["weight"] = r.weight;
    result["weight_bound"] = r.weight_bound;
  }
  if (options.placement.deficit) {
    result["deficit_mm"] = r.deficit_mm ? nlohmann::json(*r.deficit_mm) : nlohmann::json();
    result["deficit_bound_mm"] = r.deficit_bound_mm;
  }
  return result;
}

void say_result(const placement::PlacementResult& r, const Options& options, const Output& output) {
  const bool exact = options.placement.method == PlacementMethod::kBranchAndBound;
  output.say(fmt::format("{}, upper bound {}{}; clearance {:.4f} mm at tolerance {:g} mm", counted(r.modules, "module"),
                         r.upper_bound, r.proved ? " (proved optimal)" : "", without_sign_of_zero(r.clearance_mm, 5e-5),
                         r.tolerance_mm));
  if (exact && !options.placement.connected && !options.placement.weights && r.modules_within_bound < r.modules)
    output.say(fmt::format("{} of them stand over by more than half the tolerance, where the bound does not reach",
                           r.modules - r.modules_within_bound));
  if (r.stopped != placement::SearchStop::kNone)
    output.say(fmt::format("the search ended at its limit of {}: the best that was found, and a bound that is open",
                           placement::kSearchStopNames.name(r.stopped)));
  const std::string bound =
      exact ? fmt::format("; none holds more than {} with insets from {:g} mm", r.upper_bound, -0.5 * r.tolerance_mm)
            : "";
  output.say(fmt::format("placement x {:.6f} mm, y {:.6f} mm, theta {:.9f} rad; {} cells, {:.3f} s{}",
                         without_sign_of_zero(r.placement.x_mm, 5e-7), without_sign_of_zero(r.placement.y_mm, 5e-7),
                         without_sign_of_zero(r.placement.theta_rad, 5e-10), r.cells, r.seconds, bound));
  if (options.placement.weights) output.say(fmt::format("weight {:.6g}, none above {:.6g}", r.weight, r.weight_bound));
  if (r.deficit_mm)
    output.say(fmt::format("one module more would fit if every side gave way by {:.4f} mm, not by less than {:.4f} mm",
                           *r.deficit_mm, r.deficit_bound_mm));
}

// Writes the modules for `route`, with every piece as an island. The cable of a controller can reach the rim of a
// piece.
std::string module_list(const std::vector<placement::PlacementResult>& results) {
  nlohmann::json modules = nlohmann::json::array();
  for (std::size_t island = 0; island < results.size(); ++island) {
    const std::set<design::Tile> tiles(results[island].tiles.begin(), results[island].tiles.end());
    for (const design::Tile& t : results[island].tiles) {
      bool border = false;
      for (int s = 0; s < 3; ++s) border = border || !tiles.contains(design::across(t, s).tile);
      modules.push_back(
          {{"id", modules.size()}, {"i", t.i}, {"j", t.j}, {"up", t.up}, {"island", island}, {"border", border}});
    }
  }
  return nlohmann::json{{"modules", std::move(modules)}}.dump() + "\n";
}

std::vector<design::Polygon> polygons_of(const Options& options, const Output& output) {
  const std::optional<mesh::LengthUnit>& unit = options.unit.unit;
  auto [polygons, remark] =
      placement::read_polygons(options.polygon, unit ? std::optional(mesh::scale_of(*unit)) : std::nullopt);
  if (!remark.empty()) output.say(fmt::format("{}: {}", options.polygon, remark));
  const int pieces = static_cast<int>(polygons.size());
  if (options.piece >= pieces)
    throw InputError(fmt::format("--piece {}: {} has pieces 0 … {}", options.piece, options.polygon, pieces - 1));
  if (options.piece >= 0) return {polygons[static_cast<std::size_t>(options.piece)]};
  if (pieces > 1 && (!options.proof.empty() || options.placement.weights))
    throw InputError(fmt::format("{}: has {}; choose one with --piece for --proof or --weights", options.polygon,
                                 counted(pieces, "piece")));
  return polygons;
}

nlohmann::json total_of(const nlohmann::json& pieces) {
  nlohmann::json total = {{"modules", 0}, {"upper_bound", 0}, {"proved", true}, {"seconds", 0.0}, {"pieces", pieces}};
  for (const nlohmann::json& piece : pieces) {
    for (const char* key : {"modules", "upper_bound"}) total[key] = total[key].get<int>() + piece[key].get<int>();
    total["seconds"] = total["seconds"].get<double>() + piece["seconds"].get<double>();
    total["proved"] = total["proved"].get<bool>() && piece["proved"].get<bool>();
  }
  return total;
}

// The remaining pieces share the remaining time.
placement::PlacementResult place_piece(const design::Polygon& polygon, const Options& options, std::size_t pieces_left,
                                       std::chrono::steady_clock::time_point start, const Output& output) {
  placement::PlacementOptions placement = options.placement;
  if (placement.time_limit_s > 0.0) {
    const double used_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    placement.time_limit_s = std::max(1e-3, (placement.time_limit_s - used_s) / static_cast<double>(pieces_left));
  }
  if (options.proof.empty()) return placement::place(polygon, placement, output.progress());
  OutputFile file(options.proof);
  placement::ProofWriter writer([&](std::string_view part) { file.write(part); });
  placement.proof_cell = [&](const placement::ProofCell& cell) { writer.add_cell(cell); };
  placement::PlacementResult result = placement::place(polygon, placement, output.progress());
  writer.finish(polygon, result);
  file.commit();
  return result;
}

const char* reason_of_nothing(const std::vector<placement::PlacementResult>& results) {
  const bool open = std::ranges::any_of(results, [](const auto& r) { return r.upper_bound > 0; });
  return open ? "no placement with a module was found before the limit, and none was excluded: give more with "
                "--time-limit-s or --memory-mb"
              : "no module fits: a module is a triangle with sides of 30 mm, and lengths are mm unless --unit names "
                "another unit";
}

placement::LatticesOptions lattices_options(const Options& options) {
  const placement::PlacementOptions& p = options.placement;
  if (p.shape != placement::TileShape::kTriangle || p.corner_cut_mm > 0.0 || p.weights || p.connected || p.deficit ||
      p.method != PlacementMethod::kBranchAndBound || !options.proof.empty())
    throw InputError(
        "--lattices: only for the number of whole triangles; leave --shape, --corner-cut-mm, --weights, --connected, "
        "--deficit, --method and --proof out");
  placement::LatticesOptions lattices;
  lattices.gap_mm = p.gap_mm;
  lattices.tolerance_mm = p.tolerance_mm;
  if (!(p.time_limit_s > 0.0)) throw InputError("--lattices: the search never ends by itself; give --time-limit-s");
  lattices.time_limit_s = p.time_limit_s;
  lattices.steps = options.steps;
  lattices.seed = p.seed;
  if (options.lattices == "auto") return lattices;
  const char* const end = options.lattices.data() + options.lattices.size();
  if (std::from_chars(options.lattices.data(), end, lattices.max_lattices).ptr != end || lattices.max_lattices < 1)
    throw InputError(fmt::format("--lattices: \"{}\" is not understood; give a number of lattices, 1 … 1000, or auto",
                                 options.lattices));
  return lattices;
}

nlohmann::json lattices_json(const placement::FlatLayout& layout, const placement::PlacementResult& one) {
  nlohmann::json lattices = nlohmann::json::array();
  for (const placement::FlatLattice& l : layout.lattices) {
    nlohmann::json tiles = nlohmann::json::array();
    for (const design::Tile& t : l.tiles) tiles.push_back({{"i", t.i}, {"j", t.j}, {"up", t.up}});
    lattices.push_back(
        {{"placement", {{"x_mm", l.placement.x_mm}, {"y_mm", l.placement.y_mm}, {"theta_rad", l.placement.theta_rad}}},
         {"tiles", std::move(tiles)}});
  }
  return {{"modules", layout.modules},
          {"upper_bound", layout.upper_bound},
          {"proved", layout.modules == layout.upper_bound},
          {"one_lattice", one.modules},
          {"one_lattice_proved", one.proved},
          {"lattices", std::move(lattices)},
          {"steps", layout.steps},
          {"seconds", one.seconds + layout.seconds}};
}

// Several lattices on each outline; the outlines share the time, and the best single lattice gets three tenths of it.
int run_lattices(const Options& options, Output& output) {
  constexpr double kOneLatticeShare = 0.3;
  placement::LatticesOptions lattices = lattices_options(options);
  const std::vector<design::Polygon> polygons = polygons_of(options, output);
  if (!options.output.empty() && polygons.size() > 1)
    throw InputError("-o: a layout of several lattices is that of one outline; choose one with --piece");
  const double time_limit_s = lattices.time_limit_s / static_cast<double>(polygons.size());
  nlohmann::json pieces = nlohmann::json::array();
  for (const design::Polygon& polygon : polygons) {
    placement::PlacementOptions single = options.placement;
    single.time_limit_s = kOneLatticeShare * time_limit_s;
    single.largest_clearance = false;
    const placement::PlacementResult one = placement::place(polygon, single, output.progress());
    lattices.time_limit_s = std::max(0.01, time_limit_s - one.seconds);
    const placement::FlatLayout layout =
        placement::place_lattices(polygon, {one.placement, one.tiles}, lattices, output.progress());
    pieces.push_back(lattices_json(layout, one));
    output.say(fmt::format("{} on {}, no layout holds more than {}; the best single lattice holds {}{}; {:.1f} s",
                           counted(layout.modules, "module"), counted(layout.lattices.size(), "lattice"),
                           layout.upper_bound, one.modules, one.proved ? " (proved)" : "",
                           one.seconds + layout.seconds));
    if (!options.output.empty() && layout.modules > 0)
      write_output(options.output, placement::flat_layout_text(polygon, layout, lattices));
  }
  output.result = pieces.size() == 1 ? pieces[0] : total_of(pieces);
  output.result["gap_mm"] = lattices.gap_mm;
  if (output.result["modules"].get<int>() > 0) return 0;
  output.say(
      "no module fits: a module is a triangle with sides of 30 mm, and lengths are mm unless --unit names another "
      "unit");
  return 1;
}

int run(const Options& options, Output& output) {
  if (!options.lattices.empty()) return run_lattices(options, output);
  if (!options.output.empty() && options.placement.shape != placement::TileShape::kTriangle)
    throw InputError("-o: only triangles can be routed; leave --shape or -o out");
  const std::vector<design::Polygon> polygons = polygons_of(options, output);
  std::vector<placement::PlacementResult> results;
  nlohmann::json pieces = nlohmann::json::array();
  int modules = 0;
  const auto start = std::chrono::steady_clock::now();
  for (const design::Polygon& polygon : polygons) {
    try {
      results.push_back(place_piece(polygon, options, polygons.size() - results.size(), start, output));
    } catch (const InputError& e) {
      throw InputError(fmt::format("{}: {}", options.polygon, e.what()));
    }
    const placement::PlacementResult& r = results.back();
    modules += r.modules;
    pieces.push_back(result_of(polygon, r, options, output));
    Eigen::AlignedBox2d box;
    for (const design::Vec2& p : polygon.outer) box.extend(p);
    pieces.back()["size_mm"] = {box.sizes().x(), box.sizes().y()};
    pieces.back()["area_cm2"] = placement::polygon_area(polygon) / 100.0;
    constexpr double kSkinOfPerson_mm2 = 1.5e6;
    if (placement::polygon_area(polygon) > kSkinOfPerson_mm2 && !options.unit.unit)
      output.say(
          fmt::format("{:.1f} m² are more than the skin of a person (1.5 m²); if the unit is wrong, --unit names the "
                      "right one",
                      1e-6 * placement::polygon_area(polygon)));
    if (!output.json()) {
      output.say(fmt::format("outline of {:.1f} × {:.1f} mm, {:.1f} cm²", box.sizes().x(), box.sizes().y(),
                             placement::polygon_area(polygon) / 100.0));
      say_result(r, options, output);
    }
  }
  output.result = pieces.size() == 1 ? pieces[0] : total_of(pieces);
  if (pieces.size() > 1)
    output.say(fmt::format("{} on {}, upper bound {}", counted(modules, "module"), counted(pieces.size(), "piece"),
                           output.result["upper_bound"].get<int>()));
  if (modules == 0) {
    output.say(reason_of_nothing(results));
    return 1;
  }
  if (!options.output.empty()) write_output(options.output, module_list(results));
  return 0;
}

const std::map<std::string, PlacementMethod> kMethods{{"bnb", PlacementMethod::kBranchAndBound},
                                                      {"r1", PlacementMethod::kR1},
                                                      {"r2", PlacementMethod::kR2},
                                                      {"r3", PlacementMethod::kR3},
                                                      {"r4", PlacementMethod::kR4},
                                                      {"r5", PlacementMethod::kR5},
                                                      {"r6", PlacementMethod::kR6},
                                                      {"r7", PlacementMethod::kR7}};

void add_method(CLI::App& app, Options& options) {
  placement::PlacementOptions& placement = options.placement;
  app.add_option("--method", placement.method,
                 "bnb (certified), or r1 … r7, the heuristics of the reference paper (docs/paper.md)")
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

void add_modules(CLI::App& app, Options& options) {
  app.add_option("--tolerance-mm", options.placement.tolerance_mm, "a module may stand over by this much")
      ->capture_default_str();
  static const std::map<std::string, placement::TileShape> kShapes{{"triangle", placement::TileShape::kTriangle},
                                                                   {"square", placement::TileShape::kSquare},
                                                                   {"hexagon", placement::TileShape::kHexagon}};
  app.add_option("--shape", options.placement.shape, "modules with sides of 30 mm: triangle, square or hexagon")
      ->transform(one_of(kShapes));
  app.add_option("--gap-mm", options.placement.gap_mm, "free space between facing sides of modules")
      ->capture_default_str();
  add_corner_cut(app, options.placement.corner_cut_mm);
}

void add_search_limits(CLI::App& app, Options& options) {
  app.add_option("--time-limit-s", options.placement.time_limit_s, "0: none; the pieces of a net share it")
      ->capture_default_str();
  app.add_option("--memory-mb", options.placement.memory_limit_mb,
                 "for what the search keeps open; then it ends with the best that it has (method bnb)")
      ->capture_default_str();
  app.add_option("--proof-mb", options.placement.proof_limit_mb,
                 "largest size of the file of --proof; before it the search ends with the best that it has")
      ->capture_default_str();
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("POLYGON", options.polygon,
                 "GeoJSON or WKT polygon in mm, holes allowed; a drawing in DXF or SVG; or the net that unfold writes")
      ->required();
  options.unit.add_to(app);
  app.add_option("-o,--output", options.output, "the modules, as route reads them (JSON); each piece is an island");
  app.add_option("--piece", options.piece, "of a net: only this one; default: all")->check(CLI::Range(0, 1'000'000));
  app.add_option("--lattices", options.lattices,
                 "several lattices, each moved on its own: at most so many, or auto; a search with a proved bound; -o "
                 "then writes the layout, which triskin check judges (docs/placement.md)");
  app.add_option("--steps", options.steps, "with --lattices: steps of the search (0: as the time permits)")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
  add_method(app, options);
  add_modules(app, options);
  add_search_limits(app, options);
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
        options->placement.paper.node = {options->node[0], options->node[1]};
        const bool exact = options->placement.method == PlacementMethod::kBranchAndBound;
        if (!options->proof.empty() && !exact) throw InputError("--proof: only --method bnb proves its answer");
        if (!options->weights.empty())
          options->placement.weights =
              std::make_shared<const placement::WeightMap>(placement::read_weight_map(options->weights));
        if (options->placement.deficit && !exact) throw InputError("--deficit: only --method bnb can tell");
        return run(*options, output);
      };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::place_command
