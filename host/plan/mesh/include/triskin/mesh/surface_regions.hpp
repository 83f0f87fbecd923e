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

namespace triskin::mesh {

/// Applies the regions of a cover to its surface: the weight of each place, and what must be covered or stay free.
/// Immutable; all queries are const and thread-safe. Refers to the surface.
class SurfaceRegions {
 public:
  /// Errors: InputError naming the region for shapes without size, weights or distances out of range, unknown faces, a
  /// region that is both `cover` and `free` or states neither a weight nor one of them, or that contains no part of the
  /// surface.
  SurfaceRegions(const Surface& surface, design::Regions regions);

  [[nodiscard]] const design::Regions& regions() const { return regions_; }
  [[nodiscard]] bool has_weights() const { return has_weights_; }
  /// Returns the weight of a module with this centre. Cost: one closest point.
  [[nodiscard]] double weight_at(const Vec3& center_mm) const;
  /// Returns how far the module (corners in mm, less its corner cut) reaches into a region that must stay free: the
  /// largest distance from a point of the module's projection on the surface to the rim of the region, exact to 0.005
  /// mm plus 5 % of what exceeds 1 mm. Zero means that the module keeps out. Cost: nothing far from such regions, some
  /// hundred closest points near one.
  [[nodiscard]] double keep_out_mm(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm) const;

  /// Returns true if a cable may enter here: the point's foot lies in an entry region, or no such region exists. Cost:
  /// one closest point.
  [[nodiscard]] bool allows_entry(const Vec3& point_mm) const;

  /// Points of the regions that must stay free, 0.5 mm apart at their rims and 3 mm inside: a module that covers none
  /// of them reaches in by no more than about 0.4 mm.
  [[nodiscard]] const std::vector<Vec3>& free_points() const { return free_points_; }

  /// A place that some module must cover.
  struct MustCover {
    Vec3 point_mm;
    int region;        ///< The index refers to regions().list.
    double within_mm;  ///< A module must be at least this near.
    double share;      ///< The place stands for this fraction of the region's area.
  };
  /// Returns places of the must-cover regions, at most `step_mm` > 0 apart; a region smaller than that has one.
  [[nodiscard]] std::vector<MustCover> must_cover(double step_mm) const;
  /// Returns the must-cover regions that the modules do not cover, each with its worst place; `why` is empty. Places
  /// are 1 mm apart.
  [[nodiscard]] std::vector<design::Uncovered> uncovered(const ModuleLayout& layout) const;
  /// Returns the sum of weight_at() over the modules.
  [[nodiscard]] double weight_of(const ModuleLayout& layout) const;
  /// Returns weight_of(), less kUncoveredCost for a must-cover region that is not covered at all, and proportionally
  /// less for a part of it; the places tested are 3 mm apart.
  [[nodiscard]] double module_value(const ModuleLayout& layout) const;

 private:
  struct Group {  // A group has the faces of a set and the edges that separate it from the others.
    std::vector<char> holds;
    std::vector<std::array<Vec3, 2>> rim;
  };
  [[nodiscard]] Group group_of(const design::FaceSet& set) const;
  void prepare(std::size_t region);
  void prepare_border(std::size_t region, const design::BorderStrip& strip);
  [[nodiscard]] double near_border_mm(std::size_t region, double margin_mm, const Vec3& point_mm) const;
  [[nodiscard]] double near_body_mm(const design::Obstacle& obstacle, const BodyDistance& body, const Vec3& on_surface,
                                    FaceIndex face) const;
  [[nodiscard]] std::vector<design::Uncovered> uncovered(const ModuleLayout& layout, double step_mm) const;
  [[nodiscard]] double inside_mm(std::size_t region, const Vec3& on_surface, FaceIndex face) const;
  void sample(std::size_t region, double rim_step_mm, double step_mm, double rim_mm,
              const std::function<void(const Vec3&, double area_mm2)>& visit) const;

  const Surface& surface_;
  design::Regions regions_;
  std::vector<Group> groups_;                                // Other shapes have an empty entry.
  std::vector<std::unique_ptr<const BodyDistance>> bodies_;  // Other shapes have a null pointer.
  struct Border {
    std::vector<std::array<Vec3, 2>> edges;
    Bvh tree;
  };
  std::vector<Border> borders_;  // Each region has an entry; it is empty for other shapes.
  std::vector<Vec3> free_points_;
  bool has_weights_ = false;
};

/// A must-cover region that is not covered at all costs this many modules, more than any lattice around it could gain.
inline constexpr double kUncoveredCost = 20.0;

/// Returns the distance in mm of a place of the surface from a module, seen along the module's normal; infinity for one
/// that is not near, or on another sheet. Constant cost.
[[nodiscard]] double distance_beside(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm, const Vec3& place_mm);

}  // namespace triskin::mesh
