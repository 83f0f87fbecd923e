// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "join_seams.hpp"

namespace triskin::mesh {
namespace {

// Twice the cell of welding, by which the two sides of a seam may have been moved apart, as a share of the size.
constexpr double kSeamReach = 2e-7;
constexpr int kSeamRounds = 3;

std::size_t hash_of(const auto& three) {
  std::size_t hash = 0;
  for (const auto k : three) hash = (hash ^ static_cast<std::size_t>(k)) * 0x9e3779b97f4a7c15U;
  return hash ^ (hash >> 32U);
}

// A hash table of numbers, compared by what they stand for. All slots are in one block of memory: a table with a node
// per entry took half of the time of reading a million faces.
class NumberTable {
 public:
  /// Reserves room for `most` numbers.
  explicit NumberTable(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), -1) {}

  /// Returns an equal number that is already present; otherwise stores and returns `number`.
  int find_or_put(std::size_t hash, int number, const auto& is_equal) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t k = hash & mask;; k = (k + 1) & mask) {
      if (slots_[k] < 0) slots_[k] = number;
      if (slots_[k] == number || is_equal(slots_[k])) return slots_[k];
    }
  }

 private:
  std::vector<int> slots_;  // A free slot holds −1.
};

// Makes coincident corners one vertex. Files store single precision, so equality is taken on a grid of 1e-7 of the
// size.
void weld(Mesh& mesh, MeshReadReport& report) {
  const double cell = std::max(1e-7 * diagonal_of(mesh), std::numeric_limits<double>::min());
  NumberTable first(mesh.vertices.size());
  std::vector<std::array<std::int64_t, 3>> keys;  // Each vertex that is kept has a key.
  keys.reserve(mesh.vertices.size());
  std::vector<int> target(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 q = mesh.vertices[v] / cell;
    const std::array<std::int64_t, 3> key{std::llround(q.x()), std::llround(q.y()), std::llround(q.z())};
    const auto next = static_cast<int>(keys.size());
    target[v] = first.find_or_put(hash_of(key), next, [&](int k) { return keys[static_cast<std::size_t>(k)] == key; });
    if (target[v] < next) continue;
    mesh.vertices[keys.size()] = mesh.vertices[v];
    keys.push_back(key);
  }
  report.welded_vertices = static_cast<int>(mesh.vertices.size() - keys.size());
  if (report.welded_vertices == 0) return;
  mesh.vertices.resize(keys.size());
  for (auto& face : mesh.faces) {
    for (int& v : face) v = target[static_cast<std::size_t>(v)];
  }
}

void drop_bad_faces(Mesh& mesh, MeshReadReport& report) {
  const auto corners_of = [](std::array<int, 3> face) {
    std::ranges::sort(face);
    return face;
  };
  NumberTable first(mesh.faces.size());
  std::size_t kept = 0;
  for (const auto f : mesh.faces) {
    const auto at = [&](int k) -> const Vec3& {
      return mesh.vertices[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])];
    };
    const double longest = std::max({(at(1) - at(0)).norm(), (at(2) - at(1)).norm(), (at(0) - at(2)).norm()});
    const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    if (!(area > 1e-9 * longest * longest)) {
      ++report.degenerate_faces;
      continue;
    }
    const std::array<int, 3> key = corners_of(f);
    const auto next = static_cast<int>(kept);
    const auto is_equal = [&](int k) { return corners_of(mesh.faces[static_cast<std::size_t>(k)]) == key; };
    if (first.find_or_put(hash_of(key), next, is_equal) < next) {
      ++report.duplicate_faces;
      continue;
    }
    mesh.faces[kept++] = f;
  }
  mesh.faces.resize(kept);
}

}  // namespace

void drop_unused_vertices(Mesh& mesh) {
  std::vector<int> target(mesh.vertices.size(), -1);
  std::vector<Vec3> kept;
  kept.reserve(mesh.vertices.size());
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

double diagonal_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  return mesh.vertices.empty() ? 0.0 : box.diagonal().norm();
}

// A vertex without a face may lie anywhere and must not affect the size that sets the welding distance.
void clean(Mesh& mesh, MeshReadReport& report, Corners corners) {
  drop_unused_vertices(mesh);
  if (corners == Corners::kWelded) weld(mesh, report);
  drop_bad_faces(mesh, report);
  // A face without area may have been all that joined its neighbours, so seams are joined after it is gone. Joining can
  // leave new ones.
  const double reach_mm = kSeamReach * diagonal_of(mesh);
  for (int round = 0; round < kSeamRounds && corners == Corners::kWelded; ++round) {
    const int before = report.joined_corners + report.welded_vertices;
    join_seams(mesh, reach_mm, report);
    if (report.joined_corners + report.welded_vertices == before) break;
    drop_bad_faces(mesh, report);
  }
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

}  // namespace triskin::mesh
