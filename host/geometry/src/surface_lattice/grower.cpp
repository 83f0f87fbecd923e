// SPDX-License-Identifier: GPL-3.0-or-later
#include "grower.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "layout/rigid.hpp"
#include "triskin/geometry/map_modules.hpp"

namespace triskin::geometry {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

constexpr double kReach_mm = 62.0;      // modules that a new one may push
constexpr double kTryJoin_mm = 9.0;     // corners nearer than this are pulled together before the limit decides
constexpr double kMargin = 0.96;        // of each limit: the final measurement walks the sides more finely
constexpr int kCoarseSamples = 15;
constexpr int kSeedTries = 150;

Vec3 centroid(const std::array<Vec3, 3>& t) { return (t[0] + t[1] + t[2]) / 3.0; }
Vec3 normal(const std::array<Vec3, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]).normalized(); }

}  // namespace

Grower::Grower(const Surface& surface, const std::vector<double>& area_sums, const LayoutLimits& limits, std::uint64_t seed)
    : surface_(surface), area_sums_(area_sums), limits_(limits), random_(seed) {}

void Grower::grow(Deadline deadline) {
  int failures = 0;
  while (failures < kSeedTries && std::chrono::steady_clock::now() < deadline) {
    if (!seed_island(random_point())) {
      ++failures;
      continue;
    }
    failures = failures / 2;
    grow_island(deadline);
  }
}

Vec3 Grower::random_point() {
  const double pick = uniform() * area_sums_.back();
  const int face = static_cast<int>(std::ranges::upper_bound(area_sums_, pick) - area_sums_.begin());
  const auto& f = surface_.mesh().faces[at(std::min(face, static_cast<int>(area_sums_.size()) - 1))];
  double u = uniform(), v = uniform();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const auto& p = surface_.mesh().vertices;
  return (1 - u - v) * p[at(f[0])] + u * p[at(f[1])] + v * p[at(f[2])];
}

// A module at the place, at a random angle, when it is free.
bool Grower::seed_island(const Vec3& middle) {
  for (const PlacedModule& m : modules_) {
    if ((centroid(m.corner_mm) - middle).norm() < 9.0) return false;
  }
  const Vec3 n = surface_.normal_at(surface_.closest(middle));
  const Vec3 x = n.unitOrthogonal();
  const double turn = uniform() * 2 * M_PI;
  PlacedModule m;
  m.island = islands_;
  m.tile = {0, 0, true};
  for (int k = 0; k < 3; ++k) {
    const double a = turn + 2 * M_PI * k / 3;
    m.corner_mm[at(k)] = middle + 17.32 * (std::cos(a) * x + std::sin(a) * n.cross(x));
  }
  m.corner_mm = fit_rigid(m.corner_mm);
  modules_.push_back(m);
  const int id = static_cast<int>(modules_.size()) - 1;
  relax({id}, 6);
  if (!holds({id})) {
    modules_.pop_back();
    return false;
  }
  place_[{islands_, m.tile}] = id;
  ++islands_;
  for (int s = 0; s < 3; ++s) open_.push_back({id, s});
  return true;
}

void Grower::keep(const std::vector<bool>& kept) {
  std::vector<int> target(modules_.size(), -1);
  std::vector<PlacedModule> left;
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    if (!kept[k]) continue;
    target[k] = static_cast<int>(left.size());
    left.push_back(modules_[k]);
  }
  for (PlacedModule& m : left) {
    m.island = -1;
    for (int& n : m.neighbour) n = n < 0 ? -1 : target[at(n)];
  }
  modules_ = std::move(left);
  // What falls apart becomes islands of its own: their lattices need not fit each other any more.
  place_.clear();
  islands_ = 0;
  for (std::size_t first = 0; first < modules_.size(); ++first) {
    if (modules_[first].island >= 0) continue;
    std::vector<int> queue{static_cast<int>(first)};
    modules_[first].island = islands_;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      const PlacedModule& m = modules_[at(queue[q])];
      place_[{islands_, m.tile}] = queue[q];
      for (const int n : m.neighbour) {
        if (n < 0 || modules_[at(n)].island >= 0) continue;
        modules_[at(n)].island = islands_;
        queue.push_back(n);
      }
    }
    ++islands_;
  }
}

void Grower::ruin_and_recreate(double radius_mm, double allowed_loss, double island_cost, Deadline deadline) {
  if (modules_.empty()) return;
  const auto before = std::tuple(modules_, place_, islands_);
  const double old_score = score(island_cost);
  const Vec3 middle = centroid(modules_[random_() % modules_.size()].corner_mm);
  std::vector<bool> kept(modules_.size());
  for (std::size_t k = 0; k < kept.size(); ++k) kept[k] = (centroid(modules_[k].corner_mm) - middle).norm() > radius_mm;
  keep(kept);
  open_.clear();
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    if ((centroid(modules_[k].corner_mm) - middle).norm() > radius_mm + 40.0) continue;
    for (int s = 0; s < 3; ++s) {
      if (modules_[k].neighbour[at(s)] < 0) open_.push_back({static_cast<int>(k), s});
    }
  }
  std::ranges::shuffle(open_, random_);
  grow_island(deadline);
  for (int k = 0; k < 12 && std::chrono::steady_clock::now() < deadline; ++k) {
    const Vec3 offset = (radius_mm + 15.0) * Vec3(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
    if (seed_island(surface_.closest(middle + offset).position_mm)) grow_island(deadline);
  }
  if (score(island_cost) < old_score - allowed_loss) std::tie(modules_, place_, islands_) = before;
  open_.clear();
}

int Grower::find(int island, const Tile& tile) const {
  const auto found = place_.find({island, tile});
  return found == place_.end() ? -1 : found->second;
}

// How many modules of the island the new one would meet.
int Grower::closings(const Side& side) const {
  const PlacedModule& m = modules_[at(side.module)];
  const Tile tile = across(m.tile, side.side).tile;
  int n = 0;
  for (int s = 0; s < 3; ++s) n += find(m.island, across(tile, s).tile) >= 0 ? 1 : 0;
  return n;
}

void Grower::grow_island(Deadline deadline) {
  while (!open_.empty() && std::chrono::steady_clock::now() < deadline) {
    // Close corners first, then the oldest side: islands stay round, and slits short.
    std::size_t best = 0;
    int most = -1;
    for (std::size_t k = 0; k < open_.size(); ++k) {
      const int n = closings(open_[k]);
      if (n > most) {
        most = n;
        best = k;
      }
    }
    const Side side = open_[best];
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(best));
    add_across(side);
  }
}

// The module's mirror image across the side, turned about it until its apex lies on the surface.
std::array<Vec3, 3> Grower::roll(const PlacedModule& from, int side) const {
  const Vec3 &p = from.corner_mm[at(side)], &q = from.corner_mm[at((side + 1) % 3)], &r = from.corner_mm[at((side + 2) % 3)];
  const Vec3 middle = (p + q) / 2.0, out = (middle - r).normalized(), n = normal(from.corner_mm);
  double angle = 0.0;
  Vec3 apex;
  for (int k = 0; k < 6; ++k) {
    apex = middle + kHeight_mm * (std::cos(angle) * out + std::sin(angle) * n);
    const SurfacePoint c = surface_.closest(apex);
    const Vec3 tangent = -std::sin(angle) * out + std::cos(angle) * n;
    angle = std::clamp(angle + (c.position_mm - apex).dot(tangent) / kHeight_mm, -limits_.fold_rad, limits_.fold_rad);
  }
  const int t = across(from.tile, side).side;
  std::array<Vec3, 3> corners;
  corners[at(t)] = q;
  corners[at((t + 1) % 3)] = p;
  corners[at((t + 2) % 3)] = middle + kHeight_mm * (std::cos(angle) * out + std::sin(angle) * n);
  return corners;
}

void Grower::join(int a, int side) {
  const TileSide other = across(modules_[at(a)].tile, side);
  const int b = find(modules_[at(a)].island, other.tile);
  modules_[at(a)].neighbour[at(side)] = b;
  modules_[at(b)].neighbour[at(other.side)] = a;
}

void Grower::part(int a, int side) {
  const int b = modules_[at(a)].neighbour[at(side)];
  modules_[at(a)].neighbour[at(side)] = -1;
  modules_[at(b)].neighbour[at(across(modules_[at(a)].tile, side).side)] = -1;
}

bool Grower::add_across(const Side& side) {
  const PlacedModule from = modules_[at(side.module)];
  const TileSide target = across(from.tile, side.side);
  if (from.neighbour[at(side.side)] >= 0 || find(from.island, target.tile) >= 0) return false;
  const std::vector<PlacedModule> before = modules_;
  PlacedModule m;
  m.island = from.island;
  m.tile = target.tile;
  m.corner_mm = roll(from, side.side);
  const int id = static_cast<int>(modules_.size());
  modules_.push_back(m);
  place_[{m.island, m.tile}] = id;
  for (int s = 0; s < 3; ++s) {
    const TileSide other = across(m.tile, s);
    const int b = find(m.island, other.tile);
    if (b < 0) continue;
    const auto& c = modules_[at(b)].corner_mm;
    const double gap = std::max((m.corner_mm[at(s)] - c[at((other.side + 1) % 3)]).norm(), (m.corner_mm[at((s + 1) % 3)] - c[at(other.side)]).norm());
    if (gap < kTryJoin_mm) join(id, s);
  }
  const std::vector<int> members = neighbourhood(id);
  relax(members, 12);
  for (int round = 0; round < 3 && open_bad_joints(members, id); ++round) relax(members, 8);
  const bool joined = std::ranges::any_of(modules_[at(id)].neighbour, [](int n) { return n >= 0; });
  if (!joined || open_bad_joints(members, -1) || !holds(members)) {
    modules_ = before;
    place_.erase({m.island, m.tile});
    return false;
  }
  for (int s = 0; s < 3; ++s) {
    if (modules_[at(id)].neighbour[at(s)] < 0) open_.push_back({id, s});
  }
  return true;
}

std::vector<int> Grower::neighbourhood(int center) const {
  std::vector<int> members;
  const Vec3 c = centroid(modules_[at(center)].corner_mm);
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    if (modules_[k].island == modules_[at(center)].island && (centroid(modules_[k].corner_mm) - c).norm() < kReach_mm) members.push_back(static_cast<int>(k));
  }
  return members;
}

Vec3 Grower::pulled_corner(const PlacedModule& m, int c) const {
  Vec3 sum = m.corner_mm[at(c)];
  int n = 1;
  for (const int s : {c, (c + 2) % 3}) {
    if (m.neighbour[at(s)] < 0) continue;
    const int t = across(m.tile, s).side;
    sum += modules_[at(m.neighbour[at(s)])].corner_mm[at(s == c ? (t + 1) % 3 : t)];
    ++n;
  }
  return surface_.closest(sum / n).position_mm;
}

void Grower::relax(const std::vector<int>& members, int steps) {
  std::vector<std::array<Vec3, 3>> next(members.size());
  for (int step = 0; step < steps; ++step) {
    for (std::size_t k = 0; k < members.size(); ++k) {
      const PlacedModule& m = modules_[at(members[k])];
      for (int c = 0; c < 3; ++c) next[k][at(c)] = 0.75 * pulled_corner(m, c) + 0.25 * m.corner_mm[at(c)];
    }
    for (std::size_t k = 0; k < members.size(); ++k) modules_[at(members[k])].corner_mm = fit_rigid(next[k]);
  }
}

// Parts the joints that break a limit: those of `added` alone, or (−1) only reports whether any member has one.
bool Grower::open_bad_joints(const std::vector<int>& members, int added) {
  bool any = false;
  for (const int a : members) {
    if (added >= 0 && a != added) continue;
    for (int s = 0; s < 3; ++s) {
      const int b = modules_[at(a)].neighbour[at(s)];
      if (b < 0) continue;
      const auto &p = modules_[at(a)].corner_mm, &q = modules_[at(b)].corner_mm;
      const int t = across(modules_[at(a)].tile, s).side;
      const double gap = std::max((p[at(s)] - q[at((t + 1) % 3)]).norm(), (p[at((s + 1) % 3)] - q[at(t)]).norm());
      const double length = ((p[at((s + 1) % 3)] + q[at(t)]) / 2 - (p[at(s)] + q[at((t + 1) % 3)]) / 2).norm();
      const double cosine = normal(p).dot(normal(q));
      if (gap <= kMargin * limits_.hinge_gap_mm && cosine >= std::cos(kMargin * limits_.fold_rad) &&
          std::abs(length - kSide_mm) <= kMargin * limits_.edge_error_mm) continue;
      any = true;
      if (added >= 0) part(a, s);
    }
  }
  return any;
}

bool Grower::holds_alone(const PlacedModule& m) const {
  const Vec3 c = centroid(m.corner_mm);
  const SurfacePoint hit = surface_.closest(c);
  if (hit.distance_mm > kMargin * limits_.center_gap_mm || surface_.normal_at(hit).dot(normal(m.corner_mm)) < 0.6) return false;
  // Far from the border no walk is needed: every point of a module is within its circumradius.
  if (surface_.border_distance(hit.position_mm) > 25.0) return true;
  return walk_sides(surface_, m.corner_mm, kCoarseSamples).overrun_mm <= 0.8 * limits_.overrun_mm;
}

bool Grower::holds(const std::vector<int>& members) const {
  for (const int k : members) {
    const PlacedModule& m = modules_[at(k)];
    if (!holds_alone(m)) return false;
    const Vec3 c = centroid(m.corner_mm);
    for (std::size_t o = 0; o < modules_.size(); ++o) {
      if (static_cast<int>(o) == k || (centroid(modules_[o].corner_mm) - c).squaredNorm() > 45.0 * 45.0) continue;
      if (penetration_depth(m.corner_mm, modules_[o].corner_mm) > kMargin * limits_.penetration_mm) return false;
    }
  }
  return true;
}

}  // namespace triskin::geometry
