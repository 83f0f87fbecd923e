// SPDX-License-Identifier: GPL-3.0-or-later
// A search must leave kept modules where they are.
#include "plan/lattice/src/kept_modules.hpp"

#include <gtest/gtest.h>

#include "plan/lattice/src/relax.hpp"
#include "shapes.hpp"

namespace triskin::lattice {
namespace {

// Returns the first `count` modules, with the joints among them.
std::vector<PlacedModule> first_of(const ModuleLayout& layout, int count) {
  std::vector<PlacedModule> kept(layout.modules.begin(), layout.modules.begin() + count);
  for (PlacedModule& m : kept) {
    for (int& n : m.neighbour) n = n < count ? n : -1;
  }
  return kept;
}

TEST(KeptModules, are_a_net_that_relaxing_does_not_move) {
  const Mesh mesh = sphere_cap(90.0, 1.4);
  const CanonicalCopy copy(mesh);
  const mesh::Surface surface(copy.mesh()), original(mesh);
  const ModuleLayout layout = grow_lattice(original, {}, effort(3));
  const std::vector<PlacedModule> kept = first_of(layout, 10);
  LatticeMesh net = net_of_kept(surface, copy, kept, 0.0);
  ASSERT_EQ(net.size(), 10);
  int joints = 0;
  for (const PlacedModule& m : kept)
    joints += static_cast<int>(std::ranges::count_if(m.neighbour, [](int n) { return n >= 0; }));
  EXPECT_EQ(2 * net.joints(), joints);
  const auto expect_unmoved = [&] {
    for (int k = 0; k < 10; ++k) {
      ModuleLayout one;
      one.modules.push_back(copy.carried_there(kept[at(k)]));
      EXPECT_EQ(net.triangles()[at(k)].rigid, one.modules[0].corner_mm);
      copy.carry_back(one);
      EXPECT_EQ(one.modules[0].tile, kept[at(k)].tile);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_LT((one.modules[0].corner_mm[c] - kept[at(k)].corner_mm[c]).norm(), 1e-9);
    }
  };
  expect_unmoved();
  NearSurface near(surface);
  Relaxer relaxer(near, 1.5);
  (void)relaxer.relax(net, 0, 60.0, 5);
  expect_unmoved();
  // A vertex of fixed modules only must not move because of a gap among them.
  for (const NetVertex& v : net.vertices()) EXPECT_TRUE(!v.used || v.is_fixed);
}

TEST(KeptModules, are_the_first_of_every_layout) {
  const mesh::Surface surface(sphere_cap(90.0, 1.4));
  const ModuleLayout layout = grow_lattice(surface, {}, effort(3));
  SurfaceLatticeOptions options = effort(20);
  options.kept = first_of(layout, 10);
  const std::vector<ModuleLayout> found = grow_front(surface, {}, options);
  ASSERT_FALSE(found.empty());
  for (const ModuleLayout& other : found) {
    ASSERT_GT(other.modules.size(), 10U);
    for (std::size_t k = 0; k < 10; ++k) {
      EXPECT_EQ(other.modules[k].corner_mm, options.kept[k].corner_mm);
      EXPECT_EQ(other.modules[k].tile, options.kept[k].tile);
      for (std::size_t s = 0; s < 3; ++s) {
        const int n = other.modules[k].neighbour[s];
        EXPECT_TRUE(n >= 10 || n == options.kept[k].neighbour[s]);
        EXPECT_LE(other.modules[k].hinge_gap_mm[s], 2.0);
      }
    }
  }
}

}  // namespace
}  // namespace triskin::lattice
