// SPDX-License-Identifier: GPL-3.0-or-later
// What design and edit write is judged before it is a file: modules that break a rule go, or nothing is written.
#include "app/cli/src/geometry/checked_output.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "checked_file.hpp"
#include "support/temp_folder.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {
namespace {

using design::Vec3;

class CheckedOutput : public testing::Test {
 protected:
  // A plate with 20 modules or more.
  static design::Design plate_design(const test::TempFolder& folder) {
    mesh::write_obj(folder / "plate.obj",
                    check::sheet_mesh(15, 10, [](int c, int r) { return Vec3(10.0 * c, 10.0 * r, 0.0); }));
    pipeline::DesignOptions options;
    options.iterations = 60;
    options.time_limit_s = 60.0;
    return pipeline::make_design(folder / "plate.obj", options).design;
  }
  static void move(design::PlacedModule& m, const Vec3& by) {
    for (Vec3& corner : m.corner_mm) corner += by;
  }
};

TEST_F(CheckedOutput, is_written_as_it_is_when_no_rule_is_broken) {
  const test::TempFolder folder;
  design::Design d = plate_design(folder);
  const std::size_t modules = d.layout.modules.size();
  const std::string path = folder / "good.json";
  const OutputCheck check = write_checked_design(path, d, OnViolation::kRefuse);
  EXPECT_TRUE(check.keeps_all_rules());
  EXPECT_EQ(check.removed.size(), 0U);
  EXPECT_GE(modules, 20U);
  EXPECT_EQ(check::check_design(path).modules, modules);
}

// A module 5 mm above its place gapes at its joints and over the surface.
TEST_F(CheckedOutput, leaves_out_a_module_that_breaks_a_rule) {
  const test::TempFolder folder;
  design::Design d = plate_design(folder);
  const std::size_t modules = d.layout.modules.size();
  move(d.layout.modules[3], {0.0, 0.0, 5.0});
  const std::string path = folder / "mended.json";
  const OutputCheck check = write_checked_design(path, d, OnViolation::kRemoveModules);
  EXPECT_TRUE(check.keeps_all_rules());
  EXPECT_EQ(check.removed.size(), 1U);
  const check::DesignReport report = check::check_design(path);
  EXPECT_EQ(report.violations.size(), 0U);
  EXPECT_EQ(report.modules, modules - check.removed.size());
  EXPECT_EQ(d.layout.modules.size(), report.modules);
}

TEST_F(CheckedOutput, is_refused_where_every_module_must_stay) {
  const test::TempFolder folder;
  design::Design d = plate_design(folder);
  move(d.layout.modules[3], {0.0, 0.0, 5.0});
  const std::string path = folder / "refused.json";
  EXPECT_INPUT_ERROR((void)write_checked_design(path, d, OnViolation::kRefuse), "hinge-gap");
  EXPECT_FALSE(std::filesystem::exists(path));
}

// The wiring of a controller has no module that could be left out.
TEST_F(CheckedOutput, is_refused_where_a_broken_rule_names_no_module) {
  const test::TempFolder folder;
  design::Design d = plate_design(folder);
  d.patches[0].max_depth += 1;
  const std::string path = folder / "refused.json";
  EXPECT_INPUT_ERROR((void)write_checked_design(path, d, OnViolation::kRemoveModules), "max-depth");
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace triskin::cli
