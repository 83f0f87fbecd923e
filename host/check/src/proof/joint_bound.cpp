// SPDX-License-Identifier: GPL-3.0-or-later
#include "joint_bound.hpp"

#include <algorithm>
#include <array>

namespace triskin::check {
namespace {

constexpr double kOpposed = -0.998;      // Two normals with a smaller cosine count as opposed.
constexpr double kMinMultiplier = 0.04;  // Needs of a triple with a smaller multiplier are ignored.
constexpr int kMaxHalvings = 16;         // Bounds the halvings of a region's angles.
constexpr std::size_t kMaxNeeds = 30;    // More needs of a module would give too many triples.

double turn_between(const Need& a, const Need& b) {
  return middle(a.normal.x) * middle(b.normal.y) - middle(a.normal.y) * middle(b.normal.x);
}
bool opposed(const Need& a, const Need& b) {
  return a.by_side == b.by_side && a.edge != b.edge &&
         middle(a.normal.x) * middle(b.normal.x) + middle(a.normal.y) * middle(b.normal.y) < kOpposed;
}
IntervalPoint times(const Interval& factor, const IntervalPoint& p) {
  return {factor * p.x, factor * p.y};
}

}  // namespace

JointBound::JointBound(const MotionRegion& region, const CandidateList& list) : region_(region) {
  for (const Candidate& module : list.tiles) {
    std::vector<Need> needs;
    for (std::uint32_t k = module.first; k < module.first + module.count; ++k)
      region.add_needs(module, list.edges[k], needs);
    needs_.push_back(std::move(needs));
  }
  dead_.assign(list.tiles.size(), false);
}

int JointBound::bound(CandidateList& list) {
  for (std::size_t k = 0; k < needs_.size(); ++k) dead_[k] = never_inside(needs_[k]);
  const int conflicts = disjoint_conflicts();
  drop_dead(list);
  return list.bound() - conflicts;
}

bool JointBound::never_inside(std::span<const Need> needs) {
  if (std::ranges::any_of(needs, [&](const Need& need) { return region_.never_met(need); })) return true;
  if (needs.size() < 2 || needs.size() > kMaxNeeds) return false;
  sums_.clear();
  for (std::size_t a = 0; a < needs.size(); ++a) {
    for (std::size_t b = a + 1; b < needs.size(); ++b) {
      if (opposed(needs[a], needs[b])) add_pair(needs[a], needs[b]);
    }
  }
  const auto& [low, high] = region_.angles();
  if (!sums_.empty() && excluded(low, high, kMaxHalvings)) return true;
  add_triples(needs);
  return !sums_.empty() && excluded(low, high, kMaxHalvings);
}

void JointBound::add_pair(const Need& a, const Need& b) {
  add_sum(std::array{&a, &b}, std::array{1.0, 1.0});
}

void JointBound::add_triples(std::span<const Need> needs) {
  for (std::size_t a = 0; a < needs.size(); ++a) {
    for (std::size_t b = a + 1; b < needs.size(); ++b) {
      const double third = turn_between(needs[a], needs[b]);
      if (needs[a].edge == needs[b].edge || std::abs(third) < kMinMultiplier) continue;
      for (std::size_t c = b + 1; c < needs.size(); ++c) {
        if (needs[c].edge == needs[a].edge || needs[c].edge == needs[b].edge) continue;
        if (needs[a].by_side != needs[b].by_side || needs[a].by_side != needs[c].by_side) continue;
        const double first = turn_between(needs[b], needs[c]) / third,
                     second = turn_between(needs[c], needs[a]) / third;
        if (first < kMinMultiplier || second < kMinMultiplier) continue;
        add_sum(std::array{&needs[a], &needs[b], &needs[c]}, std::array{first, second, 1.0});
      }
    }
  }
}

// Adds the sum of multiplier * need. Points are relative to the last one's: the rest of the normals leaves a part of
// the translation, bounded by the farthest point of the region.
void JointBound::add_sum(std::span<const Need* const> needs, std::span<const double> multipliers) {
  AngleNeed sum;
  IntervalPoint rest{0.0, 0.0};
  const Need& last = *needs.back();
  const Interval way(last.by_side ? -1.0 : 1.0);  // A side turns the edge's end, a line turns the module back.
  for (std::size_t k = 0; k < needs.size(); ++k) {
    const IntervalPoint normal = times(multipliers[k], needs[k]->normal), from_last = needs[k]->point - last.point;
    sum.cosine = sum.cosine + dot(normal, from_last);
    sum.sine = sum.sine + way * (normal.x * from_last.y - normal.y * from_last.x);
    sum.constant = sum.constant + Interval(multipliers[k]) * needs[k]->constant;
    rest = rest + normal;
  }
  const double left = std::hypot(rest.x.magnitude(), rest.y.magnitude()) * (1.0 + 1e-12) * last.farthest_mm;
  sum.constant = sum.constant + Interval(-left, left);
  sums_.push_back(sum);
}

// Uses the mean value form over the angles, and if no sum stays below its constant, tries either half.
bool JointBound::excluded(double low, double high, int halvings) const {
  const double at = 0.5 * (low + high), half = std::max(high - at, at - low) * (1.0 + 1e-12) + 1e-16;
  const Interval c = cosine(Interval(at)), s = sine(Interval(at));
  const Interval c_range = cosine(Interval(at - half, at + half)), s_range = sine(Interval(at - half, at + half));
  bool somewhere = false;
  for (const AngleNeed& n : sums_) {
    const Interval value = n.cosine * c + n.sine * s - n.constant;
    if (!(value.high < 0.0)) continue;
    somewhere = true;
    const Interval slope = n.sine * c_range - n.cosine * s_range;
    if (value.high + slope.magnitude() * half * (1.0 + 1e-12) < 0.0) return true;
  }
  if (!somewhere || halvings == 0) return false;
  return excluded(low, at, halvings - 1) && excluded(at, high, halvings - 1);
}

void JointBound::drop_dead(CandidateList& list) const {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < list.tiles.size(); ++k) {
    if (!dead_[k]) list.tiles[kept++] = list.tiles[k];
  }
  list.tiles.resize(kept);
}

bool JointBound::contradictory(std::span<const Need> a, std::span<const Need> b) {
  sums_.clear();
  for (const Need& p : a) {
    for (const Need& q : b) {
      if (opposed(p, q)) add_pair(p, q);
    }
  }
  const auto& [low, high] = region_.angles();
  return !sums_.empty() && excluded(low, high, kMaxHalvings);
}

// Each pair holds at most one module. Finds them by augmenting paths between the two colours of the rivals.
int JointBound::disjoint_conflicts() {
  const std::size_t n = needs_.size();
  rivals_.assign(n, {});
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n && !dead_[a]; ++b) {
      if (dead_[b] || !contradictory(needs_[a], needs_[b])) continue;
      rivals_[a].push_back(b);
      rivals_[b].push_back(a);
    }
  }
  colour_.assign(n, 0);
  for (std::size_t root = 0; root < n; ++root) {
    if (colour_[root] != 0) continue;
    colour_[root] = 1;
    std::vector<std::size_t> stack{root};
    while (!stack.empty()) {
      const std::size_t from = stack.back();
      stack.pop_back();
      for (const std::size_t to : rivals_[from]) {
        if (colour_[to] != 0) continue;
        colour_[to] = -colour_[from];
        stack.push_back(to);
      }
    }
  }
  partner_.assign(n, -1);
  int pairs = 0;
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<bool> asked(n, false);
    if (colour_[k] == 1 && rematch(k, asked)) ++pairs;
  }
  return pairs;
}

bool JointBound::rematch(std::size_t module, std::vector<bool>& asked) {
  for (const std::size_t rival : rivals_[module]) {
    if (colour_[rival] == colour_[module] || asked[rival]) continue;
    asked[rival] = true;
    if (partner_[rival] >= 0 && !rematch(static_cast<std::size_t>(partner_[rival]), asked)) continue;
    partner_[rival] = static_cast<int>(module);
    return true;
  }
  return false;
}

}  // namespace triskin::check
