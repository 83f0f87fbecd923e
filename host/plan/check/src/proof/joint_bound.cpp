// SPDX-License-Identifier: GPL-3.0-or-later
#include "joint_bound.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "core_search.hpp"

namespace triskin::check {
namespace {

constexpr double kOpposed = -0.998;      // Two normals with a smaller cosine count as opposed.
constexpr double kMinMultiplier = 0.04;  // Needs of a triple with a smaller multiplier are ignored.
constexpr int kMaxHalvings = 16;         // Bounds the halvings of a region's angles.
constexpr std::size_t kMaxNeeds = 30;    // More needs of a module would give too many triples.
constexpr int kMaxDrops = 3;             // The searches for cores are as many as 4^drops.
constexpr std::size_t kMaxInGroup = 16;  // A member of a group is compared with all others.
constexpr std::ptrdiff_t kNearest = 4;   // A module is compared with this many to either side at an opposed edge.
constexpr std::size_t kSamples = kSampledAngles;

double turn_between(const Need& a, const Need& b) {
  return middle(a.normal.x) * middle(b.normal.y) - middle(a.normal.y) * middle(b.normal.x);
}
bool opposed(const Need& a, const Need& b) {
  return a.by_side == b.by_side && a.edge != b.edge &&
         middle(a.normal.x) * middle(b.normal.x) + middle(a.normal.y) * middle(b.normal.y) < kOpposed;
}
bool opposed(const NeedGroup& a, const NeedGroup& b) {
  return a.by_side == b.by_side && a.edge != b.edge &&
         a.least.normal_x * b.least.normal_x + a.least.normal_y * b.least.normal_y < kOpposed;
}
bool faces(const SampledNeed& a, const SampledNeed& b) {
  return a.at.normal_x * b.at.normal_x + a.at.normal_y * b.at.normal_y < kOpposed;
}
IntervalPoint times(const Interval& factor, const IntervalPoint& p) {
  return {factor * p.x, factor * p.y};
}
double sum_at(std::size_t k, std::span<const SampledNeed* const> needs, std::span<const double> multipliers) {
  double sum = 0.0;
  for (std::size_t n = 0; n < needs.size(); ++n) sum += multipliers[n] * needs[n]->at.excess_mm[k];
  return sum;
}

}  // namespace

JointBound::JointBound(const MotionRegion& region, const CandidateList& list) : region_(region) {
  std::vector<Need> needs;
  for (const Candidate& module : list.tiles) {
    needs.clear();
    for (std::uint32_t k = module.first; k < module.first + module.count; ++k)
      region.add_needs(module, list.edges[k], needs);
    Needs& sampled = needs_.emplace_back();
    for (const Need& need : needs) sampled.push_back({need, region.samples(need)});
    centers_.push_back(module.center);
  }
  dead_.assign(list.tiles.size(), false);
}

bool JointBound::holds(CandidateList& list, int allowed) {
  int alive = 0;
  for (std::size_t k = 0; k < needs_.size(); ++k) {
    dead_[k] = never_inside(k);
    alive += dead_[k] ? 0 : 1;
    // Pairs leave at least half of the modules.
    if (list.certain + alive - alive / 2 > allowed) break;
  }
  drop_dead(list);
  const int wanted = list.bound() - allowed;
  if (wanted <= 0) return true;
  partner_.assign(needs_.size(), -1);
  if (wanted <= kMaxDrops + 1 && no_set_without(wanted - 1, false)) return true;
  find_candidates();
  const auto with_any = std::ranges::count_if(candidates_, [](const auto& c) { return !c.empty(); });
  if (with_any >= wanted && 2 * wanted <= static_cast<int>(list.tiles.size()) && greedy_pairs(wanted) >= wanted)
    return true;
  const int pairs = with_any > 0 ? most_pairs() : 0;
  if (pairs >= wanted || excluded_in_groups() >= wanted) return true;
  return pairs > 0 && wanted - pairs <= kMaxDrops + 1 && no_set_without(wanted - pairs - 1, true);
}

// Returns how many modules are left out because of groups in which each module excludes each other, so that one of a
// group lies inside at most: groups of modules with needs at two opposed edges, and the pairs of other modules.
int JointBound::excluded_in_groups() const {
  struct Member {
    double along_mm;
    std::size_t module;
  };
  std::vector<Member> members;
  std::vector<bool> is_member(needs_.size(), false);
  for (std::size_t k = 0; k < needs_.size(); ++k) {
    if (dead_[k] || needs_[k].empty()) continue;
    const SampledNeed& first = needs_[k].front();
    if (std::ranges::none_of(needs_[k], [&](const SampledNeed& n) { return faces(first, n); })) continue;
    const double sign = first.at.normal_y < 0.0 || (first.at.normal_y == 0.0 && first.at.normal_x > 0.0) ? 1.0 : -1.0;
    members.push_back({region_.along_mm(-sign * first.at.normal_y, sign * first.at.normal_x, centers_[k]), k});
    is_member[k] = true;
  }
  std::ranges::sort(members, {}, [](const Member& m) { return std::pair(m.along_mm, m.module); });
  std::vector<std::vector<std::size_t>> groups;
  for (const Member& member : members) {
    const auto fitting = std::ranges::find_if(groups, [&](const std::vector<std::size_t>& group) {
      return group.size() < kMaxInGroup &&
             std::ranges::all_of(group, [&](std::size_t other) { return exclude_each_other(other, member.module); });
    });
    if (fitting == groups.end())
      groups.push_back({member.module});
    else
      fitting->push_back(member.module);
  }
  int excluded = static_cast<int>(members.size() - groups.size());
  for (std::size_t k = 0; k < partner_.size(); ++k) {
    if (partner_[k] < 0 || is_member[k]) continue;
    const auto other = static_cast<std::size_t>(partner_[k]);
    if (other > k && !is_member[other]) ++excluded;
  }
  return excluded;
}

bool JointBound::exclude_each_other(std::size_t a, std::size_t b) const {
  CoreSearch search(region_, needs_.size());
  for (const std::size_t module : {a, b}) {
    for (const SampledNeed& n : needs_[module]) search.add(module, n.need);
  }
  return search.contradictory(0);
}

// Tells whether the modules that are alive, or of them those without a partner, never lie inside together whichever
// `drops` of them are left out.
bool JointBound::no_set_without(int drops, bool only_single) const {
  CoreSearch search(region_, needs_.size());
  for (std::size_t k = 0; k < needs_.size(); ++k) {
    if (dead_[k] || (only_single && partner_[k] >= 0)) continue;
    for (const SampledNeed& n : needs_[k]) search.add(k, n.need);
  }
  return search.contradictory(drops);
}

bool JointBound::never_inside(std::size_t module) {
  const Needs& needs = needs_[module];
  if (std::ranges::any_of(needs, [&](const SampledNeed& n) { return region_.never_met(n.need); })) return true;
  if (needs.size() < 2 || needs.size() > kMaxNeeds) return false;
  sums_.clear();
  add_worst_pairs(needs, needs);
  if (excluded_everywhere()) return true;
  sums_.clear();
  add_pairs(needs, needs);
  add_triples(needs);
  return excluded_everywhere();
}

void JointBound::add_pairs(const Needs& a, const Needs& b) {
  for (const SampledNeed& p : a) {
    for (const SampledNeed& q : b) {
      if (opposed(p.need, q.need)) add_sum(std::array{&p, &q}, std::array{1.0, 1.0});
    }
  }
}

// Adds the pair with the least sum at each of the sampled angles.
void JointBound::add_worst_pairs(const Needs& a, const Needs& b) {
  std::array<std::array<const SampledNeed*, 2>, kSamples> worst{};
  std::array<double, kSamples> least{};
  for (const SampledNeed& p : a) {
    for (const SampledNeed& q : b) {
      if (!opposed(p.need, q.need)) continue;
      for (std::size_t k = 0; k < kSamples; ++k) {
        const double sum = p.at.excess_mm[k] + q.at.excess_mm[k];
        if (!(sum < least[k])) continue;
        least[k] = sum;
        worst[k] = {&p, &q};
      }
    }
  }
  for (std::size_t k = 0; k < kSamples; ++k) {
    if (worst[k][0] != nullptr && std::ranges::find(worst.begin(), worst.begin() + k, worst[k]) == worst.begin() + k)
      add_sum(worst[k], std::array{1.0, 1.0});
  }
}

void JointBound::add_triples(const Needs& needs) {
  for (std::size_t a = 0; a < needs.size(); ++a) {
    for (std::size_t b = a + 1; b < needs.size(); ++b) {
      const Need &p = needs[a].need, &q = needs[b].need;
      const double third = turn_between(p, q);
      if (p.edge == q.edge || p.by_side != q.by_side || std::abs(third) < kMinMultiplier) continue;
      for (std::size_t c = b + 1; c < needs.size(); ++c) {
        const Need& r = needs[c].need;
        if (r.edge == p.edge || r.edge == q.edge || r.by_side != p.by_side) continue;
        const double first = turn_between(q, r) / third, second = turn_between(r, p) / third;
        if (first < kMinMultiplier || second < kMinMultiplier) continue;
        add_sum(std::array{&needs[a], &needs[b], &needs[c]}, std::array{first, second, 1.0});
      }
    }
  }
}

// Adds the sum of multiplier * need, unless it excludes none of the sampled angles. Points are relative to the last
// one's: the rest of the normals leaves a part of the translation, bounded by the farthest point of the region.
void JointBound::add_sum(std::span<const SampledNeed* const> needs, std::span<const double> multipliers) {
  bool excludes_any = false;
  for (std::size_t k = 0; k < kSamples && !excludes_any; ++k) excludes_any = sum_at(k, needs, multipliers) < 0.0;
  if (!excludes_any) return;
  AngleNeed sum;
  IntervalPoint rest{0.0, 0.0};
  const Need& last = needs.back()->need;
  const Interval way(last.by_side ? -1.0 : 1.0);  // A side turns the edge's end, a line turns the module back.
  for (std::size_t k = 0; k < needs.size(); ++k) {
    const Need& need = needs[k]->need;
    const IntervalPoint normal = times(multipliers[k], need.normal), from_last = need.point - last.point;
    sum.cosine = sum.cosine + dot(normal, from_last);
    sum.sine = sum.sine + way * (normal.x * from_last.y - normal.y * from_last.x);
    sum.constant = sum.constant + Interval(multipliers[k]) * need.constant;
    rest = rest + normal;
  }
  const double left = length_of(rest.x.magnitude(), rest.y.magnitude()) * last.farthest_mm * (1.0 + 1e-15);
  sum.constant = sum.constant + Interval(-left, left);
  sums_.push_back(sum);
}

bool JointBound::excluded_everywhere() const {
  const auto& [low, high] = region_.angles();
  return !sums_.empty() && excluded(low, high, kMaxHalvings);
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

bool JointBound::contradictory(std::size_t a, std::size_t b) {
  sums_.clear();
  add_worst_pairs(needs_[a], needs_[b]);
  if (excluded_everywhere()) return true;
  sums_.clear();
  add_pairs(needs_[a], needs_[b]);
  return excluded_everywhere();
}

// Finds the pairs of modules that may contradict each other. The sum of two needs changes with the angle by the
// distance between the modules along the edges, so that modules far apart rarely contradict each other and only the
// nearest ones at the opposed edge are compared.
void JointBound::find_candidates() {
  candidates_.assign(needs_.size(), {});
  std::vector<NeedGroup> sorted = groups();
  std::ranges::sort(sorted, {}, [](const NeedGroup& g) {
    return std::tuple(g.by_side, g.edge, g.least.normal_x, g.least.normal_y, g.along_mm, g.module);
  });
  std::vector<std::span<const NeedGroup>> edges;
  for (std::size_t first = 0, last = 0; first < sorted.size(); first = last) {
    while (last < sorted.size() && sorted[last].at_same_edge(sorted[first])) ++last;
    edges.emplace_back(sorted.data() + first, last - first);
  }
  for (std::size_t a = 0; a < edges.size(); ++a) {
    for (std::size_t b = a + 1; b < edges.size(); ++b) {
      if (opposed(edges[a].front(), edges[b].front())) compare(edges[a], edges[b]);
    }
  }
}

std::vector<NeedGroup> JointBound::groups() const {
  std::vector<NeedGroup> groups;
  for (std::size_t module = 0; module < needs_.size(); ++module) {
    if (dead_[module]) continue;
    const std::size_t first = groups.size();
    for (const auto& [need, at] : needs_[module]) {
      const NeedGroup group{module, need.by_side, need.edge,
                            region_.along_mm(-at.normal_y, at.normal_x, centers_[module]), at};
      if (groups.size() == first || !groups.back().at_same_edge(group)) {
        groups.push_back(group);
        continue;
      }
      for (std::size_t k = 0; k < kSamples; ++k)
        groups.back().least.excess_mm[k] = std::min(groups.back().least.excess_mm[k], at.excess_mm[k]);
    }
  }
  return groups;
}

void JointBound::compare(std::span<const NeedGroup> here, std::span<const NeedGroup> there) {
  for (const NeedGroup& a : here) {
    const auto facing = std::ranges::lower_bound(there, -a.along_mm, {}, &NeedGroup::along_mm);
    const auto first = facing - std::min<std::ptrdiff_t>(kNearest, facing - there.begin()),
               last = facing + std::min<std::ptrdiff_t>(kNearest, there.end() - facing);
    pairs_compared_ += last - first;
    for (auto b = first; b != last; ++b) {
      // Modules that may both lie inside at the middle angle do not contradict each other.
      constexpr std::size_t kMiddle = kSamples / 2;
      if (a.module == b->module || a.least.excess_mm[kMiddle] + b->least.excess_mm[kMiddle] >= 0.0) continue;
      candidates_[a.module].push_back(b->module);
      candidates_[b->module].push_back(a.module);
    }
  }
}

// Takes disjoint contradictory pairs as they come, until there are as many as wanted.
int JointBound::greedy_pairs(int wanted) {
  partner_.assign(needs_.size(), -1);
  int pairs = 0;
  for (std::size_t a = 0; a < needs_.size() && pairs < wanted; ++a) {
    for (const std::size_t b : candidates_[a]) {
      if (partner_[a] >= 0) break;
      if (partner_[b] >= 0 || !contradictory(a, b)) continue;
      partner_[a] = static_cast<int>(b);
      partner_[b] = static_cast<int>(a);
      ++pairs;
    }
  }
  return pairs;
}

void JointBound::find_rivals() {
  rivals_.assign(needs_.size(), {});
  for (std::size_t a = 0; a < needs_.size(); ++a) {
    for (const std::size_t b : candidates_[a]) {
      if (b < a || !contradictory(a, b)) continue;
      rivals_[a].push_back(b);
      rivals_[b].push_back(a);
    }
  }
}

void JointBound::colour_rivals() {
  colour_.assign(needs_.size(), 0);
  for (std::size_t root = 0; root < needs_.size(); ++root) {
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
}

// Each pair holds at most one module. Finds them by augmenting paths between the two colours of the rivals.
int JointBound::most_pairs() {
  find_rivals();
  colour_rivals();
  partner_.assign(needs_.size(), -1);
  asked_for_.assign(needs_.size(), 0);
  int pairs = 0;
  for (std::size_t k = 0; k < needs_.size(); ++k) {
    if (colour_[k] == 1 && !rivals_[k].empty() && rematch(k, k)) ++pairs;
  }
  return pairs;
}

bool JointBound::rematch(std::size_t module, std::size_t root) {
  for (const std::size_t rival : rivals_[module]) {
    if (colour_[rival] == colour_[module] || asked_for_[rival] == root + 1) continue;
    asked_for_[rival] = root + 1;
    if (partner_[rival] >= 0 && !rematch(static_cast<std::size_t>(partner_[rival]), root)) continue;
    partner_[rival] = static_cast<int>(module);
    partner_[module] = static_cast<int>(rival);
    return true;
  }
  return false;
}

}  // namespace triskin::check
