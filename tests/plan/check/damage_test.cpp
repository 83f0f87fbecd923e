// SPDX-License-Identifier: GPL-3.0-or-later
// A real design must pass, and the rule for each kind of damage must reject it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "checked_file.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Two thirds of a cylinder, radius 60 mm, 120 mm long, unfold without error and hold several islands and patches.
design::Mesh half_pipe() {
  constexpr int kAlong = 12, kAround = 24;
  return sheet_mesh(kAround, kAlong, [](int r, int a) {
    const double angle = 4.0 * r / kAround;
    return design::Vec3(60 * std::cos(angle), 60 * std::sin(angle), 10.0 * a);
  });
}

class Damage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("check_damage." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    mesh::write_obj(folder_ / "pipe.obj", half_pipe());
    pipeline::DesignOptions options;
    options.iterations = 40;
    options.time_limit_s = 60.0;
    design::write_design(folder_ / "good.json", pipeline::make_design(folder_ / "pipe.obj", options).design);
    good_ = new json(json::parse(read_file(folder_ / "good.json")));
  }
  static void TearDownTestSuite() {
    fs::remove_all(folder_);
    delete good_;
  }

  // Returns the names of the rules that the damaged design breaks.
  static std::vector<std::string> broken_by(const std::function<void(json&)>& damage) {
    json j = *good_;
    damage(j);
    return broken_rules(j, folder_ / "damaged.json");
  }
  static void expect(const std::string& rule, const std::function<void(json&)>& damage) {
    EXPECT_THAT(broken_by(damage), testing::Contains(rule));
  }

  static inline fs::path folder_;
  static inline json* good_ = nullptr;
};

void shift(json& module, double dx, double dy, double dz) {
  for (json& c : module["corners"]) {
    c[0] = c[0].get<double>() + dx;
    c[1] = c[1].get<double>() + dy;
    c[2] = c[2].get<double>() + dz;
  }
}

json& leaf(json& j) {
  return j["modules"][j["patches"][0]["modules"].back().get<std::size_t>()];
}
json& entry(json& j) {
  return j["modules"][j["patches"][0]["entry"].get<std::size_t>()];
}

TEST_F(Damage, the_design_itself_is_accepted) {
  const DesignReport report = check_design(folder_ / "good.json");
  for (const Violation& v : report.violations) ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;
  EXPECT_GE(report.rules.size(), 40U);
  EXPECT_GE((*good_)["modules"].size(), 20U);
}

TEST_F(Damage, geometry) {
  expect("hinge-gap", [](json& j) { shift(leaf(j), 0, 0, 3); });
  expect("center-gap", [](json& j) {
    for (json& m : j["modules"]) shift(m, 6, 0, 0);
  });
  expect("rigid", [](json& j) { leaf(j)["corners"][0][2] = leaf(j)["corners"][0][2].get<double>() + 0.01; });
  expect("penetration", [](json& j) { shift(leaf(j), 0, 0, 2); });
  expect("overrun", [](json& j) {
    for (json& m : j["modules"]) shift(m, 0, 0, 40);
  });
  expect("outward", [](json& j) {
    for (json& m : j["modules"]) std::swap(m["corners"][1], m["corners"][2]);
  });
  expect("report-coverage", [](json& j) { j["report"]["coverage"] = 0.99; });
  expect("report-area", [](json& j) { j["report"]["area_cm2"] = 1.0; });
  expect("report-maxima", [](json& j) { j["report"]["max_center_gap_mm"] = 0.0; });
  expect("report-bound", [](json& j) { j["report"]["upper_bound"] = 1; });
  expect("taxel-pose", [](json& j) { leaf(j)["taxels"][3]["position"][0] = 0.0; });
}

// Removes faces that a module covers, which makes a hole that none of its sides meets.
TEST_F(Damage, a_hole_under_the_middle_of_a_module) {
  const auto middle = [](const json& points, const auto& index) {
    std::array<double, 3> c{};
    for (const auto& k : index) {
      for (std::size_t axis = 0; axis < 3; ++axis) c[axis] += points[k][axis].template get<double>() / 3.0;
    }
    return c;
  };
  for (const std::size_t module : {std::size_t{0}, std::size_t{7}, std::size_t{15}}) {
    const std::vector<std::string> broken = broken_by([&](json& j) {
      const auto c = middle(j["modules"][module]["corners"], std::array<std::size_t, 3>{0, 1, 2});
      const json all = j["surface"]["faces"];
      std::size_t nearest = 0;
      double least = 1e300;
      for (std::size_t f = 0; f < all.size(); ++f) {
        const auto m = middle(j["surface"]["vertices"], all[f].get<std::array<std::size_t, 3>>());
        const double d = std::hypot(m[0] - c[0], m[1] - c[1], m[2] - c[2]);
        if (d >= least) continue;
        least = d;
        nearest = f;
      }
      j["surface"]["faces"].erase(nearest);
      j["pieces"] = json::array();
    });
    EXPECT_THAT(broken, testing::Contains("overrun")) << module;
  }
}

// On the straight end of the pipe the overrun equals the distance by which the module was pushed over it; the text
// gives the numbers beside it.
TEST_F(Damage, overrun_is_measured_to_a_hundredth) {
  for (const double past_mm : {0.6, 1.25, 3.0}) {
    json j = *good_;
    double top = -1e300;
    for (const json& c : leaf(j)["corners"]) top = std::max(top, c[2].get<double>());
    shift(leaf(j), 0, 0, 120.0 + past_mm - top);
    std::ofstream(folder_ / "over.json") << j.dump();
    bool found = false;
    for (const Violation& v : check_design(folder_ / "over.json").violations) {
      if (v.rule != "overrun" || v.text.find("limit") == std::string::npos) continue;
      EXPECT_NEAR(std::stod(v.text), past_mm, 0.01);
      found = true;
    }
    EXPECT_TRUE(found) << past_mm;
  }
}

// A corner high above the pipe that passes its straight end overhangs it at once by as much as the interpolated normal
// leans, so no number is wrong there. A fifth of a facet from its edge that is 0.3 facets of 1/6 rad.
TEST_F(Damage, a_module_that_just_reaches_the_border_may_state_either_number) {
  constexpr double kFacet_rad = 4.0 / 24, kRadius_mm = 63.0;
  const auto with = [&](double past_mm, double stated_mm) {
    const auto broken = broken_by([&](json& j) {
      json& m = leaf(j);
      json& top = *std::ranges::max_element(m["corners"], {}, [](const json& c) { return c[2].get<double>(); });
      const double x = top[0], y = top[1], from = std::atan2(y, x),
                   to = (std::floor((from < 0 ? from + 2 * M_PI : from) / kFacet_rad) + 0.2) * kFacet_rad;
      const double dx = kRadius_mm * std::cos(to) - (x * std::cos(to - from) - y * std::sin(to - from));
      const double dy = kRadius_mm * std::sin(to) - (x * std::sin(to - from) + y * std::cos(to - from)),
                   dz = 120.0 + past_mm - top[2].get<double>();
      for (json& c : m["corners"]) {
        const double cx = c[0], cy = c[1];
        c[0] = cx * std::cos(to - from) - cy * std::sin(to - from);
        c[1] = cx * std::sin(to - from) + cy * std::cos(to - from);
      }
      shift(m, dx, dy, dz);
      m["overrun_mm"] = stated_mm;
    });
    return std::ranges::count(broken, "overrun") != 0;
  };
  const double height_mm = kRadius_mm * std::cos(0.3 * kFacet_rad) - 60.0 * std::cos(0.5 * kFacet_rad),
               leaning_mm = height_mm * std::sin(0.3 * kFacet_rad);
  ASSERT_GT(leaning_mm, 0.1);
  for (const double past_mm : {-0.0004, 0.0004}) {
    EXPECT_FALSE(with(past_mm, 0.0)) << past_mm;
    EXPECT_FALSE(with(past_mm, leaning_mm)) << past_mm;
    EXPECT_TRUE(with(past_mm, leaning_mm + 0.1)) << past_mm;
  }
  EXPECT_TRUE(with(0.1, 0.0));
  EXPECT_FALSE(with(0.1, std::hypot(0.1, leaning_mm)));
  EXPECT_TRUE(with(-0.1, leaning_mm));
}

TEST_F(Damage, what_flashing_relies_on) {
  expect("design-id", [](json& j) { j["design_id"] = "0123456789abcdef"; });
  expect("bend-radius", [](json& j) { leaf(j)["bend_radius_mm"] = 5.0; });
}

TEST_F(Damage, limits_are_the_users_choice_but_must_be_limits) {
  for (const char* limit : {"edge_error_mm", "hinge_gap_mm", "center_gap_mm", "fold_rad", "penetration_mm",
                            "overrun_mm", "lift_mm", "depth_mm", "fold_away_rad", "fold_towards_rad"}) {
    EXPECT_THAT(broken_by([&](json& j) { j["limits"][limit] = 50.0; }), testing::IsEmpty()) << limit;
    expect("limits", [&](json& j) { j["limits"][limit] = -1.0; });
    EXPECT_THROW((void)broken_by([&](json& j) { j["limits"][limit] = std::nan(""); }), InputError)
        << limit;  // The value is written as null.
  }
}

TEST_F(Damage, a_fold_is_limited_in_its_own_direction_only) {
  // The faces of the pipe look away from its axis, so that every joint that folds does so over a ridge.
  const auto limited = [](const char* limit) { return broken_by([&](json& j) { j["limits"][limit] = 0.1; }); };
  EXPECT_THAT(limited("fold_away_rad"), testing::Contains("fold"));
  EXPECT_THAT(limited("fold_towards_rad"), testing::IsEmpty());
}

TEST_F(Damage, lattice) {
  expect("tile-unique", [](json& j) {
    for (const char* k : {"i", "j", "up"}) j["modules"][1][k] = j["modules"][0][k];
  });
  expect("joint-lattice", [](json& j) { leaf(j)["i"] = leaf(j)["i"].get<int>() + 7; });
  expect("joint-symmetric", [](json& j) {
    json& m = leaf(j);
    for (json& n : m["neighbours"]) n = -1;
  });
  expect("island-connected", [](json& j) { j["islands"] = 99; });
  expect("joint-island", [](json& j) { leaf(j)["island"] = 77; });
}

TEST_F(Damage, pieces) {
  expect("piece-flip", [](json& j) { std::swap(j["pieces"][0]["flat"][0][0], j["pieces"][0]["flat"][0][1]); });
  expect("piece-scale", [](json& j) { j["pieces"][0]["max_edge_error_mm"] = 0.5; });
  expect("piece-overlap",
         [](json& j) { j["pieces"][0]["outline"][0][0] = j["pieces"][0]["outline"][0][0].get<double>() + 50; });
  expect("piece-placement", [](json& j) {
    j["pieces"][0]["placement"]["theta_rad"] = j["pieces"][0]["placement"]["theta_rad"].get<double>() + 0.3;
  });
  expect("piece-placement", [](json& j) { j["pieces"][0]["upper_bound"] = 1; });
  expect("piece-faces", [](json& j) { j["pieces"].push_back(j["pieces"][0]); });
}

TEST_F(Damage, wiring) {
  expect("address-unique", [](json& j) {
    for (const char* k : {"line", "address"}) leaf(j)[k] = entry(j)[k];
  });
  expect("line-load", [](json& j) {
    for (json& m : j["modules"]) m["line"] = 0;
  });
  expect("address-range", [](json& j) { leaf(j)["address"] = 4; });
  expect("rotation", [](json& j) { leaf(j)["rotation"] = (leaf(j)["rotation"].get<int>() + 1) % 3; });
  expect("one-entry", [](json& j) { leaf(j)["parent"] = -1; });
  expect("parent", [](json& j) {
    const auto second = j["patches"][1]["entry"];
    leaf(j)["parent"] = second;
  });
  expect("parent-first",
         [](json& j) { std::reverse(j["patches"][0]["modules"].begin(), j["patches"][0]["modules"].end()); });
  expect("depth", [](json& j) { leaf(j)["depth"] = 15; });
  expect("max-depth", [](json& j) { j["patches"][0]["max_depth"] = 0; });
  expect("line-hops", [](json& j) { j["patches"][0]["line_hops"] = 0; });
  expect("joint-use", [](json& j) { j["patches"][0]["cut_joints"].push_back({entry(j)["id"], leaf(j)["id"]}); });
  const auto hang_on_cable = [](json& j, double length_mm) {
    j["version"] = 2;
    j["limits"]["jumper_mm"] = 8.5e6;
    j["report"]["jumpers_lower_bound"] = 0;
    j["jumpers"] = json::array({{{"kind", "cable"},
                                 {"modules", {leaf(j)["parent"], leaf(j)["id"]}},
                                 {"sides", {0, 0}},
                                 {"length_mm", length_mm},
                                 {"fold_rad", 0.0}}});
  };
  // The last module hangs on a cable of 8 km: 7.8 kΩ, so its milliampere takes all of the supply.
  expect("supply", [&](json& j) { hang_on_cable(j, 8e6); });
  // A cable of 6 m between two modules has 360 pF. Without it the line of a full patch has 172.
  expect("pull-up", [&](json& j) { hang_on_cable(j, 6e3); });
  expect("patch-members", [](json& j) { j["patches"][0]["modules"].push_back(leaf(j)["id"]); });
  expect("every-module-wired", [](json& j) { j["patches"].erase(0); });
  expect("patch-node", [](json& j) { j["patches"][0]["node_address"] = 5; });
  expect("entry", [](json& j) { j["patches"][0]["entry"] = j["patches"][1]["entry"]; });
  expect("second-entry", [](json& j) {  // Both cables are at one side.
    j["patches"][0]["second_entry"] = j["patches"][0]["entry"];
    j["patches"][0]["second_entry_side"] = entry(j)["rotation"];
  });
  expect("patches-bound", [](json& j) { j["report"]["patches_lower_bound"] = 99; });
  expect("patch-size", [](json& j) {
    for (const json& m : j["patches"][1]["modules"]) j["patches"][0]["modules"].push_back(m);
  });
}

// Changes a number wherever the design names its module.
void renumber(json& j, int from, int to) {
  const auto change = [&](json& name) {
    if (name == from) name = to;
  };
  for (json& m : j["modules"]) {
    change(m["id"]);
    change(m["parent"]);
    for (json& n : m["neighbours"]) change(n);
  }
  for (json& p : j["patches"]) {
    change(p["entry"]);
    change(p["second_entry"]);
    for (json& m : p["modules"]) change(m);
    for (json& joint : p["cut_joints"])
      for (json& m : joint) change(m);
    for (json& failure : p["failures"]) {
      change(failure["module"]);
      change(failure["other"]);
      for (json& joint : failure["backup"])
        for (json& m : joint) change(m);
    }
  }
}

TEST_F(Damage, numbers_of_modules) {
  const int last = static_cast<int>((*good_)["modules"].size()) - 1;
  // A gap before the last module changes the id of the design and nothing else.
  EXPECT_THAT(broken_by([&](json& j) { renumber(j, last, last + 10); }), testing::ElementsAre("design-id"));
  EXPECT_THAT(broken_by([&](json& j) { renumber(j, last, 65'535); }), testing::ElementsAre("design-id"));
  expect("module-number", [&](json& j) { renumber(j, last, 65'536); });
  expect("module-number", [&](json& j) { renumber(j, 0, last + 10); });  // It is no longer the smallest.
  expect("module-number", [&](json& j) { renumber(j, last, last - 1); });
  EXPECT_THAT(broken_by([&](json& j) { j["next_module"] = last + 1; }), testing::IsEmpty());
  // Numbers above the last one are those of modules that are gone: taking them for new ones changes the id.
  EXPECT_THAT(broken_by([&](json& j) { j["next_module"] = last + 2; }), testing::ElementsAre("design-id"));
  expect("module-number", [&](json& j) { j["next_module"] = last; });
  // What follows from a doubled number stands behind it.
  EXPECT_EQ(broken_by([&](json& j) {
              j["modules"][2]["id"] = 1;
              renumber(j, 2, 1);
            }).front(),
            "module-number");
}

TEST_F(Damage, what_cannot_be_read_is_said_with_its_place) {
  const int last = static_cast<int>((*good_)["modules"].size()) - 1;
  const auto error_of = [&](const std::function<void(json&)>& damage) {
    try {
      (void)broken_by(damage);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  const auto expect_error = [&](const std::string& part, const std::function<void(json&)>& damage) {
    EXPECT_THAT(error_of(damage), testing::HasSubstr(part));
  };
  const std::string none = fmt::format("names module {}, which the design does not have", last + 5);
  expect_error("damaged.json: /patches/0/entry: " + none, [&](json& j) { j["patches"][0]["entry"] = last + 5; });
  expect_error("/patches/0/cut_joints/0/1: " + none, [&](json& j) { j["patches"][0]["cut_joints"] = {{0, last + 5}}; });
  expect_error("/patches/0/failures/0/module: " + none,
               [&](json& j) { j["patches"][0]["failures"][0]["module"] = last + 5; });
  expect_error("/patches/0/failures/1/backup/0/1: " + none,
               [&](json& j) { j["patches"][0]["failures"][1]["backup"] = {{0, last + 5}}; });
  expect_error("/modules/3/id: must be a whole number, is 1.5", [](json& j) { j["modules"][3]["id"] = 1.5; });
  expect_error("/modules/3/id: must lie in ±9e+06, is 1e+20", [](json& j) { j["modules"][3]["id"] = 1e20; });
  expect_error("damaged.json: /modules/0/id: module-number: is -1; numbers of modules ascend from 0",
               [](json& j) { j["modules"][0]["id"] = -1; });
  // The last module has another place than number.
  expect_error(fmt::format("module {}: /modules/{}/corners: must be a list of 3, has 2", last + 10, last),
               [&](json& j) {
                 renumber(j, last, last + 10);
                 j["modules"].back()["corners"].erase(0);
               });
}

TEST_F(Damage, what_is_not_a_design_ends_with_the_file_named) {
  for (const char* text : {"", "{}", "[1,2]", "{\"format\":\"triskin-design\",\"version\":2}", "nonsense"}) {
    const fs::path path = folder_ / "bad.json";
    std::ofstream(path) << text;
    try {
      (void)check_design(path);
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("bad.json"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace triskin::check
