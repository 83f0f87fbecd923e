// SPDX-License-Identifier: GPL-3.0-or-later
// Runs record, recover, replay and live as a shell does.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
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

class Recordings : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(20, 10));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  // Starts the program with its output in the file `name`.
  [[nodiscard]] pid_t start(const std::string& arguments, const std::string& name) const {
    const std::string command = line(arguments) + " >" + name + " 2>&1";
    const pid_t child = ::fork();
    if (child == 0) {
      ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      std::_Exit(127);
    }
    return child;
  }
  static int end_of(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  // Waits until a file has this length; a broken program ends the wait by the time limit of the test.
  void wait_for(const std::string& name, std::uintmax_t bytes) const {
    std::error_code none;
    while (!fs::exists(folder_ / name) || fs::file_size(folder_ / name, none) < bytes) ::usleep(5'000);
  }
  void wait_for_text(const std::string& name, const std::string& text) const {
    wait_for(name, 1);
    while (read_file(folder_ / name).find(text) == std::string::npos) ::usleep(5'000);
  }
  [[nodiscard]] nlohmann::json recovered(const std::string& file) const {
    return nlohmann::json::parse(run("recover " + file + " --json").out);
  }
  void write_scene(const std::string& rest) const {
    write_file_atomically(folder_ / "scene.json",
                          R"({"format":"triskin-scene","version":1,"design":"strip.json",)" + rest + "}");
  }
  // Serves the scene and returns the link to it.
  [[nodiscard]] std::string serve(pid_t& server) const {
    server = start("simulate scene.json --listen 127.0.0.1:0", "served");
    wait_for_text("served", "end with Ctrl-C");
    const std::string text = read_file(folder_ / "served");
    const auto at = text.find("sim:127.0.0.1:");
    return text.substr(at, text.find_first_of(" ,;\n", at) - at);
  }
  // Serves boards with power on whose taxel 3 of module 4 an object lies, and returns the link to them. It came after
  // the controllers had settled their offsets: what lies there at power-up is no pressure (docs/stream.md).
  [[nodiscard]] std::string serve_touched() {
    write_scene(R"("contacts":[{"at_s":0.8,"module":4,"taxel":3,"force_n":6,"radius_mm":3}])");
    const std::string link = serve(touched_);
    ::sleep(2);
    return link;
  }
  void end_touched() {
    if (touched_ > 0) ::kill(touched_, SIGTERM);
    if (touched_ > 0) (void)end_of(touched_);
    touched_ = 0;
  }
  void TearDown() override {
    end_touched();
    ShellCase::TearDown();
  }

 private:
  pid_t touched_ = 0;
};

TEST_F(Recordings, formats_hold_the_same_samples) {
  const auto mcap = nlohmann::json::parse(run("record strip.json --link sim --seconds 1 -o r.mcap --json").out);
  const auto csv = nlohmann::json::parse(run("record strip.json --link sim --seconds 1 -o r.csv --json").out);
  EXPECT_EQ(mcap["samples"], csv["samples"]);
  EXPECT_EQ(mcap["samples"], recovered("r.mcap")["samples"]);
  const std::string text = read_file(folder_ / "r.csv");
  EXPECT_EQ(static_cast<std::uint64_t>(std::ranges::count(text, '\n')), csv["samples"].get<std::uint64_t>() + 1);
  EXPECT_EQ(run("record strip.json --link sim --seconds 1 -o r.csv --format mcap").status, 2);
  EXPECT_EQ(run("record strip.json --link sim --seconds 1 -o r.dat").status, 2);
  EXPECT_EQ(run("record strip.json --link sim --seconds 1 -o r.dat --format mcap").status, 0);
}

TEST_F(Recordings, the_file_is_opened_before_the_link) {
  // Nobody listens at port 1, yet the message must be about the file.
  const Outcome nowhere = run("record strip.json --link sim:127.0.0.1:1 -o nowhere/r.mcap");
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_THAT(nowhere.messages, HasSubstr("nowhere/r.mcap: cannot write"));
  write_file_atomically(folder_ / "old.mcap", "old");
  EXPECT_EQ(run("record strip.json --link sim:127.0.0.1:1 -o old.mcap").status, 3);
  EXPECT_EQ(read_file(folder_ / "old.mcap"), "old");
}

TEST_F(Recordings, a_full_disk_is_said) {
  const Outcome full = run("record strip.json --link sim --seconds 1 --format mcap -o /dev/full");
  EXPECT_EQ(full.status, 2);
  EXPECT_THAT(full.messages, HasSubstr("No space left on device"));
}

TEST_F(Recordings, signals_end_a_recording_in_order) {
  for (const auto& [signal, status] : {std::pair{SIGHUP, 129}, {SIGINT, 130}, {SIGTERM, 143}}) {
    fs::remove(folder_ / "r.mcap");
    const pid_t child = start("record strip.json --link sim --seconds 1e6 -o r.mcap", "log");
    wait_for("r.mcap", 100'000);
    ::kill(child, signal);
    EXPECT_EQ(end_of(child), status);
    EXPECT_TRUE(recovered("r.mcap")["was_complete"]) << status;
    EXPECT_THAT(read_file(folder_ / "log"), HasSubstr("the file holds what arrived until then"));
  }
}

TEST_F(Recordings, a_killed_recording_is_recovered) {
  const pid_t child = start("record strip.json --link sim --seconds 1e6 -o r.mcap", "log");
  wait_for("r.mcap", 300'000);
  ::kill(child, SIGKILL);
  EXPECT_EQ(end_of(child), -SIGKILL);
  const auto first = recovered("r.mcap");
  EXPECT_FALSE(first["was_complete"]);
  EXPECT_GT(first["samples"], 1'000);
  EXPECT_LT(first["dropped_bytes"], 200'000);
  EXPECT_TRUE(recovered("r.mcap")["was_complete"]);
}

TEST_F(Recordings, a_lost_link_ends_with_what_came) {
  write_scene(R"("seed":1)");
  pid_t server = 0;
  const std::string link = serve(server);
  const pid_t child = start("record strip.json --link " + link + " --seconds 1000 -o r.mcap", "log");
  wait_for("r.mcap", 60'000);
  ::kill(server, SIGKILL);
  (void)end_of(server);
  EXPECT_EQ(end_of(child), 3);
  EXPECT_THAT(read_file(folder_ / "log"), HasSubstr("the recording ends here"));
  const auto r = recovered("r.mcap");
  EXPECT_TRUE(r["was_complete"]);
  EXPECT_GT(r["samples"], 100);
}

// A link that fails ends a stream, but must not lose the counts: "0 lost" of a view that had lost its link was
// meaningless.
TEST_F(Recordings, a_view_keeps_its_counts_when_the_link_fails) {
  write_scene(R"("seed":1)");
  pid_t server = 0;
  const std::string link = serve(server);
  const pid_t child = start("view strip.json --link " + link + " --no-open --port 0 --json", "log");
  ::sleep(2);  // Two seconds of samples are enough.
  ::kill(server, SIGKILL);
  (void)end_of(server);
  ::sleep(1);  // The program reports that and tries again.
  ::kill(child, SIGINT);
  (void)end_of(child);
  const std::string log = read_file(folder_ / "log");
  EXPECT_GT(nlohmann::json::parse(log.substr(log.find('{')))["frames"], 20) << log;
}

TEST_F(Recordings, a_replay_shows_what_live_showed) {
  ASSERT_EQ(run("record strip.json --link " + serve_touched() + " --seconds 1 -o r.mcap").status, 0);
  const Outcome o = run("replay r.mcap --speed 0 --json");
  EXPECT_EQ(o.status, 0);
  const std::string last = o.out.substr(o.out.rfind('\n', o.out.size() - 2) + 1);
  const auto result = nlohmann::json::parse(last);
  ASSERT_EQ(result["pressed"].size(), 1U) << last;
  EXPECT_EQ(result["pressed"][0]["module"], 4);
  EXPECT_EQ(result["pressed"][0]["taxel"], 3);
  EXPECT_EQ(result["samples"], recovered("r.mcap")["samples"]);
  EXPECT_GT(std::ranges::count(o.out, '\n'), 3);
}

TEST_F(Recordings, a_recording_is_played_into_a_link_that_live_reads) {
  ASSERT_EQ(run("record strip.json --link " + serve_touched() + " --seconds 2 -o r.mcap").status, 0);
  end_touched();
  const pid_t server = start("replay r.mcap --listen 127.0.0.1:0 --loop", "played");
  wait_for_text("played", "end with Ctrl-C");
  const std::string text = read_file(folder_ / "played");
  const auto at = text.find("sim:127.0.0.1:");
  const Outcome o =
      run("live strip.json --link " + text.substr(at, text.find_first_of(" ,;", at) - at) + " --seconds 3 --json");
  ::kill(server, SIGTERM);
  EXPECT_EQ(end_of(server), 143);
  EXPECT_EQ(o.status, 0) << o.messages;
  const auto last = nlohmann::json::parse(o.out.substr(o.out.rfind('\n', o.out.size() - 2) + 1));
  ASSERT_EQ(last["pressed"].size(), 1U) << last.dump();
  EXPECT_EQ(last["pressed"][0]["module"], 4);
  EXPECT_EQ(last["pressed"][0]["taxel"], 3);
}

TEST_F(Recordings, live_shows_contacts_that_are_there_at_the_start_and_adds_no_finger_to_a_served_scene) {
  const Outcome o = run("live strip.json --link " + serve_touched() + " --seconds 3 --json");
  EXPECT_EQ(o.status, 0) << o.messages;
  std::size_t lines = 0, touched = 0;
  std::istringstream text(o.out);
  for (std::string each; std::getline(text, each); ++lines) {
    const auto object = nlohmann::json::parse(each);
    for (const auto& t : object["pressed"]) {
      EXPECT_EQ(t["module"], 4) << each;
      EXPECT_EQ(t["taxel"], 3) << each;
      ++touched;
    }
  }
  EXPECT_GT(lines, 5U);
  EXPECT_GT(touched, 5U);
}

TEST_F(Recordings, a_tare_makes_the_present_rest_and_is_kept) {
  const std::string link = serve_touched();
  const auto pressed = [&](const std::string& options) {
    const Outcome o = run("live strip.json --link " + link + " --seconds 0.5 --json " + options);
    return nlohmann::json::parse(o.out.substr(o.out.rfind('\n', o.out.size() - 2) + 1))["pressed"].size();
  };
  EXPECT_EQ(pressed(""), 1U);
  const auto recorded = [&] {
    EXPECT_EQ(run("record strip.json --link " + link + " --seconds 1 -o r.mcap").status, 0);
    const Outcome o = run("replay r.mcap --speed 0 --json");
    return nlohmann::json::parse(o.out.substr(o.out.rfind('\n', o.out.size() - 2) + 1))["pressed"].size();
  };
  EXPECT_EQ(recorded(), 1U);
  EXPECT_EQ(pressed("--tare"), 0U);
  EXPECT_EQ(pressed(""), 0U);
  EXPECT_EQ(recorded(), 0U) << "record and replay do not begin with the rest values that were kept";
  fs::remove_all(folder_ / "state" / "triskin" / "rest");
  const Outcome replay = run("replay r.mcap --speed 0 --json");
  EXPECT_THAT(replay.out, testing::Not(HasSubstr("\"taxel\""))) << "they are not in the recording";
}

TEST_F(Recordings, live_draws_the_patch_on_a_terminal_and_takes_keys) {
  winsize size{40, 120, 0, 0};
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::string command = line("live strip.json --link sim --press 4 --taxel 3 --seconds 1e6");
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    std::_Exit(127);
  }
  std::string seen;
  const auto read_until = [&](const std::string& text) {
    std::array<char, 4096> piece{};
    while (seen.find(text) == std::string::npos) {
      const ssize_t n = ::read(terminal, piece.data(), piece.size());
      if (n <= 0) return false;
      seen.append(piece.data(), static_cast<std::size_t>(n));
    }
    return true;
  };
  EXPECT_TRUE(read_until("> patch   0"));
  EXPECT_TRUE(read_until("module    4 taxel  3"));
  EXPECT_THAT(seen, AllOf(HasSubstr("▲"), HasSubstr("▼"), Not(HasSubstr("\033[2J"))));
  EXPECT_EQ(::write(terminal, "n", 1), 1);
  EXPECT_TRUE(read_until("> patch   1"));
  EXPECT_EQ(::write(terminal, "u", 1), 1);
  EXPECT_TRUE(read_until("unit (% of range)"));
  EXPECT_EQ(::write(terminal, "q", 1), 1);
  EXPECT_TRUE(read_until(" samples of "));
  EXPECT_EQ(end_of(child), 0);
  ::close(terminal);
}

// Collects the leaves of the tree of panels.
void add_panels(const nlohmann::json& tree, std::vector<std::string>& panels) {
  if (tree.is_string()) return panels.push_back(tree.get<std::string>());
  ASSERT_THAT(tree.at("direction"), testing::AnyOf("row", "column"));
  for (const char* half : {"first", "second"}) add_panels(tree.at(half), panels);
}

// Foxglove exports panels under keys "TYPE!ID", and the layout's tree names each of them once.
TEST_F(Recordings, the_layout_for_Foxglove_shows_topics_that_a_recording_has) {
  const auto layout =
      nlohmann::json::parse(read_file(fs::path(source_folder()) / "docs/examples/foxglove_layout.json"));
  for (const char* key : {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"})
    EXPECT_TRUE(layout.contains(key)) << key;
  std::vector<std::string> panels;
  add_panels(layout["layout"], panels);
  EXPECT_EQ(panels.size(), layout["configById"].size());
  for (const std::string& panel : panels) {
    EXPECT_TRUE(layout["configById"].contains(panel)) << panel;
    EXPECT_THAT(panel.substr(0, panel.find('!')), testing::AnyOf("3D", "Plot", "RawMessages"));
  }
  write_scene(R"("contacts":[{"module":3,"taxel":3}])");
  ASSERT_EQ(run("record strip.json --link sim --scene scene.json -o r.mcap --seconds 2").status, 0);
  const std::string recording = read_file(folder_ / "r.mcap"), text = layout.dump();
  int topics = 0;
  for (std::size_t at = text.find("/skin/"); at != std::string::npos; at = text.find("/skin/", at + 1)) {
    const std::string topic = text.substr(at, text.find_first_of(".\"", at) - at);
    EXPECT_THAT(recording, HasSubstr(topic));
    ++topics;
  }
  EXPECT_EQ(topics, 4);
}

// Two covers on two buses go into one file, and no other file may remain beside it.
TEST_F(Recordings, a_robot_goes_into_one_file) {
  for (const char* words : {"robot new robot.json --name demo --bus a=sim --bus b=sim",
                            "robot add robot.json strip.json --name arm --bus a",
                            "robot add robot.json strip.json --name leg --bus b --xyz-mm 0,60,20", "flash robot.json"})
    ASSERT_EQ(run(words).status, 0) << words << run(words).messages;
  const Outcome o = run("record robot.json -o all.mcap --seconds 1 --json");
  EXPECT_EQ(o.status, 0) << o.messages;
  const std::string recording = read_file(folder_ / "all.mcap");
  for (const char* text : {"/skin/arm/raw", "/skin/leg/points", "/tf_static", "arm/design.json", "leg/design.json"})
    EXPECT_THAT(recording, HasSubstr(text));
  EXPECT_FALSE(fs::exists(folder_ / "all.mcap.covers"));
  EXPECT_THAT(run("replay all.mcap --speed 0").messages, HasSubstr("holds several covers"));
}

}  // namespace
}  // namespace triskin::test
