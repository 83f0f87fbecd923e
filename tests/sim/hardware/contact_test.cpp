// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/contact.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/hardware/skin_place.hpp"

namespace triskin::hardware {
namespace {

using design::Vec3;
constexpr std::uint64_t kSecond = 1'000'000;

TEST(Contact, place_radius_and_force_are_linear_between_keyframes) {
  Contact c;
  c.from_us = kSecond;
  c.until_us = 5 * kSecond;
  c.keyframes = {{0, {0, 0, 0}, 4.0, 0.0}, {2 * kSecond, {20, 0, 0}, 8.0, 10.0}};
  EXPECT_FALSE(state_of(c, kSecond - 1));
  const auto half = state_of(c, 2 * kSecond);
  ASSERT_TRUE(half);
  EXPECT_NEAR(half->position_mm.x(), 10.0, 1e-12);
  EXPECT_NEAR(half->radius_mm, 6.0, 1e-12);
  EXPECT_NEAR(half->force_n, 5.0, 1e-12);
  EXPECT_NEAR(state_of(c, 4 * kSecond)->force_n, 10.0, 1e-12);
  EXPECT_FALSE(state_of(c, 5 * kSecond));
}

TEST(Contact, the_force_rises_and_falls) {
  Contact c;
  c.until_us = 10 * kSecond;
  c.force_n = 8.0;
  c.rise_us = 2 * kSecond;
  c.fall_us = 4 * kSecond;
  EXPECT_EQ(state_of(c, 0)->force_n, 0.0);
  EXPECT_NEAR(state_of(c, kSecond)->force_n, 4.0, 1e-12);
  EXPECT_NEAR(state_of(c, 5 * kSecond)->force_n, 8.0, 1e-12);
  EXPECT_NEAR(state_of(c, 9 * kSecond)->force_n, 2.0, 1e-12);
}

TEST(Contact, passes_follow_each_other_until_the_last) {
  Contact c;
  c.from_us = kSecond;
  c.until_us = 2 * kSecond;
  c.to_mm = Vec3(10, 0, 0);
  c.every_us = 3 * kSecond;
  c.passes = 2;
  EXPECT_NEAR(state_of(c, 1'500'000)->position_mm.x(), 5.0, 1e-12);
  EXPECT_FALSE(state_of(c, 3 * kSecond));
  EXPECT_NEAR(state_of(c, 4'500'000)->position_mm.x(), 5.0, 1e-12);
  EXPECT_FALSE(state_of(c, 7'500'000));
  EXPECT_EQ(end_of(c), 5 * kSecond);
  c.passes = 0;
  EXPECT_TRUE(state_of(c, 7'500'000));
  EXPECT_EQ(end_of(c), kForever);
}

TEST(Contact, reaches_what_lies_along_its_way) {
  Contact c;
  c.until_us = 2;
  c.keyframes = {{0, {0, 0, 0}, 2.0, 1.0}, {1, {10, 0, 0}, 4.0, 1.0}, {2, {10, 10, 0}, 1.0, 1.0}};
  EXPECT_NEAR(distance_mm(c, {5, 3, 0}), 3.0, 1e-12);
  EXPECT_TRUE(reaches(c, {5, 3.9, 0}));
  EXPECT_FALSE(reaches(c, {5, 4.1, 0}));
  EXPECT_EQ(max_radius_mm(c), 4.0);
}

// Module 0 of the strip has the corners (0, 0), (30, 0) and (15, 25.98) on z = 0.
TEST(SkinPlace, nearest_point_and_ray_by_hand) {
  const design::Design d = test::strip(2);
  const auto above = nearest_place(d, {15, 8, 20});
  ASSERT_TRUE(above);
  EXPECT_EQ(above->module, 0);
  EXPECT_NEAR((above->position_mm - Vec3(15, 8, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(above->distance_mm, 20.0, 1e-9);
  const auto beside = nearest_place(d, {15, -3, 4});
  EXPECT_NEAR((beside->position_mm - Vec3(15, 0, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(beside->distance_mm, 5.0, 1e-9);
  const auto hit = place_on_ray(d, {15, 8, 20}, {0, 0, -3});
  ASSERT_TRUE(hit);
  EXPECT_NEAR((hit->position_mm - Vec3(15, 8, 0)).norm(), 0.0, 1e-9);
  EXPECT_FALSE(place_on_ray(d, {15, 8, 20}, {0, 0, 1}));
  EXPECT_FALSE(place_on_ray(d, {15, 8, 20}, {0, 0, 0}));
  const auto in_gap = place_on_ray(d, {15, -2, 20}, {0, 0, -1});
  ASSERT_TRUE(in_gap);
  EXPECT_NEAR(in_gap->distance_mm, 2.0, 1e-9);
  EXPECT_FALSE(place_on_ray(d, {15, -4, 20}, {0, 0, -1}));
}

TEST(SceneContacts, places_and_keyframes_of_a_file) {
  const auto folder = std::filesystem::temp_directory_path() / ("scene_contacts." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  design::write_design(folder / "d.json", test::strip(6));
  write_file_atomically(folder / "s.json", R"({"format":"triskin-scene","version":1,"design":"d.json","contacts":[
    {"nearest_to_mm":[15,8,90]},
    {"ray":{"from_mm":[15,8,90],"direction":[0,0,-1]},"until_s":2,"to":{"module":2},"every_s":3,"passes":4},
    {"module":0,"radius_mm":5,"keyframes":[{"at_s":1,"force_n":0},{"at_s":2,"force_n":4},{"at_s":3,"module":4}]},
    {"position_mm":[15,9,30],"to_mm":[75,9,30],"at_s":1,"until_s":2,"on_skin":true}]})");
  const Scene scene = read_scene(folder / "s.json");
  std::filesystem::remove_all(folder);
  ASSERT_EQ(scene.contacts.size(), 4U);
  EXPECT_NEAR((scene.contacts[0].position_mm - Vec3(15, 8, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((scene.contacts[1].position_mm - Vec3(15, 8, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((*scene.contacts[1].to_mm - center_of(scene.design, layout::ModuleId{2})).norm(), 0.0, 1e-9);
  EXPECT_EQ(end_of(scene.contacts[1]), 11 * kSecond);
  const auto pressing = state_of(scene.contacts[2], 2'500'000);
  ASSERT_TRUE(pressing);
  EXPECT_NEAR(pressing->force_n, 4.0, 1e-9);
  EXPECT_NEAR((pressing->position_mm -
               (center_of(scene.design, layout::ModuleId{0}) + center_of(scene.design, layout::ModuleId{4})) / 2.0)
                  .norm(),
              0.0, 1e-9);
  EXPECT_EQ(scene.contacts[2].until_us, 3 * kSecond);
  // The path 30 mm above the skin was projected onto it.
  EXPECT_NEAR(state_of(scene.contacts[3], 1'500'000)->position_mm.z(), 0.0, 1e-9);
  EXPECT_NEAR(state_of(scene.contacts[3], 1'500'000)->position_mm.x(), 45.0, 1e-6);
}

}  // namespace
}  // namespace triskin::hardware
