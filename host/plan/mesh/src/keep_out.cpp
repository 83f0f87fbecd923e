// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "triskin/base/index.hpp"
#include "triskin/mesh/extract_steps.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

constexpr double kFinest_mm = 1.5;

// The signed distance to the union of the keep-outs is negative inside and nowhere steeper than 1.
class KeepOuts {
 public:
  explicit KeepOuts(const ExtractOptions& options) : options_(options) {
    if (options.keep_out) inside_.emplace(extract(*options.keep_out).surface);
  }

  [[nodiscard]] double distance(const Vec3& p) const {
    double least = 1e300;
    for (const KeepOutSphere& s : options_.spheres) least = std::min(least, (p - s.center_mm).norm() - s.radius_mm);
    for (const KeepOutBox& b : options_.boxes) {
      const Vec3 out = (b.low_mm - p).cwiseMax(p - b.high_mm);
      least = std::min(least, out.cwiseMax(0.0).norm() + std::min(out.maxCoeff(), 0.0));
    }
    if (inside_) {
      const SurfacePoint c = inside_->closest(p);
      const bool within = (p - c.position_mm).dot(inside_->normal_at(c)) < 0.0;
      least = std::min(least, (within ? -c.distance_mm : c.distance_mm) - options_.keep_out_margin_mm);
    }
    return least;
  }

 private:
  const ExtractOptions& options_;
  std::optional<Surface> inside_;
};

struct Reach {
  // The distance belongs to the centroid, and the radius reaches from there to the farthest corner.
  double distance, radius;
};

Reach reach_of(const KeepOuts& outs, const Mesh& mesh, const std::array<int, 3>& f) {
  const Vec3 &a = mesh.vertices[at(f[0])], &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
  const Vec3 middle = (a + b + c) / 3.0;
  return {outs.distance(middle), std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()})};
}

// In one pass every marked edge gets a vertex in its middle, in all faces that have it, so that the mesh stays
// conforming.
class Divider {
 public:
  explicit Divider(Mesh& mesh) : mesh_(mesh) {}

  [[nodiscard]] bool pass(const KeepOuts& outs) {
    middle_.clear();
    for (const auto& f : mesh_.faces) {
      const Reach r = reach_of(outs, mesh_, f);
      if (std::abs(r.distance) >= r.radius || r.radius <= kFinest_mm) continue;
      mark_longest(f);
    }
    if (middle_.empty()) return false;
    std::vector<std::array<int, 3>> faces;
    for (const auto& f : mesh_.faces) divide(f, faces);
    mesh_.faces = std::move(faces);
    return true;
  }

 private:
  void mark_longest(const std::array<int, 3>& f) {
    std::size_t longest = 0;
    const auto length = [&](std::size_t s) {
      return (mesh_.vertices[at(f[s])] - mesh_.vertices[at(f[(s + 1) % 3])]).norm();
    };
    for (std::size_t s = 1; s < 3; ++s) {
      if (length(s) > length(longest)) longest = s;
    }
    const auto [it, is_new] =
        middle_.try_emplace(std::minmax(f[longest], f[(longest + 1) % 3]), static_cast<int>(mesh_.vertices.size()));
    if (is_new)
      mesh_.vertices.push_back(0.5 * (mesh_.vertices[at(f[longest])] + mesh_.vertices[at(f[(longest + 1) % 3])]));
  }

  void divide(const std::array<int, 3>& f, std::vector<std::array<int, 3>>& faces) const {
    for (std::size_t s = 0; s < 3; ++s) {
      const auto found = middle_.find(std::minmax(f[s], f[(s + 1) % 3]));
      if (found == middle_.end()) continue;
      divide({f[s], found->second, f[(s + 2) % 3]}, faces);
      divide({found->second, f[(s + 1) % 3], f[(s + 2) % 3]}, faces);
      return;
    }
    faces.push_back(f);
  }

  Mesh& mesh_;
  std::map<std::pair<int, int>, int> middle_;
};

}  // namespace

Mesh without_keep_outs(const Mesh& mesh, const ExtractOptions& options) {
  const KeepOuts outs(options);
  Mesh result = mesh;
  Divider divider(result);
  while (divider.pass(outs)) {
  }
  std::erase_if(result.faces, [&](const auto& f) {
    const Reach r = reach_of(outs, result, f);
    return r.distance < r.radius;
  });
  return result;
}

}  // namespace triskin::mesh
