// SPDX-License-Identifier: GPL-3.0-or-later
// Speed against error of covering a surface: time, limits, faces and area against modules; and the nets of another unfolder.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench.hpp"
#include "triskin/geometry/mesh_io.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/geometry/surface_lattice.hpp"
#include "triskin/geometry/unfolding.hpp"
#include "triskin/host/error.hpp"

namespace triskin::cli {
namespace {

using Clock = std::chrono::steady_clock;
using geometry::Mesh;
using geometry::Surface;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// z = 25 mm · sin(x / 45 mm) · sin(y / 45 mm): domes and saddles, principal radii of 81 mm and more, as large as wanted.
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

nlohmann::json row_of(const char* series, const std::string& shape, const Surface& surface, const geometry::ModuleLayout& layout) {
  const auto modules = static_cast<double>(layout.modules.size());
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& [limit, count] : layout.refused) refused[limit] = count;
  return {{"series", series}, {"shape", shape}, {"area_cm2", surface.area_mm2() / 100.0}, {"faces", surface.mesh().faces.size()},
          {"modules", layout.modules.size()}, {"islands", layout.islands}, {"refused", refused},
          {"uncovered", 1.0 - modules * geometry::kModuleArea_mm2 / surface.area_mm2()}};
}

class Rows {
 public:
  Rows(const BenchOptions& options, Output& output) : quick_(options.quick), sink_(output.progress()) {}

  nlohmann::json run() {
    const Surface sheet(wavy_sheet(700.0, 800));
    over_time("sheet", sheet);
    over_limits(sheet);
    over_island_cost(sheet);
    over_faces();
    over_area();
    against_nets();
    return std::move(rows_);
  }

 private:
  nlohmann::json& grow(const char* series, const std::string& shape, const Surface& surface, const geometry::LayoutLimits& limits,
                       const geometry::SurfaceLatticeOptions& options) {
    report(sink_, "bench unfolding", -1.0, series);
    const auto start = Clock::now();
    const geometry::ModuleLayout layout = geometry::grow_lattice(surface, limits, options);
    const double seconds = since(start);
    rows_.push_back(row_of(series, shape, surface, layout));
    rows_.back()["seconds"] = seconds;
    return rows_.back();
  }

  void over_time(const std::string& shape, const Surface& surface) {
    for (const double limit_s : {0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0}) {
      if (quick_ && limit_s > 5.0) break;
      geometry::SurfaceLatticeOptions o;
      o.time_limit_s = limit_s;
      grow("time", shape, surface, {}, o)["limit_s"] = limit_s;
    }
  }

  void over_limits(const Surface& surface) {
    for (const double scale : {0.25, 0.5, 1.0, 2.0, 4.0}) {
      geometry::LayoutLimits l;
      l.edge_error_mm *= scale;
      geometry::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 1.0 : 10.0;
      grow("edge error", "sheet", surface, l, o)["edge_error_mm"] = l.edge_error_mm;
      l = {};
      l.center_gap_mm *= scale;
      grow("centre gap", "sheet", surface, l, o)["center_gap_mm"] = l.center_gap_mm;
      const auto start = Clock::now();
      const geometry::Net net = geometry::unfold(surface, {.edge_error_mm = scale});
      rows_.push_back({{"series", "pieces"}, {"shape", "sheet"}, {"edge_error_mm", scale}, {"pieces", net.pieces.size()}, {"seconds", since(start)}});
    }
  }

  void over_island_cost(const Surface& surface) {
    for (const double cost : {0.0, 0.02, 0.1, 0.3, 1.0}) {
      geometry::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 1.0 : 10.0;
      o.island_cost = cost;
      grow("island cost", "sheet", surface, {}, o)["island_cost"] = cost;
    }
  }

  // The same shape and the same number of steps: only the mesh is finer.
  void over_faces() {
    for (const int faces : {200, 2000, 20000, 200000}) {
      if (quick_ && faces > 20000) break;
      const Surface surface(wavy_sheet(700.0, faces));
      geometry::SurfaceLatticeOptions o;
      o.iterations = quick_ ? 20 : 200;
      o.time_limit_s = quick_ ? 8.0 : 100.0;
      grow("faces", "sheet", surface, {}, o)["iterations"] = o.iterations;
    }
  }

  void over_area() {
    for (const double area_cm2 : {100.0, 300.0, 1000.0, 3000.0, 10000.0}) {
      if (quick_ && area_cm2 > 1000.0) break;
      const Surface surface(wavy_sheet(area_cm2, static_cast<int>(2.0 * area_cm2)));
      geometry::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 2.0 : 20.0;
      grow("area", "sheet", surface, {}, o);
    }
  }

  // The real covers, where TRISKIN_DATA names their folder: what the certified placement finds on another program's net.
  void against_nets() {
    const char* data = std::getenv("TRISKIN_DATA");
    if (data == nullptr) return;
    for (const char* part : {"HIP_v1", "UT_torso_v1", "LT_root_v2", "LH_hipwing_v1", "LUA_upperarm_half_v1", "RUF_forearm_v2"}) {
      const std::filesystem::path mesh = std::filesystem::path(data) / "parts" / (std::string(part) + ".obj");
      const std::filesystem::path net = std::filesystem::path(data) / "blender" / (std::string(part) + ".json");
      if (!std::filesystem::exists(mesh) || !std::filesystem::exists(net)) continue;
      const Surface surface(geometry::read_mesh(mesh).mesh);
      geometry::SurfaceLatticeOptions o;
      o.time_limit_s = quick_ ? 1.0 : 20.0;
      auto& row = grow("nets", part, surface, {}, o);
      row["modules_on_net"] = modules_on(net);
      if (quick_) break;
      over_time(part, surface);
    }
  }

  [[nodiscard]] int modules_on(const std::filesystem::path& net) const {
    std::ifstream file(net);
    const nlohmann::json json = nlohmann::json::parse(file);
    int modules = 0;
    for (const auto& island : json.at("islands")) {
      geometry::Polygon p;
      for (const auto& ring : island.at("rings")) {
        std::vector<geometry::Vec2> points;
        for (const auto& q : ring) points.emplace_back(q.at(0).get<double>(), q.at(1).get<double>());
        (p.outer.empty() ? p.outer : p.holes.emplace_back()) = std::move(points);
      }
      try {
        geometry::PlacementOptions o;
        o.time_limit_s = quick_ ? 1.0 : 20.0;
        o.largest_clearance = false;
        modules += geometry::place(geometry::normalize_polygon(std::move(p), part_name(net)), o).modules;
      } catch (const InputError&) {
        continue;  // an island whose outline touches itself holds nothing that could be built
      }
    }
    return modules;
  }

  [[nodiscard]] static std::string part_name(const std::filesystem::path& net) { return net.stem().string(); }

  bool quick_;
  ProgressSink sink_;
  nlohmann::json rows_ = nlohmann::json::array();
};

nlohmann::json unfolding_rows(const BenchOptions& options, Output& output) { return Rows(options, output).run(); }

const BenchSubject kUnfolding("unfolding", unfolding_rows);

}  // namespace
}  // namespace triskin::cli
