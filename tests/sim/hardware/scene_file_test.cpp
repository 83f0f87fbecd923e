// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/hardware/scene.hpp"

namespace triskin::hardware {
namespace {

using test::strip;

namespace fs = std::filesystem;

class SceneFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("scene_file_test." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    design::write_design(folder_ / "d.json", strip(6));
  }
  void TearDown() override { fs::remove_all(folder_); }

  Scene read(const std::string& text) const {
    std::ofstream(folder_ / "s.json", std::ios::binary | std::ios::trunc) << text;
    return read_scene(folder_ / "s.json");
  }
  Scene with(const std::string& rest) const {
    return read(R"({"format":"triskin-scene","version":1,"design":"d.json",)" + rest + "}");
  }
  std::string error_with(const std::string& rest) const {
    try {
      (void)with(rest);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  fs::path folder_;
};

TEST_F(SceneFile, a_design_file_is_a_scene_without_anything_wrong) {
  const Scene scene = read_scene(folder_ / "d.json");
  EXPECT_EQ(scene.design.layout.modules.size(), 6U);
  EXPECT_TRUE(scene.faults.empty());
}

TEST_F(SceneFile, reads_contacts_faults_and_effects) {
  const Scene s = with(R"("seed":7,
    "contacts":[{"at_s":0.5,"until_s":1,"module":2,"taxel":3,"force_n":3},{"position_mm":[15,9,3],"radius_mm":4}],
    "faults":[{"kind":"swapped_chips","module":1,"other":2},{"kind":"stuck_line","patch":0,"line":3,"signal":"scl",
     "at_s":2},
              {"kind":"lost_configuration","module":4,"at_s":0.25,"every_s":2}],
    "effects":{"noise_counts":3,"electrode_pf":[5,6.5],"bus_bit_rate":1000000})");
  EXPECT_EQ(s.seed, 7U);
  ASSERT_EQ(s.contacts.size(), 2U);
  EXPECT_EQ(s.contacts[0].from_us, 500'000U);
  EXPECT_NEAR((s.contacts[0].position_mm - center_of(s.design, layout::ModuleId{2})).norm(), 0.0, 1e-9);
  EXPECT_EQ(s.contacts[1].until_us, kForever);
  EXPECT_DOUBLE_EQ(s.contacts[1].radius_mm, 4.0);
  ASSERT_EQ(s.faults.size(), 3U);
  EXPECT_EQ(s.faults[0].kind, FaultKind::kSwappedChips);
  EXPECT_TRUE(s.faults[1].stuck_scl);
  EXPECT_EQ(s.faults[2].every_us, 2'000'000U);
  EXPECT_DOUBLE_EQ(s.effects.noise_counts, 3.0);
  EXPECT_DOUBLE_EQ(s.effects.electrode_least_pf, 5.0);
  EXPECT_DOUBLE_EQ(s.effects.electrode_most_pf, 6.5);
}

TEST_F(SceneFile, converters_are_drawn_unless_the_scene_says_otherwise) {
  const auto chip = [&](const std::string& more, std::uint64_t serial) {
    return with(more).effects.converters.of(serial);
  };
  EXPECT_TRUE(read_scene(folder_ / "d.json").effects.converters.drawn);
  EXPECT_NE(chip(R"("seed":1)", 1).zero_counts, chip(R"("seed":1)", 2).zero_counts);
  EXPECT_NE(chip(R"("converters":"drawn")", 1).zero_counts, chip(R"("converters":"drawn")", 2).zero_counts);
  EXPECT_EQ(chip(R"("converters":"ideal")", 1).zero_counts, 0.0);
  const char* some = R"("converters":{"neg_step_ratio":0.99,"zero_counts":-20,"latched_at_end":true})";
  EXPECT_EQ(chip(some, 1).neg_step_ratio, 0.99);
  EXPECT_EQ(chip(some, 2).zero_counts, -20.0);
  EXPECT_TRUE(chip(some, 3).latched_at_end);
  EXPECT_NE(chip(some, 1).step_counts, chip(some, 2).step_counts);
  EXPECT_EQ(chip(R"("converters":{"zero_counts":-20,"others":"ideal"})", 1).step_counts, 0.32 * kCountsPerPf);
}

TEST_F(SceneFile, a_removed_chip_may_come_and_go) {
  const Scene s = with(R"("faults":[{"kind":"removed_chip","module":1},
    {"kind":"removed_chip","module":2,"at_s":1,"until_s":1.5}])");
  ASSERT_EQ(s.faults.size(), 2U);
  EXPECT_EQ(s.faults[0].from_us, 0U);
  EXPECT_EQ(s.faults[0].until_us, kForever);
  EXPECT_EQ(s.faults[1].from_us, 1'000'000U);
  EXPECT_EQ(s.faults[1].until_us, 1'500'000U);
  EXPECT_NE(error_with(R"("faults":[{"kind":"removed_chip","module":2,"at_s":2,"until_s":2}])").find("until_s"),
            std::string::npos);
}

TEST_F(SceneFile, names_what_is_wrong) {
  const std::pair<const char*, const char*> cases[] = {
      {R"("fault":[])", "key \"fault\" is unknown"},
      {R"("faults":[{"kind":"melted"}])", "/faults/0/kind: \"melted\" is not a kind of fault"},
      {R"("faults":[{"kind":"removed_chip","module":6}])", "/faults/0/module: must be in 0 … 5"},
      {R"("faults":[{"kind":"removed_chip","module":1.5}])", "/faults/0/module: must be an integer"},
      {R"("faults":[{"kind":"removed_chip"}])", "key \"module\" is missing"},
      {R"("faults":[{"kind":"removed_chip","module":1,"line":2}])", "key \"line\" is unknown"},
      {R"("faults":[{"kind":"swapped_chips","module":1,"other":1}])", "must be another module"},
      {R"("faults":[{"kind":"moved_chip","module":1,"line":4,"address":0}])", "/faults/0/line"},
      {R"("faults":[{"kind":"stuck_line","patch":1,"line":0}])", "/faults/0/patch"},
      {R"("faults":[{"kind":"stuck_line","patch":0,"line":0,"signal":"x"}])", "/faults/0/signal"},
      {R"("faults":[{"kind":"frozen_taxel","module":0,"taxel":12}])", "/faults/0/taxel"},
      {R"("faults":[7])", "/faults/0: must be an object"},
      {R"("faults":{})", "faults: must be an array"},
      {R"("contacts":[{}])", "needs either"},
      {R"("contacts":[{"module":1,"position_mm":[0,0,0]}])", "needs either"},
      {R"("contacts":[{"position_mm":[0,0]}])", "/contacts/0/position_mm"},
      {R"("contacts":[{"position_mm":[0,0,1e9]}])", "/contacts/0/position_mm/2"},
      {R"("contacts":[{"module":1,"at_s":2,"until_s":1}])", "/contacts/0/until_s"},
      {R"("contacts":[{"module":1,"at_s":-1}])", "/contacts/0/at_s"},
      {R"("contacts":[{"module":1,"to_mm":[0,0,0]}])", "/contacts/0/to_mm"},
      {R"("contacts":[{"module":1,"radius_mm":0}])", "/contacts/0/radius_mm"},
      {R"("effects":{"noise_counts":-1})", "/effects/noise_counts"},
      {R"("effects":{"electrode_pf":[6,5]})", "/effects/electrode_pf/1"},
      {R"("effects":{"electrode_pf":[6]})", "/effects/electrode_pf"},
      {R"("effects":{"wind":1})", "key \"wind\" is unknown"},
      {R"("seed":-1)", "seed"},
  };
  for (const auto& [rest, expected] : cases) {
    EXPECT_NE(error_with(rest).find(expected), std::string::npos) << rest << " -> " << error_with(rest);
  }
}

TEST_F(SceneFile, refuses_what_is_no_scene) {
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("{"), std::string("null"), std::string("\xff\xfe"),
        std::string(R"({"format":"triskin-scene","version":2,"design":"d.json"})"),
        std::string(R"({"format":"triskin-scene","version":1})"),
        std::string(R"({"format":"x","version":1,"design":"d.json"})"),
        std::string(R"({"format":"triskin-scene","version":1,"design":"none.json"})"),
        std::string(R"({"format":"triskin-scene","version":1,"design":"."})"), std::string(1'000'000, '[')}) {
    EXPECT_THROW((void)read(text), InputError) << text.substr(0, 60);
  }
  EXPECT_THROW((void)read_scene(folder_ / "missing.json"), InputError);
}

}  // namespace
}  // namespace triskin::hardware
