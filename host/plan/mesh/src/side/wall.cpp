// SPDX-License-Identifier: GPL-3.0-or-later
#include "wall.hpp"

#include <algorithm>
#include <cmath>

#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"

namespace triskin::mesh {
namespace {

constexpr double kSampledArea_mm2 = 16.0;  // The thickness of a wall changes over a few millimetres, at ribs and holes.
constexpr int kMaxSamplesPerFace = 64;
// At a rounded rim both sheets turn toward each other; within 37° of opposite they still are two sides of one wall.
constexpr double kMaxPartnerCosine = -0.8;
// Rays start inside the material, because a face that shares a corner is no partner.
constexpr double kStart_mm = 0.01;
constexpr std::size_t kChunk = 512;
constexpr std::size_t kFewFaces = 4'000;

// Spreads points evenly over the unit square (the R2 sequence of M. Roberts), folded into the triangle.
Vec3 point_of(const Mesh& mesh, FaceIndex face, int k, int samples) {
  const auto& f = mesh.faces[at(face)];
  const Vec3 &a = mesh.vertices[at(f[0])], &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
  if (samples == 1) return (a + b + c) / 3.0;
  double whole = 0.0;
  double u = std::modf(0.5 + 0.7548776662466927 * k, &whole), v = std::modf(0.5 + 0.5698402909980532 * k, &whole);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return a + u * (b - a) + v * (c - a);
}

int samples_of(double area_mm2) {
  return static_cast<int>(std::clamp(std::ceil(area_mm2 / kSampledArea_mm2), 1.0, double{kMaxSamplesPerFace}));
}

void find_partner(const RayCaster& part, const SideOptions& options, WallSample& s) {
  const Vec3& normal = part.normal(s.face);
  if (normal.isZero()) return;
  const RayHit hit = part.first_hit(s.point_mm, -normal, kStart_mm, options.max_wall_mm, s.face);
  if (hit.face < 0 || hit.distance_mm < options.min_wall_mm || part.normal(hit.face).dot(normal) > kMaxPartnerCosine)
    return;
  s.partner = hit.face;
  s.wall_mm = hit.distance_mm;
  s.partner_mm = s.point_mm - hit.distance_mm * normal;
}

}  // namespace

std::vector<WallSample> wall_samples(const RayCaster& part, const SideOptions& options) {
  std::vector<WallSample> samples;
  samples.reserve(part.mesh().faces.size());
  for (FaceIndex f{0}; f < static_cast<int>(part.mesh().faces.size()); ++f) {
    const int n = samples_of(part.area_mm2(f));
    for (int k = 0; k < n; ++k)
      samples.push_back({.face = f, .point_mm = point_of(part.mesh(), f, k, n), .area_mm2 = part.area_mm2(f) / n});
  }
  in_parallel(options.threads, (samples.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(samples.size(), (chunk + 1) * kChunk);
    for (std::size_t k = chunk * kChunk; k < end; ++k) find_partner(part, options, samples[k]);
  });
  return samples;
}

double walled_fraction_of_few(const RayCaster& part, const SideOptions& options) {
  const std::size_t faces = part.mesh().faces.size(), step = 1 + faces / kFewFaces;
  double walled = 0.0, all = 0.0;
  for (std::size_t f = 0; f < faces; f += step) {
    const FaceIndex face(f);
    WallSample s{.face = face, .point_mm = point_of(part.mesh(), face, 0, 1), .area_mm2 = part.area_mm2(face)};
    find_partner(part, options, s);
    all += s.area_mm2;
    if (s.partner >= 0) walled += s.area_mm2;
  }
  return all > 0.0 ? walled / all : 0.0;
}

std::vector<double> walled_fractions(const std::vector<WallSample>& samples, std::size_t faces) {
  std::vector<double> walled(faces, 0.0), all(faces, 0.0);
  for (const WallSample& s : samples) {
    all[at(s.face)] += 1.0;
    if (s.partner >= 0) walled[at(s.face)] += 1.0;
  }
  for (std::size_t f = 0; f < faces; ++f) walled[f] /= std::max(1.0, all[f]);
  return walled;
}

}  // namespace triskin::mesh
