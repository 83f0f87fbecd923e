// SPDX-License-Identifier: GPL-3.0-or-later
// Seams that only look closed: T-junctions, slivers of no or nearly no height, doubled corners. What hangs at them must
// stay, and no point of the original may be farther from the surface than is stated. TRISKIN_SEAM_MESHES=500 tries as
// many damaged covers as the measurements state (20 otherwise), TRISKIN_SEAM_TABLE=1 prints a line for each.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "plan/mesh/broken_meshes.hpp"
#include "plan/mesh/distances.hpp"
#include "solids.hpp"
#include "support/covers.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/extract_steps.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin {
namespace {

using design::Mesh;
using design::Vec3;
using mesh::Extraction;
using mesh::ExtractOptions;

ExtractOptions as_the_program() {
  ExtractOptions options;
  options.repair = true;
  options.outer = options.wrap = ExtractOptions::When::kWhenNeeded;
  options.repair_s = 20.0;
  return options;
}

// A plate of 120 mm × 80 mm whose corner, a triangle of 25 mm × 25 mm, hangs at the edge from (120, 55) to (95, 80)
// with two faces; the other side of the edge is one face. `beside_mm` is the height of a face that fills the gap.
Mesh plate_with_hanging_corner(double beside_mm, bool is_filled) {
  const double shift = beside_mm / std::sqrt(2.0);
  Mesh m;
  m.vertices = {
      {0, 0, 0}, {120, 0, 0}, {120, 55, 0}, {95, 80, 0}, {0, 80, 0}, {120, 80, 0}, {107.5 + shift, 67.5 + shift, 0}};
  m.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {6, 5, 3}, {2, 5, 6}};
  if (is_filled) m.faces.push_back({2, 6, 3});
  return m;
}

// The corner has 3.125 cm², less than a module, so it goes unless it is joined.
TEST(HangingCorner, stays_at_a_t_junction_and_behind_a_sliver) {
  for (const auto& [height_mm, is_filled] :
       {std::pair(0.0, false), {0.0, true}, {1e-12, true}, {1e-9, true}, {1e-7, true}, {1e-6, true}}) {
    SCOPED_TRACE(fmt::format("{} mm{}", height_mm, is_filled ? ", filled" : ""));
    const Extraction e =
        mesh::extract(test::read_back(plate_with_hanging_corner(height_mm, is_filled)), as_the_program());
    EXPECT_NEAR(mesh::area_of(e.surface), 9600.0, 1e-3);
    EXPECT_EQ(e.report.removed_components, 0);
    EXPECT_TRUE(e.report.dropped.empty());
    EXPECT_EQ(e.report.boundary_loops, 1);
  }
}

// A gap of 0.1 mm is no rounding: the corner is a part of its own, and is named with area and place.
TEST(HangingCorner, apart_is_dropped_by_name) {
  const Extraction e = mesh::extract(test::read_back(plate_with_hanging_corner(0.1, false)), as_the_program());
  ASSERT_EQ(e.report.dropped.size(), 1U);
  const mesh::DroppedPart& part = e.report.dropped[0];
  EXPECT_EQ(part.faces, 2);
  EXPECT_NEAR(part.area_mm2, 312.5 - 0.1 * std::sqrt(2.0) * 12.5, 0.01);  // Its border turned in by 0.1 mm halfway.
  EXPECT_LT((part.where_mm - Vec3(112, 71, 0)).norm(), 10.0);
  EXPECT_NEAR(mesh::area_of(e.surface) + part.area_mm2, 9600.0 - 0.1 * std::sqrt(2.0) * 12.5, 0.01);
}

// One report goes through all steps: a keep-out far from the cover changes no other number.
TEST(Report, keeps_its_numbers_through_a_keep_out) {
  Mesh crossed = test::read_back(
      test::grid_of([](double u, double v) { return Vec3(100.0 * u, 100.0 * v, std::sin(9.0 * u)); }, 40, 40));
  test::append(crossed, test::read_back(test::grid_of(
                            [](double u, double v) { return Vec3(30.0 + 40.0 * u, 50.0, 60.0 * v - 30.0); }, 10, 10)));
  ExtractOptions options = as_the_program();
  options.repair_s = 0.1;  // 2,000 faces may be repaired, so the 3,400 are reduced.
  options.clock_s = [] { return 0.0; };
  const mesh::ExtractReport without = mesh::extract(crossed, options).report;
  ASSERT_GT(without.reduced_mm, 0.0);
  options.spheres.push_back({Vec3(500, 500, 500), 10.0});
  const mesh::ExtractReport with = mesh::extract(crossed, options).report;
  EXPECT_EQ(with.reduced_mm, without.reduced_mm);
  EXPECT_EQ(with.tested, without.tested);
  EXPECT_EQ(with.deviation.largest_mm, without.deviation.largest_mm);
  EXPECT_EQ(with.removed_components, without.removed_components);
  EXPECT_EQ(with.non_manifold_edges, without.non_manifold_edges);
  EXPECT_EQ(with.crossings, without.crossings);
  EXPECT_EQ(with.dropped.size(), without.dropped.size());
}

// Returns a height of 0, or of 1e-12 … 1e-6 mm.
double sliver_height(test::Dice& d) {
  return test::pick(d, 4) == 0 ? 0.0 : std::pow(10.0, test::dice(d, -12.0, -6.0));
}

// Damages seams at 30 places and marks the faces there: the shape stays the same within 1e-6 mm.
std::vector<std::size_t> damage_seams(Mesh& m, test::Dice& d) {
  std::vector<std::size_t> places;
  for (int n = 0; n < 30; ++n) {
    const std::size_t f = test::pick(d, m.faces.size()), s = test::pick(d, 3);
    const auto face = m.faces[f];
    const int a = face[s], b = face[(s + 1) % 3], c = face[(s + 2) % 3];
    const Vec3 along = m.vertices[static_cast<std::size_t>(b)] - m.vertices[static_cast<std::size_t>(a)],
               in = m.vertices[static_cast<std::size_t>(c)] - m.vertices[static_cast<std::size_t>(a)];
    if (along.cross(in).norm() < 1e-3 * along.squaredNorm() || along.norm() < 0.1) continue;
    places.push_back(f);
    if (const std::size_t kind = test::pick(d, 4); kind == 3) {
      for (std::size_t k = 0; k < 3; ++k) {  // Doubled corners: the face comes off.
        m.faces[f][k] = static_cast<int>(m.vertices.size());
        const Vec3 by = sliver_height(d) * Vec3(test::dice(d, -1, 1), test::dice(d, -1, 1), test::dice(d, -1, 1));
        m.vertices.push_back(Vec3(m.vertices[static_cast<std::size_t>(face[k])] + by));
      }
    } else {
      const int v = static_cast<int>(m.vertices.size());
      const Vec3 inward = along.cross(in).cross(along).normalized();
      const double height_mm = kind == 0 ? 0.0 : sliver_height(d) * (kind == 1 ? 1.0 : -1.0);
      m.vertices.push_back(
          Vec3(m.vertices[static_cast<std::size_t>(a)] + test::dice(d, 0.1, 0.9) * along + height_mm * inward));
      m.faces[f] = {a, v, c};
      m.faces.push_back({v, b, c});
      places.push_back(m.faces.size() - 1);
      if (kind != 0) m.faces.push_back({a, b, v});  // Kind 2 folds back by its height.
    }
  }
  return places;
}

struct Loss {
  double away_mm = 0.0, lost_mm2 = 0.0, dropped_mm2 = 0.0, stated_mm = 0.0;
  std::size_t dropped = 0;
};

// Measures surface against original both ways, at random places and all over the damaged ones.
Loss loss_of(const Mesh& original, const Extraction& e, const Mesh& damaged, const std::vector<std::size_t>& places,
             test::Dice& d) {
  Loss loss;
  loss.stated_mm = e.report.deviation.largest_mm;
  loss.dropped = e.report.dropped.size();
  for (const mesh::DroppedPart& part : e.report.dropped) loss.dropped_mm2 += part.area_mm2;
  loss.lost_mm2 = mesh::area_of(original) - mesh::area_of(e.surface);
  Mesh near{damaged.vertices, {}};
  for (const std::size_t f : places) near.faces.push_back(damaged.faces[f]);
  loss.away_mm = std::max({test::sampled_distance(e.surface, original, d, 150),
                           test::sampled_distance(original, e.surface, d, 150),
                           near.faces.empty() ? 0.0 : test::sampled_distance(near, e.surface, d, 200)});
  return loss;
}

int seam_meshes() {
  const char* text = std::getenv("TRISKIN_SEAM_MESHES");
  return text != nullptr ? std::atoi(text) : 20;
}

void expect_no_unnamed_loss(int k) {
  constexpr std::array<const char*, 10> kCovers{
      "HIP_v1",         "LH_hipwing_v1",   "LT_root_v2",     "LUA_upperarm_half_v1", "RFA_forearm_v1",
      "RUF_forearm_v2", "SHANK_front_v25", "UA_upperarm_v1", "UL_upperleg_v1",       "UT_torso_v1"};
  const char* name = kCovers[static_cast<std::size_t>(k) % kCovers.size()];
  SCOPED_TRACE(fmt::format("{} seed {}", name, k));
  test::Dice dice(static_cast<std::uint64_t>(k) + 5700);
  const Mesh original = mesh::read_mesh(test::data_folder() / "parts" / fmt::format("{}.obj", name)).mesh;
  Mesh damaged = original;
  const std::vector<std::size_t> places = damage_seams(damaged, dice);
  const Extraction before = mesh::extract(original, as_the_program());
  const Extraction e = mesh::extract(test::read_back(damaged), as_the_program());
  const Loss clean = loss_of(original, before, original, {}, dice), loss = loss_of(original, e, damaged, places, dice);
  // Reading moves points by 1e-6 of the size of at most 1 m; of the area of a needle nothing is known.
  EXPECT_LE(loss.away_mm, loss.stated_mm + 1e-3);
  EXPECT_NEAR(loss.lost_mm2 - clean.lost_mm2, loss.dropped_mm2 - clean.dropped_mm2,
              1e-5 * mesh::area_of(original) + 10.0 * loss.stated_mm);
  if (std::getenv("TRISKIN_SEAM_TABLE") != nullptr)
    fmt::print("{} seed {}: {} stated {:.6f} mm found {:.6f} mm, area {:.3f} mm² less, {} dropped of {:.3f} mm²\n",
               name, k, mesh::kRepairNames.name(e.report.repair), loss.stated_mm, loss.away_mm,
               loss.lost_mm2 - clean.lost_mm2, loss.dropped, loss.dropped_mm2);
}

TEST(DamagedSeams, lose_nothing_that_is_not_named) {
  if (!std::filesystem::exists(test::data_folder())) GTEST_SKIP() << "needs the covers of TRISKIN_DATA";
  for (int k = 0; k < seam_meshes(); ++k) expect_no_unnamed_loss(k);
}

// Here a local repair leaves out five faces of 31.6 mm² at one place, and 52.0 mm² of four faces that others replace
// for the rest.
TEST(DamagedSeams, what_a_local_repair_leaves_out_is_named) {
  if (!std::filesystem::exists(test::data_folder())) GTEST_SKIP() << "needs the covers of TRISKIN_DATA";
  for (const int k : {230, 271}) expect_no_unnamed_loss(k);
}

}  // namespace
}  // namespace triskin
