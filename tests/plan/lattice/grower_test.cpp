// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the steps of the growth: what it tries, what it undoes, and what it charges before the wiring.
#include "plan/lattice/src/grower.hpp"

#include <gtest/gtest.h>

#include "nets.hpp"
#include "plan/lattice/src/net_price.hpp"
#include "shapes.hpp"

namespace triskin::lattice {
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
  mesh::Surface surface;
  Rules rules;
  std::vector<Sample> samples;
  Grower grower;
  LatticeMesh net;
  Dice random{1};
};

// Each module at the border used to be tried again with its corners clockwise: it then faces into the part, is never
// right, and was relaxed at full cost (13 % of the time on the torso).
TEST(Grower, tries_no_module_that_looks_into_the_part) {
  Growth growth(plane(300.0, 200.0));
  growth.grower.fill(growth.net, {}, growth.random, 100);
  EXPECT_GT(growth.net.size(), 100);
  EXPECT_EQ(growth.grower.refused[static_cast<std::size_t>(Refusal::kOutward)], 0);
}

// A module for which relaxing moved others is removed: the others are back at their places, and are found there.
TEST(Relaxer, puts_back_what_gave_way) {
  Growth growth(half_cylinder(120.0, 200.0));
  ASSERT_TRUE(growth.grower.try_seed(growth.net, {Vec3(15, 85, 120), Vec3(-15, 85, 120), Vec3(0, 111, 120)}) ||
              growth.grower.try_seed(growth.net, {Vec3(-15, 85, 120), Vec3(15, 85, 120), Vec3(0, 111, 120)}));
  growth.grower.grow(growth.net, {}, growth.random);
  growth.net.separate();
  ASSERT_GT(growth.net.size(), 20);
  // A corner is pulled aside: it returns, and its neighbours yield a little meanwhile.
  LatticeMesh net = growth.net;
  const int stretched = 5;
  const int corner = net.triangles()[stretched].vertex[0];
  net.edit_vertex(corner).point += Vec3(0, 2, 0);
  const NetVertex& vertex = net.vertices()[at(corner)];
  for (int k = 0; k < vertex.valence; ++k) net.fit(vertex.triangles[at(k)]);
  const LatticeMesh before = net;
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

// The upper border of the sheet rises and falls at random every 1.5 mm, up to 1.2 mm.
struct RaggedSheet {
  static constexpr int kColumns = 200;
  static constexpr double kWidth_mm = 300.0;
  std::vector<Vec3> border;
  Mesh mesh;

  explicit RaggedSheet(Dice& random) {
    for (int k = 0; k <= kColumns; ++k) border.emplace_back(kWidth_mm * k / kColumns, 60.0 + 1.2 * random.unit(), 0.0);
    mesh = grid_mesh(kColumns, 2, [&](double u, double v) {
      const Vec3& top = border[static_cast<std::size_t>(std::lround(u * kColumns))];
      return Vec3(top.x(), v * top.y(), 0.0);
    });
  }
  // Returns how far a point lies past the border; 0 on the sheet.
  [[nodiscard]] double past(const Vec3& p) const {
    const auto k = static_cast<std::size_t>(p.x() / kWidth_mm * kColumns);
    const double x = p.x() / kWidth_mm * kColumns - static_cast<double>(k);
    if (p.y() <= border[k].y() + x * (border[k + 1].y() - border[k].y())) return 0.0;
    double least = 1e9;
    for (std::size_t s = k > 3 ? k - 3 : 0; s < std::min(border.size() - 1, k + 4); ++s) {
      const Vec3 along = border[s + 1] - border[s];
      const double t = std::clamp((p - border[s]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (p - border[s] - t * along).norm());
    }
    return least;
  }
};

// The walk in steps misses an overhang between them, for which the layout would lose the module at the end. The test
// compares with points every 0.01 mm of a ragged border.
TEST(Rules, tell_an_overrun_between_the_steps_of_the_walk) {
  Dice random(5);
  const RaggedSheet sheet(random);
  Growth growth(sheet.mesh);
  const double allowed_mm = 0.97 * growth.limits.overrun_mm;  // The search keeps a margin.
  NearSurface near(growth.surface);
  int over = 0, missed_by_steps = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 a(60.0 + 150.0 * random.unit(), 59.7 + 1.4 * random.unit(), 0.0);
    const double turn = 0.04 * (random.unit() - 0.5);
    const Vec3 side(-kSide_mm * std::cos(turn), kSide_mm * std::sin(turn), 0.0);
    const Vec3 apex = a + 0.5 * side + kHeight_mm / kSide_mm * Vec3(-side.y(), side.x(), 0.0);
    LatticeMesh net(sheet.mesh.vertices, 0.0);
    const int module = add_island(net, std::array{a, Vec3(a + side), apex});
    double worst = 0.0;
    for (int step = 0; step <= 3000; ++step) worst = std::max(worst, sheet.past(a + step / 3000.0 * side));
    if (std::abs(worst - allowed_mm) < 0.03) continue;  // The value is found to 0.02 mm.
    EXPECT_EQ(growth.rules.exceeds_overrun(near, net.triangles()[at(module)]), worst > allowed_mm)
        << k << ": " << worst << " mm";
    over += worst > allowed_mm ? 1 : 0;
    std::vector<Pair> pairs;
    std::vector<KnownSides> known;
    if (worst > allowed_mm && growth.rules.evaluate(near, net, {module}, pairs, known) == Refusal::kNone)
      ++missed_by_steps;
  }
  EXPECT_GT(over, 100);
  EXPECT_LT(over, 280);
  EXPECT_GT(missed_by_steps, 0);
}

// Before a layout is kept it loses modules that overhang too far; fixed modules stay.
TEST(Grower, removes_what_stands_over_the_border_too_far_but_no_fixed_module) {
  Growth growth(plane(300.0, 60.0));
  const auto add = [&](double x, double y) {
    return add_island(growth.net, std::array{Vec3(x + kSide_mm, y, 0.0), Vec3(x, y, 0.0),
                                             Vec3(x + 0.5 * kSide_mm, y - kHeight_mm, 0.0)});
  };
  const int within = add(30.0, 60.4), over = add(100.0, 60.6), fixed = add(170.0, 60.6);
  const Triangle corners = growth.net.triangles()[at(fixed)].rigid;
  growth.net.pin(fixed, corners);
  EXPECT_TRUE(growth.grower.remove_overrunning(growth.net));
  EXPECT_TRUE(growth.net.used(within));
  EXPECT_FALSE(growth.net.used(over));
  EXPECT_TRUE(growth.net.used(fixed));
  EXPECT_FALSE(growth.grower.remove_overrunning(growth.net));
}

// New modules of any kind are added: at open sides, at samples, at the border, beside others. A module slides much less
// than 10 mm after it was tried at its place; without the zone the sheet is filled.
TEST(Grower, adds_modules_in_its_zone_only) {
  constexpr double kSlide_mm = 10.0;
  Growth free(plane(240.0, 240.0)), confined(plane(240.0, 240.0));
  const Zone zone{{{Vec3::UnitX(), 120.0}, {-Vec3::UnitY(), -100.0}}};
  confined.grower.confine(zone);
  for (Growth* growth : {&free, &confined}) {
    growth->grower.fill(growth->net, {}, growth->random, 400);
    growth->grower.grow(growth->net, {}, growth->random);
  }
  EXPECT_GT(confined.net.size(), 8);
  EXPECT_GT(free.net.size(), 3 * confined.net.size());
  for (const NetTriangle& t : confined.net.triangles()) {
    if (t.island < 0) continue;
    EXPECT_GT(t.center.x(), 120.0 - kSlide_mm);
    EXPECT_LT(t.center.y(), 100.0 + kSlide_mm);
  }
}

// The jumpers are Σ p(nᵢ) − p(n), p(n) = max(1, n / 16 + 15 / 32). 32, 8 and 1 modules: 79/32, 1 and 1 pieces;
// together 41/16 + 15/32 = 97/32 controllers and (79 + 32 + 32 − 97)/32 = 46/32 jumpers. Apart: 143/32 controllers,
// none.
TEST(RelaxedPrice, counts_jumpers_as_the_wiring_does) {
  const Price price{.controller = 2.0, .jumper = 0.25, .island = 0.1};
  EXPECT_DOUBLE_EQ(relaxed_price({32, 8, 1}, {0, 0, 0}, price).sum(), 2.0 * 97 / 32 + 0.25 * 46 / 32 + 0.3);
  EXPECT_DOUBLE_EQ(relaxed_price({32, 8, 1}, {0, 1, 2}, price).sum(), 2.0 * 143 / 32 + 0.3);
  EXPECT_DOUBLE_EQ(relaxed_price({32, 8, 1}, {0, 0, 0}, price).controllers, 2.0 * 97 / 32);
  EXPECT_DOUBLE_EQ(relaxed_price({12}, {0}, price).sum(), 2.0 * 39 / 32 + 0.1);
}

// The jumpers are Σ ⌈nᵢ / 16⌉ − ⌈n / 16⌉. 90 and 6 modules are divided into 16 · 5 + 10 and 6: six
// controllers, seven pieces, one jumper. One module more needs a seventh controller. Apart: the same seven, no jumper.
TEST(RoundedPrice, counts_whole_controllers) {
  const Price price{.controller = 2.0, .jumper = 0.25, .island = 0.1};
  EXPECT_DOUBLE_EQ(rounded_price({90, 6}, {0, 0}, price), 2.0 * 6 + 0.25 + 0.2);
  EXPECT_DOUBLE_EQ(rounded_price({91, 6}, {0, 0}, price), 2.0 * 7 + 0.2);
  EXPECT_DOUBLE_EQ(rounded_price({90, 6}, {0, 1}, price), 2.0 * 7 + 0.2);
  EXPECT_DOUBLE_EQ(rounded_price({}, {}, price), 0.0);
}

}  // namespace
}  // namespace triskin::lattice
