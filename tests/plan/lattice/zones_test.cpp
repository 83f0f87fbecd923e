// SPDX-License-Identifier: GPL-3.0-or-later
// Several threads change a net, each in its zone. The zones' nets and the merged net must agree about their triangles;
// the conflicts are made by hand.
#include "plan/lattice/src/zones.hpp"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "random_net.hpp"

namespace triskin::lattice {
namespace {

// A module is identified by its place, and each of its joints by the place of the other module.
using Place = std::tuple<double, double>;
Place place_of(const LatticeMesh& net, int t) {
  return {net.center(t).x(), net.center(t).y()};
}
struct Seen {
  std::multiset<Place> modules;
  std::multiset<std::pair<Place, Place>> joints;
  void add(const LatticeMesh& net, int t) {
    modules.insert(place_of(net, t));
    for (int s = 0; s < 3; ++s) {
      if (const int n = net.neighbour(t, s); n >= 0) joints.emplace(place_of(net, t), place_of(net, n));
    }
  }
};

LatticeMesh empty_net() {
  return {{Vec3(0, 0, 0), Vec3(kSheet_mm, kSheet_mm, 0)}, 0.0};
}

class Zones : public testing::TestWithParam<int> {};

TEST_P(Zones, hold_as_many_modules_each_and_lie_apart) {
  RandomNet random(7);
  for (int k = 0; k < 200; ++k) random.seed();
  random.net.separate();
  const std::vector<Zone> zones = divide(random.net, GetParam(), random.random);
  ASSERT_EQ(static_cast<int>(zones.size()), GetParam());
  std::vector<std::vector<Vec3>> inside(zones.size());
  for (const int t : used_triangles(random.net)) {
    for (std::size_t z = 0; z < zones.size(); ++z) {
      if (zones[z].holds(random.net.center(t))) inside[z].push_back(random.net.center(t));
    }
  }
  for (std::size_t a = 0; a < zones.size(); ++a) {
    EXPECT_LE(static_cast<int>(inside[a].size()), 200 / GetParam() + 1);
    for (std::size_t b = 0; b < a; ++b) {
      for (const Vec3& p : inside[a]) {
        for (const Vec3& q : inside[b]) EXPECT_GE((p - q).norm(), 2.0 * kHalfBand_mm);
      }
    }
  }
  const std::size_t most = GetParam() == 1 ? 200 : 200 / at(GetParam()) / 5;  // The band is 60 mm of 400.
  EXPECT_GE(inside[0].size(), most);
}

// Each zone makes random steps in twelve rounds. Every triangle outside the zone stays unchanged; the merged net must
// agree with the zone's net about its own triangles, and with both about the others.
TEST_P(Zones, are_merged_with_every_change_of_each) {
  RandomNet random(static_cast<std::uint64_t>(GetParam()));
  for (int k = 0; k < 6; ++k) random.seed();
  random.net.separate();
  for (int k = 0; k < 12; ++k) random.step();
  int changed = 0, kept_numbers = 0;
  for (int round = 0; round < 12; ++round) {
    const std::vector<Zone> zones = divide(random.net, GetParam(), random.random);
    std::vector<RandomNet> parts;
    std::vector<std::vector<int>> pinned;
    for (const Zone& zone : zones) {
      RandomNet part(static_cast<std::uint64_t>(random.random.below(1000)));
      part.net = random.net;
      part.zone = zone;
      pinned.push_back(pin_outside(part.net, zone));
      for (int k = 0; k < 3; ++k) part.step();
      for (const int t : pinned.back())
        EXPECT_EQ(part.net.triangles()[at(t)].rigid, random.net.triangles()[at(t)].rigid);
      parts.push_back(std::move(part));
    }
    std::vector<ZoneNet> nets;
    Seen expected, seen;
    for (std::size_t z = 0; z < zones.size(); ++z) {
      nets.push_back({parts[z].net, pinned[z]});
      for (const int t : used_triangles(parts[z].net)) {
        if (!parts[z].net.triangles()[at(t)].is_fixed) expected.add(parts[z].net, t);
      }
    }
    std::set<int> in_no_zone;
    for (const int t : used_triangles(random.net)) {
      if (std::ranges::none_of(zones, [&](const Zone& z) { return z.holds(random.net.center(t)); }))
        in_no_zone.insert(t);
    }
    for (const int t : in_no_zone) expected.modules.insert(place_of(random.net, t));
    const LatticeMesh merged = merge_zones(empty_net(), nets);
    ASSERT_NO_FATAL_FAILURE(expect_right(merged, random.place())) << "round " << round;
    for (const int t : used_triangles(merged)) {
      EXPECT_FALSE(merged.triangles()[at(t)].is_fixed);
      if (!in_no_zone.contains(t)) {
        seen.add(merged, t);
      } else {
        seen.modules.insert(place_of(merged, t));
        EXPECT_EQ(merged.triangles()[at(t)].rigid, random.net.triangles()[at(t)].rigid);
      }
      kept_numbers +=
          at(t) < random.net.triangles().size() && random.net.used(t) && merged.center(t) == random.net.center(t);
    }
    EXPECT_EQ(seen.modules, expected.modules) << "round " << round;
    EXPECT_EQ(seen.joints, expected.joints) << "round " << round;
    for (const NetVertex& v : merged.vertices()) EXPECT_FALSE(v.used && v.is_fixed);
    changed += merged.size() != random.net.size();
    random.net = merged;
  }
  EXPECT_GT(changed, 3);
  EXPECT_GT(kept_numbers, 100);
}
INSTANTIATE_TEST_SUITE_P(Count, Zones, testing::Values(1, 2, 3, 5));

// Two islands, 200 mm apart, are in zones at both sides of x = 0.
struct TwoZones {
  LatticeMesh started = empty_net(), left, right;
  std::vector<Zone> zones{{{{-Vec3::UnitX(), kHalfBand_mm}}}, {{{Vec3::UnitX(), kHalfBand_mm}}}};
  std::vector<int> pinned_left, pinned_right;
  void part() {
    left = right = started;
    pinned_left = pin_outside(left, zones[0]);
    pinned_right = pin_outside(right, zones[1]);
  }
  [[nodiscard]] LatticeMesh merged() const {
    return merge_zones(empty_net(), {{left, pinned_left}, {right, pinned_right}});
  }
};

TEST(MergedZones, hold_a_tile_of_a_lattice_once) {
  TwoZones two;
  // All are one island, although its modules lie far apart: its tiles 0/0/up … are in a row, the middle ones in the
  // band.
  int last = two.started.add_vertex({-90.0, 0, 0}, Vec3::UnitZ(), 0, 0);
  int other = two.started.add_vertex({-75.0, kHeight_mm, 0}, Vec3::UnitZ(), 0, 1);
  const int island = two.started.new_island();
  for (int k = 0; k < 6; ++k) {
    const int next = two.started.add_vertex({-60.0 + 30.0 * k, 0, 0}, Vec3::UnitZ(), k + 1, 0);
    two.started.add_triangle(island, {k, 0, true}, {last, next, other});
    const int above = two.started.add_vertex({-45.0 + 30.0 * k, kHeight_mm, 0}, Vec3::UnitZ(), k + 1, 1);
    two.started.add_triangle(island, {k, 0, false}, {above, other, next});
    last = next;
    other = above;
  }
  two.started.separate();
  ASSERT_EQ(two.started.islands(), 1);
  two.part();
  // Both zones claim tile (9, 9), so labels decide, not places.
  const auto claim = [&](LatticeMesh& net, double x) {
    const int t = [&] {
      for (const int u : used_triangles(net)) {
        if (std::abs(net.center(u).x() - x) < 1.0 && !net.triangles()[at(u)].is_fixed) return u;
      }
      return -1;
    }();
    ASSERT_GE(t, 0);
    int side = 0;
    while (net.neighbour(t, side) >= 0) ++side;
    const std::array<int, 3> v = net.triangles()[at(t)].vertex;
    const int apex = net.add_vertex(net.center(t) + Vec3(0, -40, 0), Vec3::UnitZ(), 9, 9);
    net.add_triangle(island, {9, 9, true}, {v[at((side + 1) % 3)], v[at(side)], apex});
    net.separate();
  };
  claim(two.left, -75.0);
  claim(two.right, 75.0);
  const LatticeMesh merged = two.merged();
  expect_right(merged, Vec3::Zero());
  EXPECT_EQ(merged.size(), two.started.size() + 1);
  std::vector<double> claimed_at;
  for (const int t : used_triangles(merged)) {
    if (merged.triangles()[at(t)].tile == Tile{9, 9, true}) claimed_at.push_back(merged.center(t).x());
  }
  ASSERT_EQ(claimed_at.size(), 1U);
  EXPECT_LT(claimed_at[0], 0.0);
}

TEST(MergedZones, drop_what_slid_within_reach_of_another_zone) {
  TwoZones two;
  add_island(two.started, Vec3(-100, 0, 0));
  add_island(two.started, Vec3(100, 0, 0));
  two.started.separate();
  two.part();
  add_island(two.left, Vec3(-30, 0, 0));    // The centre is at x = −15.
  add_island(two.right, Vec3(-1, 0, 0));    // The centre is at x = 14, which is 29 mm away.
  add_island(two.right, Vec3(10, 100, 0));  // This island concerns no other zone.
  const LatticeMesh merged = two.merged();
  expect_right(merged, Vec3::Zero());
  EXPECT_EQ(merged.size(), 4);
  for (const int t : used_triangles(merged)) EXPECT_NE(merged.center(t).x(), 14.0);
}

TEST(MergedZones, leave_kept_modules_fixed) {
  TwoZones two;
  const int kept = add_island(two.started, Vec3(-10, 0, 0));
  two.started.pin(kept, two.started.triangles()[at(kept)].rigid);
  add_island(two.started, Vec3(-100, 0, 0));
  two.started.separate();
  two.part();
  const LatticeMesh merged = two.merged();
  EXPECT_EQ(merged.size(), 2);
  EXPECT_TRUE(merged.triangles()[at(kept)].is_fixed);
  EXPECT_EQ(merged.triangles()[at(kept)].rigid, two.started.triangles()[at(kept)].rigid);
  EXPECT_EQ(std::ranges::count_if(merged.triangles(), &NetTriangle::is_fixed), 1);
}

}  // namespace
}  // namespace triskin::lattice
