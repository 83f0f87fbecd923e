// SPDX-License-Identifier: GPL-3.0-or-later
// Designs of a ridge and a valley, whose only folds have one known angle and direction.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "checked_file.hpp"
#include "flat_parts.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

namespace fs = std::filesystem;

constexpr double kFold_rad = 0.5, kLimit_rad = 0.3;

class DirectedFolds : public testing::TestWithParam<pipeline::SearchMethod> {
 protected:
  DirectedFolds() : folder_(fs::temp_directory_path() / ("directed_folds." + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~DirectedFolds() override { fs::remove_all(folder_); }

  // Returns the largest fold of a design of two plates, after `check` has accepted it.
  double largest_fold_rad(double fold_rad, const design::LayoutLimits& limits) {
    mesh::write_obj(folder_ / "part.obj", parts::ridge(110.0, 200.0, fold_rad));
    pipeline::DesignOptions options;
    options.method = GetParam();
    options.iterations = 60;
    options.time_limit_s = 60.0;
    options.limits = limits;
    const design::Design design = pipeline::make_design(folder_ / "part.obj", options).design;
    design::write_design(folder_ / "part.json", design);
    const auto text = nlohmann::json::parse(read_file(folder_ / "part.json"));
    EXPECT_THAT(broken_rules(text, folder_ / "checked.json"), testing::IsEmpty());
    EXPECT_EQ(design::read_design(folder_ / "part.json").limits.fold_away_rad, limits.fold_away_rad);
    EXPECT_GT(design.layout.modules.size(), 40U);
    double largest = 0.0;
    for (const design::PlacedModule& m : design.layout.modules)
      largest = std::max(largest, std::ranges::max(m.fold_rad));
    return largest;
  }

  fs::path folder_;
};

// A module that straddles the bend shares its angle between two joints, so the other direction need not reach it.
TEST_P(DirectedFolds, only_the_direction_that_is_limited_has_no_fold) {
  design::LayoutLimits away, towards;
  away.fold_away_rad = towards.fold_towards_rad = kLimit_rad;
  EXPECT_LE(largest_fold_rad(kFold_rad, away), kLimit_rad);
  EXPECT_GT(largest_fold_rad(kFold_rad, towards), kLimit_rad);
  EXPECT_LE(largest_fold_rad(-kFold_rad, towards), kLimit_rad);
  EXPECT_GT(largest_fold_rad(-kFold_rad, away), kLimit_rad);
}
INSTANTIATE_TEST_SUITE_P(Methods, DirectedFolds,
                         testing::Values(pipeline::SearchMethod::kLattice, pipeline::SearchMethod::kPieces),
                         [](const auto& of) {
                           return of.param == pipeline::SearchMethod::kPieces ? "Pieces" : "Lattice";
                         });

}  // namespace
}  // namespace triskin::check
