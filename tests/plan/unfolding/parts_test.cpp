// SPDX-License-Identifier: GPL-3.0-or-later
// Every generated and every real cover must become a design that the independent checker accepts; broken files must end
// in a clear error.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/covers.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin {
namespace {

namespace fs = std::filesystem;

// Expects the checker to accept the design of the cover, and reading it back to give the same design.
design::Design accepted_design(const std::string& name, const fs::path& mesh, const pipeline::DesignOptions& options) {
  design::Design design = pipeline::make_design(mesh, options).design;
  const fs::path file = fs::temp_directory_path() / ("parts_test." + name + "." + std::to_string(::getpid()) + ".json");
  design::write_design(file, design);
  EXPECT_EQ(design::read_design(file).design_id, design.design_id);
  for (const auto& v : check::check_design(file).violations) ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;
  fs::remove(file);
  return design;
}

class Parts : public testing::TestWithParam<const char*> {};

TEST_P(Parts, designs_and_passes_every_rule) {
  const auto mesh = test::cover_file({GetParam()});
  if (!mesh) GTEST_SKIP() << test::no_data();
  pipeline::DesignOptions options;
  options.time_limit_s = 6.0;
  EXPECT_GE(accepted_design(GetParam(), mesh->path(), options).layout.modules.size(), 5U);
}

INSTANTIATE_TEST_SUITE_P(Covers, Parts,
                         testing::Values("HEAD_v1", "HIP_v1", "LH_hipwing_v1", "LT_root_v2", "LUA_upperarm_half_v1",
                                         "RFA_forearm_v1", "ROOT_v25", "RUF_forearm_v2", "SHANK_front_v25",
                                         "UA_upperarm_v1", "UL_upperleg_v1", "UT_torso_v1"),
                         [](const auto& part) { return std::string(part.param); });

// Each case is a generated cover and the least fraction of its area that modules must cover after few steps.
class GeneratedParts : public testing::TestWithParam<std::pair<test::CoverName, double>> {};

TEST_P(GeneratedParts, designs_and_passes_every_rule) {
  const auto& [cover, min_coverage] = GetParam();
  const auto mesh = test::cover_file(cover);
  pipeline::DesignOptions options;
  options.time_limit_s = 6.0;
  options.iterations = 40;
  EXPECT_GE(accepted_design(cover.name, mesh->path(), options).report.coverage, min_coverage);
}

INSTANTIATE_TEST_SUITE_P(Covers, GeneratedParts,
                         testing::Values(std::pair{test::CoverName{"torso"}, 0.65},
                                         std::pair{test::CoverName{"hip"}, 0.65},
                                         std::pair{test::CoverName{"thigh"}, 0.65},
                                         std::pair{test::CoverName{"near-degenerate"}, 0.55}),
                         [](const auto& p) { return test::case_name(p.param.first.name); });

// Expects a raw CAD mesh to become a design, or an error that names the file and the place.
void expect_design_or_clear_error(const std::string& name, const fs::path& mesh) {
  try {
    pipeline::DesignOptions options;
    options.time_limit_s = 5.0;
    EXPECT_GT(pipeline::make_design(mesh, options).design.layout.modules.size(), 0U);
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("mm"), std::string::npos) << "the place is missing: " << e.what();
  }
}

class HardMesh : public testing::TestWithParam<const char*> {};

TEST_P(HardMesh, ends_in_a_result_or_a_clear_error) {
  const fs::path mesh = test::data_folder() / "hard" / (std::string(GetParam()) + ".stl");
  if (!fs::exists(mesh)) GTEST_SKIP() << test::no_data();
  expect_design_or_clear_error(GetParam(), mesh);
}
INSTANTIATE_TEST_SUITE_P(Covers, HardMesh, testing::Values("icub25_l_hip_2", "icub25_root_link", "upmc_icub_chest"),
                         [](const auto& p) { return std::string(p.param); });

TEST(HardMeshes, generated_shell_is_repaired_or_refused_as_asked) {
  const auto mesh = test::cover_file({"dirty-shell"});
  pipeline::DesignOptions options;
  options.time_limit_s = 2.0;
  options.repair = pipeline::RepairMode::kNever;
  EXPECT_THROW((void)pipeline::make_design(mesh->path(), options), InputError);
  options.repair = pipeline::RepairMode::kAuto;
  const auto [design, notes] = pipeline::make_design(mesh->path(), options);
  EXPECT_GT(design.layout.modules.size(), 0U);
  EXPECT_GT(notes.extract.deviation.largest_mm, 0.0);
}

// Pieces that cannot win in their part of the time leave it to the growth.
TEST(TimeLimit, pieces_give_up_soon_after_their_time) {
  const auto mesh = test::cover_file({"thigh"});
  const mesh::Surface surface(mesh::read_mesh(mesh->path()).mesh);
  int asked = 0;  // This number replaces a clock.
  unfolding::UnfoldingOptions options;
  options.give_up = [&] { return ++asked > 3; };
  EXPECT_TRUE(unfolding::unfold(surface, options).pieces.empty());
  EXPECT_LT(asked, 12);  // The search stops soon after.
  const std::size_t whole = unfolding::unfold(surface).pieces.size();
  EXPECT_GT(whole, 0U);
  options.give_up = [] { return false; };
  EXPECT_EQ(unfolding::unfold(surface, options).pieces.size(), whole);
}

// Pieces are left out and counted if no time remains to map them to the surface.
TEST(TimeLimit, the_mapping_gives_up_between_pieces_and_counts_what_it_leaves_out) {
  // The sheet has room for 2,500 modules: more than are mapped between two readings of the clock.
  design::Mesh sheet;
  sheet.vertices = {{0, 0, 0}, {1000, 0, 0}, {1000, 1000, 0}, {0, 1000, 0}};
  sheet.faces = {{0, 1, 2}, {0, 2, 3}};
  const mesh::Surface surface(sheet);
  const unfolding::Net net = unfolding::unfold(surface);
  ASSERT_EQ(net.pieces.size(), 1U);
  placement::PlacementOptions placement;
  placement.time_limit_s = 0.1;
  const placement::PlacementResult placed = placement::place(net.pieces[0].outline, placement);
  const std::vector<lattice::TiledPiece> pieces(3, {&net.pieces[0], placed.placement, placed.tiles});
  const std::size_t n = placed.tiles.size();
  ASSERT_GT(n, 2000U);
  int asked = 0;
  const auto mapped = lattice::map_modules(surface, pieces, {}, 0.0, nullptr, [&] { return ++asked > 0; });
  EXPECT_EQ(mapped.modules.size(), n) << "the first piece is mapped whatever the time";
  EXPECT_EQ(asked, 2);
  const std::vector<std::pair<std::string, int>> left_out{{"time_limit", static_cast<int>(2 * n)}};
  EXPECT_EQ(mapped.refused, left_out);
  const auto alone = lattice::map_modules(surface, {pieces[0]}, {});
  EXPECT_EQ(alone.modules.size(), n);
  EXPECT_TRUE(alone.refused.empty());
  for (std::size_t k = 0; k < n; ++k)
    EXPECT_TRUE(alone.modules[k].corner_mm == mapped.modules[k].corner_mm) << "module " << k;
}

// Tetrahedra of a solid were written as faces of four corners: every inner edge has many faces, and all cross.
TEST(HardMeshes, tetrahedra_read_as_quadrangles_become_a_design_that_passes_every_rule) {
  constexpr int kCells = 6;
  constexpr std::array<std::array<int, 4>, 6> kCorners{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  const fs::path file = fs::temp_directory_path() / ("parts_test.tetrahedra." + std::to_string(::getpid()) + ".obj");
  std::ofstream out(file);
  for (int k = 0; k < (kCells + 1) * (kCells + 1) * (kCells + 1); ++k)
    out << "v " << 25 * (k % (kCells + 1)) << ' ' << 25 * (k / (kCells + 1) % (kCells + 1)) << ' '
        << 25 * (k / ((kCells + 1) * (kCells + 1))) << '\n';
  for (int cell = 0; cell < kCells * kCells * kCells; ++cell) {
    const int x = cell % kCells, y = cell / kCells % kCells, z = cell / (kCells * kCells);
    for (const auto& corners : kCorners) {
      out << 'f';
      for (const int c : corners)
        out << ' ' << 1 + x + (c & 1) + (kCells + 1) * (y + (c >> 1 & 1) + (kCells + 1) * (z + (c >> 2)));
      out << '\n';
    }
  }
  out.close();
  pipeline::DesignOptions options;
  options.unit = mesh::LengthUnit::kMillimetre;
  options.time_limit_s = 6.0;
  EXPECT_GT(accepted_design("tetrahedra", file, options).layout.modules.size(), 0U);
  fs::remove(file);
}

std::string error_of(const std::string& file_name, const std::string& content,
                     std::optional<mesh::LengthUnit> unit = {},
                     pipeline::RepairMode repair = pipeline::RepairMode::kAuto) {
  const fs::path path = fs::temp_directory_path() / (std::to_string(::getpid()) + "." + file_name);
  std::ofstream(path, std::ios::binary) << content;
  std::string message;
  try {
    pipeline::DesignOptions options;
    options.unit = unit;
    options.repair = repair;
    options.time_limit_s = 1.0;
    (void)pipeline::make_design(path, options);
  } catch (const InputError& e) {
    message = e.what();
    EXPECT_NE(message.find(path.filename().string()), std::string::npos) << message;
  }
  fs::remove(path);
  return message;
}

TEST(BadMeshes, are_named_with_the_reason) {
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(has(error_of("empty.obj", ""), "empty"));
  EXPECT_TRUE(has(error_of("noise.stl", std::string(3000, '\x7f')), "not a mesh"));
  EXPECT_TRUE(has(error_of("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "no triangle"));
  EXPECT_TRUE(has(error_of("line.obj", "v 0 0 0\nv 100 0 0\nv 200 0 0\nf 1 2 3\n"), "no triangle"));
  EXPECT_TRUE(has(error_of("metres.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nf 1 2 3\n"), "--unit m"));
  EXPECT_EQ(error_of("metres.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nf 1 2 3\n", mesh::LengthUnit::kMetre), "");
  EXPECT_TRUE(has(error_of("huge.obj", "v 0 0 0\nv 3e5 0 0\nv 0 3e5 0\nf 1 2 3\n"), "larger than a body part"));
  EXPECT_NE(error_of("nan.obj", "v nan 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n"), "");
  EXPECT_TRUE(
      has(error_of("fan.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 -100 0\nv 0 0 100\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", {},
                   pipeline::RepairMode::kNever),
          "not a manifold"));
  EXPECT_TRUE(has(error_of("tall.obj", "v 0 0 0\nv 3500 0 0\nv 0 30 0\nf 1 2 3\n"), "--unit mm"));
}

}  // namespace
}  // namespace triskin
