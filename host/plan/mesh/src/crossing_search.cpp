// SPDX-License-Identifier: GPL-3.0-or-later
#include "crossing_search.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>
#include <span>

#include "triangle_tree.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"

namespace triskin::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangle = std::array<Vec3, 3>;

// This bounds the relative rounding of a sum of three products of rounded differences.
constexpr double kRounding = 4e-15;
constexpr double kMinExactProduct = 1e-280;  // Smaller products of doubles lose digits.
constexpr double kSurelyWide = 1e-12;        // A cross product or cosine above this is far above its rounding.
constexpr std::size_t kChunk = 256;          // A thread takes this many leaves at once.
constexpr std::size_t kBatch = 128;          // The clock is read once after so many chunks.

Kernel::Point_3 point(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

// Lists the corners that two faces have in common, by their places in both.
struct Shared {
  std::size_t count = 0;
  std::array<std::size_t, 3> in_one{}, in_other{};
};

Shared shared_of(const std::array<int, 3>& one, const std::array<int, 3>& other) {
  Shared shared;
  std::array<bool, 3> is_taken{};  // A face without area may have a corner twice, so corners are marked when used.
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (one[i] != other[k] || is_taken[k]) continue;
      is_taken[k] = true;
      shared.in_one[shared.count] = i;
      shared.in_other[shared.count++] = k;
      break;
    }
  }
  return shared;
}

// If both ends agree in sign, the height over a plane through `from` has that sign, whatever the rounding.
struct Height {
  double low, high;
};
Height height_of(const Vec3& axis, const Vec3& p, const Vec3& from) {
  const Eigen::Array3d parts = axis.array() * (p - from).array();
  const double height = parts.sum(), error = kRounding * parts.abs().sum() + kMinExactProduct;
  return {height - error, height + error};
}

// Returns true if all points of one are above all points of the other along the axis.
bool is_above(const Vec3& axis, std::span<const Vec3> one, std::span<const Vec3> other, const Vec3& from) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Vec3& p : one) least = std::min(least, height_of(axis, p, from).low);
  for (const Vec3& p : other) most = std::max(most, height_of(axis, p, from).high);
  return least > most;
}
bool is_parted_by(const Vec3& axis, const Triangle& one, const Triangle& other) {
  return is_above(axis, one, other, one[0]) || is_above(axis, other, one, one[0]);
}

Vec3 cross_of(const Triangle& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]);
}

// Returns true if some plane separates them. Not every possible plane is tried.
bool are_apart(const Triangle& one, const Triangle& other) {
  const Vec3 between = (one[0] + one[1] + one[2]) - (other[0] + other[1] + other[2]);
  if (is_above(between, one, other, one[0])) return true;
  for (const auto& [a, b] : {std::pair(&one, &other), std::pair(&other, &one)}) {
    const Vec3 normal = cross_of(*a);
    if (is_parted_by(normal, *a, *b)) return true;
    for (std::size_t k = 0; k < 3; ++k) {  // The other side must lie below each side, seen inwards.
      if (is_above(normal.cross((*a)[(k + 1) % 3] - (*a)[k]), *a, *b, (*a)[0])) return true;
    }
  }
  return false;
}

// Returns true if a plane through the common corner has the other corners of one above it and those of the other below.
bool are_apart_at_corner(const Vec3& corner, const std::array<Vec3, 2>& one, const std::array<Vec3, 2>& other) {
  const auto towards = [&](const std::array<Vec3, 2>& t) {
    return Vec3(((t[0] - corner).normalized() + (t[1] - corner).normalized()).normalized());
  };
  const Vec3 axis = towards(one) - towards(other);
  return std::ranges::all_of(one, [&](const Vec3& p) { return height_of(axis, p, corner).low > 0.0; }) &&
         std::ranges::all_of(other, [&](const Vec3& p) { return height_of(axis, p, corner).high < 0.0; });
}

// Returns true if the angle at the common edge is surely not 0, so that one face is not folded back onto the other.
bool is_open_at_edge(const Triangle& one, const Triangle& other) {
  const Vec3 n = cross_of(one), m = cross_of(other);
  const double size =
      (one[1] - one[0]).norm() * (one[2] - one[0]).norm() * (other[1] - other[0]).norm() * (other[2] - other[0]).norm();
  return n.dot(m) > kSurelyWide * size;
}

// Returns a stride that visits all of n places and spreads any first part over all of them: a search that ends early
// has sampled everything, and the first crossing is found soon if there are many.
std::size_t spread_over(std::size_t n) {
  auto stride = static_cast<std::size_t>(0.381966 * static_cast<double>(n)) + 1;
  while (std::gcd(stride, n) > 1) ++stride;
  return stride;
}

class Searcher {
 public:
  Searcher(const Mesh& mesh, const CrossingSearch& search)
      : mesh_(mesh), search_(search), extents_(extents_of_faces(mesh)), tree_(extents_, search.threads) {}

  Crossings run() {
    const std::size_t n_chunks = (tree_.n_leaves() + kChunk - 1) / kChunk, stride = spread_over(n_chunks);
    for (std::size_t from = 0; from < n_chunks && !is_over(); from += kBatch) {
      in_parallel(search_.threads, std::min(kBatch, n_chunks - from), [&](std::size_t k) {
        const std::size_t chunk = (from + k) * stride % n_chunks;
        test(chunk * kChunk, std::min(tree_.n_leaves(), (chunk + 1) * kChunk));
      });
    }
    std::ranges::sort(found_.pairs);
    return std::move(found_);
  }

 private:
  [[nodiscard]] bool is_over() const {
    return (search_.any_one && !found_.pairs.empty()) || (search_.is_late && search_.is_late());
  }

  void test(std::size_t first_leaf, std::size_t end_leaf) {
    std::vector<FacePair> pairs;
    std::size_t tested = 0;
    for (std::size_t leaf = first_leaf; leaf < end_leaf; ++leaf) {
      bool is_own = true;
      tree_.touching(leaf, [&](std::span<const int> items, std::span<const int> others) {
        for (std::size_t i = 0; i < items.size(); ++i) {
          for (std::size_t k = is_own ? i : 0; k < others.size(); ++k) {
            const FaceIndex one(items[i]), other(others[k]);
            if (cross(one, other)) pairs.push_back(std::minmax({one, other}));
          }
        }
        tested += is_own ? items.size() : 0;
        is_own = false;
      });
    }
    const std::scoped_lock lock(mutex_);
    found_.tested += tested;
    found_.pairs.insert(found_.pairs.end(), pairs.begin(), pairs.end());
  }

  [[nodiscard]] Triangle corners_of(FaceIndex face) const {
    const auto& f = mesh_.faces[at(face)];
    return {mesh_.vertices[at(f[0])], mesh_.vertices[at(f[1])], mesh_.vertices[at(f[2])]};
  }

  [[nodiscard]] bool cross(FaceIndex one, FaceIndex other) const {
    const Triangle a = corners_of(one);
    if (one == other) return has_no_area(a);
    const auto &e = extents_[at(one)], &d = extents_[at(other)];
    if ((e[0] > d[1]).any() || (e[1] < d[0]).any()) return false;
    const Triangle b = corners_of(other);
    const Shared shared = shared_of(mesh_.faces[at(one)], mesh_.faces[at(other)]);
    if (shared.count == 0)
      return !are_apart(a, b) && !has_no_area(a) && !has_no_area(b) && CGAL::do_intersect(exact(a), exact(b));
    if (shared.count == 1) return cross_at_corner(a, shared.in_one[0], b, shared.in_other[0]);
    return !is_open_at_edge(a, b) && fold_at_edge(a, shared, b);
  }

  static bool has_no_area(const Triangle& t) {
    if (cross_of(t).norm() > kSurelyWide * (t[1] - t[0]).norm() * (t[2] - t[0]).norm()) return false;
    return CGAL::collinear(point(t[0]), point(t[1]), point(t[2]));
  }

  static Kernel::Triangle_3 exact(const Triangle& t) { return {point(t[0]), point(t[1]), point(t[2])}; }

  // Beyond the corner they meet only if the opposite side of one meets the other.
  static bool cross_at_corner(const Triangle& a, std::size_t i, const Triangle& b, std::size_t k) {
    const std::array<Vec3, 2> of_a{a[(i + 1) % 3], a[(i + 2) % 3]}, of_b{b[(k + 1) % 3], b[(k + 2) % 3]};
    if (are_apart_at_corner(a[i], of_a, of_b) || has_no_area(a) || has_no_area(b)) return false;
    const Kernel::Segment_3 side_a(point(of_a[0]), point(of_a[1])), side_b(point(of_b[0]), point(of_b[1]));
    return CGAL::do_intersect(exact(a), side_b) || CGAL::do_intersect(exact(b), side_a);
  }

  // Both lie in a plane, on the same side of their edge.
  static bool fold_at_edge(const Triangle& a, const Shared& shared, const Triangle& b) {
    const Vec3 &p = a[shared.in_one[0]], &q = a[shared.in_one[1]];
    const Vec3 &r = a[3 - shared.in_one[0] - shared.in_one[1]], &s = b[3 - shared.in_other[0] - shared.in_other[1]];
    if (has_no_area(a)) return false;
    return CGAL::coplanar(point(p), point(q), point(r), point(s)) &&
           CGAL::coplanar_orientation(point(p), point(q), point(r), point(s)) == CGAL::POSITIVE;
  }

  const Mesh& mesh_;
  const CrossingSearch& search_;
  std::vector<Bvh::Extent> extents_;
  Bvh tree_;
  std::mutex mutex_;
  Crossings found_;
};

}  // namespace

Crossings find_crossings(const Mesh& mesh, const CrossingSearch& search) {
  return Searcher(mesh, search).run();
}

}  // namespace triskin::mesh
