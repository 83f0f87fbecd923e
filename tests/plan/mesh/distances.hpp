// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "plan/mesh/broken_meshes.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::test {

/// Measures from a point to a triangle by its sides and its plane; shares nothing with the regions of the solver.
inline double distance_to(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto to_segment = [&](const Vec3& s, const Vec3& e) {
    const double length = (e - s).squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - s).dot(e - s) / length, 0.0, 1.0) : 0.0;
    return (s + t * (e - s) - p).norm();
  };
  double best = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  const Vec3 n = (b - a).cross(c - a);
  if (!(n.squaredNorm() > 0.0)) return best;
  const bool inside =
      (b - a).cross(p - a).dot(n) >= 0.0 && (c - b).cross(p - b).dot(n) >= 0.0 && (a - c).cross(p - c).dot(n) >= 0.0;
  return inside ? std::min(best, std::abs((p - a).dot(n)) / n.norm()) : best;
}

/// Measures the same to the nearest face.
inline double distance_to(const Vec3& p, const Mesh& mesh) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& f : mesh.faces) {
    const auto& v = mesh.vertices;
    best = std::min(best, distance_to(p, v[static_cast<std::size_t>(f[0])], v[static_cast<std::size_t>(f[1])],
                                      v[static_cast<std::size_t>(f[2])]));
  }
  return best;
}

/// Returns the largest distance of random points of a mesh to another.
inline double sampled_distance(const Mesh& from, const Mesh& to, Dice& random, int samples) {
  double most = 0.0;
  for (int k = 0; k < samples; ++k) {
    const auto& f = from.faces[pick(random, from.faces.size())];
    double s = dice(random, 0.0, 1.0), t = dice(random, 0.0, 1.0);
    if (s + t > 1.0) {
      s = 1.0 - s;
      t = 1.0 - t;
    }
    const auto& v = from.vertices;
    const Vec3 p = (1.0 - s - t) * v[static_cast<std::size_t>(f[0])] + s * v[static_cast<std::size_t>(f[1])] +
                   t * v[static_cast<std::size_t>(f[2])];
    most = std::max(most, distance_to(p, to));
  }
  return most;
}

/// Returns the mesh as reading a file gives it, with coincident vertices welded.
inline Mesh read_back(const Mesh& mesh) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("triskin_repair_{}.obj", ::getpid());
  mesh::write_obj(path, mesh);
  Mesh result = mesh::read_mesh(path).mesh;
  std::filesystem::remove(path);
  return result;
}

}  // namespace triskin::test
