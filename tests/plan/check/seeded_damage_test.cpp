// SPDX-License-Identifier: GPL-3.0-or-later
// On generated and real covers the checker must accept the design, and find every kind of damage on many modules.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "plan/check/damage_kinds.hpp"
#include "support/covers.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t kModulesEach = 4;

class SeededDamage : public testing::TestWithParam<test::CoverName> {};

TEST_P(SeededDamage, is_found_on_every_module_that_is_tried) {
  const std::string part = GetParam().name;
  const auto mesh = test::cover_file(GetParam());
  if (!mesh) GTEST_SKIP() << test::no_data();
  pipeline::DesignOptions options;
  options.iterations = 20;
  options.time_limit_s = 60.0;
  const design::Design design = pipeline::make_design(mesh->path(), options).design;
  const fs::path file =
      fs::temp_directory_path() / ("seeded_damage." + part + "." + std::to_string(::getpid()) + ".json");
  design::write_design(file, design);
  const json good = json::parse(read_file(file));
  for (const Violation& v : check_design(file).violations) ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;

  constexpr unsigned kSeed = 20;
  std::mt19937 random(kSeed);
  const mesh::Surface surface(design.surface);
  for (const damage::DamageKind& kind : damage::damage_kinds(surface)) {
    std::vector<std::size_t> order(good["modules"].size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::shuffle(order, random);
    std::size_t done = 0;
    for (const std::size_t k : order) {
      if (done == kModulesEach) break;
      json damaged = good;
      if (!kind.apply(damaged, k)) continue;
      ++done;
      std::ofstream(file) << damaged.dump();
      bool found = false;
      damage::Names seen;
      for (const Violation& v : check_design(file).violations) {
        found = found || kind.rules.contains(v.rule);
        seen.insert(v.rule);
      }
      EXPECT_TRUE(found) << part << ", module " << k << ", seed " << kSeed << ": " << kind.name << " broke "
                         << json(seen);
      EXPECT_TRUE(std::string(kind.name) == "a taxel 1 mm off" || std::string(kind.name).starts_with("a flattering") ||
                  seen.contains("design-id"));
    }
    // On a cover that is nearly flat no side is lifted, so no value can be stated too low.
    const auto& modules = design.layout.modules;
    const bool is_flat = std::ranges::count_if(modules, [](const auto& m) { return m.edge_lift_mm > 0.2; }) < 2;
    EXPECT_GE(done, is_flat && kind.rules.contains("edge-lift") && std::string(kind.name).starts_with("a flattering")
                        ? 0U
                        : 2U)
        << kind.name;
  }
  fs::remove(file);
}
INSTANTIATE_TEST_SUITE_P(Generated, SeededDamage,
                         testing::Values(test::CoverName{"hip", {.size_mm = 110.0, .faces = 300}}),
                         [](const auto& p) { return test::case_name(p.param.name); });
INSTANTIATE_TEST_SUITE_P(Covers, SeededDamage,
                         testing::Values(test::CoverName{"torso"}, test::CoverName{"LH_hipwing_v1"},
                                         test::CoverName{"RUF_forearm_v2"}, test::CoverName{"HIP_v1"},
                                         test::CoverName{"LUA_upperarm_half_v1"}, test::CoverName{"UT_torso_v1"}),
                         [](const auto& p) { return test::case_name(p.param.name); });

}  // namespace
}  // namespace triskin::check
