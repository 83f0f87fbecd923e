// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// Selects faces of a part. Values in one list are alternatives; lists that are not empty must all be met.
struct FaceSelection {
  std::vector<design::BrepFaceIndex> indices{};
  std::vector<std::string> names{};  ///< Only whole names match.
  std::vector<std::string>
      colours{};  ///< A colour is "#rrggbb", or red, green, blue, yellow, cyan, magenta, black, white, grey, orange.
  std::vector<SurfaceKind> kinds{};
  std::vector<std::string> bodies{};  ///< A body is named by its index, name or path.
  std::optional<double> min_area_cm2{}, max_area_cm2{};
  /// Selects the face nearest to this point and all faces that continue it smoothly.
  std::optional<design::Vec3> from_point_mm{};
  double smooth_deg = 20.0;       ///< An edge is smooth if it turns less than this, 0 … 180.
  bool only_outward = false;      ///< True selects FaceSide::kOutward only.
  double without_holes_mm = 0.0;  ///< A positive value leaves out the walls of round holes up to this diameter.
  std::vector<std::string> without_bodies{};  ///< A body is named by its index, name or path.

  /// Returns true if no condition is set, so that every face is selected.
  [[nodiscard]] bool is_empty() const;
};

/// Returns the indices of the selected faces, ascending; all of them for an empty selection, except those that their
/// author switched off, which only an index, a name or a body selects. Errors: InputError for an
/// index, a name, a colour or a body that the part lacks (listing up to ten that it has), and when no face meets all
/// conditions. Cost: linear; with a point O(n log n).
[[nodiscard]] std::vector<design::BrepFaceIndex> select_faces(const Part& part, const FaceSelection& selection);

/// Writes the conditions that are set as a JSON object, under the names of the members. Cost: linear.
[[nodiscard]] std::string selection_text(const FaceSelection& selection);
/// Reads the text of selection_text(). Errors: InputError for other text.
[[nodiscard]] FaceSelection parse_selection(const std::string& text);

/// Returns the triangles of these faces alone, without unused vertices. Errors: std::out_of_range for an index that
/// does not exist. Cost: linear.
[[nodiscard]] design::Mesh mesh_of_faces(const Part& part, const std::vector<design::BrepFaceIndex>& faces);

}  // namespace triskin::cad
