// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a robot as the program sees it: 12 covers, at least 96 controllers, 6 CAN buses and 2 USB hubs, one file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "app/cli/shell_case.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class RobotCommands : public ShellCase {
 protected:
  void TearDown() override {
    if (server_ > 0) (void)std::system(fmt::format("kill {}", server_).c_str());
    ShellCase::TearDown();
  }
  // Cover k has strips of 30 + k modules, so that no two designs are equal. The last `hubs` of the buses are USB hubs,
  // the others CAN.
  void make_robot(int covers, int buses, int modules, int per_patch, int hubs = 0) {
    std::string command = "robot new robot.json --name robot";
    for (int b = 0; b < buses; ++b) command += fmt::format(" --bus bus{}={}", b, b < buses - hubs ? "sim" : "sim-usb");
    ASSERT_EQ(run(command).status, 0);
    for (int c = 0; c < covers; ++c) {
      design::write_design(folder_ / fmt::format("cover{}.json", c), strip(modules + c, per_patch));
      const Outcome added =
          run(fmt::format("robot add robot.json cover{0}.json --name cover{0} --bus bus{1}", c, c % buses));
      ASSERT_EQ(added.status, 0) << added.messages;
    }
  }
  json asked(const std::string& arguments, int status = 0) const {
    const Outcome o = run(arguments + " --json");
    EXPECT_EQ(o.status, status) << arguments << ": " << o.messages;
    const auto last = o.out.rfind('\n', o.out.size() - 2);
    return json::parse(last == std::string::npos ? o.out : o.out.substr(last + 1), nullptr, false);
  }
  // Returns the link under which the buses are served.
  std::string serve(const std::string& what = "robot.json") {
    write_file_atomically(folder_ / "served", "");
    const std::string command = line("simulate " + what + " --listen 127.0.0.1:0") + " >served 2>&1 & echo $! >pid";
    EXPECT_EQ(std::system(fmt::format("cd '{}' && ({})", folder_.string(), command).c_str()), 0);
    server_ = std::stoi(read_file(folder_ / "pid"));
    for (int tries = 0; tries < 600; ++tries) {
      const std::string text = read_file(folder_ / "served");
      const auto at = text.find(" modules on ");
      const auto end = text.find(';', at);
      if (at != std::string::npos && end != std::string::npos) return text.substr(at + 12, end - at - 12);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ADD_FAILURE() << read_file(folder_ / "served");
    return "";
  }
  int server_ = 0;
};

// This is a small version of the test below.
TEST_F(RobotCommands, two_buses_by_one_file) {
  make_robot(3, 2, 6, 3);
  const json shown = asked("robot show robot.json");
  EXPECT_EQ(shown["buses"][0]["modules"], 6 + 8);
  const json first = asked("flash robot.json");
  EXPECT_EQ(first["controllers"], 2 + 3 + 3);
  EXPECT_EQ(first["skipped"], 0);
  const json verified = asked("verify robot.json --watch-s 0.5");
  EXPECT_EQ(verified["modules_ok"], 6 + 7 + 8);
  EXPECT_EQ(verified["covers"][1]["cover"], "cover2");  // The covers are listed by bus.
  const json recorded = asked("record robot.json -o recorded --seconds 0.5");
  EXPECT_EQ(recorded["lost"], 0);
  for (const char* cover : {"cover0", "cover1", "cover2"})
    EXPECT_EQ(run(fmt::format("replay recorded/{}.mcap --speed 0", cover)).status, 0) << cover;
  EXPECT_EQ(asked("live robot.json --seconds 0.5")["lost"], 0);
  EXPECT_EQ(asked("live robot.json --cover cover2 --press 7 --seconds 1")["pressed"][0]["module"], 7);
  const json found = asked("discover robot.json --note");
  EXPECT_EQ(found["noted"], 8);
  std::map<std::string, int> by_cover;
  for (const json& c : found["controllers"]) ++by_cover[c["cover"].get<std::string>()];
  EXPECT_EQ(by_cover, (std::map<std::string, int>{{"cover0", 2}, {"cover1", 3}, {"cover2", 3}}));
  EXPECT_EQ(asked("discover robot.json --note")["noted"], 0);
  EXPECT_EQ(asked("flash robot.json")["bytes"], 0);
  EXPECT_EQ(run("export robot.json --format gltf -o robot.gltf").status, 0);
}

// Rest values are kept in a file; there, six taxels of a module rest 300 counts lower than they do.
TEST_F(RobotCommands, live_says_which_taxels_of_which_cover_do_not_rest) {
  make_robot(2, 2, 6, 3);
  ASSERT_EQ(run("flash robot.json").status, 0);
  for (const char* cover : {"cover0", "cover1"})
    ASSERT_EQ(run(fmt::format("live robot.json --cover {} --tare --press -1 --seconds 0.3", cover)).status, 0);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    if (entry.path().parent_path().filename() == "rest") files.push_back(entry.path());
  }
  ASSERT_EQ(files.size(), 2U) << "one for each cover";
  for (const fs::path& file : files) {
    json rest = json::parse(read_file(file));
    if (rest["rest_counts"].size() != 7) continue;  // Cover 1 has 7 modules.
    for (std::size_t taxel = 0; taxel < 6; ++taxel)
      rest["rest_counts"][4][taxel] = rest["rest_counts"][4][taxel].get<double>() - 300.0;
    write_file_atomically(file, rest.dump());
  }
  const Outcome said = run("live robot.json --seconds 1");
  EXPECT_THAT(said.out, HasSubstr("cover1: 6 taxels do not rest: tare; their module: 4\n"));
  EXPECT_THAT(said.out, testing::Not(testing::ContainsRegex("cover0: [0-9]+ taxel")));
  const json result = asked("live robot.json --seconds 1");
  EXPECT_EQ(result["covers"][0]["off_rest"]["taxels"], 0);
  EXPECT_EQ(result["covers"][1]["off_rest"], (json{{"taxels", 6}, {"modules", {4}}}));
}

// Nobody serves the second bus.
TEST_F(RobotCommands, a_bus_that_is_away_leaves_the_others_their_tables) {
  make_robot(2, 2, 6, 3);
  std::string text = read_file(folder_ / "robot.json");
  const std::string right = R"("name":"bus1","link":"sim")";
  ASSERT_NE(text.find(right), std::string::npos);
  text.replace(text.find(right), right.size(), R"("name":"bus1","link":"can:nobody0")");
  write_file_atomically(folder_ / "robot.json", text);
  EXPECT_EQ(run("flash robot.json").status, 3);  // The error is known before anything is written.
  EXPECT_EQ(asked("flash robot.json --cover cover0")["bytes"].get<int>() > 0, true);
  EXPECT_EQ(asked("verify robot.json --cover cover0 --watch-s 0.5")["findings"], 0);
}

TEST_F(RobotCommands, refusals_name_the_remedy) {
  make_robot(2, 1, 6, 3);
  EXPECT_THAT(run("flash robot.json --patch 0").messages, HasSubstr("--cover"));
  EXPECT_THAT(run("verify robot.json --cover head").messages, HasSubstr("cover0, cover1"));
  EXPECT_THAT(run("robot add robot.json cover0.json --name cover0").messages, HasSubstr("--replace"));
  EXPECT_THAT(run("robot show robot.json --name x").messages, HasSubstr("--name is for another action"));
  // The design file is written anew under its old name.
  design::write_design(folder_ / "cover1.json", strip(9, 3));
  const Outcome changed = run("flash robot.json");
  EXPECT_EQ(changed.status, 2);
  EXPECT_THAT(changed.messages, HasSubstr("robot add robot.json cover1.json --name cover1 --replace"));
  EXPECT_EQ(run("robot show robot.json").status, 1);
  EXPECT_EQ(run("robot add robot.json cover1.json --name cover1 --replace").status, 0);
  EXPECT_EQ(run("robot show robot.json").status, 0);
}

TEST_F(RobotCommands, register_writes_a_pose_and_leaves_the_file_alone_for_a_bad_one) {
  make_robot(1, 1, 20, 16);
  // The touches are turned by 90° about z and moved.
  std::string good = "module,taxel,x_mm,y_mm,z_mm\n";
  const auto wiring = design::wiring_of(strip(20));
  for (const int m : {0, 4, 7, 9, 13, 18}) {
    const auto at = design::taxels_of(strip(20).layout.modules[static_cast<std::size_t>(m)],
                                      wiring[static_cast<std::size_t>(m)].routed.rotation)[9]
                        .position_mm;
    good += fmt::format("{},9,{},{},{}\n", m, 100 - at.y(), 50 + at.x(), 7.0);
  }
  write_file_atomically(folder_ / "touches.csv", good);
  const json r = asked("robot register robot.json touches.csv --name cover0");
  EXPECT_LT(r["rms_mm"].get<double>(), 1e-3);
  EXPECT_TRUE(r["mirror_unknown"]);  // A strip is flat, so its mirror image fits as well.
  EXPECT_THAT(read_file(folder_ / "robot.json"), HasSubstr("\"measured\":{\"points\":6"));
  EXPECT_EQ(run("robot show robot.json").status, 0);
  const std::string before = read_file(folder_ / "robot.json");
  write_file_atomically(folder_ / "touches.csv", good + "19,3,0,0,0\n");  // The touch is 300 mm from its right place.
  const Outcome bad = run("robot register robot.json touches.csv --name cover0");
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.out, HasSubstr("is above 5 mm, largest at touch 7"));
  EXPECT_EQ(read_file(folder_ / "robot.json"), before);
}

// The boards are more than half of a bus's addresses: fresh boards, which got free addresses to be asked, occupy those
// of other covers.
TEST_F(RobotCommands, fresh_controllers_fill_a_bus) {
  make_robot(5, 1, 20, 1);
  const json flashed = asked("flash robot.json");
  EXPECT_EQ(flashed["controllers"], 20 + 21 + 22 + 23 + 24);
  EXPECT_EQ(asked("flash robot.json")["bytes"], 0);
  EXPECT_EQ(asked("verify robot.json --watch-s 0.2")["modules_ok"], 110);
}

TEST_F(RobotCommands, TwelveCovers_96_controllers_6_buses_2_hubs) {
  make_robot(12, 8, 30, 4, 2);  // Each cover has 30 … 41 modules and 8 … 11 controllers.
  const json shown = asked("robot show robot.json");
  int controllers = 0, modules = 0;
  for (const auto& bus : shown["buses"]) {
    controllers += bus["controllers"].get<int>();
    modules += bus["modules"].get<int>();
  }
  EXPECT_GE(controllers, 96);
  const json flashed = asked("flash robot.json");
  EXPECT_EQ(flashed["controllers"], controllers);
  EXPECT_EQ(flashed["skipped"], 0);
  const json verified = asked("verify robot.json");
  EXPECT_EQ(verified["modules_ok"], modules);
  EXPECT_EQ(verified["touched"], modules);
  EXPECT_EQ(verified["findings"], 0);
  EXPECT_EQ(asked("live robot.json --seconds 2")["lost"], 0);
  EXPECT_EQ(asked("record robot.json -o recorded --seconds 2")["lost"], 0);
  EXPECT_EQ(asked("discover robot.json --note")["noted"], controllers);
  // A cover is replaced, and only its boards are written.
  design::write_design(folder_ / "cover3.json", strip(28, 4));
  EXPECT_EQ(asked("robot add robot.json cover3.json --name cover3 --replace")["nodes"].size(), 7U);
  const json again = asked("flash robot.json");
  for (const auto& cover : again["covers"]) {
    for (const auto& patch : cover["patches"])
      EXPECT_EQ(patch["written"], cover["cover"] == "cover3") << cover["cover"];
  }
  std::printf("%d controllers, %d modules; flash: %.2f s of the slowest bus\n", controllers, modules,
              flashed["link_s"].get<double>());
}

// Another process simulates with one port per bus. On a busy computer it may answer late, so the question is repeated.
TEST_F(RobotCommands, served_buses_have_ports_that_follow_each_other) {
  make_robot(3, 2, 6, 3);
  const std::string link = " --link " + serve();
  int status = 3;
  for (int tries = 0; status == 3 && tries < 5; ++tries) status = run("flash robot.json" + link).status;
  EXPECT_EQ(status, 0);
  json again;
  for (int tries = 0; !again.contains("controllers") && tries < 5; ++tries) {
    const Outcome o = run("flash robot.json --json" + link);
    if (o.status == 0) again = json::parse(o.out);
  }
  EXPECT_EQ(again["skipped"], 8);
  // A single cover is found at the port of its bus.
  status = 3;
  for (int tries = 0; status == 3 && tries < 5; ++tries) status = run("flash robot.json --cover cover1" + link).status;
  EXPECT_EQ(status, 0);
}

// The second cover has the node addresses 3, 4 and 5. discover used to take a node address less one for the patch, so
// it held controller 3 against patch 2 of that design, which has one module.
TEST_F(RobotCommands, discover_compares_a_controller_with_the_patch_of_its_table_whatever_its_address) {
  make_robot(2, 1, 8, 4);
  write_file_atomically(
      folder_ / "scene.json",
      json{{"format", "triskin-scene"}, {"version", 1}, {"robot", "robot.json"}, {"hardware", "switched"}}.dump());
  const std::string link = " --link " + serve("scene.json");
  int status = 3;
  for (int tries = 0; status == 3 && tries < 5; ++tries) status = run("flash robot.json" + link).status;
  ASSERT_EQ(status, 0);
  const json found = asked("discover --topology --design cover0.json --design cover1.json" + link);
  std::map<int, int> patch_of_node;
  for (const json& c : found["controllers"]) {
    const json& match = c["topology"]["match"];
    EXPECT_TRUE(match["differences"].empty()) << c.dump(1);
    patch_of_node[c["node_address"]] = match["patch"];
  }
  EXPECT_EQ(patch_of_node, (std::map<int, int>{{1, 0}, {2, 1}, {3, 0}, {4, 1}, {5, 2}}));
}

}  // namespace
}  // namespace triskin::test
