// SPDX-License-Identifier: GPL-3.0-or-later
#include "solids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::fabrication {

using design::Mesh;
using design::Vec3;

namespace {

constexpr std::array<std::array<std::uint8_t, 3>, 8> kPatchColours{{{31, 119, 180},
                                                                    {255, 127, 14},
                                                                    {44, 160, 44},
                                                                    {214, 39, 40},
                                                                    {148, 103, 189},
                                                                    {140, 86, 75},
                                                                    {227, 119, 194},
                                                                    {188, 189, 34}}};

Vec3 normal_of(const Mesh& mesh, const std::array<int, 3>& f) {
  const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])]; };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

// Makes a prism over a convex outline, from its plane to `height` above it.
Mesh prism(std::span<const Vec3> outline, const Vec3& height) {
  Mesh mesh;
  const int n = static_cast<int>(outline.size());
  for (const Vec3& p : outline) mesh.vertices.push_back(p);
  for (const Vec3& p : outline) mesh.vertices.push_back(p + height);
  for (int k = 1; k + 1 < n; ++k) {
    mesh.faces.push_back({0, k + 1, k});
    mesh.faces.push_back({n, n + k, n + k + 1});
  }
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    mesh.faces.push_back({k, next, n + next});
    mesh.faces.push_back({k, n + next, n + k});
  }
  return mesh;
}

// Returns how a vertex moves for an offset of 1 mm: along the mean of the normals of its faces, by the length that
// makes the largest and the smallest distance from their planes equally wrong.
std::vector<Vec3> offset_directions(const Mesh& mesh) {
  std::vector<Vec3> mean(mesh.vertices.size(), Vec3::Zero());
  std::vector<double> low(mesh.vertices.size(), 1.0), high(mesh.vertices.size(), -1.0);
  std::vector<Vec3> normals;
  for (const auto& f : mesh.faces) normals.push_back(normal_of(mesh, f).normalized());
  const auto each_corner = [&](auto&& visit) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = [&](std::size_t c) { return mesh.vertices[static_cast<std::size_t>(mesh.faces[f][c % 3])]; };
        const double angle_rad =
            std::acos(std::clamp((v(k + 1) - v(k)).normalized().dot((v(k + 2) - v(k)).normalized()), -1.0, 1.0));
        visit(static_cast<std::size_t>(mesh.faces[f][k]), normals[f], angle_rad);
      }
    }
  };
  each_corner([&](std::size_t v, const Vec3& normal, double angle_rad) { mean[v] += angle_rad * normal; });
  for (Vec3& direction : mean) direction.normalize();
  each_corner([&](std::size_t v, const Vec3& normal, double) {
    low[v] = std::min(low[v], mean[v].dot(normal));
    high[v] = std::max(high[v], mean[v].dot(normal));
  });
  constexpr double kMinShare = 0.5;  // Without a limit, the vertex at a needle's tip would move extremely far.
  for (std::size_t v = 0; v < mean.size(); ++v) mean[v] /= std::max(kMinShare, (low[v] + high[v]) / 2.0);
  return mean;
}

// Returns the edges that belong to one face, in the direction of that face.
std::vector<std::array<int, 2>> rim_of(const Mesh& mesh) {
  std::map<std::array<int, 2>, int> count;
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) ++count[{f[k], f[(k + 1) % 3]}];
  }
  std::vector<std::array<int, 2>> rim;
  for (const auto& [edge, times] : count) {
    if (!count.contains({edge[1], edge[0]})) rim.push_back(edge);
  }
  return rim;
}

void judge(const Mesh& surface, const std::vector<Vec3>& direction, double offset_mm, Layer& layer) {
  Mesh moved = surface;
  for (std::size_t v = 0; v < moved.vertices.size(); ++v) moved.vertices[v] += offset_mm * direction[v];
  for (const auto& f : surface.faces) {
    const Vec3 normal = normal_of(surface, f).normalized();
    layer.folded_faces += normal_of(moved, f).dot(normal) <= 0.0;
    for (const int v : f) {
      const double reached_mm = offset_mm * direction[static_cast<std::size_t>(v)].dot(normal);
      layer.error_mm = std::max(layer.error_mm, std::abs(reached_mm - offset_mm));
    }
  }
}

void append_float(std::string& bytes, double value) {
  const auto word = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((word >> shift) & 0xFFU);
}

void append_vector(std::string& bytes, const Vec3& v) {
  for (int axis = 0; axis < 3; ++axis) append_float(bytes, v[axis]);
}

}  // namespace

std::vector<Solid> module_solids(const design::Design& design, double corner_cut_mm) {
  const auto wiring = design::wiring_of(design);
  std::vector<Solid> solids;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const auto& corner = design.layout.modules[k].corner_mm;
    const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    const design::Outline outline = design::outline_of(corner, corner_cut_mm);
    const auto colour = static_cast<std::size_t>(std::max(0, wiring[k].patch.value())) % kPatchColours.size();
    solids.push_back({fmt::format("M{}", design::number_of(design, static_cast<int>(k))), kPatchColours[colour],
                      prism(outline.points(), kBoard_mm * normal)});
  }
  return solids;
}

Layer layer_of(const Mesh& surface, double from_mm, double to_mm) {
  if (surface.faces.empty()) throw InputError("the design has no surface, so no layer can lie on it");
  if (!(from_mm < to_mm)) throw InputError(fmt::format("a layer from {} to {} mm has no thickness", from_mm, to_mm));
  Layer layer;
  const std::vector<Vec3> direction = offset_directions(surface);
  const int n = static_cast<int>(surface.vertices.size());
  Mesh& mesh = layer.solid.mesh;
  for (const double offset_mm : {from_mm, to_mm}) {
    for (std::size_t v = 0; v < direction.size(); ++v)
      mesh.vertices.push_back(surface.vertices[v] + offset_mm * direction[v]);
    judge(surface, direction, offset_mm, layer);
  }
  for (const auto& [a, b, c] : surface.faces) {
    mesh.faces.push_back({a, c, b});
    mesh.faces.push_back({n + a, n + b, n + c});
  }
  for (const auto& [a, b] : rim_of(surface)) {
    mesh.faces.push_back({a, b, n + b});
    mesh.faces.push_back({a, n + b, n + a});
  }
  return layer;
}

std::string stl(const std::vector<Solid>& solids) {
  std::string bytes(80, ' ');
  std::uint32_t count = 0;
  for (const Solid& solid : solids) count += static_cast<std::uint32_t>(solid.mesh.faces.size());
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((count >> shift) & 0xFFU);
  for (const Solid& solid : solids) {
    for (const auto& f : solid.mesh.faces) {
      append_vector(bytes, normal_of(solid.mesh, f).normalized());
      for (const int v : f) append_vector(bytes, solid.mesh.vertices[static_cast<std::size_t>(v)]);
      bytes.append(2, '\0');
    }
  }
  return bytes;
}

double volume_mm3(const Mesh& mesh) {
  double six_times = 0.0;
  for (const auto& f : mesh.faces) {
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(f[k])]; };
    six_times += at(0).dot(at(1).cross(at(2)));
  }
  return six_times / 6.0;
}

}  // namespace triskin::fabrication
