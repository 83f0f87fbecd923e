// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// Selects faces of a part. Values in one list are alternatives; lists that are not empty must all be met.
struct FaceSelection {
  std::vector<int> indices{};        ///< They index Part::faces.
  std::vector<std::string> names{};  ///< They are whole names of faces.
  std::vector<std::string>
      colours{};  ///< They are "#rrggbb", or red, green, blue, yellow, cyan, magenta, black, white, grey, orange.
  std::vector<SurfaceKind> kinds{};
  std::vector<std::string> bodies{};  ///< Each is an index, a name or a path.
  std::optional<double> min_area_cm2{}, max_area_cm2{};
  std::optional<design::Vec3> from_point_mm{};  ///< The face nearest to it and what continues it smoothly are chosen.
  double smooth_deg = 20.0;                     ///< Edges that turn less are smooth, 0 … 180.
  bool only_outward = false;                    ///< It chooses FaceSide::kOutward alone.
  double without_holes_mm = 0.0;  ///< If positive, the walls of round holes up to this diameter are not chosen.
  std::vector<std::string> without_bodies{};  ///< Each is an index, a name or a path.

  /// Nothing is asked for: every face is meant.
  [[nodiscard]] bool is_empty() const;
};

/// Indices of the faces that are meant, ascending; all of them for an empty selection. Errors: InputError for an index,
/// a name, a colour or a body that the part has not (listing up to ten that it has), and when no face meets everything.
/// Cost: linear; with a point O(n log n).
[[nodiscard]] std::vector<int> select_faces(const Part& part, const FaceSelection& selection);

/// The selection as a JSON object of what is asked for, under the names of the members. Cost: linear.
[[nodiscard]] std::string selection_text(const FaceSelection& selection);
/// The selection of selection_text(). Errors: InputError for text that is none.
[[nodiscard]] FaceSelection parse_selection(const std::string& text);

/// Triangles of these faces alone, without vertices that none uses. Errors: std::out_of_range for an index that is not
/// there. Cost: linear.
[[nodiscard]] design::Mesh mesh_of_faces(const Part& part, const std::vector<int>& faces);

}  // namespace triskin::cad
