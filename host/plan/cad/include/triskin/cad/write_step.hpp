// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::cad {

/// A body of an assembly, bounded by plane faces.
struct StepBody {
  std::string name;
  std::array<std::uint8_t, 3> colour{};  ///< The components are red, green and blue.
  std::vector<design::Vec3> vertices;    ///< Positions are in mm.
  /// Each face lists its corners counter-clockwise seen from outside, in a plane. Closed bodies become solids, others
  /// shells.
  std::vector<std::vector<int>> faces;
};

/// Converts bodies to bytes for the program triskin-cad, and back. Errors of bodies_of(): std::runtime_error for other
/// bytes and for a corner that is out of range.
[[nodiscard]] std::string encode_bodies(const std::string& assembly, const std::vector<StepBody>& bodies);
struct StepAssembly {
  std::string name;
  std::vector<StepBody> bodies;
};
[[nodiscard]] StepAssembly bodies_of(std::string_view bytes);

/// Returns a STEP file (AP214, mm) of an assembly with a component for each body, its name and colour. The geometry
/// kernel runs in its own process, as for read_part(). Equal bodies give equal bytes. Errors: InputError when the
/// program is not installed, for no body, and when the kernel refuses a body, with the reason. Cost: about 1 ms per
/// face.
[[nodiscard]] std::string write_step(const std::string& assembly, const std::vector<StepBody>& bodies);

}  // namespace triskin::cad
