// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "triskin/design/outline.hpp"

namespace triskin::lattice {
namespace {

constexpr double kDamping = 0.02;
// After each step a larger overlap is hopeless: of the modules that fit in the end, one in two hundred had more; of
// those that do not, a third have.
constexpr std::array kFarOff_mm{3.0, 2.4, 1.8, 1.2};
constexpr double kReach_mm = 2.0 * kHeight_mm / 3.0;  // The corners of a module are this far from its centre.
constexpr double kPair_mm = 38.0;  // Modules with centroids nearer than this may come to overlap while sliding.
constexpr double kAllowedOverlap_mm = 0.1;
// Both modules of a pair move, and a corner of a module by little more than the corners of the net that it is fitted
// to.
constexpr double kShareOfGap = 0.3;
constexpr double kSettled_mm = 0.02;
constexpr double kMoved_mm = 0.01;
constexpr double kNearBorder_mm = 12.0;
constexpr double kWantedGap_mm = 2.0;  // Corners are lifted if the centre would otherwise be deeper than this.
constexpr double kLongest_mm = 5.0;    // A single step moves no farther than this.

// Returns the squared length of the path along a surface between two points whose normals have this cosine, as on an
// arc over the chord: the chord times (asin s / s)², s² = (1 - cosine) / 2, by its first four terms. The other side
// of a narrow part is thus far away.
double squared_way(const Vec3& chord, double cosine) {
  const double s2 = 0.5 * (1.0 - cosine);
  return chord.squaredNorm() * (1.0 + s2 * (1.0 / 3.0 + s2 * (8.0 / 45.0 + s2 * (4.0 / 35.0))));
}

}  // namespace

bool Relaxer::relax(LatticeMesh& net, int triangle, double radius_mm, int steps) {
  overhang_mm_ = design::cut_height_mm(net.corner_cut_mm());
  way_mm_ = 0.0;
  choose(net, triangle, radius_mm);
  find_pairs(net);
  bool hope = true;
  for (int k = 0; k < steps && hope; ++k) {
    adapt_lift(net);
    if (step(net) < kSettled_mm) break;
    hope = at(k) >= kFarOff_mm.size() || !overlaps(net, triangle, kFarOff_mm[at(k)]);
  }
  if (hope) settle(net, triangle);
  return hope;
}

bool Relaxer::overlaps(const LatticeMesh& net, int triangle, double depth_mm) {
  return std::ranges::any_of(pairs_, [&](Pair& pair) {
    return (pair.a == triangle || pair.b == triangle) &&
           overlap_of(net.triangles()[at(pair.a)], net.triangles()[at(pair.b)], pair.axis).depth_mm > depth_mm;
  });
}

void Relaxer::choose(const LatticeMesh& net, int triangle, double radius_mm) {
  const Vec3 place = net.triangles()[at(triangle)].center, normal = net.triangles()[at(triangle)].normal;
  for (const Moving& m : moving_) local_[at(m.vertex)] = -1;
  for (const int t : triangles_) is_local_[at(t)] = 0;
  local_.resize(std::max(local_.size(), net.vertices().size()), -1);
  is_local_.resize(std::max(is_local_.size(), net.triangles().size()), 0);
  known_gaps_.resize(std::max(known_gaps_.size(), net.triangles().size()));
  moving_.clear();
  triangles_.clear();
  saved_.clear();
  changed_.clear();
  near_.clear();
  is_local_[at(triangle)] = 1;  // This includes a module between fixed ones, which has no corner to move.
  net.near(place, radius_mm + 2.0 * kReach_mm + kPair_mm, near_);
  Vec3 low = place, high = place;
  for (const int t : near_) {
    for (const int v : net.triangles()[at(t)].vertex) {
      const NetVertex& w = net.vertices()[at(v)];
      const bool is_moving = local_[at(v)] >= 0;
      if (!is_moving && w.is_fixed) continue;
      if (!is_moving && squared_way(w.point - place, w.normal.dot(normal)) > radius_mm * radius_mm) continue;
      if (!is_moving) {
        local_[at(v)] = 0;
        Moving& m = moving_.emplace_back();
        m.vertex = v;
        m.saved_point = w.point;
        m.saved_normal = w.normal;
        m.saved_lift_mm = w.lift_mm;
        low = low.cwiseMin(w.point);
        high = high.cwiseMax(w.point);
      }
      is_local_[at(t)] = 1;
    }
    if (!is_local_[at(t)]) continue;
    triangles_.push_back(t);
    saved_.push_back(net.triangles()[at(t)].shape());
  }
  const Vec3 line = high - low;
  for (Moving& m : moving_) m.key = line.dot(m.saved_point);
  std::ranges::sort(moving_, [](const Moving& a, const Moving& b) {
    return std::pair(a.key, a.vertex) < std::pair(b.key, b.vertex);
  });
  for (std::size_t k = 0; k < moving_.size(); ++k) local_[at(moving_[k].vertex)] = static_cast<int>(k);
}

void Relaxer::find_pairs(const LatticeMesh& net) {
  pairs_.clear();
  for (const int a : triangles_) {
    for (const int b : near_) {
      if (b == a || (b < a && is_local_[at(b)])) continue;  // The other module of the pair finds it.
      if ((net.center(a) - net.center(b)).squaredNorm() < kPair_mm * kPair_mm && !net.joined(a, b)) {
        pairs_.push_back({a, b, net.in_fan(a, b)});
      }
    }
  }
}

void Relaxer::add_residual(double value, double weight, const std::array<int, 2>& vertex,
                           const std::array<Vec3, 2>& gradient) {
  Residual r{value, weight, {-1, -1}, {}};
  for (std::size_t k = 0; k < 2; ++k) {
    r.local[k] = vertex[k] < 0 ? -1 : local_[at(vertex[k])];
    if (r.local[k] < 0) continue;
    const Moving& m = moving_[at(r.local[k])];
    r.gradient[k] = {gradient[k].dot(m.x), gradient[k].dot(m.y)};
  }
  if (r.local[0] == r.local[1]) return;  // A corner cannot be separated from itself.
  if (r.local[0] < r.local[1]) {
    std::swap(r.local[0], r.local[1]);
    std::swap(r.gradient[0], r.gradient[1]);
  }
  residuals_.push_back(r);
}

// Long and short edges weigh more, so that the largest error falls; a module is easier to separate than to push
// together.
void Relaxer::add_edges(const LatticeMesh& net) {
  for (const int t : triangles_) {
    const auto& v = net.triangles()[at(t)].vertex;
    for (std::size_t s = 0; s < 3; ++s) {
      const int a = v[s], b = v[(s + 1) % 3];
      const Vec3 d = net.vertices()[at(a)].point - net.vertices()[at(b)].point;
      const double length = d.norm(), error = length - kSide_mm;
      const double weight = (0.15 + error * error) * (error < 0 ? 1.5 : 1.0);
      add_residual(error, std::min(weight, 4.0), {a, b}, {Vec3(d / length), Vec3(-d / length)});
    }
  }
}

void Relaxer::add_pairs(const LatticeMesh& net) {
  for (Pair& pair : pairs_) {
    if (pair.in_fan || way_mm_ < pair.apart_until_mm) continue;
    const NetTriangle &p = net.triangles()[at(pair.a)], &q = net.triangles()[at(pair.b)];
    const Overlap o = overlap_of(p, q, pair.axis);
    pair.apart_until_mm = way_mm_ + kShareOfGap * o.apart_mm;
    if (o.depth_mm <= kAllowedOverlap_mm) continue;
    // The whole module yields, the touching corner most.
    add_residual(o.depth_mm - kAllowedOverlap_mm, 3.0, {p.vertex[at(o.corner_a)], q.vertex[at(o.corner_b)]},
                 {o.axis, Vec3(-o.axis)});
  }
}

// Takes sides of modules near the border: a side that overhangs is pushed back through its corners.
void Relaxer::add_border(const LatticeMesh& net) {
  for (const Moving& m : moving_) {
    const NetVertex& v = net.vertices()[at(m.vertex)];
    if (v.on_border) add_residual(0.0, 6.0, {m.vertex, -1}, {v.outward, Vec3::Zero()});
  }
  for (const int t : triangles_) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    if (surface_.border_at_least(triangle.center) >= kNearBorder_mm + kReach_mm) continue;
    for (std::size_t s = 0; s < 3; ++s) {
      if (net.neighbour(t, static_cast<int>(s)) < 0) add_side_at_border(triangle, s);
    }
  }
}

void Relaxer::add_side_at_border(const NetTriangle& triangle, std::size_t side) {
  const double cut = triangle.corner_cut_mm / kSide_mm;
  const bool is_cut = cut > 0.0;  // Without a cut, the end of the side is the start of the next.
  const double spacing = is_cut ? 0.25 * (1.0 - 2.0 * cut) : 0.2;
  for (int k = 0; k < 5;) {
    const double x = cut + k * spacing;
    const double far_mm = add_point_at_border(triangle, side, x);
    k += 1 + std::max(0, static_cast<int>(far_mm / (spacing * kSide_mm)));
  }
}

// Adds the point at fraction x of a side and returns how far from it no other point needs a test.
double Relaxer::add_point_at_border(const NetTriangle& triangle, std::size_t side, double x) {
  const Vec3 &a = triangle.rigid[side], &b = triangle.rigid[(side + 1) % 3];
  const Vec3 p = a + x * (b - a);
  if (const double far_mm = surface_.border_at_least(p) - kNearBorder_mm; far_mm >= 0.0) return far_mm;
  if (!surface_.may_be_over_border(p)) return 0.0;
  const Foot foot = surface_.closest(p);
  if (!foot.on_border) return 0.0;
  const Vec3 off = p - foot.point, over = off - off.dot(foot.normal) * foot.normal;
  const double depth = over.norm();
  if (depth < 0.15 || depth > 10.0) return 0.0;
  const Vec3 out = over / depth;
  add_residual(depth - 0.15, 2.0, {triangle.vertex[side], triangle.vertex[(side + 1) % 3]},
               {Vec3((1 - x) * out), Vec3(x * out)});
  return 0.0;
}

void Relaxer::solve() {
  first_.resize(moving_.size());
  for (std::size_t k = 0; k < first_.size(); ++k) first_[k] = static_cast<int>(k);
  for (const Residual& r : residuals_) {
    if (r.local[1] >= 0) first_[at(r.local[0])] = std::min(first_[at(r.local[0])], r.local[1]);
  }
  system_.reset(first_);
  for (int row = 0; row < static_cast<int>(2 * first_.size()); ++row) system_.add(row, row, kDamping);
  for (const Residual& r : residuals_) {
    for (std::size_t p = 0; p < 2; ++p) {
      if (r.local[p] < 0) continue;
      const int row = 2 * r.local[p];
      const double gx = r.weight * r.gradient[p][0], gy = r.weight * r.gradient[p][1];
      system_.right(row) -= r.value * gx;
      system_.right(row + 1) -= r.value * gy;
      for (std::size_t q = p; q < 2; ++q) {  // The lower half belongs to local[0] > local[1].
        if (r.local[q] < 0) continue;
        const int column = 2 * r.local[q];
        system_.add(row, column, gx * r.gradient[q][0]);
        if (q != p) system_.add(row, column + 1, gx * r.gradient[q][1]);
        system_.add(row + 1, column, gy * r.gradient[q][0]);
        system_.add(row + 1, column + 1, gy * r.gradient[q][1]);
      }
    }
  }
  system_.solve();
}

double Relaxer::step(LatticeMesh& net) {
  if (moving_.empty()) return 0.0;
  for (Moving& m : moving_) {
    m.x = net.vertices()[at(m.vertex)].normal.unitOrthogonal();
    m.y = net.vertices()[at(m.vertex)].normal.cross(m.x);
  }
  residuals_.clear();
  add_edges(net);
  add_pairs(net);
  add_border(net);
  solve();
  double largest = 0.0;
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    const Moving& m = moving_[k];
    Vec3 by = system_.right(static_cast<int>(2 * k)) * m.x + system_.right(static_cast<int>(2 * k + 1)) * m.y;
    double length = by.norm();
    if (!(length < 1e3)) by = Vec3::Zero(), length = 0.0;
    if (length > kLongest_mm) by *= kLongest_mm / length;
    largest = std::max(largest, std::min(length, kLongest_mm));
    move(net, m, by);
  }
  for (const int t : triangles_) net.fit_for_now(t);
  way_mm_ += largest;
  return largest;
}

void Relaxer::move(LatticeMesh& net, const Moving& moving, const Vec3& by) {
  NetVertex& v = net.edit_vertex(moving.vertex);
  const Vec3 wanted = v.point - v.lift_mm * v.normal + by;
  const Foot foot = surface_.closest(wanted);
  v.normal = foot.normal;
  v.point = foot.point + v.lift_mm * foot.normal;
  v.on_border = false;
  if (!foot.on_border) return;
  const Vec3 off = wanted - foot.point, over = off - off.dot(v.normal) * v.normal;
  const double length = over.norm();
  v.on_border = length > overhang_mm_ + 1e-3;
  if (overhang_mm_ > 0.0) v.point += std::min(1.0, overhang_mm_ / std::max(length, 1e-12)) * over;
  if (v.on_border) v.outward = over / length;
}

// Modules that bridge a strong convex bend dip below it at the centre, so their corners are lifted a little.
void Relaxer::adapt_lift(LatticeMesh& net) {
  if (lift_mm_ <= 0.0) return;
  bool any = false;
  for (Moving& m : moving_) {
    const double lift = net.vertices()[at(m.vertex)].lift_mm;
    any = any || lift != 0.0;
    m.wanted_lift_mm = std::max(0.0, lift - 0.1);
  }
  for (const int t : triangles_) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    const double under = height_of_surface(t, triangle);
    if (under < kWantedGap_mm) continue;
    for (const int v : triangle.vertex) {
      if (local_[at(v)] < 0) continue;
      any = true;
      double& lift = moving_[at(local_[at(v)])].wanted_lift_mm;
      lift = std::min(lift_mm_, lift + 0.5 * (under - kWantedGap_mm));
    }
  }
  if (any) apply_lift(net);
}

// Returns the height of the surface over the centre of a module; below the wanted gap it may be any lower number. The
// distance changes by no more than the centre moves, so most centres need not be measured again.
double Relaxer::height_of_surface(int t, const NetTriangle& triangle) {
  KnownGap& known = known_gaps_[at(t)];
  const double room = kWantedGap_mm - known.distance_mm;
  if (room > 0.0 && (triangle.center - known.center).squaredNorm() < room * room) return 0.0;
  const Foot foot = surface_.closest(triangle.center);
  known = {triangle.center, foot.distance_mm};
  return foot.distance_mm < kWantedGap_mm ? 0.0 : (foot.point - triangle.center).dot(triangle.normal);
}

void Relaxer::apply_lift(LatticeMesh& net) {
  for (Moving& m : moving_) {
    const double by = m.wanted_lift_mm - net.vertices()[at(m.vertex)].lift_mm;
    m.is_lifted = by != 0.0;
    if (!m.is_lifted) continue;
    NetVertex& v = net.edit_vertex(m.vertex);
    v.point += by * v.normal;
    v.lift_mm = m.wanted_lift_mm;
  }
  const auto is_lifted = [&](int v) { return local_[at(v)] >= 0 && moving_[at(local_[at(v)])].is_lifted; };
  for (const int t : triangles_) {
    if (std::ranges::any_of(net.triangles()[at(t)].vertex, is_lifted)) net.fit_for_now(t);
  }
}

// Corners that hardly moved return to their place, so that their modules need no new evaluation.
void Relaxer::settle(LatticeMesh& net, int triangle) {
  for (Moving& m : moving_) {
    NetVertex& v = net.edit_vertex(m.vertex);
    const bool moved = (v.point - m.saved_point).squaredNorm() > kMoved_mm * kMoved_mm;
    m.key = moved ? 1.0 : 0.0;
    if (moved) continue;
    v.point = m.saved_point;
    v.normal = m.saved_normal;
    v.lift_mm = m.saved_lift_mm;
  }
  changed_.clear();
  for (const int t : triangles_) {
    const auto has_moved = [&](int v) { return local_[at(v)] >= 0 && moving_[at(local_[at(v)])].key > 0.0; };
    net.fit_for_now(t);
    if (t != triangle && std::ranges::none_of(net.triangles()[at(t)].vertex, has_moved)) continue;
    net.note_moved(t);
    changed_.push_back(t);
  }
}

void Relaxer::undo(LatticeMesh& net) const {
  for (const Moving& m : moving_) {
    NetVertex& v = net.edit_vertex(m.vertex);
    v.point = m.saved_point;
    v.normal = m.saved_normal;
    v.lift_mm = m.saved_lift_mm;
  }
  for (std::size_t k = 0; k < triangles_.size(); ++k) net.set_back(triangles_[k], saved_[k]);
  for (const int t : changed_) net.note_moved(t);
}

}  // namespace triskin::lattice
