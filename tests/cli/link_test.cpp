// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which link a device command uses, and that a simulation is never taken for hardware.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/shell_case.hpp"
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
  EXPECT_THAT(o.out, StartsWith("simulated: "));
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

TEST_F(Links, a_simulated_link_says_so_in_the_first_line_and_in_json) {
  for (const char* command :
       {"flash strip.json", "verify strip.json", "discover --design strip.json", "live strip.json --seconds 0.2",
        "record strip.json -o r.mcap --seconds 0.2", "identify strip.json --patch 0 --limit-s 1 -o b.json"}) {
    const Outcome text = run(std::string(command) + " --link sim");
    EXPECT_THAT(text.out, StartsWith("simulated: sim is no hardware\n")) << command << text.messages;
    const std::string lines = run(std::string(command) + " --link sim --json").out;
    const auto last = lines.rfind('\n', lines.size() - 2);
    const auto object = nlohmann::json::parse(lines.substr(last == std::string::npos ? 0 : last + 1));
    EXPECT_EQ(object.value("simulated", false), true) << command << lines;
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
