// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "triskin/cli/command.hpp"
#include "triskin/geometry/mesh_io.hpp"

namespace triskin::cli {
namespace {

// Half shell around a bent, tapering axis: like the outer cover of a forearm. 300 mm long, radius 62 → 42 mm.
geometry::Mesh forearm() {
  constexpr int kAlong = 60, kAround = 32;
  constexpr double kLength_mm = 300.0, kBend_rad = 0.35, kHalfTurn_rad = 1.75;
  geometry::Mesh mesh;
  for (int a = 0; a <= kAlong; ++a) {
    const double t = static_cast<double>(a) / kAlong;
    const double bend = kBend_rad * t, radius = 62.0 - 20.0 * t, arc = kLength_mm / kBend_rad;
    const geometry::Vec3 axis(0.0, arc * (1.0 - std::cos(bend)), arc * std::sin(bend));
    const geometry::Vec3 side(1, 0, 0), up(0, std::cos(bend), -std::sin(bend));
    for (int r = 0; r <= kAround; ++r) {
      const double angle = kHalfTurn_rad * (2.0 * r / kAround - 1.0);
      mesh.vertices.push_back(axis + radius * (std::sin(angle) * side + std::cos(angle) * up));
    }
  }
  for (int a = 0; a < kAlong; ++a) {
    for (int r = 0; r < kAround; ++r) {
      const int v = a * (kAround + 1) + r;
      mesh.faces.push_back({v, v + kAround + 1, v + 1});
      mesh.faces.push_back({v + 1, v + kAround + 1, v + kAround + 2});
    }
  }
  for (auto& f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

const Registration kGenerate{{
    "generate",
    "write a surface of our own to try the program on",
    "triskin generate forearm -o forearm.obj",
    [](CLI::App& app) -> Run {
      auto kind = std::make_shared<std::string>();
      auto path = std::make_shared<std::string>();
      app.add_option("KIND", *kind, "forearm: tapered and bent")->required()->check(CLI::IsMember({"forearm"}));
      app.add_option("-o,--output", *path, "mesh (OBJ, mm)")->required();
      return [kind, path](Output& output) {
        const geometry::Mesh mesh = forearm();
        geometry::write_obj(*path, mesh);
        output.result = {{"faces", mesh.faces.size()}};
        output.say(fmt::format("{}: {} faces", *path, mesh.faces.size()));
        return 0;
      };
    },
}};

}  // namespace
}  // namespace triskin::cli
