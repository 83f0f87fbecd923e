// SPDX-License-Identifier: GPL-3.0-or-later
// Measures speed against error of covering a surface: time, limits, faces and area against modules; and the nets of
// another unfolder.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench.hpp"
#include "triskin/base/error.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::cli {
namespace {

namespace fs = std::filesystem;
using design::Mesh;
using mesh::Surface;

double since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// z = 25 mm · sin(x / 45 mm) · sin(y / 45 mm) gives domes and saddles with principal radii of 81 mm and more, of any
// size.
Mesh wavy_sheet(double area_cm2, int faces) {
  const int cells = std::max(2, static_cast<int>(std::lround(std::sqrt(faces / 2.0))));
  const double side_mm = 10.0 * std::sqrt(area_cm2 / 1.075);
  Mesh m;
  for (int v = 0; v <= cells; ++v) {
    for (int u = 0; u <= cells; ++u) {
      const double x = side_mm * u / cells, y = side_mm * v / cells;
      m.vertices.emplace_back(x, y, 25.0 * std::sin(x / 45.0) * std::sin(y / 45.0));
    }
  }
  const auto id = [cells](int u, int v) { return v * (cells + 1) + u; };
  for (int v = 0; v < cells; ++v) {
    for (int u = 0; u < cells; ++u) {
      m.faces.push_back({id(u, v), id(u + 1, v), id(u + 1, v + 1)});
      m.faces.push_back({id(u, v), id(u + 1, v + 1), id(u, v + 1)});
    }
  }
  return m;
}

nlohmann::json row_of(const char* series, const std::string& shape, const Surface& surface,
                      const design::ModuleLayout& layout) {
  const auto modules = static_cast<double>(layout.modules.size());
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& [limit, count] : layout.refused) refused[limit] = count;
  return {{"series", series},
          {"shape", shape},
          {"area_cm2", surface.area_mm2() / 100.0},
          {"faces", surface.mesh().faces.size()},
          {"modules", layout.modules.size()},
          {"islands", layout.islands},
          {"refused", refused},
          {"uncovered", 1.0 - modules * design::kModuleArea_mm2 / surface.area_mm2()}};
}

class UnfoldingRows {
 public:
  UnfoldingRows(const BenchOptions& options, Output& output)
      : quick_(options.quick), data_(options.data), sink_(output.progress()) {}

  nlohmann::json run() {
    const Surface sheet(wavy_sheet(700.0, 800));
    over_time("sheet", sheet);
    over_limits(sheet);
    over_island_cost(sheet);
    over_faces();
    over_area();
    if (!data_.empty() && !quick_) {
      over_time("UT_torso_v1", Surface(mesh::read_mesh(fs::path(data_) / "parts/UT_torso_v1.obj").mesh));
    }
    return std::move(rows_);
  }

  // Compares the real covers, in the folder that TRISKIN_DATA names, with the nets that another program made of them.
  nlohmann::json run_nets() {
    if (data_.empty())
      throw InputError("bench nets: --data or TRISKIN_DATA must name the folder with parts/ and blender/");
    for (const char* part :
         {"LH_hipwing_v1", "LUA_upperarm_half_v1", "RFA_forearm_v1", "SHANK_front_v25", "RUF_forearm_v2",
          "UA_upperarm_v1", "HIP_v1", "ROOT_v25", "UL_upperleg_v1", "UT_torso_v1", "LT_root_v2", "HEAD_v1"}) {
      const fs::path mesh = fs::path(data_) / "parts" / (std::string(part) + ".obj"), net = net_of(data_, part);
      if (!fs::exists(net)) throw InputError("bench nets: " + net.string() + ": no such file");
      lattice::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 1.5 : 20.0;
      auto& row = grow("nets", part, Surface(mesh::read_mesh(mesh).mesh), {}, o);
      row["modules_on_net"] = modules_on(net, o.time_limit_s);
      row["ratio"] = row["modules"].get<double>() / std::max(1, row["modules_on_net"].get<int>());
    }
    return std::move(rows_);
  }

 private:
  nlohmann::json& grow(const char* series, const std::string& shape, const Surface& surface,
                       const design::LayoutLimits& limits, const lattice::SurfaceLatticeOptions& options) {
    report(sink_, "bench unfolding", -1.0, series);
    const auto start = std::chrono::steady_clock::now();
    const design::ModuleLayout layout = lattice::grow_lattice(surface, limits, options);
    const double seconds = since(start);
    rows_.push_back(row_of(series, shape, surface, layout));
    rows_.back()["seconds"] = seconds;
    return rows_.back();
  }

  void over_time(const std::string& shape, const Surface& surface) {
    for (const double limit_s : {0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0}) {
      if (quick_ && limit_s > 5.0) break;
      lattice::SurfaceLatticeOptions o;
      o.time_limit_s = limit_s;
      grow("time", shape, surface, {}, o)["limit_s"] = limit_s;
    }
  }

  void over_limits(const Surface& surface) {
    for (const double scale : {0.25, 0.5, 1.0, 2.0, 4.0}) {
      design::LayoutLimits l;
      l.edge_error_mm *= scale;
      lattice::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 1.0 : 10.0;
      grow("edge error", "sheet", surface, l, o)["edge_error_mm"] = l.edge_error_mm;
      l = {};
      l.center_gap_mm *= scale;
      grow("centre gap", "sheet", surface, l, o)["center_gap_mm"] = l.center_gap_mm;
      const auto start = std::chrono::steady_clock::now();
      const unfolding::Net net = unfolding::unfold(surface, {.edge_error_mm = scale});
      rows_.push_back({{"series", "pieces"},
                       {"shape", "sheet"},
                       {"edge_error_mm", scale},
                       {"pieces", net.pieces.size()},
                       {"seconds", since(start)}});
    }
  }

  void over_island_cost(const Surface& surface) {
    for (const double cost : {0.0, 0.02, 0.1, 0.3, 1.0}) {
      lattice::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 1.0 : 10.0;
      o.price.island = cost;
      grow("island cost", "sheet", surface, {}, o)["island_cost"] = cost;
    }
  }

  // Shape and number of steps stay the same; only the mesh becomes finer.
  void over_faces() {
    for (const int faces : {200, 2000, 20000, 200000}) {
      if (quick_ && faces > 20000) break;
      const Surface surface(wavy_sheet(700.0, faces));
      lattice::SurfaceLatticeOptions o;
      o.iterations = quick_ ? 20 : 200;
      o.time_limit_s = quick_ ? 8.0 : 100.0;
      grow("faces", "sheet", surface, {}, o)["iterations"] = o.iterations;
    }
  }

  void over_area() {
    for (const double area_cm2 : {100.0, 300.0, 1000.0, 3000.0, 10000.0}) {
      if (quick_ && area_cm2 > 1000.0) break;
      const Surface surface(wavy_sheet(area_cm2, static_cast<int>(2.0 * area_cm2)));
      lattice::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 2.0 : 20.0;
      grow("area", "sheet", surface, {}, o);
    }
  }

  [[nodiscard]] static fs::path net_of(const fs::path& data, const std::string& part) {
    return data / "blender" / (part + ".json");
  }

  // Returns how many modules the certified placement finds on another program's net; all islands together get the time
  // that the growth has.
  [[nodiscard]] int modules_on(const fs::path& net, double limit_s) const {
    std::ifstream file(net);
    std::vector<design::Polygon> islands;
    double area = 0.0;
    const nlohmann::json read = nlohmann::json::parse(file);
    for (const auto& island : read.at("islands")) {
      try {
        islands.push_back(placement::normalize_polygon(polygon_of(island), net.stem().string()));
        area += placement::polygon_area(islands.back());
      } catch (const InputError&) {
        continue;  // An island whose outline touches itself could not be built.
      }
    }
    if (islands.empty()) throw InputError(net.string() + ": no island has an outline that does not cross itself");
    int modules = 0;
    for (const auto& island : islands) {
      const double share = placement::polygon_area(island) / area;
      if (share * area < design::kModuleArea_mm2) continue;
      placement::PlacementOptions o;
      o.time_limit_s = std::max(0.2, limit_s * share);
      o.largest_clearance = false;
      modules += placement::place(island, o).modules;
    }
    return modules;
  }

  [[nodiscard]] static design::Polygon polygon_of(const nlohmann::json& island) {
    design::Polygon p;
    for (const auto& ring : island.at("rings")) {
      std::vector<design::Vec2> points;
      for (const auto& q : ring) points.emplace_back(q.at(0).get<double>(), q.at(1).get<double>());
      (p.outer.empty() ? p.outer : p.holes.emplace_back()) = std::move(points);
    }
    return p;
  }

  bool quick_;
  std::string data_;
  ProgressSink sink_;
  nlohmann::json rows_ = nlohmann::json::array();
};

nlohmann::json unfolding_rows(const BenchOptions& options, Output& output) {
  return UnfoldingRows(options, output).run();
}

nlohmann::json net_rows(const BenchOptions& options, Output& output) {
  return UnfoldingRows(options, output).run_nets();
}

const BenchSubject kUnfolding("unfolding", "unfolding: time and pieces against edge error", unfolding_rows);
const BenchSubject kNets("nets", "modules on our nets and on those of the paper model", net_rows);

}  // namespace
}  // namespace triskin::cli
