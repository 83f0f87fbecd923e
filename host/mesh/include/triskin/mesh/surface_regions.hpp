// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"
#include "triskin/design/regions.hpp"
#include "triskin/mesh/body_distance.hpp"
#include "triskin/mesh/bvh.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::geometry {

/// The regions of a cover on its surface: worth of a place, what must stay free, what must be covered. Immutable; all
/// queries are const and thread-safe. Refers to the surface.
class SurfaceRegions {
 public:
  /// Errors: InputError naming the region for shapes without size, weights or distances out of range, faces that are
  /// not there, a region that is both `cover` and `free`, that says nothing, or that no part of the surface lies in.
  SurfaceRegions(const Surface& surface, design::Regions regions);

  [[nodiscard]] const design::Regions& regions() const { return regions_; }
  [[nodiscard]] bool has_weights() const { return has_weights_; }
  /// Worth of a module with this centre. Cost: one closest point.
  [[nodiscard]] double weight_at(const Vec3& center_mm) const;
  /// How far the module (corners in mm, less its corner cut) reaches into a region that must stay free: the largest
  /// distance from a foot of the module on the surface to the rim of the region, to 0.005 mm below, beyond 1 mm to 5 %.
  /// 0: it does not. Cost: nothing far from such regions, some hundred closest points near one.
  [[nodiscard]] double keep_out_mm(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm) const;

  /// Whether a cable may enter here: the point's foot lies in an entry region, or there is none. Cost: one closest
  /// point.
  [[nodiscard]] bool allows_entry(const Vec3& point_mm) const;

  /// Points of the regions that must stay free, 0.5 mm apart at their rims and 3 mm inside: a module that covers none
  /// of them reaches in by no more than about 0.4 mm.
  [[nodiscard]] const std::vector<Vec3>& free_points() const { return free_points_; }

  /// A place that must be covered.
  struct MustCover {
    Vec3 point_mm;
    int region;        ///< It is an index in regions().list.
    double within_mm;  ///< A module must be at least this near.
    double share;      ///< It is a share of the region's area.
  };
  /// Places of the must-cover regions, at most `step_mm` > 0 apart (a region smaller than that has one).
  [[nodiscard]] std::vector<MustCover> must_cover(double step_mm) const;
  /// The must-cover regions that the modules do not cover, each with its worst place; `why` is empty. Places are 1 mm
  /// apart.
  [[nodiscard]] std::vector<design::Uncovered> uncovered(const ModuleLayout& layout) const;
  /// Σ weight_at() of the modules.
  [[nodiscard]] double weight_of(const ModuleLayout& layout) const;
  /// weight_of(), less kUncoveredCost modules for each share of a must-cover region that is not
  /// covered, at places 3 mm apart.
  [[nodiscard]] double module_value(const ModuleLayout& layout) const;

 private:
  struct Group {  // A group is the faces of a set, with the edges that separate it from the others.
    std::vector<char> holds;
    std::vector<std::array<Vec3, 2>> rim;
  };
  [[nodiscard]] Group group_of(const design::FaceSet& set) const;
  void prepare(std::size_t region);
  void prepare_border(std::size_t region, const design::BorderStrip& strip);
  [[nodiscard]] double near_border_mm(std::size_t region, double margin_mm, const Vec3& point_mm) const;
  [[nodiscard]] double near_body_mm(const design::Obstacle& obstacle, const BodyDistance& body, const Vec3& on_surface,
                                    int face) const;
  [[nodiscard]] std::vector<design::Uncovered> uncovered(const ModuleLayout& layout, double step_mm) const;
  [[nodiscard]] double inside_mm(std::size_t region, const Vec3& on_surface, int face) const;
  void sample(std::size_t region, double rim_step_mm, double step_mm, double rim_mm,
              const std::function<void(const Vec3&, double area_mm2)>& visit) const;

  const Surface& surface_;
  design::Regions regions_;
  std::vector<Group> groups_;                                // Indexed by region; empty for other shapes.
  std::vector<std::unique_ptr<const BodyDistance>> bodies_;  // Indexed by region; null for other shapes.
  struct Border {
    std::vector<std::array<Vec3, 2>> edges;
    Bvh tree;
  };
  std::vector<Border> borders_;  // Indexed by region; empty for other shapes.
  std::vector<Vec3> free_points_;
  bool has_weights_ = false;
};

/// Modules that a must-cover region is worth which is not covered at all: more than any lattice round it could gain.
inline constexpr double kUncoveredCost = 20.0;

/// Distance of a place of the surface from a module, seen along the module's normal, mm; infinity for one that is not
/// near, or on another sheet. Constant cost.
[[nodiscard]] double distance_beside(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm, const Vec3& place_mm);

}  // namespace triskin::geometry
