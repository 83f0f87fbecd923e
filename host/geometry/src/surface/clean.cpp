// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <unordered_set>

namespace triskin::geometry {
namespace {

struct HashOfThree {
  template <class T>
  std::size_t operator()(const std::array<T, 3>& key) const {
    std::size_t hash = 0;
    for (const T& k : key) hash = (hash ^ static_cast<std::size_t>(k)) * 0x9e3779b97f4a7c15U;
    return hash ^ (hash >> 32U);
  }
};

// Makes coincident corners one vertex. Files store single precision, so equality is taken on a grid of 1e-7 of the
// size.
void weld(Mesh& mesh, MeshReadReport& report) {
  const double cell = std::max(1e-7 * diagonal_of(mesh), std::numeric_limits<double>::min());
  std::unordered_map<std::array<std::int64_t, 3>, int, HashOfThree> first;
  first.reserve(mesh.vertices.size());
  std::vector<int> target(mesh.vertices.size());
  std::vector<Vec3> kept;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 q = mesh.vertices[v] / cell;
    const std::array<std::int64_t, 3> key{std::llround(q.x()), std::llround(q.y()), std::llround(q.z())};
    const auto [entry, is_new] = first.try_emplace(key, static_cast<int>(kept.size()));
    if (is_new) kept.push_back(mesh.vertices[v]);
    target[v] = entry->second;
  }
  report.welded_vertices = static_cast<int>(mesh.vertices.size() - kept.size());
  mesh.vertices = std::move(kept);
  for (auto& face : mesh.faces) {
    for (int& v : face) v = target[static_cast<std::size_t>(v)];
  }
}

void drop_bad_faces(Mesh& mesh, MeshReadReport& report) {
  std::unordered_set<std::array<int, 3>, HashOfThree> seen;
  seen.reserve(mesh.faces.size());
  std::vector<std::array<int, 3>> kept;
  for (const auto& f : mesh.faces) {
    const auto at = [&](int k) -> const Vec3& {
      return mesh.vertices[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])];
    };
    const double longest = std::max({(at(1) - at(0)).norm(), (at(2) - at(1)).norm(), (at(0) - at(2)).norm()});
    const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    if (!(area > 1e-9 * longest * longest)) {
      ++report.degenerate_faces;
      continue;
    }
    std::array<int, 3> key = f;
    std::ranges::sort(key);
    if (!seen.insert(key).second) {
      ++report.duplicate_faces;
      continue;
    }
    kept.push_back(f);
  }
  mesh.faces = std::move(kept);
}

void drop_unused_vertices(Mesh& mesh) {
  std::vector<int> target(mesh.vertices.size(), -1);
  std::vector<Vec3> kept;
  for (auto& face : mesh.faces) {
    for (int& v : face) {
      int& t = target[static_cast<std::size_t>(v)];
      if (t < 0) {
        t = static_cast<int>(kept.size());
        kept.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
      }
      v = t;
    }
  }
  mesh.vertices = std::move(kept);
}

}  // namespace

double diagonal_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  return mesh.vertices.empty() ? 0.0 : box.diagonal().norm();
}

// A vertex without a face may lie anywhere and must not tell the size by which the others are welded.
void clean(Mesh& mesh, MeshReadReport& report) {
  drop_unused_vertices(mesh);
  weld(mesh, report);
  drop_bad_faces(mesh, report);
  drop_unused_vertices(mesh);
}

std::string bytes_of(const Mesh& mesh) {
  const std::array<std::size_t, 2> counts{mesh.vertices.size(), mesh.faces.size()};
  std::string out(reinterpret_cast<const char*>(counts.data()), sizeof(counts));
  for (const Vec3& v : mesh.vertices) out.append(reinterpret_cast<const char*>(v.data()), 3 * sizeof(double));
  for (const auto& f : mesh.faces) out.append(reinterpret_cast<const char*>(f.data()), sizeof(f));
  return out;
}

Mesh mesh_of(const std::string& bytes) {
  std::array<std::size_t, 2> counts{};
  const char* from = bytes.data();
  const auto take = [&](void* to, std::size_t n) {
    std::memcpy(to, from, n);
    from += n;
  };
  take(counts.data(), sizeof(counts));
  Mesh mesh;
  mesh.vertices.resize(counts[0]);
  mesh.faces.resize(counts[1]);
  for (Vec3& v : mesh.vertices) take(v.data(), 3 * sizeof(double));
  for (auto& f : mesh.faces) take(f.data(), sizeof(f));
  return mesh;
}

}  // namespace triskin::geometry
