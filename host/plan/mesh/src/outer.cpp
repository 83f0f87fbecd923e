// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "edge_sides.hpp"
#include "triskin/base/index.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Tree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>>;

constexpr double kStart_mm = 0.05;  // Rays start this far above the face.
constexpr int kEvenPasses = 4;
constexpr double kRaysPer_s = 8e5;        // The rate was measured on scans of 50,000 … 120,000 faces.
constexpr double kMinVisibility_s = 0.2;  // This much processor time is enough to sample each of up to 1,250 faces.
constexpr double kSameDirection = 0.8;    // Faces share an answer if the cosine between their normals is at least this.

Kernel::Point_3 point(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

// Malley's method over a Fibonacci spiral: even points of the disc, raised to the half sphere, are cosine-weighted.
std::vector<Vec3> directions(int rays) {
  std::vector<Vec3> result;
  constexpr double kGoldenAngle = 2.399963229728653;
  for (int k = 0; k < rays; ++k) {
    const double squared = (k + 0.5) / rays, angle = kGoldenAngle * k;
    result.emplace_back(std::sqrt(squared) * std::cos(angle), std::sqrt(squared) * std::sin(angle),
                        std::sqrt(1.0 - squared));
  }
  return result;
}

std::array<Vec3, 3> corners_of(const Mesh& mesh, std::size_t face) {
  const auto& f = mesh.faces[face];
  return {mesh.vertices[at(f[0])], mesh.vertices[at(f[1])], mesh.vertices[at(f[2])]};
}

Vec3 cross_of(const Mesh& mesh, std::size_t face) {
  const auto c = corners_of(mesh, face);
  return (c[1] - c[0]).cross(c[2] - c[0]);
}

double share_free(const Tree& tree, const std::vector<Vec3>& directions, const Vec3& from, const Vec3& up) {
  const Vec3 x = up.unitOrthogonal(), y = up.cross(x), start = from + kStart_mm * up;
  int free = 0;
  for (const Vec3& d : directions) {
    const Vec3 ray = d.x() * x + d.y() * y + d.z() * up;
    free += tree.do_intersect(Kernel::Ray_3(point(start), Kernel::Vector_3(ray.x(), ray.y(), ray.z()))) ? 0 : 1;
  }
  return static_cast<double>(free) / static_cast<double>(directions.size());
}

// Pairs sides that run opposite ways; if several run the same way, each is paired with the last opposite one before it.
std::vector<std::array<FaceIndex, 3>> pairs_across(const Mesh& mesh) {
  constexpr FaceIndex kNone = FaceIndex::none();
  std::vector<std::array<FaceIndex, 3>> neighbour(mesh.faces.size(), {kNone, kNone, kNone});
  const EdgeSides sides(mesh);
  sides.each_edge([&](std::span<const EdgeSide> edge) {
    std::array<const EdgeSide*, 2> last{};  // The first starts at the low vertex, the second at the high one.
    for (const EdgeSide& s : edge) {
      const std::size_t way = mesh.faces[at(s.face)][at(s.side)] == s.low ? 0 : 1;
      last[way] = &s;
      const EdgeSide* const twin = last[1 - way];
      if (twin == nullptr) continue;
      neighbour[at(s.face)][at(s.side)] = twin->face;
      neighbour[at(twin->face)][at(twin->side)] = s.face;
    }
  });
  return neighbour;
}

// Groups connected faces, at most `most` together, that face about the same way as the first and largest of them.
std::vector<std::vector<FaceIndex>> groups_of(const Mesh& mesh, std::size_t most) {
  const auto neighbour = pairs_across(mesh);
  std::vector<Vec3> cross(mesh.faces.size());
  for (std::size_t f = 0; f < cross.size(); ++f) cross[f] = cross_of(mesh, f);
  std::vector<FaceIndex> large_first(mesh.faces.size());
  std::iota(large_first.begin(), large_first.end(), FaceIndex{0});
  std::ranges::stable_sort(large_first, std::greater{}, [&](FaceIndex f) { return cross[at(f)].squaredNorm(); });
  std::vector<bool> seen(mesh.faces.size(), false);
  std::vector<std::vector<FaceIndex>> groups;
  for (const FaceIndex first : large_first) {
    if (seen[at(first)]) continue;
    const Vec3 up = cross[at(first)].normalized();
    std::vector<FaceIndex> group{first};
    seen[at(first)] = true;
    for (std::size_t q = 0; q < group.size(); ++q) {
      for (const FaceIndex n : neighbour[at(group[q])]) {
        if (group.size() == most || n < 0 || seen[at(n)] || cross[at(n)].normalized().dot(up) < kSameDirection)
          continue;
        seen[at(n)] = true;
        group.push_back(n);
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

// Whole parts may be stored inside out: a part that sees more with its back is turned.
void turn_parts(Mesh& mesh, std::vector<Visibility>& visibility,
                const std::vector<std::array<FaceIndex, 3>>& neighbour) {
  std::vector<bool> seen(mesh.faces.size(), false);
  for (std::size_t first = 0; first < mesh.faces.size(); ++first) {
    if (seen[first]) continue;
    std::vector<FaceIndex> part{FaceIndex(first)};
    seen[first] = true;
    double front = 0.0, back = 0.0;
    for (std::size_t q = 0; q < part.size(); ++q) {
      const double area = cross_of(mesh, at(part[q])).norm();
      front += area * visibility[at(part[q])].front;
      back += area * visibility[at(part[q])].back;
      for (const FaceIndex n : neighbour[at(part[q])]) {
        if (n < 0 || seen[at(n)]) continue;
        seen[at(n)] = true;
        part.push_back(n);
      }
    }
    if (back <= front) continue;
    for (const FaceIndex f : part) {
      std::swap(mesh.faces[at(f)][1], mesh.faces[at(f)][2]);
      std::swap(visibility[at(f)].front, visibility[at(f)].back);
    }
  }
}

}  // namespace

double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) area += 0.5 * cross_of(mesh, f).norm();
  return area;
}

std::vector<Visibility> visibility_of(const Mesh& mesh, const std::vector<FaceIndex>& faces, int rays) {
  Triangles triangles;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto c = corners_of(mesh, f);
    triangles.emplace_back(point(c[0]), point(c[1]), point(c[2]));
  }
  Tree tree(triangles.cbegin(), triangles.cend());
  tree.build();
  const std::vector<Vec3> up = directions(rays);
  std::vector<Visibility> visibility(faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t k) {
    const std::size_t f = at(faces[k]);
    const auto c = corners_of(mesh, f);
    const Vec3 normal = cross_of(mesh, f).normalized(), middle = (c[0] + c[1] + c[2]) / 3.0;
    if (!(normal.squaredNorm() > 0.5)) return;
    visibility[k] = {share_free(tree, up, middle, normal), share_free(tree, up, middle, -normal)};
  });
  return visibility;
}

std::size_t faces_asked_in(double cpu_s) {
  return static_cast<std::size_t>(kRaysPer_s * std::max(cpu_s, kMinVisibility_s) / (2.0 * kVisibilityRays));
}

int rays_for(std::size_t faces, double cpu_s) {
  const std::size_t fitting = kVisibilityRays * faces_asked_in(cpu_s) / std::max<std::size_t>(1, faces);
  return static_cast<int>(std::clamp<std::size_t>(fitting, kMinVisibilityRays, kVisibilityRays));
}

std::vector<Visibility> visibility_of_all(const Mesh& mesh, double cpu_s) {
  const std::size_t asked_of = faces_asked_in(cpu_s);
  const auto groups = groups_of(mesh, std::max<std::size_t>(1, (mesh.faces.size() + asked_of - 1) / asked_of));
  std::vector<FaceIndex> asked;
  for (const auto& group : groups) asked.push_back(group.front());
  const std::vector<Visibility> answers = visibility_of(mesh, asked, rays_for(asked.size(), cpu_s));
  std::vector<Visibility> visibility(mesh.faces.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const FaceIndex f : groups[g]) visibility[at(f)] = answers[g];
  }
  return visibility;
}

Mesh outer_faces(const Mesh& mesh, double visibility_fraction, double cpu_s) {
  Mesh result = mesh;
  std::vector<Visibility> visibility = visibility_of_all(mesh, cpu_s);
  const auto neighbour = pairs_across(mesh);
  turn_parts(result, visibility, neighbour);
  std::vector<bool> kept(mesh.faces.size());
  for (std::size_t f = 0; f < kept.size(); ++f) kept[f] = visibility[f].front >= visibility_fraction;
  for (int pass = 0; pass < kEvenPasses; ++pass) {
    const std::vector<bool> before = kept;
    for (std::size_t f = 0; f < kept.size(); ++f) {
      const auto same =
          std::ranges::count_if(neighbour[f], [&](FaceIndex n) { return n >= 0 && before[at(n)] == before[f]; });
      const auto other =
          std::ranges::count_if(neighbour[f], [&](FaceIndex n) { return n >= 0 && before[at(n)] != before[f]; });
      if (other > same && other >= 2) kept[f] = !before[f];
    }
  }
  std::vector<std::array<int, 3>> faces;
  for (std::size_t f = 0; f < kept.size(); ++f) {
    if (kept[f]) faces.push_back(result.faces[f]);
  }
  result.faces = std::move(faces);
  return result;
}

}  // namespace triskin::mesh
