// SPDX-License-Identifier: GPL-3.0-or-later

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include "shapes.hpp"
#include "support/covers.hpp"
#include "triskin/base/error.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::lattice {
namespace {

// Clips one triangle by the other in the mean plane and returns the area of overlap, by code that shares nothing with
// the search.
double overlap_area(const PlacedModule& a, const PlacedModule& b) {
  if ((center_of(a) - center_of(b)).norm() > 36.0 || normal_of(a).dot(normal_of(b)) < 0) return 0.0;
  const Vec3 n = (normal_of(a) + normal_of(b)).normalized(), x = n.unitOrthogonal(), y = n.cross(x);
  const auto flat = [&](const Vec3& p) { return Vec2(p.dot(x), p.dot(y)); };
  std::vector<Vec2> poly{flat(a.corner_mm[0]), flat(a.corner_mm[1]), flat(a.corner_mm[2])};
  for (int s = 0; s < 3; ++s) {
    const Vec2 p = flat(b.corner_mm[at(s)]), d = flat(b.corner_mm[at((s + 1) % 3)]) - p;
    const auto side = [&](const Vec2& q) { return d.x() * (q - p).y() - d.y() * (q - p).x(); };
    std::vector<Vec2> cut;
    for (std::size_t k = 0; k < poly.size(); ++k) {
      const Vec2 u = poly[k], v = poly[(k + 1) % poly.size()];
      if (side(u) >= 0) cut.push_back(u);
      if ((side(u) < 0) != (side(v) < 0)) cut.push_back(u + (v - u) * (side(u) / (side(u) - side(v))));
    }
    poly = cut;
  }
  double area = 0.0;
  for (std::size_t k = 0; k < poly.size(); ++k) {
    const Vec2 &u = poly[k], &v = poly[(k + 1) % poly.size()];
    area += 0.5 * (u.x() * v.y() - u.y() * v.x());
  }
  return area;
}

void expect_joints(const ModuleLayout& layout, const LayoutLimits& limits) {
  std::set<std::pair<int, Tile>> tiles;
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    const PlacedModule& m = layout.modules[k];
    EXPECT_TRUE(tiles.emplace(m.island, m.tile).second) << "module " << k << " shares its tile";
    for (int s = 0; s < 3; ++s) {
      EXPECT_NEAR((m.corner_mm[at((s + 1) % 3)] - m.corner_mm[at(s)]).norm(), 30.0, 1e-9);
      if (m.neighbour[at(s)] < 0) continue;
      const PlacedModule& o = layout.modules[at(m.neighbour[at(s)])];
      const TileSide there = across(m.tile, s);
      ASSERT_EQ(o.tile, there.tile);
      EXPECT_EQ(o.island, m.island);
      EXPECT_EQ(o.neighbour[at(there.side)], static_cast<int>(k));
      const double gap = std::max((m.corner_mm[at(s)] - o.corner_mm[at((there.side + 1) % 3)]).norm(),
                                  (m.corner_mm[at((s + 1) % 3)] - o.corner_mm[at(there.side)]).norm());
      EXPECT_LE(gap, limits.hinge_gap_mm);
      EXPECT_LE(std::acos(std::min(1.0, normal_of(m).dot(normal_of(o)))), limits.fold_rad);
    }
  }
}

void expect_valid(const mesh::Surface& surface, const ModuleLayout& layout, const LayoutLimits& limits = {}) {
  EXPECT_EQ(layout.method, LayoutMethod::kSurface);
  expect_joints(layout, limits);
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    const PlacedModule& m = layout.modules[k];
    EXPECT_LE(surface.closest(center_of(m)).distance_mm, limits.center_gap_mm);
    EXPECT_GT(surface.normal_at(surface.closest(center_of(m))).dot(normal_of(m)), 0.5);
    EXPECT_LE(m.edge_error_mm, limits.edge_error_mm);
    // Two modules that overlap by no more than the depth d share less than a strip of d along a side.
    for (std::size_t o = k + 1; o < layout.modules.size(); ++o)
      EXPECT_LE(overlap_area(m, layout.modules[o]), 30.0 * limits.penetration_mm);
  }
}

TEST(SurfaceLattice, PlaneTakesNoModuleOverItsBorder) {
  const mesh::Surface surface(plane(155.0, 108.0));
  const ModuleLayout layout = grow_lattice(surface, {}, effort(30));
  expect_valid(surface, layout);
  // Four rows of height 26 mm with 9 triangles each fit 150 × 104 mm: 36 of the 42 that the area would allow.
  EXPECT_GE(layout.modules.size(), 33U);
  for (const PlacedModule& m : layout.modules) {
    for (const Vec3& c : m.corner_mm) {
      EXPECT_GE(std::min({c.x(), c.y(), 155.0 - c.x(), 108.0 - c.y()}), -0.5);
      EXPECT_NEAR(c.z(), 0.0, 1e-6);
    }
  }
}

TEST(SurfaceLattice, NothingFitsWhereThereIsNoRoom) {
  EXPECT_TRUE(grow_lattice(mesh::Surface(plane(20.0, 20.0)), {}, effort(5)).modules.empty());
}

// A loaded machine may have used up the time before the search begins.
TEST(SurfaceLattice, FirstModuleIsFoundAfterTheTimeToo) {
  SurfaceLatticeOptions options;
  options.time_limit_s = 1e-9;
  EXPECT_FALSE(grow_lattice(mesh::Surface(half_cylinder(60.0, 200.0)), {}, options).modules.empty());
}

TEST(SurfaceLattice, HoleInAModuleIsKeptFree) {
  // One cell of 6 mm is missing in the middle of a plane, and no module may cover its centre.
  Mesh mesh = grid_mesh(15, 15, [](double u, double v) { return Vec3(90.0 * u, 90.0 * v, 0.0); });
  const std::size_t cell = 2 * (7 * 15 + 7);
  mesh.faces.erase(mesh.faces.begin() + static_cast<std::ptrdiff_t>(cell),
                   mesh.faces.begin() + static_cast<std::ptrdiff_t>(cell) + 2);
  const mesh::Surface surface(mesh);
  const ModuleLayout layout = grow_lattice(surface, {}, effort(10));
  expect_valid(surface, layout);
  EXPECT_FALSE(layout.modules.empty());
  const Vec3 hole(45.0, 45.0, 0.0);
  for (const PlacedModule& m : layout.modules) {
    bool inside = true;
    for (std::size_t s = 0; s < 3; ++s)
      inside = inside && normal_of(m).cross(m.corner_mm[(s + 1) % 3] - m.corner_mm[s]).dot(hole - m.corner_mm[s]) > 0;
    EXPECT_FALSE(inside);
  }
}

TEST(SurfaceLattice, CylinderIsCoveredAsThePlane) {
  const mesh::Surface surface(turned_outward(half_cylinder(60.0, 108.0), Vec3(0, 54, 0)));
  const ModuleLayout layout = grow_lattice(surface, {}, effort(30));
  expect_valid(surface, layout);
  EXPECT_GE(static_cast<double>(layout.modules.size()) * kModuleArea_mm2, 0.68 * surface.area_mm2());
  for (const PlacedModule& m : layout.modules) {
    // The limit is a²κ/12 under the centre, plus the deviation of the mesh's facets.
    EXPECT_LE(m.center_gap_mm, 30.0 * 30.0 / (12.0 * 60.0) + 0.3);
  }
}

class Sphere : public testing::TestWithParam<double> {};
TEST_P(Sphere, EveryLimitHolds) {
  const mesh::Surface surface(turned_outward(sphere_cap(GetParam(), 1.4), Vec3::Zero()));
  const ModuleLayout layout = grow_lattice(surface, {}, effort(12));
  expect_valid(surface, layout);
  EXPECT_GE(static_cast<double>(layout.modules.size()) * kModuleArea_mm2, 0.5 * surface.area_mm2());
}
INSTANTIATE_TEST_SUITE_P(Radii, Sphere, testing::Values(60.0, 100.0, 150.0));

TEST(SurfaceLattice, SameSeedAndBudgetGiveTheSameLayout) {
  const mesh::Surface surface(turned_outward(half_cylinder(50.0, 90.0), Vec3(0, 45, 0)));
  const ModuleLayout a = grow_lattice(surface, {}, effort(12)), b = grow_lattice(surface, {}, effort(12));
  ASSERT_EQ(a.modules.size(), b.modules.size());
  for (std::size_t k = 0; k < a.modules.size(); ++k) {
    EXPECT_EQ(a.modules[k].tile, b.modules[k].tile);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(a.modules[k].corner_mm[c], b.modules[k].corner_mm[c]);
  }
}

// With room for 90 modules each, three of four threads change one layout: the result is the same for a seed and a
// number of steps, within the limits, and has more modules than one thread finds with as many steps as each of them.
TEST(SurfaceLattice, ThreadsOfATeamShareTheSteps) {
  const mesh::Surface surface(grid_mesh(
      20, 20, [](double u, double v) { return Vec3(330.0 * u, 330.0 * v, 60.0 * u * (1.0 - u) + 40.0 * v * v); }));
  const auto grown = [&](int threads, std::uint64_t seed) {
    SurfaceLatticeOptions options = effort(300);
    options.threads = threads;
    options.seed = seed;
    options.price = {.controller = 0.0, .jumper = 0.0, .island = 0.0};
    return grow_lattice(surface, {}, options);
  };
  std::size_t alone = 0, together = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    alone += grown(1, seed).modules.size();
    const ModuleLayout team = grown(4, seed);
    expect_valid(surface, team);
    together += team.modules.size();
    if (seed > 1) continue;
    const ModuleLayout again = grown(4, seed);
    ASSERT_EQ(team.modules.size(), again.modules.size());
    for (std::size_t k = 0; k < team.modules.size(); ++k)
      EXPECT_EQ(team.modules[k].corner_mm, again.modules[k].corner_mm);
  }
  EXPECT_GT(together, alone);
}

// The clock stands still for some questions and is far past any end from then on: in the first growth, among the
// starts, in the annealing. The growth ends soon after, with its best layout, and certifies none beside it.
TEST(SurfaceLattice, GivesUpSoonAfterItsTime) {
  const mesh::Surface surface(turned_outward(half_cylinder(50.0, 90.0), Vec3(0, 45, 0)));
  SurfaceLatticeOptions options;
  options.threads = 1;
  const std::chrono::steady_clock::time_point begin{};
  std::size_t modules = 0;
  for (const int still : {2, 30, 3000}) {
    int asked = 0;
    options.now = [&] { return ++asked > still ? begin + std::chrono::hours(1) : begin; };
    const std::vector<ModuleLayout> layouts = grow_front(surface, {}, options);
    EXPECT_LT(asked - still, 30) << "questions after the time was over, of " << still << " before";
    ASSERT_EQ(layouts.size(), 1U) << still;
    EXPECT_GE(layouts[0].modules.size(), std::max<std::size_t>(1, modules)) << still;
    modules = layouts[0].modules.size();
    expect_valid(surface, layouts[0]);
  }
}

// The copy is moved by more than rounding, mirrored and numbered from the other end: the search takes the same path,
// and its result is carried back.
TEST(SurfaceLattice, MovedAndMirroredCopyGetsTheSameLayout) {
  const auto place = [](double u, double v) {
    return Vec3(140.0 * u, 90.0 * v + 12.0 * u * u, 20.0 * u * v + 9.0 * v * v);
  };
  const Mesh mesh = grid_mesh(9, 7, place);
  Mesh copy = mesh;
  for (Vec3& v : copy.vertices) v = Vec3(40.0 - v.y(), v.z() + 300.0, v.x() - 7.0);  // The determinant is −1.
  for (auto& f : copy.faces) std::swap(f[1], f[2]);
  std::ranges::reverse(copy.faces);
  const mesh::Surface first(mesh), second(copy);
  const ModuleLayout a = grow_lattice(first, {}, effort(12)), b = grow_lattice(second, {}, effort(12));
  expect_valid(first, a);
  expect_valid(second, b);
  ASSERT_GT(a.modules.size(), 10U);
  ASSERT_EQ(a.modules.size(), b.modules.size());
  EXPECT_EQ(a.islands, b.islands);
  for (std::size_t k = 0; k < a.modules.size(); ++k) {
    const Vec3 c = center_of(a.modules[k]);
    EXPECT_LT((center_of(b.modules[k]) - Vec3(40.0 - c.y(), c.z() + 300.0, c.x() - 7.0)).norm(), 1e-6);
  }
}

TEST(SurfaceLattice, DearControllersLeaveFewSmallIslands) {
  const auto cone = [](double u, double v) {
    const double slant = 60.0 + 120.0 * v, angle = 2.5 * u;
    return Vec3(slant * 0.8 * std::cos(angle), slant * 0.8 * std::sin(angle), -0.6 * slant);
  };
  const mesh::Surface surface(grid_mesh(30, 12, cone));
  SurfaceLatticeOptions cheap = effort(60), dear = effort(60);
  cheap.price = {0.0, 0.0, 0.0};
  dear.price = {3.0, 0.25, 0.1};
  cheap.hinge_reward = dear.hinge_reward = 0.0;  // Its result has few islands too.
  // One seed in six finds more islands where they are dear.
  int many = 0, few = 0;
  for (cheap.seed = 1; cheap.seed <= 6; ++cheap.seed) {
    dear.seed = cheap.seed;
    many += grow_lattice(surface, {}, cheap).islands;
    few += grow_lattice(surface, {}, dear).islands;
  }
  EXPECT_LT(3 * few, 2 * many);
}

TEST(SurfaceLattice, BadOptionsAreNamed) {
  const mesh::Surface surface(plane(60.0, 60.0));
  SurfaceLatticeOptions o;
  o.threads = 0;
  EXPECT_THROW((void)grow_lattice(surface, {}, o), InputError);
  LayoutLimits limits;
  limits.penetration_mm = 0.0;
  EXPECT_THROW((void)grow_lattice(surface, limits, effort(1)), InputError);
}

// Each case is a cover and the least number of modules that it must take.
class CoverLimits : public testing::TestWithParam<std::pair<test::CoverName, std::size_t>> {};

TEST_P(CoverLimits, hold_for_every_module) {
  const auto& [cover, least] = GetParam();
  const auto file = test::cover_file(cover);
  if (!file) GTEST_SKIP() << test::no_data();
  const mesh::Surface surface(mesh::extract(mesh::read_mesh(file->path()).mesh).surface);
  SurfaceLatticeOptions most = effort(12);
  most.price = {0.05, 0.05, 0.05};  // With this price only the modules count, almost whatever they cost.
  const ModuleLayout layout = grow_lattice(surface, {}, most);
  expect_valid(surface, layout);
  EXPECT_GE(layout.modules.size(), least);
}

std::string name_of(const testing::TestParamInfo<std::pair<test::CoverName, std::size_t>>& p) {
  return test::case_name(p.param.first.name);
}

INSTANTIATE_TEST_SUITE_P(Generated, CoverLimits,
                         testing::Values(std::pair{test::CoverName{"thigh", {.size_mm = 120.0, .faces = 400}}, 38U},
                                         std::pair{test::CoverName{"near-degenerate"}, 20U}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Real, CoverLimits,
                         testing::Values(std::pair{test::CoverName{"LH_hipwing_v1"}, 10U},
                                         std::pair{test::CoverName{"LUA_upperarm_half_v1"}, 21U},
                                         std::pair{test::CoverName{"RUF_forearm_v2"}, 46U}),
                         name_of);

}  // namespace
}  // namespace triskin::lattice
