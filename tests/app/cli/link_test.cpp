// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which link a device command uses, and that a simulation is never taken for hardware.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "app/cli/shell_case.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Links : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(4, 4));
    ::unsetenv("TRISKIN_LINK");
  }
  void TearDown() override {
    ::unsetenv("TRISKIN_LINK");
    ShellCase::TearDown();
  }
};

TEST_F(Links, a_device_command_without_a_link_touches_nothing_and_says_how_to_name_one) {
  for (const char* command :
       {"flash strip.json", "verify strip.json", "live strip.json --seconds 0.1", "record strip.json -o r.mcap",
        "view strip.json --no-open", "identify strip.json -o b.json", "calibrate strip.json --steps 5,10", "discover",
        "bridge strip.json --seconds 0.1", "bring-up strip.json --no-questions", "live --protocol icub"}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.status, 2) << command << o.messages;
    EXPECT_THAT(o.messages, AllOf(HasSubstr("no link is named"), HasSubstr("Attached here:"), HasSubstr("--link"),
                                  HasSubstr("TRISKIN_LINK"), HasSubstr("--link sim simulates")))
        << command;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "state")) << command;
  }
}

TEST_F(Links, the_environment_names_the_link_of_a_design_and_a_robot_file_names_its_own) {
  ::setenv("TRISKIN_LINK", "sim", 1);
  EXPECT_EQ(run("flash strip.json").status, 0);
  ::setenv("TRISKIN_LINK", "can:nowhere", 1);
  EXPECT_EQ(run("flash strip.json").status, 3);
  EXPECT_EQ(run("flash strip.json --link sim").status, 0);
  ASSERT_EQ(run("robot new r.json --name r --bus left=sim").status, 0);
  ASSERT_EQ(run("robot add r.json strip.json --name strip --bus left").status, 0);
  const Outcome o = run("flash r.json");
  EXPECT_EQ(o.status, 0) << o.messages;
  EXPECT_THAT(o.out, StartsWith("Simulated; no hardware"));
}

// The file stands for variables that are not set; an option goes before both.
TEST_F(Links, the_settings_file_names_a_link_and_a_paper) {
  const auto settings = [&](const std::string& text) {
    std::filesystem::create_directories(folder_ / "config/triskin");
    write_file_atomically(folder_ / "config/triskin/config", text);
  };
  ::setenv("XDG_CONFIG_HOME", (folder_ / "config").c_str(), 1);
  settings("# the bench\nlink = can:nowhere  # one bus\n\npaper=roll\n");
  EXPECT_THAT(run("flash strip.json").messages, HasSubstr("can:nowhere"));
  EXPECT_EQ(run("flash strip.json --link sim").status, 0);
  ::setenv("TRISKIN_LINK", "sim", 1);
  EXPECT_EQ(run("flash strip.json").status, 0);
  ASSERT_EQ(run("export strip.json --format sheet-svg -o roll.svg").status, 0);
  ASSERT_EQ(run("export strip.json --format sheet-svg --paper A4 -o a4.svg").status, 0);
  // The roll is 610 mm wide and A4 upright 210.
  EXPECT_THAT(read_file(folder_ / "roll.svg").substr(0, 400), HasSubstr("width=\"610"));
  EXPECT_THAT(read_file(folder_ / "a4.svg").substr(0, 400), HasSubstr("width=\"210"));
  settings("link = sim\nlnk = can:can0\n");
  const Outcome o = run("flash strip.json");
  EXPECT_EQ(o.status, 2);
  EXPECT_THAT(o.messages, AllOf(HasSubstr("config: line 2: \"lnk = can:can0\""), HasSubstr("one of link, paper")));
  ::unsetenv("XDG_CONFIG_HOME");
}

// Every command with --link, and arguments with which it ends soon.
const std::map<std::string, std::string>& device_commands() {
  static const std::map<std::string, std::string> commands{
      {"bridge", "bridge strip.json --seconds 0.2"},
      {"bring-up", "bring-up strip.json --no-questions --seconds 0.2"},
      {"calibrate", "calibrate strip.json --steps 5,10 --modules 1"},
      {"discover", "discover --design strip.json"},
      {"dump", "dump strip.json --ask --frames 2"},
      {"flash", "flash strip.json"},
      {"identify", "identify strip.json --patch 0 --limit-s 1 -o b.json"},
      {"live", "live strip.json --seconds 0.2"},
      {"log", "log strip.json --seconds 0.2"},
      {"protect", "protect --scene strip.json"},
      {"record", "record strip.json -o r.mcap --seconds 0.2"},
      {"repair", "repair strip.json </dev/null"},
      {"verify", "verify strip.json"},
      {"view", "view strip.json --no-open"},
  };
  return commands;
}

TEST_F(Links, no_device_command_is_left_out_below) {
  static const std::regex row(R"(\n  ([a-z][a-z-]*) {2,})");
  const std::string help = run("--help").out;
  std::set<std::string> with_link, listed;
  for (std::sregex_iterator at(help.begin(), help.end(), row), end; at != end; ++at)
    if (run((*at)[1].str() + " --help").out.find("\n  --link ") != std::string::npos) with_link.insert((*at)[1]);
  for (const auto& [name, arguments] : device_commands()) listed.insert(name);
  EXPECT_EQ(with_link, listed);
}

std::string last_line(const std::string& text) {
  const auto before = text.size() < 2 ? std::string::npos : text.rfind('\n', text.size() - 2);
  return text.substr(before == std::string::npos ? 0 : before + 1);
}

TEST_F(Links, every_device_command_says_in_the_first_line_and_in_json_that_its_link_is_simulated) {
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  for (const auto& [name, arguments] : device_commands()) {
    if (name == "view") continue;  // It runs until Ctrl-C: see below.
    const Outcome text = run(arguments + " --link sim");
    EXPECT_THAT(text.out, StartsWith("Simulated; no hardware is involved.\n")) << arguments << text.messages;
    if (text.status >= 2) continue;  // It writes no object then.
    const auto object = nlohmann::json::parse(last_line(run(arguments + " --link sim --json").out), nullptr, false);
    EXPECT_TRUE(object.is_object() && object.value("simulated", false)) << arguments << object;
  }
}

TEST_F(Links, a_recording_says_that_it_is_of_a_simulation) {
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  ASSERT_EQ(run("record strip.json --link sim -o r.mcap --seconds 0.2").status, 0);
  const std::string bytes = read_file(folder_ / "r.mcap");
  EXPECT_THAT(bytes, HasSubstr("simulated"));
}

// Sends Ctrl-C to a command when it has printed `sign`; returns its status.
int status_after_interrupt(const std::string& command, const std::filesystem::path& log, const std::string& sign) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", (command + " >'" + log.string() + "' 2>&1").c_str(), static_cast<char*>(nullptr));
    std::_Exit(127);
  }
  while (!std::filesystem::exists(log) || read_file(log).find(sign) == std::string::npos) ::usleep(10'000);
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Links, ctrl_c_is_the_usual_end_of_live_and_view) {
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  EXPECT_EQ(status_after_interrupt(line("live strip.json --link sim --json"), folder_ / "live", "frames"), 0);
  EXPECT_EQ(status_after_interrupt(line("view strip.json --link sim --no-open"), folder_ / "view", "http://"), 0);
}

// Standard output is for the address alone, so view says it on standard error.
TEST_F(Links, view_says_first_that_its_link_is_simulated) {
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  const std::filesystem::path log = folder_ / "view";
  EXPECT_EQ(status_after_interrupt(line("view strip.json --link sim --no-open --json"), log, "http://"), 0);
  EXPECT_THAT(read_file(log), StartsWith("Simulated; no hardware is involved.\n"));
  EXPECT_TRUE(nlohmann::json::parse(last_line(read_file(log))).value("simulated", false));
}

TEST_F(Links, view_shows_a_design_alone_or_beside_another_one_without_a_link) {
  EXPECT_THAT(run("view strip.json --no-open").messages, HasSubstr("--link none shows the design alone"));
  EXPECT_EQ(status_after_interrupt(line("view strip.json --link none --no-open"), folder_ / "alone", "http://"), 0);
  EXPECT_EQ(status_after_interrupt(line("view strip.json --compare strip.json --no-open"), folder_ / "two", "http://"),
            0);
  EXPECT_THAT(run("view strip.json --compare strip.json --link sim --no-open").messages, HasSubstr("leave out --link"));
}

TEST_F(Links, a_missing_interface_leads_to_the_doctor) {
  EXPECT_THAT(run("discover --link can:nowhere").messages, HasSubstr("run: triskin doctor"));
}

}  // namespace
}  // namespace triskin::test
