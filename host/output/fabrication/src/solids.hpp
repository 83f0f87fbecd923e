// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::fabrication {

/// The flexible board of a module has this thickness.
inline constexpr double kBoard_mm = 0.3;

/// A closed solid with triangles counter-clockwise seen from outside, mesh frame, mm.
struct Solid {
  std::string name;
  std::array<std::uint8_t, 3> colour{};  ///< The components are red, green and blue.
  design::Mesh mesh;
};

/// Returns the modules of a design as prisms at their places: outline with its corner cut, kBoard_mm thick, away from
/// the body. They are named M<id> and coloured by patch. Cost: O(n).
[[nodiscard]] std::vector<Solid> module_solids(const design::Design& design, double corner_cut_mm);

/// A layer beside a surface, and how exactly it keeps its distance.
struct Layer {
  Solid solid;
  /// No face of the layer is farther from its wanted distance to the plane of its surface face than this. The offset
  /// follows the normals of vertices, so the error grows with the angle between faces.
  double error_mm = 0.0;
  /// The offset turned these faces over, because the surface is bent more tightly there than the offset.
  int folded_faces = 0;
};

/// Makes the layer of a surface between the offsets `from_mm` < `to_mm` along its outward normal, closed along its rim.
/// Errors: InputError for a surface without faces and for from_mm ≥ to_mm. Cost: O(faces log faces).
[[nodiscard]] Layer layer_of(const design::Mesh& surface, double from_mm, double to_mm);

/// Returns the binary STL of all solids. Cost: linear.
[[nodiscard]] std::string stl(const std::vector<Solid>& solids);
/// Writes 3MF: an object for each solid with its name and colour, unit mm. Errors: InputError naming the file when it
/// cannot be written. Cost: linear.
void write_3mf(const std::filesystem::path& path, const std::vector<Solid>& solids);

/// Returns the volume of a closed mesh, mm³. Cost: linear.
[[nodiscard]] double volume_mm3(const design::Mesh& mesh);

}  // namespace triskin::fabrication
