// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {
namespace {

// Returns a sheet of 160 mm × 130 mm; `height` gives its z.
design::Mesh sheet(const auto& height) {
  constexpr int kColumns = 16, kRows = 13;
  design::Mesh mesh;
  for (int j = 0; j <= kRows; ++j) {
    for (int i = 0; i <= kColumns; ++i) mesh.vertices.emplace_back(10.0 * i, 10.0 * j, height(10.0 * i, 10.0 * j));
  }
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const int a = j * (kColumns + 1) + i, c = a + kColumns + 1;
      mesh.faces.push_back({a, a + 1, c + 1});
      mesh.faces.push_back({a, c + 1, c});
    }
  }
  return mesh;
}

design::Mesh plate() {
  return sheet([](double, double) { return 0.0; });
}

// The sagitta is 1 mm at 20 mm, as on a sphere with a radius of 200 mm.
design::Mesh dome() {
  return sheet([](double x, double y) { return -((x - 80.0) * (x - 80.0) + (y - 65.0) * (y - 65.0)) / 400.0; });
}

class SearchMethodTest : public testing::Test {
 protected:
  DesignNotes notes_of(const design::Mesh& mesh, SearchMethod method) {
    mesh::write_obj(folder_ / "part.obj", mesh);
    DesignOptions options;
    options.method = method;
    options.iterations = 1;
    options.time_limit_s = 600.0;
    options.threads = 1;
    return make_design(folder_ / "part.obj", options).notes;
  }

  static std::vector<std::string> names(const DesignNotes& notes) {
    std::vector<std::string> names;
    for (const StepTime& s : notes.steps) names.push_back(s.name);
    return names;
  }

  SearchMethodTest() { std::filesystem::create_directories(folder_); }
  ~SearchMethodTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("triskin_search_method_{}", ::getpid());
};

using Names = std::vector<std::string>;

TEST_F(SearchMethodTest, tries_pieces_on_a_plate) {
  const DesignNotes notes = notes_of(plate(), SearchMethod::kAuto);
  EXPECT_EQ(names(notes), Names({"reading", "repairing", "pieces", "growth", "pricing", "wiring"}));
  EXPECT_NEAR(notes.curvature_rad, 0.0, 1e-12);
  EXPECT_GT(notes.pieces, 20);
}

TEST_F(SearchMethodTest, leaves_pieces_out_on_a_dome_unless_they_are_asked_for) {
  const DesignNotes left_out = notes_of(dome(), SearchMethod::kAuto);
  EXPECT_EQ(names(left_out), Names({"reading", "repairing", "growth", "pricing", "wiring"}));
  EXPECT_EQ(left_out.pieces, 0);
  EXPECT_GT(left_out.surface, 20);
  // By formula 0.0071: 390 mm²/R² at the top, times 0.88 as the dome flattens outward, divided by 1.04 for its larger
  // area, times the 180 of 208 cells' vertices that are not on the border.
  EXPECT_NEAR(left_out.curvature_rad, 0.0071, 0.0004);
  EXPECT_GT(notes_of(dome(), SearchMethod::kPieces).pieces, 10);
}

TEST_F(SearchMethodTest, leaves_pieces_out_on_a_plate_when_asked) {
  EXPECT_EQ(notes_of(plate(), SearchMethod::kLattice).pieces, 0);
}

}  // namespace
}  // namespace triskin::pipeline
