// SPDX-License-Identifier: GPL-3.0-or-later
// Lists kinds of damage of a design file, and the rules one of which must name each. Damaged modules stay whole (taxels
// move with their corners, and the id of the design is not counted), so that the checker must find the geometry.
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "triskin/design/mesh.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::check::damage {

using design::Vec3;
using nlohmann::json;
using Names = std::set<std::string>;

inline Vec3 vec(const json& j) {
  return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()};
}
inline json list(const Vec3& v) {
  return json::array({v.x(), v.y(), v.z()});
}

/// Gives corners, centre and normal of a module of a design file.
struct Frame {
  Vec3 center, normal;
  std::array<Vec3, 3> corner;
  explicit Frame(const json& m) : corner{vec(m["corners"][0]), vec(m["corners"][1]), vec(m["corners"][2])} {
    center = (corner[0] + corner[1] + corner[2]) / 3.0;
    normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  }
};

inline void transform(json& m, const std::function<Vec3(const Vec3&)>& place,
                      const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  for (json& c : m["corners"]) c = list(place(vec(c)));
  for (json& t : m["taxels"]) {
    t["position"] = list(place(vec(t["position"])));
    t["normal"] = list(turn * vec(t["normal"]));
  }
}
inline void move(json& m, const Vec3& by) {
  transform(m, [&](const Vec3& p) { return Vec3(p + by); });
}
inline void turn(json& m, const Vec3& axis, double degrees) {
  const Eigen::Matrix3d r = Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()).toRotationMatrix();
  const Vec3 c = Frame(m).center;
  transform(m, [&](const Vec3& p) { return Vec3(c + r * (p - c)); }, r);
}

inline bool joined(const json& m) {
  return std::ranges::any_of(m["neighbours"], [](const json& n) { return n.get<int>() >= 0; });
}

/// Adds a copy of a module with its own id.
inline json& append_copy(json& d, std::size_t module) {
  json copy = d["modules"][module];
  copy["id"] = d["modules"].size();
  d["modules"].push_back(std::move(copy));
  return d["modules"].back();
}
/// States 0 for a number; returns false if it is already nearly 0.
inline bool flattered(json& number) {
  const bool lie = number.get<double>() > 0.2;
  number = 0.0;
  return lie;
}

struct DamageKind {
  const char* name;
  Names rules;  // The checker must report at least one of these rules.
  // The function returns false if it cannot do this kind of damage to this module.
  std::function<bool(json& design, std::size_t module)> apply;
};

inline json& module_of(json& design, std::size_t k) {
  return design["modules"][k];
}
/// Returns the id of the first neighbour of a module, or 0.
inline std::size_t neighbour_of(const json& m) {
  for (const json& n : m["neighbours"]) {
    if (n.get<int>() >= 0) return n.get<std::size_t>();
  }
  return 0;
}
/// Returns the way from the centre of a module to the nearest vertex of the border.
inline Vec3 way_to_border(const mesh::Surface& surface, const json& m) {
  const Frame f(m);
  Vec3 best = Vec3::Zero();
  double least = 1e300;
  for (const auto& loop : surface.border_loops()) {
    for (const design::VertexIndex v : loop) {
      const Vec3 d = surface.mesh().vertices[static_cast<std::size_t>(v)] - f.center;
      if (d.norm() >= least) continue;
      least = d.norm();
      best = d;
    }
  }
  return best;
}

/// Returns the kinds that put a module at a wrong place.
inline std::vector<DamageKind> misplacements(const mesh::Surface& surface) {
  return {
      {"moved 2 mm in its plane",
       {"hinge-gap", "edge-error"},
       [](json& d, std::size_t k) {
         const Frame f(module_of(d, k));
         move(module_of(d, k), 2.0 * (f.corner[1] - f.corner[0]).normalized());
         return joined(module_of(d, k));
       }},
      {"rotated 3° in its plane",
       {"hinge-gap", "edge-error"},
       [](json& d, std::size_t k) {
         turn(module_of(d, k), Frame(module_of(d, k)).normal, 3.0);
         return joined(module_of(d, k));
       }},
      {"over the border",
       {"overrun"},
       [&surface](json& d, std::size_t k) {
         const Vec3 way = way_to_border(surface, module_of(d, k));
         const Frame f(module_of(d, k));
         const Vec3 flat = way - way.dot(f.normal) * f.normal;
         if (way.norm() > 25.0) return false;
         move(module_of(d, k), std::max(4.0, flat.norm() - 5.0) * flat.normalized());
         return true;
       }},
      {"through a neighbour",
       {"penetration", "pierced"},
       [](json& d, std::size_t k) {
         if (!joined(module_of(d, k))) return false;
         const Frame f(module_of(d, k)), other(module_of(d, neighbour_of(module_of(d, k))));
         const Vec3 across = (other.center - f.center).normalized();
         move(module_of(d, k), 8.0 * across + 3.0 * f.normal);
         turn(module_of(d, k), f.normal.cross(across), 35.0);
         return true;
       }},
      {"4 mm above its place",
       // The gap has no sign: the centre of a free module may end as far above the surface as it was below it.
       {"center-gap", "hinge-gap", "edge-lift"},
       [](json& d, std::size_t k) {
         move(module_of(d, k), 4.0 * Frame(module_of(d, k)).normal);
         return true;
         // A module that bridges an edge may turn onto the face behind it, and is then below it.
       }},
      {"tilted by 30°, a corner 9 mm off",
       {"edge-lift", "edge-depth"},
       [](json& d, std::size_t k) {
         const Frame f(module_of(d, k));
         turn(module_of(d, k), f.corner[1] - f.corner[0], 30.0);
         return true;
       }},
      {"upside down",
       {"outward", "hinge-gap", "fold"},
       [](json& d, std::size_t k) {
         const Frame f(module_of(d, k));
         turn(module_of(d, k), f.corner[1] - f.corner[0], 180.0);
         return true;
       }},
  };
}

/// Returns the kinds that leave a module where it is and state something wrong about it.
inline std::vector<DamageKind> false_statements() {
  return {
      {"doubled",
       {"tile-unique", "penetration"},
       [](json& d, std::size_t k) {
         append_copy(d, k);
         return true;
       }},
      {"doubled on a tile of its own",
       {"penetration", "every-module-wired"},
       [](json& d, std::size_t k) {
         json& copy = append_copy(d, k);
         copy["i"] = 1000;
         copy["neighbours"] = {-1, -1, -1};
         return true;
       }},
      {"off the lattice",
       {"joint-lattice", "tile-unique"},
       [](json& d, std::size_t k) {
         module_of(d, k)["i"] = module_of(d, k)["i"].get<int>() + 1;
         return joined(module_of(d, k));
       }},
      {"a flattering lift",
       {"edge-lift"},
       [](json& d, std::size_t k) { return flattered(module_of(d, k)["edge_lift_mm"]); }},
      {"1 % too large",
       {"rigid"},
       [](json& d, std::size_t k) {
         const Vec3 c = Frame(module_of(d, k)).center;
         transform(module_of(d, k), [&](const Vec3& p) { return Vec3(c + 1.01 * (p - c)); });
         return true;
       }},
      {"joined to a module elsewhere",
       {"joint-lattice", "joint-symmetric"},
       [](json& d, std::size_t k) {
         const std::size_t n = d["modules"].size();
         for (json& side : module_of(d, k)["neighbours"]) {
           if (side.get<int>() < 0) continue;
           side = (side.get<std::size_t>() + n / 2) % n;
           return true;
         }
         return false;
       }},
      {"in another island",
       {"joint-island", "island-connected"},
       [](json& d, std::size_t k) {
         module_of(d, k)["island"] = module_of(d, k)["island"].get<int>() + 1;
         return joined(module_of(d, k));
       }},
      {"a taxel 1 mm off",
       {"taxel-pose"},
       [](json& d, std::size_t k) {
         json& p = module_of(d, k)["taxels"][7]["position"];
         p = list(vec(p) + Vec3(0, 1, 0));
         return true;
       }},
      {"a flattering centre gap",
       {"center-gap"},
       [](json& d, std::size_t k) { return flattered(module_of(d, k)["center_gap_mm"]); }},
  };
}

/// Returns the kinds of damage of a design on `surface`, which must outlive them.
inline std::vector<DamageKind> damage_kinds(const mesh::Surface& surface) {
  std::vector<DamageKind> kinds = misplacements(surface);
  std::ranges::move(false_statements(), std::back_inserter(kinds));
  return kinds;
}

}  // namespace triskin::check::damage
