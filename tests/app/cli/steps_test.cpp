// SPDX-License-Identifier: GPL-3.0-or-later
// Chains the steps of a design as a shell does, and tests the messages about slips.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/cli/shell_case.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Steps : public ShellCase {
 protected:
  static void require_geometry() {
    if (!program_has_solvers()) GTEST_SKIP() << "built without the solvers";
  }
  void write(const std::string& name, const std::string& text) const { write_file_atomically(folder_ / name, text); }
  // The plate lies in the plane z = 0.
  void write_plate(const std::string& name, double width, double height) const {
    write(name, fmt::format("v 0 0 0\nv {0} 0 0\nv {0} {1} 0\nv 0 {1} 0\nf 1 2 3\nf 1 3 4\n", width, height));
  }
};

TEST_F(Steps, a_net_is_placed_and_the_modules_are_routed) {
  require_geometry();
  if (IsSkipped()) return;
  write_plate("plate.obj", 200, 180);
  ASSERT_EQ(run("unfold plate.obj -o net.json").status, 0);
  const Outcome placed = run("place net.json -o modules.json --json");
  ASSERT_EQ(placed.status, 0) << placed.messages;
  const auto modules = nlohmann::json::parse(placed.out)["modules"].get<int>();
  EXPECT_GT(modules, 50);
  const Outcome routed = run("route modules.json --json");
  ASSERT_EQ(routed.status, 0) << routed.messages;
  EXPECT_GE(nlohmann::json::parse(routed.out)["patches"].get<int>(), (modules + 15) / 16);
}

// A comb with twelve teeth of 1 m × 24 mm, in which no module fits, and a plate of 60 mm at its end: a design of some
// modules on a surface that has room for hundreds is not the one that was meant.
TEST_F(Steps, a_cover_of_hardly_anything_is_no_success_and_says_what_to_choose) {
  require_geometry();
  if (IsSkipped()) return;
  constexpr int kTeeth = 12;
  std::vector<double> xs{0.0, 60.0};
  for (int k = 0; k < kTeeth; ++k) xs.insert(xs.end(), {100.0 + 60.0 * k, 124.0 + 60.0 * k});
  const std::array ys{0.0, 24.0, 60.0, 1024.0};
  std::string mesh;
  for (const double y : ys) {
    for (const double x : xs) mesh += fmt::format("v {} {} 0\n", x, y);
  }
  for (std::size_t row = 0; row + 1 < ys.size(); ++row) {
    for (std::size_t column = 0; column + 1 < xs.size(); ++column) {
      const bool is_plate = column == 0 && row == 1, is_tooth = column >= 2 && column % 2 == 0;
      if (row > 0 && !is_plate && !is_tooth) continue;
      const std::size_t a = row * xs.size() + column + 1, above = a + xs.size();
      mesh += fmt::format("f {} {} {}\nf {} {} {}\n", a, a + 1, above + 1, a, above + 1, above);
    }
  }
  write("comb.obj", mesh);
  const Outcome few = run("design comb.obj -o comb.json --iterations 5 --time-limit-s 100");
  EXPECT_EQ(few.status, 1) << few.messages;
  EXPECT_THAT(few.out, AllOf(testing::ContainsRegex("Only [0-9]+ modules? of [0-9]+ by area: choose the body"),
                             HasSubstr("--side"), HasSubstr("repair the mesh")));
}

TEST_F(Steps, a_design_is_changed_by_hand) {
  require_geometry();
  if (IsSkipped()) return;
  write_plate("plate.obj", 100, 60);
  ASSERT_EQ(run("design plate.obj -o a.json --iterations 20 --time-limit-s 100").status, 0);
  const Outcome removed = run("edit a.json --remove 1,3-4 -o b.json --json");
  ASSERT_EQ(removed.status, 0) << removed.messages;
  const auto result = nlohmann::json::parse(removed.out);
  EXPECT_EQ(result["removed"], nlohmann::json({1, 3, 4}));
  EXPECT_EQ(result["added"], nlohmann::json::array());
  const auto made = nlohmann::json::parse(read_file(folder_ / "b.json"));
  ASSERT_GE(made["modules"].size(), 3U);
  EXPECT_EQ(made["modules"][0]["id"], 0);
  EXPECT_EQ(made["modules"][1]["id"], 2);
  EXPECT_EQ(made["modules"][2]["id"], 5);
  EXPECT_THAT(run("edit b.json --remove 3 -o c.json").messages,
              HasSubstr("--remove: there is no module 3; the design has 0,2,5-"));
  EXPECT_EQ(run("check b.json").status, 0);
  EXPECT_THAT(run("edit a.json --keep 0-2 --mirror x -o c.json").messages,
              HasSubstr("--keep and --mirror cannot stand together"));
  // A design under the name of another format would be taken for a mesh.
  const Outcome misnamed = run("edit a.json --remove 1 -o c.OBJ");
  EXPECT_EQ(misnamed.status, 2);
  EXPECT_THAT(misnamed.messages, HasSubstr("c.OBJ: a design is a JSON file; name it c.json"));
  EXPECT_FALSE(fs::exists(folder_ / "c.OBJ"));
  const Outcome nothing = run("edit a.json -o c.json");
  EXPECT_EQ(nothing.status, 2);
  EXPECT_THAT(nothing.messages, HasSubstr("say what to change"));
  EXPECT_EQ(run("edit a.json --remove 1 --threads 2 -o c.json").status, 2);
  EXPECT_THAT(run("edit a.json --remove 1-x -o c.json").messages, HasSubstr("\"1-x\" is not understood"));
  EXPECT_THAT(run("edit a.json --add 0.3 -o c.json").messages, HasSubstr("give MODULE.SIDE"));
  EXPECT_THAT(run("edit a.json --add 0:1/2/left -o c.json").messages, HasSubstr("ISLAND:I/J/up"));
  EXPECT_THAT(run("edit a.json --mirror 0,0,0,5 -o c.json").messages, HasSubstr("--mirror: \"0,0,0,5\""));
  EXPECT_FALSE(fs::exists(folder_ / "c.json"));
  // A design in place of a mesh: the program names the command that changes designs.
  const Outcome not_a_mesh = run("design a.json -o c.json");
  EXPECT_EQ(not_a_mesh.status, 2);
  EXPECT_THAT(not_a_mesh.messages, HasSubstr("triskin edit"));
  const Outcome mirrored = run("edit a.json --mirror 1,1,0,20 -o c.json --json");
  ASSERT_EQ(mirrored.status, 0);
  const auto number_keys = [](const Outcome& o) {
    const auto keys = nlohmann::json::parse(o.out);
    EXPECT_EQ(keys["kept"], keys["modules"]);
    EXPECT_EQ(keys["removed"], nlohmann::json::array());
    EXPECT_EQ(keys["added"], nlohmann::json::array());
  };
  number_keys(mirrored);
  EXPECT_EQ(run("check c.json").status, 0);
  write("kinds.json", R"({"format":"triskin-kinds","version":1,"kinds":[{"name":"soft","taxels":8}],
                          "regions":[{"kind":"soft","modules":[2]}]})");
  EXPECT_THAT(run("design plate.obj --kinds kinds.json -o e.json").messages, HasSubstr("make it without --kinds"));
  const Outcome kinds = run("edit b.json --kinds kinds.json -o e.json --json");
  EXPECT_EQ(nlohmann::json::parse(kinds.out)["kinds"]["soft"], 1);
  number_keys(kinds);
  const Outcome taken = run("edit b.json --take 0 -o t.json --json");
  ASSERT_EQ(taken.status, 0) << taken.messages;
  const auto keys = nlohmann::json::parse(taken.out);
  EXPECT_EQ(keys["kept"].get<std::size_t>() + keys["added"].size(), keys["modules"].get<std::size_t>());
  EXPECT_EQ(run("check e.json").status, 0);
  ASSERT_EQ(run("edit e.json --kinds none -o f.json").status, 0);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "f.json")), nlohmann::json::parse(read_file(folder_ / "b.json")));
  ASSERT_EQ(run("edit b.json --keep 0-2 --iterations 5 --time-limit-s 100 -o d.json").status, 0);
  EXPECT_EQ(run("check d.json").status, 0);
}

TEST_F(Steps, every_piece_of_a_net_becomes_an_island) {
  require_geometry();
  if (IsSkipped()) return;
  write("net.json", R"({"format":"triskin-net","version":1,"pieces":[
    {"outline":[[0,0],[100,0],[100,60],[0,60]],"holes":[],"faces":[],"flat":[]},
    {"outline":[[0,0],[90,0],[90,90],[0,90]],"holes":[[[40,40],[40,50],[50,50],[50,40]]],"faces":[],"flat":[]}]})");
  const auto all = nlohmann::json::parse(run("place net.json -o modules.json --json").out);
  const auto first = nlohmann::json::parse(run("place net.json --piece 0 --json").out);
  const auto second = nlohmann::json::parse(run("place net.json --piece 1 --json").out);
  EXPECT_EQ(all["modules"].get<int>(), first["modules"].get<int>() + second["modules"].get<int>());
  const auto list = nlohmann::json::parse(read_file(folder_ / "modules.json"))["modules"];
  ASSERT_EQ(list.size(), all["modules"].get<std::size_t>());
  EXPECT_EQ(list.front()["island"], 0);
  EXPECT_EQ(list.back()["island"], 1);
  EXPECT_EQ(run("route modules.json").status, 0);
  EXPECT_EQ(run("place net.json --piece 2").status, 2);
}

TEST_F(Steps, nothing_that_fits_is_status_1_with_the_reason) {
  require_geometry();
  if (IsSkipped()) return;
  write_plate("plate.obj", 20, 18);  // The numbers are cm but taken for mm.
  const Outcome o = run("design plate.obj -o d.json --time-limit-s 1");
  EXPECT_EQ(o.status, 1);
  EXPECT_THAT(o.out, AllOf(HasSubstr("no module fits"), HasSubstr("20 × 18 × 0 mm"), HasSubstr("--unit cm")));
  EXPECT_FALSE(fs::exists(folder_ / "d.json"));
  EXPECT_EQ(run("design plate.obj --unit cm -o d.json --time-limit-s 1").status, 0);
  EXPECT_EQ(run("check d.json").status, 0);
  write("small.wkt", "POLYGON((0 0, 20 0, 20 18, 0 18, 0 0))");
  EXPECT_EQ(run("place small.wkt").status, 1);
}

TEST_F(Steps, a_design_without_modules_is_neither_checked_nor_recorded_as_good) {
  design::write_design(folder_ / "empty.json", strip(0));
  const Outcome recorded = run("record empty.json --link sim -o r.mcap");
  EXPECT_EQ(recorded.status, 2);
  EXPECT_THAT(recorded.messages, HasSubstr("no modules"));
  EXPECT_FALSE(fs::exists(folder_ / "r.mcap"));
  require_geometry();
  if (IsSkipped()) return;
  const Outcome checked = run("check empty.json");
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(checked.out, HasSubstr("no modules"));
}

TEST_F(Steps, a_design_that_is_ended_keeps_the_best_layout) {
  require_geometry();
  if (IsSkipped()) return;
  write_plate("plate.obj", 200, 180);
  // The growth reports itself after a quarter of the limit.
  const std::string command = line("design plate.obj -o d.json --time-limit-s 60 >log 2>&1");
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    std::_Exit(127);
  }
  while (!fs::exists(folder_ / "log") || read_file(folder_ / "log").find("lattice") == std::string::npos)
    ::usleep(10'000);
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_THAT(read_file(folder_ / "log"), HasSubstr("the best layout so far"));
  EXPECT_EQ(run("check d.json").status, 0);
  EXPECT_GT(design::read_intact_design(folder_ / "d.json").layout.modules.size(), 50U);
}

TEST_F(Steps, a_number_that_is_shown_as_0_has_no_sign) {
  require_geometry();
  if (IsSkipped()) return;
  write("module.wkt", "POLYGON((0 0, 30 0, 15 25.980762113533, 0 0))");  // The polygon fits exactly one module.
  const Outcome o = run("place module.wkt");
  EXPECT_EQ(o.status, 0);
  EXPECT_THAT(o.out, AllOf(HasSubstr("0.0000 mm"), Not(HasSubstr("-0.0000 mm"))));
}

TEST_F(Steps, a_slip_gets_the_nearest_name) {
  EXPECT_THAT(run("recrod").messages, HasSubstr("did you mean record?"));
  EXPECT_THAT(run("record s.json --secnods 1").messages, HasSubstr("did you mean --seconds?"));
  EXPECT_THAT(run("record s.json --lnik=sim").messages, HasSubstr("did you mean --link?"));
  EXPECT_THAT(run("something").messages, Not(HasSubstr("did you mean")));
  EXPECT_EQ(run("recrod").status, 2);
}

TEST_F(Steps, names_of_the_json_library_are_not_shown) {
  write("broken.json", "{\"modules\": [1, 2,, 3]}");
  for (const char* command : {"check broken.json", "route broken.json", "place broken.json", "flash broken.json",
                              "export broken.json --format taxels"}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.status, 2) << command;
    EXPECT_THAT(o.messages, Not(HasSubstr("json.exception"))) << command;
  }
  EXPECT_THAT(run("flash broken.json").messages, HasSubstr("line 1, column 19"));
}

}  // namespace
}  // namespace triskin::test
