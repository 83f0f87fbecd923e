// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a closed surface around any triangles by marching tetrahedra. Each tetrahedron contains its own triangles, so
// the result is a manifold that does not cross itself, whatever the input.
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "triangle_tree.hpp"
#include "triskin/base/index.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

constexpr int kMargin = 3;  // This many empty cells surround the mesh.
// In cells, this is over half a body diagonal, so that no sheet slips between two nodes.
constexpr double kLevel = 0.9;
constexpr double kFromNode = 0.05;  // A corner of the result keeps this share of the edge away from the nodes.
constexpr int kBlock = 4;

// These are Kuhn's six tetrahedra of a cube, as bits of x, y, z from its low corner.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra{
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

class GridWrap {
 public:
  GridWrap(const Mesh& mesh, double cell_mm) : surface_(mesh), cell_(cell_mm), level_(kLevel * cell_mm) {
    Eigen::AlignedBox3d box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    origin_ = box.min() - Vec3::Constant(kMargin * cell_);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      size_[k] = static_cast<std::int64_t>(std::ceil(box.sizes()[axis] / cell_)) + 2 * kMargin + 1;
    }
  }

  Mesh run() {
    measure();
    flood();
    for (std::int64_t z = 0; z + 1 < size_[2]; ++z) {
      for (std::int64_t y = 0; y + 1 < size_[1]; ++y) {
        for (std::int64_t x = 0; x + 1 < size_[0]; ++x) march(x, y, z);
      }
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::size_t node(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * size_[1] + y) * size_[0] + x);
  }
  [[nodiscard]] Vec3 place(std::size_t n) const {
    const auto i = static_cast<std::int64_t>(n);
    return origin_ + cell_ * Vec3(static_cast<double>(i % size_[0]), static_cast<double>(i / size_[0] % size_[1]),
                                  static_cast<double>(i / (size_[0] * size_[1])));
  }

  // Computes the distance above the level; blocks far from the mesh get the bound of their middle.
  void measure() {
    value_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), 0.0F);
    tbb::parallel_for(std::int64_t{0}, (size_[2] + kBlock - 1) / kBlock, [&](std::int64_t slab) {
      for (std::int64_t y = 0; y < size_[1]; y += kBlock) {
        for (std::int64_t x = 0; x < size_[0]; x += kBlock) measure_block(x, y, slab * kBlock);
      }
    });
  }
  void measure_block(std::int64_t x0, std::int64_t y0, std::int64_t z0) {
    const Vec3 middle = place(node(x0, y0, z0)) + Vec3::Constant(0.5 * (kBlock - 1) * cell_);
    const double radius = 0.5 * std::sqrt(3.0) * (kBlock - 1) * cell_;
    const double least = surface_.closest(middle).distance_mm - radius - level_;
    for (std::int64_t z = z0; z < std::min(z0 + kBlock, size_[2]); ++z) {
      for (std::int64_t y = y0; y < std::min(y0 + kBlock, size_[1]); ++y) {
        for (std::int64_t x = x0; x < std::min(x0 + kBlock, size_[0]); ++x) {
          const std::size_t n = node(x, y, z);
          // If the neighbours are as far, only the sign counts.
          value_[n] = static_cast<float>(least > 2.0 * cell_ ? least : surface_.closest(place(n)).distance_mm - level_);
        }
      }
    }
  }

  // Everything that can be reached from the corner of the grid along the edges of the tetrahedra is outside.
  void flood() {
    outside_.assign(value_.size(), 0);
    std::vector<std::size_t> open{0};
    outside_[0] = 1;
    while (!open.empty()) {
      const auto n = static_cast<std::int64_t>(open.back());
      open.pop_back();
      const std::array<std::int64_t, 3> p{n % size_[0], n / size_[0] % size_[1], n / (size_[0] * size_[1])};
      for (int bits = 1; bits < 8; ++bits) {
        for (const int sign : {-1, 1}) {
          std::array<std::int64_t, 3> q = p;
          for (std::size_t k = 0; k < 3; ++k) q[k] += (bits >> k & 1) != 0 ? sign : 0;
          if (std::ranges::any_of(std::array{0, 1, 2}, [&](int k) { return q[at(k)] < 0 || q[at(k)] >= size_[at(k)]; }))
            continue;
          const std::size_t next = node(q[0], q[1], q[2]);
          if (outside_[next] != 0 || value_[next] <= 0.0F) continue;
          outside_[next] = 1;
          open.push_back(next);
        }
      }
    }
  }

  void march(std::int64_t x, std::int64_t y, std::int64_t z) {
    std::array<std::size_t, 8> corner{};
    int count = 0;
    for (int k = 0; k < 8; ++k) {
      corner[at(k)] = node(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2 & 1));
      count += outside_[corner[at(k)]];
    }
    if (count == 0 || count == 8) return;
    for (const auto& t : kTetrahedra) {
      std::vector<std::size_t> in, out;
      for (const int k : t) (outside_[corner[at(k)]] != 0 ? out : in).push_back(corner[at(k)]);
      if (in.empty() || out.empty()) continue;
      if (in.size() == 2) {
        const int a = cut(in[0], out[0]), b = cut(in[0], out[1]), c = cut(in[1], out[1]), d = cut(in[1], out[0]);
        add(a, b, c, in, out);
        add(a, c, d, in, out);
      } else {
        std::array<int, 3> v{};
        for (std::size_t k = 0; k < 3; ++k) v[k] = in.size() == 1 ? cut(in[0], out[k]) : cut(in[k], out[0]);
        add(v[0], v[1], v[2], in, out);
      }
    }
  }

  int cut(std::size_t in, std::size_t out) {
    const auto [entry, is_new] =
        corner_of_.try_emplace(std::min(in, out) << 32U | std::max(in, out), static_cast<int>(result_.vertices.size()));
    if (is_new) {
      const double low = static_cast<double>(value_[in]), high = static_cast<double>(value_[out]);
      const double t = std::clamp(-low / std::max(high - low, 1e-12), kFromNode, 1.0 - kFromNode);
      result_.vertices.push_back((1.0 - t) * place(in) + t * place(out));
    }
    return entry->second;
  }

  void add(int a, int b, int c, const std::vector<std::size_t>& in, const std::vector<std::size_t>& out) {
    const auto& v = result_.vertices;
    const Vec3 normal = (v[at(b)] - v[at(a)]).cross(v[at(c)] - v[at(a)]);
    const bool outward = normal.dot(place(out[0]) - v[at(a)]) > normal.dot(place(in[0]) - v[at(a)]);
    if (outward)
      result_.faces.push_back({a, b, c});
    else
      result_.faces.push_back({a, c, b});
  }

  TriangleTree surface_;
  double cell_, level_;
  Vec3 origin_ = Vec3::Zero();
  std::array<std::int64_t, 3> size_{};
  std::vector<float> value_;
  std::vector<std::uint8_t> outside_;
  std::unordered_map<std::uint64_t, int> corner_of_;
  Mesh result_;
};

}  // namespace

Mesh grid_wrapped(const Mesh& mesh, double cell_mm) {
  return GridWrap(mesh, cell_mm).run();
}

}  // namespace triskin::mesh
