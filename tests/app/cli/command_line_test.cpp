// SPDX-License-Identifier: GPL-3.0-or-later
// Tests files and exit status of the program as a shell sees them.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "app/cli/shell_case.hpp"
#include "support/child_process.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;

class CommandLine : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(4, 4));
  }
};

TEST_F(CommandLine, a_full_disk_behind_standard_output_is_an_error) {
  EXPECT_EQ(run("export strip.json --format taxels -o - > /dev/full").status, 2);
  EXPECT_EQ(run("export strip.json --format taxels -o t.csv > /dev/full").status, 2);
  EXPECT_EQ(run("export strip.json --format taxels -o t.csv --json > /dev/full").status, 2);
}

TEST_F(CommandLine, a_dash_is_standard_output_and_messages_stand_aside) {
  const Outcome file = run("export strip.json --format taxels -o t.csv");
  EXPECT_EQ(file.status, 0);
  const Outcome dash = run("export strip.json --format taxels -o -");
  EXPECT_EQ(dash.status, 0);
  EXPECT_EQ(dash.out, read_file(folder_ / "t.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "-"));
  const Outcome both = run("export strip.json --format taxels -o - --json");
  EXPECT_EQ(both.status, 2);
  EXPECT_NE(both.messages.find("both want standard output"), std::string::npos) << both.messages;
}

TEST_F(CommandLine, a_device_and_a_pipe_are_written_into_and_stay) {
  EXPECT_EQ(run("export strip.json --format taxels -o /dev/null").status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const Outcome full = run("export strip.json --format taxels -o /dev/full");
  EXPECT_EQ(full.status, 2);
  EXPECT_NE(full.messages.find("/dev/full: cannot write"), std::string::npos) << full.messages;
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const std::string reader = "cat '" + (folder_ / "pipe").string() + "' > '" + (folder_ / "copy").string() + "' &";
  ASSERT_EQ(std::system(reader.c_str()), 0);
  EXPECT_EQ(run("export strip.json --format taxels -o pipe").status, 0);
  EXPECT_TRUE(fs::is_fifo(folder_ / "pipe"));
}

TEST_F(CommandLine, a_symbolic_link_is_followed) {
  std::ofstream(folder_ / "real.csv") << "old";
  fs::create_symlink("real.csv", folder_ / "link.csv");
  EXPECT_EQ(run("export strip.json --format taxels -o link.csv").status, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.csv"));
  EXPECT_GT(read_file(folder_ / "real.csv").size(), 100U);
}

TEST_F(CommandLine, the_input_is_never_written_over) {
  const std::string before = read_file(folder_ / "strip.json");
  fs::create_hard_link(folder_ / "strip.json", folder_ / "same.svg");
  for (const char* file : {"strip.json", "./strip.json", "same.svg"}) {
    const Outcome o = run(std::string("export strip.json --format picture -o ") + file);
    EXPECT_EQ(o.status, 2) << file;
    EXPECT_NE(o.messages.find("is the input"), std::string::npos) << o.messages;
  }
  EXPECT_EQ(read_file(folder_ / "strip.json"), before);
}

TEST_F(CommandLine, a_format_follows_the_extension_or_is_refused) {
  EXPECT_EQ(run("export strip.json -o a.svg").status, 0);
  EXPECT_TRUE(read_file(folder_ / "a.svg").starts_with("<svg"));
  ASSERT_EQ(run("export strip.json -o page.html").status, 0);
  EXPECT_NE(read_file(folder_ / "page.html").find("<canvas"), std::string::npos);  // the page, not a table
  const Outcome other = run("export strip.json --format html -o page.pdf");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.messages.find(".html"), std::string::npos) << other.messages;
  EXPECT_FALSE(fs::exists(folder_ / "page.pdf"));
  EXPECT_EQ(run("export strip.json --format modules -o modules.stl").status, 2);
  EXPECT_EQ(run("export strip.json -o a.png").status, 2);
}

// Program, firmware and its packages are released together.
TEST_F(CommandLine, the_program_and_its_controllers_say_one_version) {
  const std::string version = run("--version").out;
  const auto controllers =
      nlohmann::json::parse(run("discover --link sim --design strip.json --json").out)["controllers"];
  ASSERT_FALSE(controllers.empty());
  for (const auto& c : controllers) EXPECT_EQ(c["firmware"].get<std::string>() + "\n", version);
}

TEST_F(CommandLine, log_shows_what_controllers_write) {
  const Outcome o = run("log strip.json --link sim --seconds 1 --json");
  EXPECT_EQ(o.status, 0) << o.messages;
  const auto result = nlohmann::json::parse(o.out);
  EXPECT_TRUE(result["crashes"].empty());
  EXPECT_EQ(result["lost"], 0);
  bool started = false;
  for (const auto& line : result["lines"]) {
    EXPECT_EQ(line["node_address"], 1);
    started = started || line["text"].get<std::string>().starts_with("started: firmware ");
  }
  EXPECT_TRUE(started) << o.out;
  EXPECT_EQ(run("log strip.json --link sim --seconds 0.1 --node 9").status, 3);
  EXPECT_EQ(run("log strip.json --link sim --seconds 0.1 --level loud").status, 2);
}

// A design and a robot file are taken alike.
TEST_F(CommandLine, what_looks_at_a_bus_takes_a_design_or_a_robot) {
  ASSERT_EQ(run("robot new robot.json --name demo --bus left=sim --bus right=sim").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name forearm --bus left").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name upperarm --bus right --first-node 7").status, 0);
  ASSERT_EQ(run("flash robot.json").status, 0);
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  EXPECT_NE(run("discover strip.json --link sim").out.find("  patch 0\n"), std::string::npos);
  EXPECT_NE(run("discover robot.json").out.find("  upperarm, patch 0\n"), std::string::npos);
  const auto log = nlohmann::json::parse(run("log robot.json --seconds 1 --json").out);
  std::map<std::string, int> node_of_bus;
  for (const auto& row : log["lines"]) node_of_bus[row["bus"]] = row["node_address"];
  EXPECT_EQ(node_of_bus, (std::map<std::string, int>{{"left", 1}, {"right", 7}}));
  const Outcome dump = run("dump robot.json --ask --frames 2");
  for (const char* bus : {"left", "right"})
    EXPECT_NE(dump.out.find(std::string("  ") + bus + "  18E0FFF1 "), std::string::npos) << dump.out << dump.messages;
  for (const char* file : {"strip.json", "robot.json"})
    EXPECT_EQ(run(std::string("protect ") + file + " --link sim").status, 3) << file;  // as simulated boards answer
}

TEST_F(CommandLine, robot_remove_takes_a_cover_and_then_its_bus) {
  ASSERT_EQ(run("robot new robot.json --name demo --bus left=sim --bus right=sim").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name forearm --bus left").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name upperarm --bus left").status, 0);
  const auto file = [&] { return nlohmann::json::parse(read_file(folder_ / "robot.json")); };
  const auto node_of_upperarm = file()["covers"][1]["controllers"][0]["node"];
  const Outcome used = run("robot remove robot.json --bus left");
  EXPECT_EQ(used.status, 2);
  EXPECT_NE(used.messages.find("cover forearm is on bus left"), std::string::npos) << used.messages;
  EXPECT_EQ(run("robot remove robot.json --name nobody").status, 2);
  EXPECT_EQ(run("robot remove robot.json").status, 2);
  EXPECT_EQ(file()["covers"].size(), 2U);
  EXPECT_EQ(run("robot remove robot.json --name forearm").out, "robot.json: cover forearm removed; 1 cover left\n");
  EXPECT_EQ(file()["covers"].size(), 1U);
  EXPECT_EQ(file()["covers"][0]["controllers"][0]["node"], node_of_upperarm);  // the others keep their addresses
  EXPECT_EQ(run("robot remove robot.json --bus right").out, "robot.json: bus right removed; 1 bus left\n");
  EXPECT_EQ(file()["buses"].size(), 1U);
}

// The design has two controllers, the simulation that stands for its bus has one.
TEST_F(CommandLine, log_names_the_controllers_that_the_design_expects_in_vain) {
  design::write_design(folder_ / "one.json", strip(2, 2));
  design::write_design(folder_ / "two.json", strip(4, 2));
  const ServedSimulation one((folder_ / "one.json").string());
  const Outcome log = run("log two.json --seconds 0.1 --link " + one.link());
  EXPECT_EQ(log.status, 1) << log.messages;
  EXPECT_NE(log.out.find("patch 1 (node address 2) does not answer; check power and cable"), std::string::npos)
      << log.out << log.messages;
  EXPECT_EQ(run("log one.json --seconds 0.1 --link " + one.link()).status, 0);
  EXPECT_EQ(run("log two.json --node 1 --seconds 0.1 --link " + one.link()).status, 0) << "the other was not asked for";
}

// A simulated board has no pages to protect, and reports that.
TEST_F(CommandLine, protect_names_a_board_that_cannot) {
  const Outcome o = run("protect --link sim");
  EXPECT_NE(o.status, 0);
  EXPECT_FALSE(o.messages.empty());
}

TEST_F(CommandLine, a_design_that_was_changed_by_hand_is_not_deployed) {
  design::Design changed = strip(4, 4);
  changed.layout.modules[1].corner_mm[0].x() += 5.0;  // The changed design keeps the id of the strip.
  design::write_design(folder_ / "changed.json", changed);
  for (const char* command : {"flash", "verify", "live --seconds 0.1", "record --seconds 0.1 -o r.csv"}) {
    const std::string name(command);
    const auto space = name.find(' ');
    const Outcome o = run(name.substr(0, space) + " changed.json --link sim" +
                          (space == std::string::npos ? "" : name.substr(space)));
    EXPECT_EQ(o.status, 2) << command;
    EXPECT_NE(o.messages.find("changed after it was made"), std::string::npos) << command << ": " << o.messages;
  }
  EXPECT_FALSE(fs::exists(folder_ / "r.csv"));
  EXPECT_EQ(run("flash strip.json --link sim").status, 0);
}

}  // namespace
}  // namespace triskin::test
