// SPDX-License-Identifier: GPL-3.0-or-later
// Tests flat faces in any pose. Version 0.1 compared a determinant with an absolute 1e-12, where rounding alone gave
// 4e-12: `check` called 7 to 20 modules of a turned 200 × 180 mm plate "pierced", and the growth refused good modules
// by the same comparison.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>
#include <random>

#include "plan/check/flat_parts.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

namespace fs = std::filesystem;
using parts::box, parts::ridge;

class FlatFaces : public testing::Test {
 protected:
  FlatFaces() : folder_(fs::temp_directory_path() / ("flat_faces." + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~FlatFaces() override { fs::remove_all(folder_); }

  // Designs the mesh in `poses` random poses; each design must keep every rule and hold at least `least` modules.
  void expect_no_finding(const design::Mesh& mesh, int poses, std::size_t least) {
    std::mt19937_64 random(20);
    for (int pose = 0; pose < poses; ++pose) {
      mesh::write_obj(folder_ / "part.obj", parts::in_pose(mesh, 100.0, random));
      pipeline::DesignOptions options;
      options.iterations = 20;
      options.time_limit_s = 4.0;
      const design::Design design = pipeline::make_design(folder_ / "part.obj", options).design;
      EXPECT_GE(design.layout.modules.size(), least) << "pose " << pose;
      design::write_design(folder_ / "part.json", design);
      const DesignReport report = check_design(folder_ / "part.json");
      EXPECT_TRUE(report.violations.empty())
          << "pose " << pose << " of seed 20: " << report.violations.size() << " violations, the first: "
          << (report.violations.empty() ? "" : report.violations.front().rule + " " + report.violations.front().text);
    }
  }

 private:
  fs::path folder_;
};

TEST_F(FlatFaces, a_plate) {
  expect_no_finding(ridge(100, 180, 0.0), 7, 60);
}

TEST_F(FlatFaces, a_box) {
  expect_no_finding(box(110, 90, 70), 3, 40);
}

TEST_F(FlatFaces, ridges_and_valleys) {
  for (const double fold_deg : {20.0, 45.0, 90.0, 170.0, -20.0, -45.0, -90.0}) {
    SCOPED_TRACE(fold_deg);
    expect_no_finding(ridge(80, 120, fold_deg * std::numbers::pi / 180.0), 2, 20);
  }
}

}  // namespace
}  // namespace triskin::check
