// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/contact_density.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/region_file.hpp"

namespace triskin::scenario {
namespace {

// A finger of 3 mm presses the middle taxel of module 1 for 3 s, and one presses that of module 4 for 1 s.
hardware::Scene two_touches() {
  hardware::Scene scene;
  scene.design = test::strip(6);
  for (const auto& [module, seconds] : {std::pair{1, 3}, std::pair{4, 1}}) {
    hardware::Contact c;
    c.from_us = 1'000'000;
    c.until_us = 1'000'000 + static_cast<std::uint64_t>(seconds) * 1'000'000;
    c.position_mm = hardware::center_of(scene.design, layout::ModuleId{module});
    c.radius_mm = 3.0;
    scene.contacts.push_back(c);
  }
  return scene;
}

TEST(ContactDensity, counts_how_long_each_module_is_touched) {
  const ContactDensity density = density_of_scene(two_touches());
  ASSERT_EQ(density.touched_s.size(), 6U);
  EXPECT_EQ(density.duration_s, 4.0);
  EXPECT_NEAR(density.touched_s[1], 3.0, 1e-9);
  EXPECT_NEAR(density.touched_s[4], 1.0, 1e-9);
  EXPECT_EQ(density.touched_modules(), 2U);
  EXPECT_NEAR(density_of_scene(two_touches(), 1.5).touched_s[1], 0.5, 1e-9);
}

TEST(ContactDensity, the_regions_are_read_by_design) {
  const auto file = std::filesystem::temp_directory_path() / ("density." + std::to_string(::getpid()) + ".json");
  write_file_atomically(file, regions_text(density_of_scene(two_touches()), 7.0));
  const design::RegionFile regions = design::read_region_file(file);
  std::filesystem::remove(file);
  ASSERT_EQ(regions.regions.size(), 2U);
  EXPECT_EQ(regions.elsewhere, 1.0);
  // The weight is 1 + 6 · (1 s / 3 s), and the most important place follows.
  EXPECT_NEAR(*regions.regions[0].region.weight, 3.0, 1e-9);
  EXPECT_NEAR(*regions.regions[1].region.weight, 7.0, 1e-9);
  const auto& ball = std::get<design::Sphere>(regions.regions[1].region.shape);
  EXPECT_NEAR((ball.center_mm - hardware::center_of(test::strip(6), layout::ModuleId{1})).norm(), 0.0, 1e-9);
}

TEST(ContactDensity, nothing_to_count_is_said) {
  hardware::Scene scene = two_touches();
  EXPECT_THROW((void)regions_text(density_of_scene(scene), 1.0), InputError);
  scene.contacts[0].until_us = hardware::kForever;
  EXPECT_THROW((void)density_of_scene(scene), InputError);
  EXPECT_NO_THROW((void)density_of_scene(scene, 2.0));
  for (hardware::Contact& c : scene.contacts) c.position_mm.z() = 500.0;
  EXPECT_THROW((void)regions_text(density_of_scene(scene, 2.0), 5.0), InputError);
  scene.contacts.clear();
  EXPECT_THROW((void)density_of_scene(scene, 2.0), InputError);
}

}  // namespace
}  // namespace triskin::scenario
