// SPDX-License-Identifier: GPL-3.0-or-later
#include "refine.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <unordered_map>

namespace triskin::cad_reader {
namespace {

constexpr int kMaxRounds = 14;
constexpr std::size_t kMaxTriangles = 4'000'000;
constexpr int kMaxProjectionSteps = 6;
// A side this short cannot be farther than half of it from a surface through its ends that does not fold.
constexpr double kMinSideInDeviations = 2.0;
constexpr double kGapFactor = 1.2;
constexpr double kOnSide = 1e-9;

Vec3 point_of(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}
Vec3 vector_of(const gp_Vec& v) {
  return {v.X(), v.Y(), v.Z()};
}

Vec3 value(const ExactFace& face, const Vec2& uv) {
  return point_of(face.surface.Value(uv.x(), uv.y()));
}

// Returns the distance of a point of a triangle from the surface, by Gauss-Newton steps from `uv`; it is never less
// than the true one.
double distance_to_surface(const ExactFace& face, const Vec3& place, Vec2 uv) {
  double best = 1e300;
  for (int step = 0; step < kMaxProjectionSteps; ++step) {
    gp_Pnt p;
    gp_Vec du, dv;
    face.surface.D1(uv.x(), uv.y(), p, du, dv);
    const Vec3 error = place - point_of(p);
    const double distance = error.norm();
    if (!(distance < best * (1.0 - 1e-3))) break;
    best = distance;
    Eigen::Matrix<double, 3, 2> jacobian;
    jacobian << vector_of(du), vector_of(dv);
    const Eigen::Matrix2d normal = jacobian.transpose() * jacobian;
    if (!(std::abs(normal.determinant()) > 1e-18 * normal.squaredNorm())) break;
    uv += normal.inverse() * (jacobian.transpose() * error);
  }
  return best;
}

// Returns the distance of a point of the surface from the plane of its triangle. An offset within the plane does not
// count, because parameters of an edge may be off along the surface.
double distance_to_plane(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  return length > 0.0 ? std::abs((p - a).dot(normal)) / length : 0.0;
}

bool is_on(const std::vector<double>& sides, double parameter) {
  return std::ranges::any_of(
      sides, [&](double side) { return std::abs(side - parameter) < kOnSide * (1.0 + std::abs(side)); });
}

// Returns the mean of parameters; a corner in a pole has no u of its own.
Vec2 mean_uv(const ExactFace& face, std::initializer_list<Vec2> corners) {
  Vec2 sum = Vec2::Zero(), count = Vec2::Zero(), all = Vec2::Zero();
  for (const Vec2& uv : corners) {
    const Vec2 weight(is_on(face.singular_v, uv.y()) ? 0.0 : 1.0, is_on(face.singular_u, uv.x()) ? 0.0 : 1.0);
    sum += weight.cwiseProduct(uv);
    count += weight;
    all += uv / static_cast<double>(corners.size());
  }
  return {count.x() > 0.0 ? sum.x() / count.x() : all.x(), count.y() > 0.0 ? sum.y() / count.y() : all.y()};
}

std::uint64_t key_of(int a, int b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
  return low << 32U | high;
}

class Refiner {
 public:
  Refiner(BodyMesh& mesh, double limit_mm) : mesh_(mesh), limit_mm_(limit_mm) {}

  void run() {
    for (ExactFace& face : mesh_.faces) face.deviation_mm = 0.0;
    std::vector<std::size_t> open(mesh_.triangles.size());
    for (std::size_t t = 0; t < open.size(); ++t) open[t] = t;
    for (int round = 0; !open.empty(); ++round) {
      const bool is_last = round == kMaxRounds || mesh_.triangles.size() > kMaxTriangles;
      marked_.clear();
      for (const std::size_t t : open) inspect(mesh_.triangles[t], is_last);
      if (marked_.empty()) return;
      open = divide();
    }
  }

 private:
  [[nodiscard]] const Vec3& at(const Triangle& t, std::size_t k) const {
    return mesh_.points[static_cast<std::size_t>(t.corners[k])];
  }
  [[nodiscard]] double deviation(const Triangle& t, const ExactFace& face, const Vec3& place, const Vec2& uv) const {
    const double from_surface = distance_to_plane(value(face, uv), at(t, 0), at(t, 1), at(t, 2));
    return std::max(from_surface, distance_to_surface(face, place, uv));
  }

  struct Distances {
    std::array<double, 3> sides{};
    double centre = 0.0, worst = 0.0;
    Vec3 worst_place = Vec3::Zero();
  };
  [[nodiscard]] Distances distances(const Triangle& t, const ExactFace& face) const {
    Distances d;
    const auto note = [&](double found, const Vec3& place) {
      if (found >= d.worst) d.worst = found, d.worst_place = place;
      return found;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const Vec3 middle = 0.5 * (at(t, k) + at(t, next));
      d.sides[k] = note(deviation(t, face, middle, mean_uv(face, {t.uv[k], t.uv[next]})), middle);
    }
    const Vec3 centre = (at(t, 0) + at(t, 1) + at(t, 2)) / 3.0;
    d.centre = note(deviation(t, face, centre, mean_uv(face, {t.uv[0], t.uv[1], t.uv[2]})), centre);
    return d;
  }

  // Marks the sides that have to be divided, or keeps the measurements of a triangle that stays.
  void inspect(const Triangle& t, bool is_last) {
    ExactFace& face = mesh_.faces[static_cast<std::size_t>(t.face)];
    if (face.surface.GetType() == GeomAbs_Plane) return;
    const Distances d = distances(t, face);
    if (d.worst > limit_mm_ && !is_last && mark_sides(t, face, d)) return;
    if (d.worst < face.deviation_mm) return;
    face.deviation_mm = d.worst;
    face.worst_mm = d.worst_place;
  }
  // Dividing does not help if the file's edge lies beside the surface.
  bool mark_sides(const Triangle& t, const ExactFace& face, const Distances& d) {
    const double limit = std::max(limit_mm_, kGapFactor * corner_gap(t, face));
    bool is_marked = false;
    std::size_t longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (length(t, k) > length(t, longest)) longest = k;
      if (d.sides[k] > limit && can_divide(length(t, k))) is_marked = mark(t, k);
    }
    return is_marked || (d.centre > limit && can_divide(length(t, longest)) && mark(t, longest));
  }
  [[nodiscard]] double length(const Triangle& t, std::size_t k) const { return (at(t, (k + 1) % 3) - at(t, k)).norm(); }
  [[nodiscard]] double corner_gap(const Triangle& t, const ExactFace& face) const {
    double gap = 0.0;
    for (std::size_t k = 0; k < 3; ++k) gap = std::max(gap, distance_to_surface(face, at(t, k), t.uv[k]));
    return gap;
  }
  [[nodiscard]] bool can_divide(double length) const { return length > kMinSideInDeviations * limit_mm_; }
  bool mark(const Triangle& t, std::size_t side) {
    marked_.emplace(key_of(t.corners[side], t.corners[(side + 1) % 3]), -1);
    return true;
  }

  // Divides every triangle with a marked side and returns the new ones.
  std::vector<std::size_t> divide() {
    std::vector<std::size_t> changed;
    const std::size_t count = mesh_.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      std::array<int, 3> middles{};
      const Triangle before = mesh_.triangles[t];
      if (!find_middles(before, middles)) continue;
      const std::size_t first = mesh_.triangles.size();
      replace(t, before, middles);
      changed.push_back(t);
      for (std::size_t added = first; added < mesh_.triangles.size(); ++added) changed.push_back(added);
    }
    return changed;
  }

  bool find_middles(const Triangle& t, std::array<int, 3>& middles) {
    bool is_any = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const auto found = marked_.find(key_of(t.corners[k], t.corners[next]));
      middles[k] = -1;
      if (found == marked_.end()) continue;
      if (found->second < 0) found->second = add_middle(t, k, next);
      middles[k] = found->second;
      is_any = true;
    }
    return is_any;
  }
  int add_middle(const Triangle& t, std::size_t k, std::size_t next) {
    const ExactFace& face = mesh_.faces[static_cast<std::size_t>(t.face)];
    mesh_.points.push_back(value(face, mean_uv(face, {t.uv[k], t.uv[next]})));
    const int middle = static_cast<int>(mesh_.points.size()) - 1;
    const auto side = std::minmax(t.corners[k], t.corners[next]);
    if (mesh_.free_sides.erase({side.first, side.second}) > 0) {
      mesh_.free_sides.insert(std::minmax(side.first, middle));
      mesh_.free_sides.insert(std::minmax(side.second, middle));
    }
    return middle;
  }

  // One marked side gives two triangles, two give three, three give four.
  void replace(std::size_t index, const Triangle& t, const std::array<int, 3>& middles) {
    const ExactFace& face = mesh_.faces[static_cast<std::size_t>(t.face)];
    std::vector<std::pair<int, Vec2>> ring;
    std::vector<std::size_t> middle_at;
    for (std::size_t k = 0; k < 3; ++k) {
      ring.emplace_back(t.corners[k], t.uv[k]);
      if (middles[k] < 0) continue;
      middle_at.push_back(ring.size());
      ring.emplace_back(middles[k], mean_uv(face, {t.uv[k], t.uv[(k + 1) % 3]}));
    }
    bool is_first = true;
    const auto emit = [&](std::size_t a, std::size_t b, std::size_t c) {
      const Triangle made{
          {ring[a].first, ring[b].first, ring[c].first}, {ring[a].second, ring[b].second, ring[c].second}, t.face};
      if (is_first)
        mesh_.triangles[index] = made;
      else
        mesh_.triangles.push_back(made);
      is_first = false;
    };
    if (middle_at.size() == 3) {
      emit(0, 1, 5);
      emit(1, 2, 3);
      emit(3, 4, 5);
      emit(1, 3, 5);
      return;
    }
    const std::size_t n = ring.size(), from = middle_at.front();
    if (n == 4) {
      emit(from, (from + 1) % n, (from + 2) % n);
      emit(from, (from + 2) % n, (from + 3) % n);
      return;
    }
    // The ring has five corners: the one between the two middles is cut off, and a quadrangle remains.
    const std::size_t corner = (middle_at[1] - middle_at[0] == 2) ? middle_at[0] + 1 : 0;
    const std::size_t before = (corner + n - 1) % n, after = (corner + 1) % n;
    emit(corner, after, before);
    emit(after, (after + 1) % n, (after + 2) % n);
    emit(after, (after + 2) % n, before);
  }

  BodyMesh& mesh_;
  double limit_mm_;
  std::unordered_map<std::uint64_t, int> marked_;  // The middle of each marked side.
};

}  // namespace

void refine(BodyMesh& mesh, double max_deviation_mm) {
  Refiner(mesh, max_deviation_mm).run();
}

}  // namespace triskin::cad_reader
