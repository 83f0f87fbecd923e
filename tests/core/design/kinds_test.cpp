// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/kinds.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "support/flat_design.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/mirror.hpp"
#include "triskin/exports/export.hpp"

namespace triskin::design {
namespace {

namespace fs = std::filesystem;

const std::string kFile = R"({"format":"triskin-kinds","version":1,
  "kinds":[{"name":"soft","taxels":10,"dielectric":"silicone foam, 3 mm","sensitivity_counts_per_kpa":80},
           {"name":"hard"}],
  "regions":[{"kind":"soft","box":{"low_mm":[0,-1,-1],"high_mm":[50,30,1]}},{"kind":"hard","modules":[1,5]},
             {"kind":"standard","sphere":{"center_mm":[15,8.7,0],"radius_mm":1}}]})";

class Kinds : public testing::Test {
 protected:
  void SetUp() override { path_ = fs::temp_directory_path() / ("kinds_test." + std::to_string(::getpid()) + ".json"); }
  void TearDown() override { fs::remove(path_); }
  [[nodiscard]] KindPlan plan_of(const std::string& text) const {
    write_file_atomically(path_, text);
    return read_kind_plan(path_);
  }
  [[nodiscard]] std::string error_with(const std::string& from, const std::string& to) const {
    std::string text = kFile;
    text.replace(text.find(from), from.size(), to);
    try {
      (void)plan_of(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  [[nodiscard]] Design kinds_of_strip() const {
    Design d = test::strip(6);
    d.kinds = plan_of(kFile);
    assign_kinds(d.kinds, d.layout);
    d.design_id = design_id_of(d);
    return d;
  }
  fs::path path_;
};

std::vector<int> numbers(const ModuleLayout& layout) {
  std::vector<int> kinds;
  for (const PlacedModule& m : layout.modules) kinds.push_back(m.kind);
  return kinds;
}

// The centres of the strip are at x = 15, 30, 45, 60, …: modules 0 … 2 lie in the box, 0 also in the sphere.
TEST_F(Kinds, are_chosen_by_region_and_the_last_one_counts) {
  const Design d = kinds_of_strip();
  ASSERT_EQ(d.kinds.kinds.size(), 2U);
  EXPECT_EQ(d.kinds.kinds[0], (ModuleKind{"soft", 10, "silicone foam, 3 mm", 80.0}));
  EXPECT_EQ(d.kinds.kinds[1], (ModuleKind{"hard", 12, "", 0.0}));
  EXPECT_EQ(numbers(d.layout), (std::vector{0, 2, 1, 0, 0, 2}));
  EXPECT_EQ(count_kinds(d.kinds, d.layout), (std::vector{3, 1, 2}));
  EXPECT_EQ(kind_of(d.kinds, 0).name, "standard");
  EXPECT_THROW((void)kind_of(d.kinds, 3), std::out_of_range);
  // From module 1 on only the place counts, because the list means modules of another layout.
  ModuleLayout layout = d.layout;
  layout.modules[0].kind = 2;
  assign_kinds_by_place(d.kinds, layout, 1);
  EXPECT_EQ(numbers(layout), (std::vector{2, 1, 1, 0, 0, 0}));
  layout.modules.resize(4);
  EXPECT_THROW(assign_kinds(d.kinds, layout), InputError);
}

TEST_F(Kinds, errors_name_the_place) {
  const std::string error = error_with("\"taxels\":10", "\"taxels\":13");
  EXPECT_NE(error.find("/kinds/0/taxels: must be in 1 … 12"), std::string::npos) << error;
  EXPECT_NE(error_with("\"hard\"}]", "\"soft\"}]").find("/kinds/1/name: appears twice"), std::string::npos);
  EXPECT_NE(error_with("\"hard\"}]", "\"standard\"}]").find("/kinds/1/name"), std::string::npos);
  EXPECT_NE(error_with("\"kind\":\"hard\"", "\"kind\":\"harder\"").find("\"harder\" is not among"), std::string::npos);
  EXPECT_NE(error_with("\"modules\":[1,5]", "\"patches\":[1,5]").find("\"patches\" is unknown"), std::string::npos);
  EXPECT_NE(
      error_with("\"version\":1", "\"version\":2").find("/version: this file is of version 2, this program reads 1"),
      std::string::npos);
  EXPECT_NE(error_with(":80", ":-1").find("sensitivity_counts_per_kpa"), std::string::npos);
}

TEST_F(Kinds, stand_in_the_design_file_and_its_id) {
  const Design d = kinds_of_strip();
  write_design(path_, d);
  const Design read = read_intact_design(path_);
  EXPECT_EQ(read.kinds, d.kinds);
  EXPECT_EQ(numbers(read.layout), numbers(d.layout));
  Design other = d;
  other.layout.modules[3].kind = 1;
  EXPECT_NE(design_id_of(other), d.design_id);
  other = d;
  other.kinds.kinds[0].taxels = 9;
  EXPECT_NE(design_id_of(other), d.design_id);
  // Files, ids and lists do not mention kinds that are not needed.
  other.kinds = {};
  assign_kinds(other.kinds, other.layout);
  EXPECT_EQ(design_id_of(other), test::strip(6).design_id);
  other.design_id = design_id_of(other);
  write_design(path_, other);
  EXPECT_EQ(read_file(path_).find("kind"), std::string::npos);
  EXPECT_TRUE(
      exports::taxels_csv(other).starts_with("cover,module,taxel,patch,line,address,x_mm,y_mm,z_mm,nx,ny,nz\n"));
}

TEST_F(Kinds, stand_in_the_lists) {
  const Design d = kinds_of_strip();
  const std::string csv = exports::taxels_csv(d);
  EXPECT_TRUE(csv.starts_with("cover,module,taxel,patch,line,address,x_mm,y_mm,z_mm,nx,ny,nz,kind\nstrip,0,0,0,"));
  EXPECT_NE(csv.find(",standard\n"), std::string::npos);
  EXPECT_NE(csv.find(",soft\n"), std::string::npos);
}

TEST_F(Kinds, are_mirrored_with_the_cover) {
  const KindPlan plan = plan_of(kFile);
  const KindPlan image = mirrored(plan, {Vec3::UnitX(), 5.0});
  EXPECT_EQ(std::get<Box>(image.regions[0].region), (Box{{-40, -1, -1}, {10, 30, 1}}));
  EXPECT_EQ(image.regions[1], plan.regions[1]);
  EXPECT_EQ(std::get<Sphere>(image.regions[2].region).center_mm, Vec3(-5, 8.7, 0));
  EXPECT_EQ(mirrored(plan, {Vec3(1, 1, 0).normalized(), 5.0}).regions.size(), 2U);
}

}  // namespace
}  // namespace triskin::design
