// SPDX-License-Identifier: GPL-3.0-or-later
// Designs a mesh with more faces than its shape needs: the search uses few faces, while report and check use all.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "plan/lattice/shapes.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/edit_design.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {
namespace {

using design::Vec3;
using triskin::at;

// Makes a roof of two planes and a bent eave, 180 × 150 mm; 120 × 100 cells.
design::Mesh roof() {
  return lattice::grid_mesh(120, 100, [](double u, double v) {
    return Vec3(180 * u, 150 * v, std::min(20.0 * u, 12.0) + 4.0 * std::max(0.0, v - 0.5) * v);
  });
}

struct Files {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("triskin_solver_mesh_{}", ::getpid());
  Files() { std::filesystem::create_directories(folder); }
  ~Files() { std::filesystem::remove_all(folder); }
};

DesignOptions quick() {
  DesignOptions options;
  options.time_limit_s = 600.0;
  options.iterations = 20;
  return options;
}

TEST(DesignOfADenseMesh, is_measured_and_checked_on_all_faces) {
  const Files files;
  const design::Mesh mesh = roof();
  mesh::write_obj(files.folder / "roof.obj", mesh);
  DesignOptions options = quick();
  options.regions.emplace();
  design::FaceSet middle;  // The region must stay free and is given by the faces of the file.
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    const Vec3& p = mesh.vertices[at(mesh.faces[at(f)][0])];
    if (std::hypot(p.x() - 90.0, p.y() - 75.0) < 15.0) middle.faces.emplace_back(f);
  }
  design::WantedRegion logo;
  logo.region.name = "logo";
  logo.region.shape = middle;
  logo.region.free = true;
  options.regions->regions.push_back(logo);
  const auto [d, notes] = make_design(files.folder / "roof.obj", options);
  EXPECT_LT(notes.solver_faces, 2'000);
  EXPECT_GT(notes.solver_deviation_mm, 0.0);
  EXPECT_LE(notes.solver_deviation_mm, 0.05);
  EXPECT_EQ(d.surface.faces.size(), 24'000U);
  EXPECT_TRUE(d.pieces.empty());
  EXPECT_GT(notes.pieces, 10);
  EXPECT_GT(d.layout.modules.size(), 30U);
  design::write_design(files.folder / "roof.json", d);
  const check::DesignReport report = check::check_design(files.folder / "roof.json");
  for (const check::Violation& v : report.violations) ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;
}

TEST(DesignOfADenseMesh, is_searched_on_all_faces_when_asked) {
  const Files files;
  mesh::write_obj(files.folder / "roof.obj", roof());
  DesignOptions options = quick();
  options.iterations = 1;
  options.solver_deviation_mm = 0.0;
  const auto [d, notes] = make_design(files.folder / "roof.obj", options);
  EXPECT_EQ(notes.solver_faces, 24'000);
  EXPECT_EQ(notes.solver_deviation_mm, 0.0);
  EXPECT_FALSE(d.pieces.empty());
}

TEST(DesignOfADenseMesh, is_grown_around_modules_that_stay) {
  const Files files;
  mesh::write_obj(files.folder / "roof.obj", roof());
  DesignOptions options = quick();
  options.iterations = 1;
  const design::Design d = make_design(files.folder / "roof.obj", options).design;
  ASSERT_GT(d.layout.modules.size(), 10U);
  const EditedDesign grown = grow_around(d, {2, 3, 5}, {.time_limit_s = 600.0, .iterations = 10});
  for (const int k : {2, 3, 5}) {
    ASSERT_GE(grown.new_id[at(k)], 0);
    EXPECT_EQ(grown.design.layout.modules[at(grown.new_id[at(k)])].corner_mm, d.layout.modules[at(k)].corner_mm);
  }
  design::write_design(files.folder / "roof.json", grown.design);
  EXPECT_TRUE(check::check_design(files.folder / "roof.json").violations.empty());
}

}  // namespace
}  // namespace triskin::pipeline
