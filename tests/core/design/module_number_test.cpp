// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/module_number.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/strip_design.hpp"
#include "support/temp_folder.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/side_by_side.hpp"

namespace triskin::design {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

// A strip of five whose modules 1 and 3, of seven, are gone, and 7 was one.
Design strip_of_five() {
  Design d = test::strip(5, 3);
  set_numbers(d.layout, {0, 2, 4, 5, 6});
  d.next_number = 8;
  d.design_id = design_id_of(d);
  return d;
}

TEST(ModuleNumber, is_that_of_the_list_or_without_gaps_the_id) {
  const Design d = strip_of_five(), plain = test::strip(5);
  EXPECT_EQ(number_of(d, 1), 2);
  EXPECT_EQ(number_of(d, 4), 6);
  EXPECT_EQ(number_of(d, -1), -1);
  EXPECT_EQ(module_with(d, {5}), 3);
  for (const int none : {-1, 1, 3, 7}) EXPECT_EQ(module_with(d, {none}), -1) << none;
  EXPECT_EQ(number_of(plain, 4), 4);
  EXPECT_EQ(module_with(plain, {4}), 4);
  EXPECT_EQ(module_with(plain, {5}), -1);
  EXPECT_EQ(next_number(d), 8);
  EXPECT_EQ(next_number(plain), 5);
  EXPECT_EQ(ranges_text(all_numbers(d.layout)), "0,2,4-6");
  try {
    (void)require_module(d, {3});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "there is no module 3; the design has 0,2,4-6");
  }
}

TEST(ModuleNumber, without_gaps_is_not_stored) {
  Design d = strip_of_five();
  set_numbers(d.layout, {0, 1, 2, 3, 4});
  EXPECT_TRUE(d.layout.numbers.empty());
}

// Every place of the file that names a module has its number. By hand: module 2 hangs on 0, 4 on 2; 5 is the entry of
// the second patch and 6 hangs on it.
TEST(ModuleNumber, names_modules_in_the_file) {
  const test::TempFolder folder;
  write_design(folder / "strip.json", strip_of_five());
  const json file = json::parse(read_file(folder / "strip.json"));
  std::vector<int> ids, parents;
  for (const json& m : file["modules"]) {
    ids.push_back(m["id"]);
    parents.push_back(m["parent"]);
  }
  EXPECT_THAT(ids, ElementsAre(0, 2, 4, 5, 6));
  EXPECT_THAT(parents, ElementsAre(-1, 0, 2, -1, 5));
  EXPECT_EQ(file["modules"][1]["neighbours"], json({4, -1, 0}));
  EXPECT_EQ(file["patches"][1]["entry"], 5);
  EXPECT_EQ(file["patches"][1]["modules"], json({5, 6}));
  EXPECT_EQ(file["next_module"], 8);
  const Design again = read_intact_design(folder / "strip.json");
  EXPECT_EQ(again.layout.numbers, strip_of_five().layout.numbers);
  EXPECT_EQ(again.next_number, 8);
  EXPECT_EQ(again.layout.modules[1].neighbour, (std::array{2, -1, 0}));
  EXPECT_EQ(again.patches[1].modules[1].parent, 3);
  EXPECT_NE(again.design_id, test::strip(5, 3).design_id);
  Design older = strip_of_five();
  older.next_number = 7;  // The next module would get the number that one once had.
  EXPECT_NE(design_id_of(older), again.design_id);
  older.next_number = 0;  // This means the same.
  const std::uint64_t without = design_id_of(older);
  older.next_number = 7;
  EXPECT_EQ(design_id_of(older), without);
}

TEST(ModuleNumber, of_a_damaged_file_is_refused) {
  const test::TempFolder folder;
  write_design(folder / "strip.json", strip_of_five());
  const json good = json::parse(read_file(folder / "strip.json"));
  const auto error_after = [&](const auto& damage) {
    json file = good;
    damage(file);
    std::ofstream(folder / "bad.json") << file;
    try {
      (void)read_design(folder / "bad.json");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_after([](json& j) { j["modules"][2]["id"] = 2; }), HasSubstr("numbers of modules must ascend"));
  EXPECT_THAT(error_after([](json& j) { j["modules"][1]["parent"] = 3; }), HasSubstr("names module 3, which is not"));
  EXPECT_THAT(error_after([](json& j) { j["patches"][0]["entry"] = 1; }), HasSubstr("names module 1, which is not"));
  EXPECT_NE(error_after([](json& j) { j["modules"][4]["id"] = 65'536; }), "");
  EXPECT_NE(error_after([](json& j) { j["next_module"] = 6; }), "") << "a module has it";
}

TEST(ModuleNumber, is_that_of_the_cover_in_a_robot) {
  const Design d = strip_of_five(), plain = test::strip(2);
  const std::array<PlacedCover, 2> covers{
      {{&d, Eigen::Isometry3d::Identity()}, {&plain, Eigen::Isometry3d::Identity()}}};
  EXPECT_THAT(side_by_side(covers).design.layout.numbers, ElementsAre(0, 2, 4, 5, 6, 0, 1));
}

TEST(ModuleNumber, a_design_that_is_too_large_is_not_made_again) {
  Design d;
  d.kinds.kinds.push_back({"soft", 12, "", 0.0});
  d.layout.modules.resize(8192);
  EXPECT_NO_THROW(require_fitting_number(d, 8191));
  EXPECT_INPUT_ERROR(require_fitting_number(d, 8192), "make the design anew");
  d.layout.modules.resize(8193);
  EXPECT_INPUT_ERROR(require_fitting_number(d, 8192), "at most 8192 modules where there are kinds, this one 8193");
}

}  // namespace
}  // namespace triskin::design
