// SPDX-License-Identifier: GPL-3.0-or-later
#include "grower.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "overlap.hpp"

namespace triskin::lattice {
namespace {

constexpr double kSnap_mm = 7.0;       // An apex this near to a corner at the same lattice point joins it.
constexpr int kFailuresAThirdTry = 2;  // The second try fails so many times before the next third one.
constexpr double kCrowded_mm = 6.0;    // Relaxing does not undo a larger overlap.
constexpr double kShort_mm = 6.0;      // An apex that the border holds back by more is not tried.
constexpr double kReach_mm = 45.0;
constexpr double kCornerReach_mm =
    28.0;  // A vertex is 17.3 mm from the centre of its triangle; the rest allows for the largest edge error.
constexpr double kSampleCell_mm = 20.0;
constexpr double kSurroundings_mm = 45.0;  // Modules farther away hardly decide whether one more fits.

NetTriangle loose(const Triangle& corners, double corner_cut_mm) {
  NetTriangle t;
  t.corner_cut_mm = corner_cut_mm;
  t.rigid = fit_rigid(corners);
  t.center = (t.rigid[0] + t.rigid[1] + t.rigid[2]) / 3.0;
  t.normal = (t.rigid[1] - t.rigid[0]).cross(t.rigid[2] - t.rigid[0]).normalized();
  return t;
}

}  // namespace

std::vector<Sample> spread_samples(const mesh::Surface& surface, double area_each_mm2, std::uint64_t seed) {
  std::vector<Sample> samples;
  Dice random(seed);
  double due = 0.5;
  const Mesh& mesh = surface.mesh();
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    const auto& v = mesh.faces[at(f)];
    const Vec3 &a = mesh.vertices[at(v[0])], &b = mesh.vertices[at(v[1])], &c = mesh.vertices[at(v[2])];
    for (due += 0.5 * (b - a).cross(c - a).norm() / area_each_mm2; due >= 1.0; due -= 1.0) {
      const double r = std::sqrt(random.unit()), s = random.unit();
      const mesh::SurfacePoint p = surface.closest((1 - r) * a + r * (1 - s) * b + r * s * c);
      samples.push_back({p.position_mm, surface.normal_at(p)});
    }
  }
  return samples;
}

Grower::Grower(const mesh::Surface& surface, const Rules& rules, const std::vector<Sample>& samples,
               double corner_lift_mm, Clock::time_point end, std::function<Clock::time_point()> now)
    : surface_(surface),
      rules_(rules),
      samples_(samples),
      sample_grid_(surface.mesh().vertices, kSampleCell_mm),
      relaxer_(surface_, corner_lift_mm),
      end_(end),
      now_(std::move(now)) {
  for (int k = 0; k < static_cast<int>(samples.size()); ++k) sample_grid_.add(k, samples[at(k)].point);
}

// Finds the point of the surface 30 mm from both ends of a side by turning the height about the side.
bool Grower::roll(const Vec3& a, const Vec3& b, const Vec3& away, Foot& apex) {
  const Vec3 middle = 0.5 * (a + b), along = (b - a).normalized();
  Vec3 direction = (away - away.dot(along) * along).normalized();
  for (int k = 0; k < 5; ++k) {
    apex = surface_.closest(middle + kHeight_mm * direction);
    const Vec3 d = apex.point - middle;
    const Vec3 across_side = d - d.dot(along) * along;
    if (across_side.norm() < 1.0) return false;
    direction = across_side.normalized();
  }
  return std::abs((apex.point - middle).norm() - kHeight_mm) < kShort_mm;
}

bool Grower::try_side(LatticeMesh& net, Side side) {
  const NetTriangle t = net.triangles()[at(side.triangle)];
  const TileSide next = across(t.tile, side.side);
  if (net.has_tile(t.island, next.tile)) return false;
  const Vec3 a = net.vertices()[at(t.vertex[at(side.side)])].point,
             b = net.vertices()[at(t.vertex[at((side.side + 1) % 3)])].point;
  const Vec3 far = net.vertices()[at(t.vertex[at((side.side + 2) % 3)])].point;
  Foot apex;
  if (!roll(a, b, 0.5 * (a + b) - far, apex)) {
    ++refused[static_cast<std::size_t>(Refusal::kOverrun)];
    return false;
  }
  const auto label = tile_corner_index(next.tile, (next.side + 2) % 3);
  // Corners of the same lattice point nearby; joining them closes the ring around a corner.
  std::vector<std::pair<double, int>> snaps;
  (void)net.any_near(apex.point, kSnap_mm + kCornerReach_mm, [&](int other) {
    if (net.triangles()[at(other)].island != t.island) return false;
    for (const int v : net.triangles()[at(other)].vertex) {
      const NetVertex& w = net.vertices()[at(v)];
      const double distance = (w.point - apex.point).norm();
      if (w.i == label[0] && w.j == label[1] && distance < kSnap_mm) snaps.emplace_back(distance, v);
    }
    return false;
  });
  std::ranges::sort(snaps);
  snaps.erase(std::ranges::unique(snaps).begin(), snaps.end());
  for (const auto& [distance, v] : snaps) {
    if (!crowded(net, {b, a, net.vertices()[at(v)].point}, side.triangle) && try_corner(net, side, v)) return true;
  }
  if (crowded(net, {b, a, apex.point}, side.triangle)) {
    ++refused[static_cast<std::size_t>(Refusal::kPenetration)];
    return false;
  }
  return try_corner(net, side, net.add_vertex(apex.point, apex.normal, label[0], label[1]));
}

bool Grower::try_corner(LatticeMesh& net, Side side, int apex) {
  const NetTriangle& t = net.triangles()[at(side.triangle)];
  const TileSide next = across(t.tile, side.side);
  std::array<int, 3> v{};
  v[at(next.side)] = t.vertex[at((side.side + 1) % 3)];
  v[at((next.side + 1) % 3)] = t.vertex[at(side.side)];
  v[at((next.side + 2) % 3)] = apex;
  return keep_or_revert(net, net.add_triangle(t.island, next.tile, v));
}

// A module that is refused after a hopeful start, beside others of its island, is tried again with more of its
// surroundings free to move.
bool Grower::keep_or_revert(LatticeMesh& net, int triangle) {
  Refusal refusal = refusal_of(net, triangle, tries_.first);
  const bool was_hopeful = !relaxer_.changed().empty();
  if (refusal != Refusal::kNone && was_hopeful && net.island_sizes()[at(net.triangles()[at(triangle)].island)] > 1) {
    const auto try_again = [&](const RelaxTry& attempt) {
      relaxer_.undo(net);
      refusal = refusal_of(net, triangle, attempt);
    };
    try_again(tries_.second);
    if (refusal != Refusal::kNone && tries_.third && ++second_failures_ % kFailuresAThirdTry == 0)
      try_again(*tries_.third);
  }
  if (refusal == Refusal::kNone) return true;
  ++refused[static_cast<std::size_t>(refusal)];
  relaxer_.undo(net);
  net.take_back(triangle);
  return false;
}

Refusal Grower::refusal_of(LatticeMesh& net, int triangle, const RelaxTry& attempt) {
  if (!relaxer_.relax(net, triangle, attempt.radius_mm, attempt.steps)) return Refusal::kPenetration;
  return rules_.evaluate(surface_, net, relaxer_.changed(), relaxer_.pairs(), known_sides_);
}

// Hopeless places are found before the costly relaxing.
bool Grower::crowded(const LatticeMesh& net, const Triangle& corners, int beside) const {
  const NetTriangle candidate = loose(corners, net.corner_cut_mm());
  return net.any_near(candidate.center, kReach_mm, [&](int k) {
    return k != beside && overlap_of(candidate, net.triangles()[at(k)]).depth_mm > kCrowded_mm;
  });
}

bool Grower::try_seed(LatticeMesh& net, const Triangle& corners) {
  if (!zone_.holds((corners[0] + corners[1] + corners[2]) / 3.0) || crowded(net, corners, -1)) return false;
  const int island = net.new_island();
  const Tile tile;
  std::array<int, 3> v{};
  for (int k = 0; k < 3; ++k) {
    const Foot foot = surface_.closest(corners[at(k)]);
    const auto label = tile_corner_index(tile, k);
    v[at(k)] = net.add_vertex(foot.point, foot.normal, label[0], label[1]);
  }
  return keep_or_revert(net, net.add_triangle(island, tile, v));
}

bool Grower::seed_at_side(LatticeMesh& net, Side side) {
  const NetTriangle& t = net.triangles()[at(side.triangle)];
  const Vec3 a = t.rigid[at(side.side)], b = t.rigid[at((side.side + 1) % 3)], far = t.rigid[at((side.side + 2) % 3)];
  Foot apex;
  if (!roll(a, b, 0.5 * (a + b) - far, apex)) return false;
  return try_seed(net, {b, a, apex.point});
}

bool Grower::seed_at_sample(LatticeMesh& net, const Sample& sample, Dice& random) {
  const Vec3 x = sample.normal.unitOrthogonal(), y = sample.normal.cross(x);
  const double turn = 2.0 * M_PI * random.unit();
  Triangle corners;
  for (int k = 0; k < 3; ++k) {
    const double angle = turn + 2.0 * M_PI * k / 3.0;
    corners[at(k)] = sample.point + 2.0 * kHeight_mm / 3.0 * (std::cos(angle) * x + std::sin(angle) * y);
  }
  return try_seed(net, corners);
}

// Lays one side along the nearest border, counter-clockwise seen from outside.
bool Grower::seed_at_border(LatticeMesh& net, const Sample& sample) {
  const double reach = surface_.surface().border_distance(sample.point);
  if (!(reach < 20.0)) return false;
  constexpr double kProbe_mm = 0.5;
  const Vec3 x = sample.normal.unitOrthogonal(), y = sample.normal.cross(x);
  const Vec3 uphill = (surface_.surface().border_distance(sample.point + kProbe_mm * x) - reach) * x +
                      (surface_.surface().border_distance(sample.point + kProbe_mm * y) - reach) * y;
  if (uphill.norm() < 1e-6) return false;
  const Vec3 in = uphill.normalized(), along = in.cross(sample.normal);
  const Vec3 foot = sample.point - (reach - 0.2) * in;
  return try_seed(net, {Vec3(foot - 15.0 * along), Vec3(foot + 15.0 * along), Vec3(foot + kHeight_mm * in)});
}

std::vector<Grower::Side> Grower::open_sides(const LatticeMesh& net, const Ball& ball) const {
  std::vector<Side> sides;
  std::vector<int> inside;
  net.near(ball.center, ball.radius_mm, inside);
  for (const int t : inside) {
    for (int s = 0; s < 3; ++s) {
      if (net.neighbour(t, s) < 0) sides.push_back({t, s});
    }
  }
  return sides;
}

void Grower::grow(LatticeMesh& net, const Ball& ball, Dice& random) {
  grow_from(net, open_sides(net, ball), ball, random);
}

// Takes sides with small keys first: near the start, with noise so that each growth differs.
void Grower::grow_from(LatticeMesh& net, const std::vector<Side>& front, const Ball& ball, Dice& random) {
  struct Entry {
    double key;
    Side side;
  };
  const auto later = [](const Entry& a, const Entry& b) { return a.key > b.key; };
  std::vector<Entry> heap;
  const double noise = 60.0 * random.unit();
  const auto push = [&](Side s, double start) {
    heap.push_back({start + noise * random.unit(), s});
    std::ranges::push_heap(heap, later);
  };
  for (const Side s : front) push(s, 0.0);
  while (!heap.empty() && !late()) {
    std::ranges::pop_heap(heap, later);
    const Entry entry = heap.back();
    heap.pop_back();
    const Side s = entry.side;
    if (!net.used(s.triangle) || net.neighbour(s.triangle, s.side) >= 0) continue;
    if (!ball.holds(net.triangles()[at(s.triangle)].center) || !zone_.holds(place_beside(net, s))) continue;
    const std::uint64_t surroundings = surroundings_of(net, s);
    std::uint64_t& last_failed = last_failure(failed_join_, s);
    if (last_failed == surroundings) continue;
    if (!try_side(net, s)) {
      last_failed = surroundings;
      continue;
    }
    const int added = net.neighbour(s.triangle, s.side);
    for (int k = 0; k < 3; ++k) {
      if (net.neighbour(added, k) < 0) push({added, k}, entry.key + 10.0);
    }
  }
}

// Returns the centre of a module at a side, as if there were no fold.
Vec3 Grower::place_beside(const LatticeMesh& net, Side side) {
  const NetTriangle& t = net.triangles()[at(side.triangle)];
  return t.rigid[at(side.side)] + t.rigid[at((side.side + 1) % 3)] - t.center;
}

std::uint64_t Grower::surroundings_of(const LatticeMesh& net, Side side) const {
  return net.signature(place_beside(net, side), kSurroundings_mm);
}

std::uint64_t& Grower::last_failure(std::vector<std::array<std::uint64_t, 3>>& failures, Side side) {
  if (failures.size() <= at(side.triangle)) failures.resize(at(side.triangle) + 1);
  return failures[at(side.triangle)][at(side.side)];
}

void Grower::fill(LatticeMesh& net, const Ball& ball, Dice& random, int attempts) {
  const auto grow_newest = [&](int before) {
    if (net.size() == before) return;
    std::vector<Side> sides = open_sides(net, ball);
    grow_from(net, sides, ball, random);
  };
  for (const Side s : open_sides(net, ball)) {
    if (late()) return;
    if (!net.used(s.triangle) || net.neighbour(s.triangle, s.side) >= 0 || random.unit() < 0.3) continue;
    if (!zone_.holds(place_beside(net, s))) continue;
    const std::uint64_t surroundings = surroundings_of(net, s);
    std::uint64_t& last_failed = last_failure(failed_seed_, s);
    if (last_failed == surroundings) continue;
    const int before = net.size();
    if (!seed_at_side(net, s)) last_failed = surroundings;
    grow_newest(before);
  }
  std::vector<int> near;
  (void)sample_grid_.any_near(ball.center, ball.radius_mm, [&](int k) {
    if (ball.holds(samples_[at(k)].point) && zone_.holds(samples_[at(k)].point) && !covered(net, samples_[at(k)].point))
      near.push_back(k);
    return false;
  });
  std::ranges::sort(near);
  for (int k = 0; k < attempts && !near.empty() && !late(net); ++k) {
    const Sample& sample = samples_[at(near[at(random.scaled_below(static_cast<int>(near.size())))])];
    if (covered(net, sample.point)) continue;
    const int before = net.size();
    if (random.unit() < 0.5 || !seed_at_border(net, sample)) seed_at_sample(net, sample, random);
    grow_newest(before);
  }
}

bool Grower::remove_overrunning(LatticeMesh& net) {
  bool any = false;
  known_within_.resize(std::max(known_within_.size(), net.triangles().size()), kNowhere);
  for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    if (!net.used(t) || triangle.is_fixed || known_within_[at(t)] == triangle.rigid) continue;
    if (rules_.exceeds_overrun(surface_, triangle)) {
      net.remove_triangle(t);
      any = true;
    } else {
      known_within_[at(t)] = triangle.rigid;
    }
  }
  return any;
}

bool Grower::covered(const LatticeMesh& net, const Vec3& p) const {
  return net.any_near(p, kModuleReach_mm, [&](int t) { return lies_over(net.triangles()[at(t)], p); });
}

}  // namespace triskin::lattice
