// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "triskin/check/design_rules.hpp"

namespace triskin::check {

using P2 = Eigen::Vector2d;
using P3 = Eigen::Vector3d;
using Triangle3 = std::array<P3, 3>;

/// The checker reads the design with its own code, so it shares no type with the solvers.
struct CheckedDesign {
  struct Module {
    int number;  ///< The file names modules by numbers; everything else here has indices.
    int island, i, j;
    bool up;
    Triangle3 corner;
    std::array<int, 3> neighbour;
    std::array<int, 3> beside;  ///< A side lists its neighbour, or the module to which a jumper leads.
    double edge_error, center_gap, edge_lift, edge_depth, penetration, overrun, keep_out, bend_radius;
    std::array<double, 3> hinge_gap, fold;
    int patch, line, address, rotation, parent, depth;
    std::array<P3, 12> taxel, taxel_normal;
    std::string kind;  ///< A file without kinds leaves this empty.
  };
  struct Piece {
    std::vector<P2> outline;
    std::vector<std::vector<P2>> holes;
    std::vector<int> faces;
    std::vector<std::array<P2, 3>> flat;
    double max_edge_error;
    double x, y, theta;
    int modules, upper_bound;
    bool proved;
  };
  struct Patch {
    int node_address, entry, second_entry, second_entry_side, line_hops, max_depth;
    std::vector<int> modules;
    std::vector<std::array<int, 2>> cut_joints;
  };
  struct Jumper {
    std::string kind;
    std::array<int, 2> module, side;
    double length, fold;
  };
  struct Region {
    enum class Kind { kSphere, kBox, kFaces, kObstacle, kBorder };
    std::string name;
    Kind kind;
    P3 a, b;  ///< A sphere has its centre in `a`; a box has its low and high corner.
    double radius;
    std::vector<int> faces;
    std::vector<P3> body_vertices;
    std::vector<std::array<int, 3>> body_faces;  ///< Only an obstacle has vertices and faces of its own.
    double margin, above, below, min_width, max_width;
    bool cover, free, entry;
    double within;
  };
  struct Kind {
    std::string name, dielectric;
    int taxels;
    double sensitivity;
  };
  struct Limits {
    double edge_error, hinge_gap, center_gap, fold, penetration, overrun;
    double lift, depth;              ///< Files that do not limit the sides have infinite values.
    double jumper;                   ///< A file without jumpers has 0.
    double fold_away, fold_towards;  ///< Files that do not tell the directions apart have infinite values.
  };
  std::vector<P3> vertices;
  std::vector<std::array<int, 3>> faces;
  std::string side;  ///< This side was taken of a part with a wall; empty if the file does not say.
  bool is_side_certain = true;
  std::vector<P3> part_vertices;
  /// The whole part has these faces; if there are none, the part has only the surface.
  std::vector<std::array<int, 3>> part_faces;
  Limits limits;
  int islands;
  double corner_cut;  ///< The length is in mm; 0 if the file has none.
  std::vector<Module> modules;
  std::vector<Kind> kinds;  ///< The standard kind is not listed here.
  std::vector<Jumper> jumpers;
  std::vector<Piece> pieces;
  std::vector<Region> regions;
  std::vector<Patch> patches;  ///< by number; one without modules stands for a number that no controller has
  double area_cm2, coverage, coverage_cut, max_edge_error, max_hinge_gap, max_center_gap, max_edge_lift, max_edge_depth;
  int upper_bound, patches_lower_bound, jumpers_lower_bound;
  std::vector<int> entries_elsewhere;  ///< The file lists these patches if entries are limited.
  std::string method;
  std::uint64_t design_id;
  int next_module;  ///< −1: the file does not say
  /// Returns the number of module `k` for messages; −1 gives −1.
  [[nodiscard]] int number(int k) const { return k < 0 ? k : modules[static_cast<std::size_t>(k)].number; }
  [[nodiscard]] std::string name(std::size_t k) const { return "module " + std::to_string(modules[k].number); }
};

/// Returns the number of a kind by its name: 0 the standard one, k + 1 kinds[k], −1 none.
[[nodiscard]] int kind_number(const CheckedDesign& design, const std::string& name);

/// Reads the text of a design file; errors name it `name`.
[[nodiscard]] CheckedDesign read_checked_design(const std::string& text, const std::string& name);

/// Collects violations; each rule names itself once.
class Findings {
 public:
  explicit Findings(DesignReport& report) : report_(report) {}
  void rule(const char* name) { report_.rules.emplace_back(name); }
  void broken(const char* name, std::string where, std::string text) {
    report_.violations.push_back({name, std::move(where), std::move(text)});
  }

 private:
  DesignReport& report_;
};

void check_modules(const CheckedDesign& design, Findings& findings);  ///< Covers lattice, rigidity and joints.
/// Covers gaps, border, overlap and orientation.
void check_surface(const CheckedDesign& design, Findings& findings);
/// Finds modules on the inner side of a wall, or back to back with another.
void check_side(const CheckedDesign& design, Findings& findings);
/// Finds the joints that are too sharp for the board of a module.
[[nodiscard]] std::vector<SharpJoint> sharp_joints_of(const CheckedDesign& design);
void check_pieces(const CheckedDesign& design, Findings& findings);   ///< Covers nets and placements on the plane.
void check_jumpers(const CheckedDesign& design, Findings& findings);  ///< Covers joints between islands.
/// Covers members, trees and addresses of all patches, and the stated bound of their number.
void check_patches(const CheckedDesign& design, Findings& findings);
/// Covers regions that must stay free or must be covered.
void check_regions(const CheckedDesign& design, Findings& findings);
/// Compares the numbers and the id that the file states.
void check_report(const CheckedDesign& design, Findings& findings);

inline constexpr double kSide = 30.0, kRoot3 = std::numbers::sqrt3;
inline constexpr double kModule_mm2 = kSide * kSide * kRoot3 / 4.0;
[[nodiscard]] inline P3 centroid(const Triangle3& t) {
  return (t[0] + t[1] + t[2]) / 3.0;
}
[[nodiscard]] inline P3 unit_normal(const Triangle3& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]).normalized();
}

/// Returns the grid vertex of a corner, written down from docs/design_file.md.
[[nodiscard]] std::array<int, 2> corner_vertex(const CheckedDesign::Module& m, int corner);
/// Returns the side of the neighbour's tile that joins side s, −1 when the tiles do not share that side.
[[nodiscard]] int matching_side(const CheckedDesign::Module& m, int side, const CheckedDesign::Module& other);

}  // namespace triskin::check
