// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of the growth: what it tries, what it takes back, and what it charges before the wiring.
#include "../../host/geometry/src/surface_lattice/grower.hpp"  // no public header

#include <gtest/gtest.h>

#include "../../host/geometry/src/surface_lattice/net_price.hpp"
#include "shapes.hpp"

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kNoLift_mm = 0.0;

struct Growth {
  explicit Growth(const Mesh& mesh)
      : surface(mesh),
        rules(surface, limits),
        samples(spread_samples(surface, 50.0, 1)),
        grower(surface, rules, samples, kNoLift_mm, Grower::Clock::time_point::max()),
        net(mesh.vertices, 0.0) {}

  LayoutLimits limits;
  Surface surface;
  Rules rules;
  std::vector<Sample> samples;
  Grower grower;
  LatticeNet net;
  Dice random{1};
};

// Each module at the border used to be tried again with its corners clockwise: it then looks into the part, is never
// right, and had been relaxed at full cost (13 % of the time on the torso).
TEST(Grower, tries_no_module_that_looks_into_the_part) {
  Growth growth(plane(300.0, 200.0));
  growth.grower.fill(growth.net, {}, growth.random, 100);
  EXPECT_GT(growth.net.size(), 100);
  EXPECT_EQ(growth.grower.refused[static_cast<std::size_t>(Refusal::kOutward)], 0);
}

// A module that relaxing moved others for goes: they are where they were, and are found there.
TEST(Relaxer, puts_back_what_gave_way) {
  Growth growth(half_cylinder(120.0, 200.0));
  ASSERT_TRUE(growth.grower.try_seed(growth.net, {Vec3(15, 85, 120), Vec3(-15, 85, 120), Vec3(0, 111, 120)}) ||
              growth.grower.try_seed(growth.net, {Vec3(-15, 85, 120), Vec3(15, 85, 120), Vec3(0, 111, 120)}));
  growth.grower.grow(growth.net, {}, growth.random);
  growth.net.separate();
  ASSERT_GT(growth.net.size(), 20);
  // A corner is drawn aside: it goes back, and its neighbours give way a little meanwhile.
  LatticeNet net = growth.net;
  const int stretched = 5;
  const int corner = net.triangles()[stretched].vertex[0];
  net.edit_vertex(corner).point += Vec3(0, 2, 0);
  const NetVertex& vertex = net.vertices()[at(corner)];
  for (int k = 0; k < vertex.valence; ++k) net.fit(vertex.triangles[at(k)]);
  const LatticeNet before = net;
  NearSurface near(growth.surface);
  Relaxer relaxer(near, kNoLift_mm);
  ASSERT_TRUE(relaxer.relax(net, stretched, 60.0, 5));
  ASSERT_FALSE(relaxer.changed().empty());
  const Vec3 place = before.center(stretched);
  EXPECT_NE(net.signature(place, 45.0), before.signature(place, 45.0));
  relaxer.undo(net);
  for (std::size_t t = 0; t < net.triangles().size(); ++t) {
    EXPECT_EQ(net.triangles()[t].rigid, before.triangles()[t].rigid) << t;
    EXPECT_EQ(net.center(static_cast<int>(t)), before.center(static_cast<int>(t))) << t;
  }
  EXPECT_EQ(net.signature(place, 45.0), before.signature(place, 45.0));
}

// Σ p(nᵢ) − p(n) jumpers, p(n) = max(1, n / 16 + 15 / 32). 32, 8 and 1 modules: 79/32, 1 and 1 pieces; together
// 41/16 + 15/32 = 97/32 controllers and (79 + 32 + 32 − 97)/32 = 46/32 jumpers. Apart: 143/32 controllers, none.
TEST(RelaxedPrice, counts_jumpers_as_the_wiring_does) {
  const Price price{.controller = 2.0, .jumper = 0.25, .island = 0.1};
  EXPECT_DOUBLE_EQ(relaxed_price({32, 8, 1}, {0, 0, 0}, price), 2.0 * 97 / 32 + 0.25 * 46 / 32 + 0.3);
  EXPECT_DOUBLE_EQ(relaxed_price({32, 8, 1}, {0, 1, 2}, price), 2.0 * 143 / 32 + 0.3);
  EXPECT_DOUBLE_EQ(relaxed_price({12}, {0}, price), 2.0 * 39 / 32 + 0.1);
}

}  // namespace
}  // namespace triskin::geometry::surface_lattice
