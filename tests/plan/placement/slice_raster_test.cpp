// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the raster of a slice: bits and their sums worked by hand, the figure of one edge against its formula, and
// bounds of random slices against motions in them.
#include "plan/placement/src/kernels/slice_raster.hpp"

#include <gtest/gtest.h>

#include "plan/placement/src/kernels/evaluator.hpp"
#include "polygons.hpp"

namespace triskin::placement {
namespace {

TEST(SampleBits, parity_runs_from_word_to_word_and_stays_in_its_row) {
  SampleBits bits;
  bits.clear(16, 3);
  bits.flip(3, 5);
  bits.flip(3, 40);
  bits.flip(4, 31);
  bits.flip(4, 32);
  bits.flip(5, 10);
  bits.flip(5, 90);
  bits.accumulate_parity();
  EXPECT_EQ(*bits.word(3, 0), 0xffffffe0U);  // The set columns are 5 … 39.
  EXPECT_EQ(*bits.word(3, 1), 0x000000ffU);
  EXPECT_EQ(*bits.word(3, 2), 0U);
  EXPECT_EQ(*bits.word(4, 0), 0x80000000U);  // Only column 31 is set.
  EXPECT_EQ(*bits.word(4, 1), 0U);
  EXPECT_EQ(*bits.word(5, 0), 0xfffffc00U);  // The set columns are 10 … 89.
  EXPECT_EQ(*bits.word(5, 1), 0xffffffffU);
  EXPECT_EQ(*bits.word(5, 2), 0x03ffffffU);
  EXPECT_EQ(*bits.word(6, 1), 0U);
}

TEST(BitCounts, every_other_block_is_counted_without_what_is_cut) {
  SampleBits inside, cut;
  inside.clear(4 * 16, 1);
  cut.clear(4 * 16, 1);
  inside.flip(0 * 16 + 5, 3);
  inside.flip(2 * 16 + 5, 3);
  inside.flip(2 * 16 + 5, 3 + 16);  // This is the same part of the next tile.
  inside.flip(1 * 16 + 5, 3);
  inside.flip(3 * 16 + 6, 15);
  cut.flip(2 * 16 + 5, 3);
  BitCounts even, odd;
  even.add(inside, cut, 0);
  odd.add(inside, cut, 1);
  BitCounts::Counts counts{};
  even.add_to(counts, 0);
  EXPECT_EQ(counts[3][5], 2);
  EXPECT_EQ(counts[15][6], 0);
  odd.add_to(counts, 8);
  EXPECT_EQ(counts[3][5], 2);
  EXPECT_EQ(counts[11][5], 1);
  EXPECT_EQ(counts[7][6], 1);
  even.clear();
  even.add(inside, inside, 0);
  counts = {};
  even.add_to(counts, 0);
  EXPECT_EQ(counts, BitCounts::Counts{});
}

// 2 words × 150 blocks of two tiles each exceed eight binary digits.
TEST(BitCounts, six_hundred_tiles) {
  SampleBits inside, cut;
  inside.clear(300 * 16, 2);
  cut.clear(300 * 16, 2);
  for (int row = 0; row < inside.rows(); ++row) *inside.word(row, 0) = *inside.word(row, 1) = ~0U;
  BitCounts sum;
  sum.add(inside, cut, 0);
  sum.add(inside, cut, 0);
  BitCounts::Counts counts{};
  sum.add_to(counts, 0);
  for (const auto& column : counts) {
    for (const int n : column) ASSERT_EQ(n, 1200);
  }
}

// Samples are 1 mm apart around the origin, with row 0 and column 0 at +200 mm.
class OneEdge : public testing::Test {
 protected:
  static constexpr int kHalf_mm = 200;

  OneEdge() : edges_(prepare(test::moved(triangle(), 0, {0, 0}))) {
    edges_.count = 1;
    terms_.column0 = terms_.row0 = kHalf_mm;
    terms_.step_x = terms_.step_y = 1.0;
  }
  static Polygon triangle() {
    Polygon p;
    p.outer = {{0, 0}, {30, 0}, {15, 20}};
    return p;
  }
  void set_edge(const Vec2& a, const Vec2& b) {
    const Vec2 n = Vec2(a.y() - b.y(), b.x() - a.x()).normalized();
    edges_.ax[0] = a.x();
    edges_.ay[0] = a.y();
    edges_.bx[0] = b.x();
    edges_.by[0] = b.y();
    edges_.normal_x[0] = n.x();
    edges_.normal_y[0] = n.y();
    edges_.offset[0] = n.dot(a);
    edges_.far[0] = std::max(a.norm(), b.norm());
  }
  [[nodiscard]] SampleBits figure(bool outer) const {
    SampleBits bits;
    bits.clear(2 * kHalf_mm, 2 * kHalf_mm / SampleBits::kWord + 1);
    fill_figures(edges_, grid_, terms_, outer, bits);
    return bits;
  }
  // Compares with a truth for the centre (x, y) of a tile: the cut contains only true samples, and all that are true
  // within 0.01 mm around; the touched set contains all true samples, and none that is false 1.01 mm beside.
  template <typename Truth>
  void expect_figures(const Truth& truth) const {
    const SampleBits cut = figure(false), touched = figure(true);
    const auto around = [&](double x, double y, double by) {
      return std::array{truth(x - by, y), truth(x + by, y), truth(x, y - by), truth(x, y + by)};
    };
    int cuts = 0, wrong = 0;
    for (int r = 0; r < 2 * kHalf_mm; ++r) {
      for (int c = 0; c < 2 * kHalf_mm; ++c) {
        const double x = kHalf_mm - c, y = kHalf_mm - r;
        const auto on = [&](const SampleBits& b) { return (*b.word(r, c / 32) >> (c % 32) & 1U) != 0; };
        const bool is = truth(x, y), surely = is && std::ranges::count(around(x, y, 0.01), false) == 0,
                   perhaps = is || std::ranges::count(around(x, y, 1.01), true) > 0;
        wrong += (surely && !on(cut)) || (!is && on(cut)) || (is && !on(touched)) || (!perhaps && on(touched)) ? 1 : 0;
        cuts += surely ? 1 : 0;
      }
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(cuts, 500);
  }

  TileGrid grid_ = tile_grid(TileShape::kTriangle, 0.0);
  EdgeArrays edges_;
  FigureTerms terms_;
};

// An up tile of height h = 25.98 mm has its base h/3 below its centre; at a height t over the base it is 30·(1 - t/h)
// wide. It meets the level edge from 0 to 30 if the edge is at such a height and not beside that width.
TEST_F(OneEdge, a_level_edge_and_an_up_tile) {
  set_edge({0, 0}, {30, 0});
  const double h = 15.0 * std::sqrt(3.0);
  expect_figures([&](double x, double y) {
    const double t = h / 3.0 - y, half_width = 15.0 * (1.0 - t / h);
    return t > 0.0 && t < h && x + half_width > 0.0 && x - half_width < 30.0;
  });
}

// In the mirror image, the tip of a down tile is 2h/3 below its centre.
TEST_F(OneEdge, an_upright_edge_and_a_down_tile) {
  set_edge({5, -40}, {5, 30});
  terms_.sign = -1.0;
  const double h = 15.0 * std::sqrt(3.0);
  expect_figures([&](double x, double y) {
    if (std::abs(x - 5.0) >= 15.0) return false;
    const double top = y + h / 3.0,
                 bottom = y - 2.0 * h / 3.0 + std::abs(x - 5.0) * std::sqrt(3.0);  // The edge meets the tile at 5.
    return top > -40.0 && bottom < 30.0;
  });
}

// A shift of ±2 mm in x and ±1 mm in y grows and shrinks the figure of the level edge by as much.
TEST_F(OneEdge, shifts_shrink_the_cut_and_grow_what_is_touched) {
  set_edge({0, 0}, {30, 0});
  const auto count = [](const SampleBits& bits, int row) {
    int n = 0;
    for (int w = 0; w < bits.words(); ++w) n += std::popcount(*bits.word(row, w));
    return n;
  };
  // The level of the centre is 0: the edge passes the tile h/3 over the base, where it is 20 mm wide. Centres in
  // (−10, 40) are cut: −9 … 39.
  EXPECT_EQ(count(figure(false), kHalf_mm), 49);
  EXPECT_EQ(count(figure(true), kHalf_mm), 51 + 2);
  terms_.half_x = 2.0;
  EXPECT_EQ(count(figure(false), kHalf_mm), 45);  // The range is (−8, 38).
  EXPECT_EQ(count(figure(true), kHalf_mm), 55 + 2);
  terms_.half_x = 0.0;
  terms_.half_y = 1.0;  // Sides lean by 60°, so 1 mm up is 0.577 mm aside.
  EXPECT_EQ(count(figure(false), kHalf_mm), 49);
  terms_.half_y = 2.0;  // The range is (−8.85, 38.85).
  EXPECT_EQ(count(figure(false), kHalf_mm), 47);
  EXPECT_EQ(count(figure(false), kHalf_mm + 17), 0);  // This is 2 mm below the reach of the tip.
}

CellFrame frame_of(const PreparedPolygon& p, const TileGrid& grid, double theta, double half_theta) {
  CellFrame f;
  f.set(p, grid, {{0, 0, theta - half_theta}, {grid.row_step_mm, grid.row_height_mm, theta + half_theta}}, 0.0, -1e-6);
  f.certain_mm = f.sufficient_mm;
  return f;
}

// Compares bound and certain tiles of each part with counts at motions in it, for all shapes.
TEST(SliceRaster, bounds_hold_at_random_motions_and_are_close) {
  std::mt19937_64 random(97);
  const std::array grids{tile_grid(TileShape::kTriangle, 0.0), tile_grid(TileShape::kTriangle, 1.0, 3.0),
                         tile_grid(TileShape::kSquare, 0.0), tile_grid(TileShape::kHexagon, 2.0)};
  double room = 0.0, most = 0.0;
  for (int k = 0; k < 24; ++k) {
    const TileGrid& grid = grids[static_cast<std::size_t>(k % 4)];
    const PreparedPolygon p = prepare(test::random_polygon(random, 5 + 3 * k, 250.0 + 40.0 * k, k % 3));
    const CellFrame f = frame_of(p, grid, test::uniform(random, 0, 3), 1.25 / p.radius_mm);
    SliceRaster raster(p, grid);
    raster.scan(f);
    Evaluator evaluator(p, grid);
    std::array<int, SliceRaster::kSteps * SliceRaster::kSteps> bound{};
    for (int n = 0; n < 256; ++n) bound[static_cast<std::size_t>(n)] = raster.count(n % 16, n / 16);
    raster.collect(f);
    for (int n = 0; n < 256; ++n) {
      const int x = n % 16, y = n / 16;
      ASSERT_EQ(raster.certain() + raster.count(x, y), bound[static_cast<std::size_t>(n)]);
      int may = raster.certain(), must = raster.certain();
      for (const SliceRaster::Border& b : raster.border()) {
        may += static_cast<int>(b.may[static_cast<std::size_t>(y)] >> x & 1U);
        must += static_cast<int>(b.must[static_cast<std::size_t>(y)] >> x & 1U);
      }
      ASSERT_EQ(may, bound[static_cast<std::size_t>(n)]);
      const auto motion = [&](double u, double v, double w) {
        return Motion{(x + u) / 16 * grid.row_step_mm, (y + v) / 16 * grid.row_height_mm, f.center[2] + w * f.half[2]};
      };
      // A bound breaks first at the corners of the part, at either end of the angles.
      for (int corner = 0; corner < 8; ++corner) {
        const int value = evaluator.count(motion(corner & 1, corner >> 1 & 1, corner >> 2 & 1 ? 1.0 : -1.0), 0.0);
        ASSERT_GE(may, value);
        ASSERT_LE(must, value);
      }
      const int value = evaluator.count(
          motion(test::uniform(random, 0, 1), test::uniform(random, 0, 1), test::uniform(random, -1, 1)), 0.0);
      ASSERT_GE(may, value);
      ASSERT_LE(must, value);
      room += may - must;
      most += value;
    }
  }
  EXPECT_LT(room, 0.15 * most);  // A raster that bounds nothing would pass without this.
}

}  // namespace
}  // namespace triskin::placement
