// SPDX-License-Identifier: GPL-3.0-or-later
// The independent checker must accept the output of the program and name each seeded damage.
#include "triskin/check/routing_rules.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "shapes.hpp"
#include "support/places.hpp"
#include "triskin/base/error.hpp"

namespace triskin::testing {
namespace {

using nlohmann::json;

json module_list(const Listed& patch) {
  json modules = json::array();
  for (std::size_t k = 0; k < patch.tiles.size(); ++k) {
    modules.push_back({{"id", k}, {"i", patch.tiles[k].i}, {"j", patch.tiles[k].j}, {"up", patch.tiles[k].up}});
  }
  return {{"modules", modules}};
}

// Returns the output of the program for a list, through its own files, as a user gets it.
json routed(const json& modules, const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("triskin_routing_" + name + std::to_string(::testing::UnitTest::GetInstance()->random_seed()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "modules.json") << modules;
  const std::string command = test::program_file() + " route " + (folder / "modules.json").string() + " -o " +
                              (folder / "routes.json").string() + " >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  json routes = json::parse(std::ifstream(folder / "routes.json"));
  std::filesystem::remove_all(folder);
  return routes;
}

bool names(const check::DesignReport& report, const std::string& rule) {
  return std::ranges::any_of(report.violations, [&](const check::Violation& v) { return v.rule == rule; });
}

struct Damage {
  const char* rule;
  std::function<void(json& routes)> seed;
};

json& module_row(json& routes, std::size_t patch, std::size_t row) {
  return routes["routes"][patch]["modules"][row];
}
json& failure_where(json& routes, const std::function<bool(const json&)>& fits) {
  for (json& p : routes["routes"]) {
    for (json& f : p["failures"]) {
      if (fits(f)) return f;
    }
  }
  throw std::logic_error("no failure row fits");
}

/// Returns damages of the trees, their lines and addresses.
std::vector<Damage> tree_damages() {
  return {
      {"address-unique",
       [](json& r) {
         module_row(r, 0, 1)["line"] = module_row(r, 0, 0)["line"];
         module_row(r, 0, 1)["address"] = module_row(r, 0, 0)["address"];
       }},
      {"line-load",
       [](json& r) {
         for (std::size_t k = 0; k < 5; ++k) module_row(r, 0, k)["line"] = 2;
       }},
      {"line-range", [](json& r) { module_row(r, 0, 3)["line"] = 4; }},
      {"address-range", [](json& r) { module_row(r, 0, 3)["address"] = -1; }},
      {"connected", [](json& r) { std::swap(module_row(r, 0, 2)["id"], module_row(r, 1, 2)["id"]); }},
      {"acyclic",
       [](json& r) {
         json& m = module_row(r, 0, 1);
         m["parent"] = module_row(r, 0, r["routes"][0]["modules"].size() - 1)["id"];
         for (json& x : r["routes"][0]["modules"])
           if (x["parent"] == r["routes"][0]["entry"] && x["id"] != m["id"]) x["parent"] = m["id"];
         json& last = r["routes"][0]["modules"].back();
         last["parent"] = m["id"];
       }},
      {"entry-degree",
       [](json& r) {
         json& p = r["routes"][0];
         std::size_t n = 0;
         for (json& x : p["modules"])
           if (x["id"] != p["entry"] && n++ < 3) x["parent"] = p["entry"];
       }},
      {"tree-degree",
       [](json& r) {
         json& p = r["routes"][0];
         const json hub = p["modules"][1]["id"];
         for (std::size_t k = 2; k < 5; ++k) p["modules"][k]["parent"] = hub;
       }},
      {"rotation",
       [](json& r) {
         json& m = module_row(r, 0, 2);
         m["rotation"] = (m["rotation"].get<int>() + 1) % 3;
       }},
      {"rotation-range", [](json& r) { module_row(r, 1, 2)["rotation"] = 3; }},
      {"one-entry", [](json& r) { module_row(r, 0, 4)["parent"] = -1; }},
      {"entry", [](json& r) { r["routes"][0]["entry"] = r["routes"][1]["entry"]; }},
      {"parent-member", [](json& r) { module_row(r, 0, 3)["parent"] = module_row(r, 1, 3)["id"]; }},
      {"parent-joint",
       [](json& r) {
         json& p = r["routes"][0];
         p["modules"].back()["parent"] = p["entry"];
       }},
      {"depth",
       [](json& r) {
         json& m = module_row(r, 0, 3);
         m["depth"] = m["depth"].get<int>() + 1;
       }},
  };
}

/// Returns damages of which modules a patch has, and of what is said of patches and failures.
std::vector<Damage> patch_damages() {
  return {
      {"every-module-wired", [](json& r) { r["routes"][0]["modules"].erase(r["routes"][0]["modules"].size() - 1); }},
      {"one-patch", [](json& r) { r["routes"][0]["modules"].push_back(module_row(r, 1, 1)); }},
      {"known-module", [](json& r) { module_row(r, 0, 5)["id"] = 99999; }},
      {"patch-size",
       [](json& r) {
         for (const json& m : r["routes"][1]["modules"]) r["routes"][0]["modules"].push_back(m);
       }},
      {"joint-use",
       [](json& r) { r["routes"][0]["cut_joints"].push_back({module_row(r, 0, 0)["id"], module_row(r, 0, 1)["id"]}); }},
      {"joint-use",
       [](json& r) {
         for (json& p : r["routes"])
           if (!p["cut_joints"].empty()) {
             p["cut_joints"].erase(0);
             return;
           }
       }},
      {"border-entry", [](json& r) { r["routes"][0]["border_entry"] = !r["routes"][0]["border_entry"].get<bool>(); }},
      {"line-hops", [](json& r) { r["routes"][0]["line_hops"] = r["routes"][0]["line_hops"].get<int>() - 1; }},
      {"max-depth", [](json& r) { r["routes"][0]["max_depth"] = r["routes"][0]["max_depth"].get<int>() + 1; }},
      {"patch-count", [](json& r) { r["patches"] = 1; }},
      {"lower-bound", [](json& r) { r["lower_bound"] = 1; }},
      {"proved", [](json& r) { r["proved"] = false; }},
      {"mean-loss",
       [](json& r) {
         r["mean_loss"] = 0.0;
         r["routes"][0]["failures"][0]["lost_backed_up"] = 9;
       }},
      {"failure-rows", [](json& r) { r["routes"][0]["failures"].erase(0); }},
      {"loss-strapped",
       [](json& r) {
         json& f = r["routes"][0]["failures"][0];
         f["lost_strapped"] = f["lost_strapped"].get<int>() + 1;
       }},
      {"loss-rerouted",
       [](json& r) {
         json& f = r["routes"][0]["failures"][0];
         f["lost_rerouted"] = f["lost_rerouted"].get<int>() - 1;
       }},
      {"loss-one-entry",
       [](json& r) {
         json& f = r["routes"][0]["failures"][0];
         f["lost_one_entry"] = f["lost_one_entry"].get<int>() + 1;
       }},
      {"loss-backed-up",
       [](json& r) {
         json& f = r["routes"][0]["failures"][0];
         f["lost_backed_up"] = f["lost_backed_up"].get<int>() + 1;
       }},
      {"second-entry", [](json& r) { r["routes"][0]["second_entry"] = r["routes"][0]["entry"]; }},
      {"backup-tree",
       [](json& r) { failure_where(r, [](const json& f) { return !f["backup"].empty(); })["backup"] = json::array(); }},
      {"adoption",
       [](json& r) {
         json& p = r["routes"][0];
         p["failures"][0]["adopted"].push_back({p["modules"][2]["id"], r["routes"][1]["entry"]});
       }},
  };
}

std::vector<Damage> damages() {
  std::vector<Damage> all = tree_damages();
  std::ranges::move(patch_damages(), std::back_inserter(all));
  return all;
}

TEST(RoutingRules, accepts_every_result) {
  constexpr std::array kShapes{Shape::kCompact, Shape::kStrip, Shape::kHoled, Shape::kDendritic};
  for (std::uint64_t k = 0; k < 16; ++k) {
    const json modules = module_list(random_patch(kShapes[k % 4], 1 + static_cast<int>(k) * 14, k));
    const check::DesignReport report = check::check_routes(modules, routed(modules, "accept"));
    EXPECT_GE(report.rules.size(), 30U);
    for (const check::Violation& v : report.violations)
      ADD_FAILURE() << k << ": " << v.rule << ": " << v.where << ": " << v.text;
  }
}

TEST(RoutingRules, names_every_seeded_damage) {
  const json modules = module_list(random_patch(Shape::kCompact, 60, 2));
  const json sound = routed(modules, "damage");
  ASSERT_TRUE(check::check_routes(modules, sound).violations.empty());
  for (const Damage& damage : damages()) {
    json broken = sound;
    damage.seed(broken);
    const check::DesignReport report = check::check_routes(modules, broken);
    EXPECT_TRUE(names(report, damage.rule))
        << damage.rule << " was not named; " << report.violations.size() << " others were";
  }
}

TEST(RoutingRules, names_a_cable_at_a_used_port) {
  const json modules = module_list(random_patch(Shape::kCompact, 60, 2));
  const json sound = routed(modules, "cable");
  int named = 0;
  for (int side = 0; side < 3; ++side) {
    json broken = sound;
    module_row(broken, 0, 0)["rotation"] = side;
    named += names(check::check_routes(modules, broken), "entry-cable") ? 1 : 0;
  }
  EXPECT_GE(named, 1);
}

TEST(RoutingRules, refuses_a_document_without_its_keys) {
  const json modules = module_list(random_patch(Shape::kCompact, 8, 2));
  EXPECT_THROW((void)check::check_routes(modules, json::object()), InputError);
  json routes = routed(modules, "keys");
  routes["routes"][0]["modules"][0].erase("line");
  EXPECT_THROW((void)check::check_routes(modules, routes), InputError);
  EXPECT_THROW((void)check::check_routes(json::array(), routes), InputError);
}

}  // namespace
}  // namespace triskin::testing
