// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/cover_part.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/flat_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/json_value.hpp"

namespace triskin::design {
namespace {

CoverPart part_of(const std::string& text) {
  const nlohmann::json document = nlohmann::json::parse(text);
  return read_cover_part(JsonValue(document, "a.json", "/place"));
}

std::string error_of_part(const std::string& text) {
  try {
    (void)part_of(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

// Tiles (0, 0) up and down and (1, 0) up have centroids at x = 15, 30 and 45, y = h/3, 2h/3 and h/3.
ModuleLayout three_modules() {
  Design d = test::flat_design("row", {-10, -10}, {90, 40});
  const std::vector<Tile> tiles{{0, 0, true}, {0, 0, false}, {1, 0, true}};
  test::lay_modules(d, tiles, {});
  d.layout.modules[2].island = 1;
  return d.layout;
}

TEST(CoverPart, holds_modules_by_centre_island_and_id) {
  const ModuleLayout layout = three_modules();
  const auto held = [&](const std::string& text) {
    std::vector<int> ids;
    for (int id = 0; id < 3; ++id) {
      if (holds(part_of(text), layout, id)) ids.push_back(id);
    }
    return ids;
  };
  using Ids = std::vector<int>;
  // Measured from the centre of module 0, the others lie √(15² + (h/3)²) = 17.3 and 30 mm away.
  EXPECT_EQ(held(R"({"sphere":{"center_mm":[15,8.66025,0],"radius_mm":17}})"), (Ids{0}));
  EXPECT_EQ(held(R"({"sphere":{"center_mm":[15,8.66025,0],"radius_mm":18}})"), (Ids{0, 1}));
  EXPECT_EQ(held(R"({"box":{"low_mm":[29,0,-1],"high_mm":[46,10,1]}})"), (Ids{2}));
  EXPECT_EQ(held(R"({"box":{"low_mm":[29,0,1],"high_mm":[46,20,2]}})"), (Ids{}));
  EXPECT_EQ(held(R"({"island":0})"), (Ids{0, 1}));
  EXPECT_EQ(held(R"({"modules":[2,0]})"), (Ids{0, 2}));
  EXPECT_THROW((void)holds(Sphere{{0, 0, 0}, 1.0}, layout, 3), std::out_of_range);
  // A list of modules and an island contain no point.
  EXPECT_FALSE(holds(part_of(R"({"island":0})"), Vec3(15, 8, 0)));
  EXPECT_TRUE(holds(part_of(R"({"box":{"low_mm":[0,0,0],"high_mm":[1,1,1]}})"), Vec3(1, 1, 1)));
}

TEST(CoverPart, is_written_as_it_was_read) {
  for (const std::string text :
       {R"({"sphere":{"center_mm":[1.0,2.0,3.5],"radius_mm":4.0}})",
        R"({"box":{"high_mm":[4.0,5.0,6.0],"low_mm":[1.0,2.0,3.0]}})", R"({"island":7})", R"({"modules":[3,1]})"})
    EXPECT_EQ(cover_part_json(part_of(text)).dump(), text);
}

TEST(CoverPart, errors_name_the_place) {
  EXPECT_EQ(error_of_part("{}"),
            "a.json: /place: must have one of the keys \"sphere\", \"box\", \"island\", \"modules\"");
  EXPECT_EQ(error_of_part(R"({"island":1,"modules":[1]})"),
            "a.json: /place: must have one of the keys \"sphere\", \"box\", \"island\", \"modules\"");
  EXPECT_EQ(error_of_part(R"({"sphere":{"center_mm":[0,0,0],"radius_mm":0}})"),
            "a.json: /place/sphere/radius_mm: must be positive");
  EXPECT_EQ(error_of_part(R"({"box":{"low_mm":[0,0,0],"high_mm":[1,1,0]}})"),
            "a.json: /place/box/high_mm: must be above \"low_mm\" along every axis");
  EXPECT_NE(error_of_part(R"({"sphere":{"centre":[0,0,0],"radius_mm":1}})").find("\"centre\" is unknown"),
            std::string::npos);
  EXPECT_NE(error_of_part(R"({"modules":[-1]})"), "");
  EXPECT_NE(error_of_part(R"({"island":"one"})"), "");
}

}  // namespace
}  // namespace triskin::design
