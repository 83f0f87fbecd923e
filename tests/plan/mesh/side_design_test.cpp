// SPDX-License-Identifier: GPL-3.0-or-later
// Designs parts with a wall: modules must be on the outer side, which the checker tests by its own rays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/design.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "walled_parts.hpp"

namespace triskin {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::WalledPart;
namespace fs = std::filesystem;

class SideDesign : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("side." + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  design::Design design_of(const std::string& part, mesh::SideWanted wanted = mesh::SideWanted::kAuto) {
    const std::vector<WalledPart> parts = testing::walled_parts();
    return design_of(*std::ranges::find(parts, part, &WalledPart::name), wanted);
  }
  design::Design design_of(const WalledPart& part, mesh::SideWanted wanted = mesh::SideWanted::kAuto) {
    mesh::write_obj(folder_ / "part.obj", part.mesh);
    pipeline::DesignOptions options;
    options.iterations = 20;
    options.time_limit_s = 60.0;
    options.side.wanted = wanted;
    pipeline::DesignResult made = pipeline::make_design(folder_ / "part.obj", options);
    notes_ = std::move(made.notes);
    return std::move(made.design);
  }
  // Returns the names of the broken rules about sides, one for each violation.
  std::vector<std::string> broken(const nlohmann::json& design) {
    std::ofstream(folder_ / "checked.json") << design.dump();
    std::vector<std::string> names;
    for (const check::Violation& v : check::check_design(folder_ / "checked.json").violations) {
      if (v.rule == "inner-side" || v.rule == "back-to-back") names.push_back(v.rule);
    }
    return names;
  }
  nlohmann::json json_of(const design::Design& d) {
    design::write_design(folder_ / "design.json", d);
    return nlohmann::json::parse(read_file(folder_ / "design.json"));
  }

  fs::path folder_;
  pipeline::DesignNotes notes_;
};

TEST_F(SideDesign, ModulesLieOnTheOuterSide) {
  for (const char* part : {"tray", "ribs_and_bosses", "half_shell_with_ribs", "box_with_lid", "round_rimmed_cap"}) {
    const design::Design d = design_of(part);
    ASSERT_TRUE(d.side.has_value()) << part;
    EXPECT_TRUE(d.side->is_certain) << part;
    EXPECT_FALSE(d.layout.modules.empty()) << part;
    EXPECT_THAT(broken(json_of(d)), IsEmpty()) << part;
  }
}

// Some modules lie in a recess and see less than their back, which sees out of a shallow tray.
TEST_F(SideDesign, FloorOfARecessIsNoInnerSide) {
  for (const auto& [kind, seed] : {std::pair{4, 302U}, {15, 301U}, {15, 302U}}) {
    const WalledPart part = testing::random_walled_part(kind, seed);
    EXPECT_THAT(broken(json_of(design_of(part))), IsEmpty()) << part.name;
  }
}

// The design covers the inner side, although its file says that nobody asked for it.
TEST_F(SideDesign, CheckerFindsModulesOnTheInnerSide) {
  nlohmann::json design = json_of(design_of("half_shell_with_holes", mesh::SideWanted::kInner));
  EXPECT_THAT(broken(design), IsEmpty());
  design["side"]["taken"] = "outer";
  const std::vector<std::string> names = broken(design);
  EXPECT_EQ(names.size(), design["modules"].size());
  EXPECT_THAT(names, Not(Contains("back-to-back")));
}

// The design covers both sides, in a file from before there was a choice.
TEST_F(SideDesign, CheckerFindsModulesBackToBack) {
  nlohmann::json design = json_of(design_of("tray", mesh::SideWanted::kBoth));
  EXPECT_THAT(broken(design), IsEmpty());
  design.erase("side");
  EXPECT_THAT(broken(design), Contains("back-to-back"));
  EXPECT_THAT(broken(design), Contains("inner-side"));
}

TEST_F(SideDesign, ALidIsAskedAbout) {
  const design::Design d = design_of("flat_lid");
  EXPECT_TRUE(notes_.side.is_undecided);
  EXPECT_TRUE(d.layout.modules.empty());
  EXPECT_FALSE(notes_.part.faces.empty());
}

// Reading the file restores the part unchanged.
TEST_F(SideDesign, FileKeepsThePart) {
  const design::Design d = design_of("tray");
  design::write_design(folder_ / "design.json", d);
  const design::Design again = design::read_design(folder_ / "design.json");
  ASSERT_TRUE(again.side.has_value());
  EXPECT_EQ(again.side->taken, "outer");
  EXPECT_EQ(again.side->part.faces, d.side->part.faces);
  EXPECT_EQ(again.side->part.vertices, d.side->part.vertices);
  EXPECT_NEAR(again.side->wall_mm, 2.0, 1e-6);
}

TEST_F(SideDesign, SurfacesWithoutAWallHaveNoSide) {
  const design::Design d = design_of("scan");
  EXPECT_FALSE(d.side.has_value());
  EXPECT_FALSE(json_of(d).contains("side"));
}

}  // namespace
}  // namespace triskin
