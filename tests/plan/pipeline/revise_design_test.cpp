// SPDX-License-Identifier: GPL-3.0-or-later
// Designs a new version of a part: modules and tables that the change does not touch must stay.
#include "triskin/pipeline/revise_design.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "triskin/check/design_rules.hpp"
#include "triskin/exports/revision_picture.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {
namespace {

namespace fs = std::filesystem;
using design::Design;
using design::Vec2;
using design::Vec3;

constexpr double kHoleRadius_mm = 14.0;

// Makes a plate of 360 × 240 mm, bent to a cylinder of radius 300 mm, from cells of 4 mm without those in a round
// hole.
design::Mesh plate_with_hole(const Vec2& hole_mm) {
  constexpr int kColumns = 90, kRows = 60;
  constexpr double kCell_mm = 4.0, kRadius_mm = 300.0;
  design::Mesh mesh;
  for (int y = 0; y <= kRows; ++y) {
    for (int x = 0; x <= kColumns; ++x) {
      const double angle_rad = (kCell_mm * x - 180.0) / kRadius_mm;
      mesh.vertices.push_back({kRadius_mm * std::sin(angle_rad), kCell_mm * y, kRadius_mm * std::cos(angle_rad)});
    }
  }
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const Vec2 middle(kCell_mm * (x + 0.5), kCell_mm * (y + 0.5));
      if ((middle - hole_mm).norm() < kHoleRadius_mm) continue;
      const int a = y * (kColumns + 1) + x, c = a + kColumns + 2;
      mesh.faces.push_back({a, a + 1, c});
      mesh.faces.push_back({a, c, a + kColumns + 1});
    }
  }
  return mesh;
}

Vec3 on_plate(const Vec2& place_mm) {
  const double angle_rad = (place_mm.x() - 180.0) / 300.0;
  return {300.0 * std::sin(angle_rad), place_mm.y(), 300.0 * std::cos(angle_rad)};
}

// Makes the design of a plate in a fixed number of steps, not in a time.
DesignResult design_of(const Vec2& hole_mm, const std::shared_ptr<const Design>& like) {
  const fs::path file = fs::temp_directory_path() / ("revise." + std::to_string(::getpid()) + ".obj");
  mesh::write_obj(file, plate_with_hole(hole_mm));
  DesignOptions options;
  options.iterations = 2000;
  options.time_limit_s = 60.0;
  options.like = like;
  DesignResult made = make_design(file, options);
  fs::remove(file);
  return made;
}

std::vector<std::string> broken_by(const Design& d) {
  const fs::path file = fs::temp_directory_path() / ("revise." + std::to_string(::getpid()) + ".json");
  design::write_design(file, d);
  std::vector<std::string> broken;
  for (const check::Violation& v : check::check_design(file).violations)
    broken.push_back(v.rule + ": " + v.where + ": " + v.text);
  fs::remove(file);
  return broken;
}

// Returns row by row what a controller's table says about a patch, with modules named by their ids in the older design.
std::vector<std::array<int, 5>> table_of(const Design& d, int patch, const std::vector<int>& old_id) {
  const auto old = [&](int node) { return node < 0 ? -1 : old_id[static_cast<std::size_t>(node)]; };
  std::vector<std::array<int, 5>> rows;
  for (const auto& m : d.patches.at(static_cast<std::size_t>(patch)).modules)
    rows.push_back({old(m.node), old(m.parent), m.rotation, m.line, m.address});
  return rows;
}

struct RevisedPlate {
  std::shared_ptr<const Design> old;
  Design now;
  Revision revision;
};
const RevisedPlate& revised_plate() {
  static const RevisedPlate kPlate = [] {
    auto old = std::make_shared<const Design>(design_of({100, 120}, nullptr).design);
    DesignResult now = design_of({250, 120}, old);
    return RevisedPlate{old, std::move(now.design), now.notes.revision.value()};
  }();
  return kPlate;
}

TEST(ReviseDesign, ModulesAwayFromAMovedHoleStay) {
  const auto& [old, now, revision] = revised_plate();
  ASSERT_EQ(revision.new_id.size(), old->layout.modules.size());
  int away = 0, stay = 0;
  for (std::size_t k = 0; k < revision.new_id.size(); ++k) {
    const auto& corner = old->layout.modules[k].corner_mm;
    const Vec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
    // The corners of a module are 17.4 mm from its middle.
    const auto is_near = [&](const Vec2& hole) { return (on_plate(hole) - middle).norm() < kHoleRadius_mm + 20.0; };
    if (is_near({100, 120}) || is_near({250, 120})) continue;
    ++away;
    stay += revision.new_id[k] >= 0;
    if (revision.new_id[k] < 0) continue;
    EXPECT_EQ(now.layout.modules.at(static_cast<std::size_t>(revision.new_id[k])).corner_mm, corner);
  }
  EXPECT_GT(away, 80);
  EXPECT_GE(stay, 0.9 * away) << stay << " of " << away;
  RecordProperty("away", away);
  RecordProperty("stay", stay);
}

TEST(ReviseDesign, NothingStandsOverTheNewHole) {
  const auto& [old, now, revision] = revised_plate();
  for (const auto& m : now.layout.modules) EXPECT_LE(m.overrun_mm, now.limits.overrun_mm);
  EXPECT_GT(std::ranges::count(revision.new_id, -1), 0);
}

TEST(ReviseDesign, TheResultKeepsEveryRule) {
  EXPECT_EQ(broken_by(revised_plate().now), std::vector<std::string>{});
}

TEST(ReviseDesign, TablesOfUntouchedControllersStayWordByWord) {
  const auto& [old, now, revision] = revised_plate();
  std::vector<int> old_id(now.layout.modules.size(), -1), same(old->layout.modules.size());
  for (std::size_t k = 0; k < same.size(); ++k) same[k] = static_cast<int>(k);
  for (std::size_t k = 0; k < revision.new_id.size(); ++k) {
    if (revision.new_id[k] >= 0) old_id[static_cast<std::size_t>(revision.new_id[k])] = static_cast<int>(k);
  }
  int kept = 0;
  for (std::size_t p = 0; p < old->patches.size(); ++p) {
    const bool is_whole = std::ranges::all_of(
        old->patches[p].modules, [&](const auto& m) { return revision.new_id[static_cast<std::size_t>(m.node)] >= 0; });
    EXPECT_EQ(is_whole, std::ranges::binary_search(revision.kept_patches, layout::PatchIndex{p})) << p;
    if (!is_whole) continue;
    ++kept;
    EXPECT_EQ(table_of(now, static_cast<int>(p), old_id), table_of(*old, static_cast<int>(p), same)) << p;
  }
  EXPECT_GE(kept, 3);
}

TEST(ReviseDesign, AnUnchangedPartKeepsAll) {
  const auto& [old, now, revision] = revised_plate();
  const auto [again, notes] = design_of({100, 120}, old);
  EXPECT_EQ(std::ranges::count(notes.revision->new_id, -1), 0);
  EXPECT_EQ(notes.revision->kept_patches, design::patches_of(*old));
  EXPECT_GE(again.layout.modules.size(), old->layout.modules.size());
}

TEST(ReviseDesign, ThePictureShowsEveryChange) {
  const auto& [old, now, revision] = revised_plate();
  const std::string svg = exports::revision_svg(*old, now, revision.new_id, revision.added);
  const auto count = [&](const std::string& what) {
    std::ptrdiff_t times = 0;
    for (std::size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++times;
    return times;
  };
  EXPECT_EQ(count("class=\"gone\""), std::ranges::count(revision.new_id, -1));
  EXPECT_EQ(count("class=\"new\""), static_cast<std::ptrdiff_t>(revision.added.size()));
}

}  // namespace
}  // namespace triskin::pipeline
