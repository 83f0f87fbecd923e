// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/mirror.hpp"

#include <gtest/gtest.h>

#include "support/flat_design.hpp"

namespace triskin::design {
namespace {

TEST(Mirror, exchanges_the_axes_of_the_lattice) {
  for (const bool up : {true, false}) {
    const Tile tile{2, 5, up}, image = mirrored_tile(tile);
    EXPECT_EQ(image, (Tile{5, 2, up}));
    std::array<std::array<int, 2>, 3> corners;
    for (int c = 0; c < 3; ++c) corners[static_cast<std::size_t>(c)] = tile_corner_index(tile, c);
    const auto moved = mirrored_corners(tile, corners);
    for (int c = 0; c < 3; ++c) {
      const auto [i, j] = moved[static_cast<std::size_t>(c)];
      EXPECT_EQ((std::array{j, i}), tile_corner_index(image, c)) << up << c;
    }
    const auto side = mirrored_sides(tile, std::array{0, 1, 2});
    for (int s = 0; s < 3; ++s) {
      const TileSide over = across(tile, side[static_cast<std::size_t>(s)]), over_image = across(image, s);
      EXPECT_EQ(over_image.tile, mirrored_tile(over.tile)) << up << s;
      EXPECT_EQ(mirrored_sides(over.tile, std::array{0, 1, 2})[static_cast<std::size_t>(over_image.side)], over.side);
    }
    EXPECT_EQ(mirrored_corners(image, moved), corners);
  }
}

// The mirror plane is x = 10: corners (0, 0), (30, 0), (15, h) of the up tile of cell (0, 0) move to (20, 0), (−10,
// 0), (5, h).
TEST(Mirror, a_module_keeps_its_sense) {
  Design d = test::flat_design("row", {-10, -10}, {90, 40});
  const std::vector<Tile> tiles{{0, 0, true}, {0, 0, false}};
  test::lay_modules(d, tiles, {{tiles[0], 0}, {tiles[1], 1}});
  d.layout.modules[0].fold_rad = {0.0, 0.2, 0.0};
  d.layout.jumpers.resize(1);
  const ModuleLayout image = mirrored(d.layout, {Vec3::UnitX(), 10.0});
  ASSERT_EQ(image.modules.size(), 2U);
  const PlacedModule& m = image.modules[0];
  EXPECT_EQ(m.tile, (Tile{0, 0, true}));
  EXPECT_TRUE(m.corner_mm[0].isApprox(Vec3(20, 0, 0)));
  EXPECT_TRUE(m.corner_mm[1].isApprox(Vec3(5, kHeight_mm, 0)));
  EXPECT_TRUE(m.corner_mm[2].isApprox(Vec3(-10, 0, 0)));
  EXPECT_GT((m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).z(), 0.0);
  // Side 1 of the up tile leads to the down tile of its cell, in the image as before.
  EXPECT_EQ(m.neighbour, (std::array{-1, 1, -1}));
  EXPECT_DOUBLE_EQ(m.fold_rad[1], 0.2);
  EXPECT_TRUE(image.jumpers.empty());
  const Mesh mesh = mirrored(d.surface, {Vec3::UnitX(), 10.0});
  const auto& f = mesh.faces[0];
  const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(f[k])]; };
  EXPECT_GT((at(1) - at(0)).cross(at(2) - at(0)).z(), 0.0);
}

TEST(Mirror, a_piece_is_turned_over_with_the_tiles_in_it) {
  PlacedPiece p;
  p.piece.outline.outer = {{1, 1}, {40, 2}, {20, 30}};
  p.piece.faces = {FaceIndex{7}};
  p.piece.flat = {{Vec2{1, 1}, Vec2{40, 2}, Vec2{20, 30}}};
  p.placement = {3.0, -2.0, 0.4};
  const PlacedPiece image = turned_over(p);
  const auto on_grid = [](const PlacedPiece& q, const Vec2& point) {
    return Vec2(Eigen::Rotation2Dd(q.placement.theta_rad) * point + Vec2(q.placement.x_mm, q.placement.y_mm));
  };
  const auto area = [](const std::vector<Vec2>& r) {
    const Vec2 u = r[1] - r[0], v = r[2] - r[0];
    return u.x() * v.y() - u.y() * v.x();
  };
  EXPECT_NEAR(area(image.piece.outline.outer), area(p.piece.outline.outer), 1e-9);
  // A point at (i, j) of the lattice moves to (j, i); here these are the outline's corners, listed from the first on.
  const auto lattice = [](const Vec2& g) {
    const double j = g.y() / kHeight_mm;
    return Vec2(g.x() / kSide_mm - 0.5 * j, j);
  };
  for (const auto& [k, l] : {std::pair{0, 0}, std::pair{1, 2}, std::pair{2, 1}}) {
    const Vec2 before = lattice(on_grid(p, p.piece.outline.outer[static_cast<std::size_t>(k)]));
    const Vec2 after = lattice(on_grid(image, image.piece.outline.outer[static_cast<std::size_t>(l)]));
    EXPECT_NEAR(after.x(), before.y(), 1e-9);
    EXPECT_NEAR(after.y(), before.x(), 1e-9);
  }
  EXPECT_EQ(image.piece.flat[0][0], image.piece.outline.outer[0]);
  EXPECT_EQ(image.piece.flat[0][1], image.piece.outline.outer[1]);
}

}  // namespace
}  // namespace triskin::design
