// SPDX-License-Identifier: GPL-3.0-or-later
// Two programs write one file, or the disk is full or broken: the old or the new file must remain, never neither.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <map>

#include "guarantees/faulty_program.hpp"
#include "support/child_process.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/writer_lock.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Writers : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    design::write_design(folder_ / "strip.json", strip(2, 2));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  // Runs a command whose change number `at` of a file fails, as do all later ones.
  [[nodiscard]] int run_failing(const std::string& arguments, int at, int cause) const {
    const std::string variables = fmt::format("TRISKIN_TEST_FAIL_AT={} TRISKIN_TEST_FAIL_ERRNO={}", at, cause);
    const std::string command = fmt::format("cd '{}' && {} {} {} >out 2>messages", folder_.string(),
                                            with_faults(variables), program_file(), arguments);
    return WEXITSTATUS(std::system(command.c_str()));
  }
  [[nodiscard]] std::string kept(const char* name) const {
    return std::filesystem::exists(folder_ / name) ? read_file(folder_ / name) : "";
  }
};

TEST_F(Writers, a_second_recorder_is_told_who_writes_the_file) {
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  const ServedSimulation served(path("strip.json"));
  Running first(line("record strip.json --seconds 60 --link " + served.link() + " -o r.mcap"), folder_ / "log");
  ASSERT_TRUE(wait_until([&] { return kept("r.mcap").size() > 100; })) << first.text();
  const Outcome second = run("record strip.json --link sim --seconds 0.1 -o r.mcap");
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.messages, AllOf(HasSubstr("r.mcap"), HasSubstr(fmt::format("process {}", first.pid())),
                                     HasSubstr("is writing it")));
  EXPECT_EQ(run("recover r.mcap").status, 2) << "recover would cut a file that still grows";
  first.signal(SIGINT);
  EXPECT_TRUE(first.ends());
  recording::Summary summary = recording::read_recording(folder_ / "r.mcap", [](const recording::ModuleSample&) {});
  EXPECT_TRUE(summary.file.complete) << summary.file.problem;
  const Outcome again = run("record strip.json --seconds 0.5 -o r.mcap --link " + served.link());
  EXPECT_EQ(again.status, 0) << "the lock ends with the program: " << again.messages;
}

// ulimit -f counts in units of 512 bytes. The signal that the kernel sends would end the program without a word.
TEST_F(Writers, a_recording_beyond_the_limit_of_file_sizes_ends_with_a_sentence_and_keeps_its_whole_chunks) {
  const std::string command =
      fmt::format("cd '{}' && ulimit -f 60 && {} record strip.json --link sim --seconds 20 -o r.mcap >out 2>messages",
                  folder_.string(), program_file());
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_THAT(kept("messages"),
              AllOf(HasSubstr("r.mcap: cannot write (File too large)"), HasSubstr("which are there")));
  EXPECT_LE(kept("r.mcap").size(), 60U * 512);
  const recording::Summary whole = recording::read_recording(folder_ / "r.mcap", {});
  EXPECT_GT(whole.samples, 50U);
  EXPECT_EQ(run("recover r.mcap").status, 0);
  EXPECT_EQ(recording::read_recording(folder_ / "r.mcap", {}).samples, whole.samples);
}

TEST_F(Writers, a_second_simulation_of_a_board_is_told_who_holds_it) {
  Running first(line("simulate strip.json --listen 127.0.0.1:0"), folder_ / "log");
  ASSERT_TRUE(first.says("127.0.0.1:"));
  const Outcome second = run("verify strip.json --link sim");
  EXPECT_EQ(second.status, 3);
  EXPECT_THAT(second.messages, HasSubstr(fmt::format("process {}", first.pid())));
}

TEST_F(Writers, a_robot_file_is_changed_by_one_program_at_a_time) {
  ASSERT_EQ(run("robot new r.json --name r --bus left=sim").status, 0);
  const std::string before = kept("r.json");
  {
    const WriterLock lock(folder_ / "r.json");
    const Outcome o = run("robot add r.json strip.json --name strip --bus left");
    EXPECT_EQ(o.status, 2);
    EXPECT_THAT(o.messages, HasSubstr(fmt::format("process {}", ::getpid())));
    EXPECT_EQ(kept("r.json"), before);
  }
  EXPECT_EQ(run("robot add r.json strip.json --name strip --bus left").status, 0);
}

// These commands replace a file whole.
TEST_F(Writers, a_full_or_broken_disk_leaves_the_old_file_or_the_new_one) {
  ASSERT_EQ(run("robot new r.json --name r --bus left=sim").status, 0);
  const std::map<std::string, std::string> commands{
      {"picture.svg", "export strip.json -o picture.svg"},
      {"sheet.gltf", "export strip.json -o sheet.gltf"},
      {"backup.json", "flash strip.json --link sim --save backup.json"},
      {"r.json", "robot add r.json strip.json --name strip --bus left --replace"}};
  ASSERT_EQ(run("robot add r.json strip.json --name strip --bus left").status, 0);
  for (const auto& [file, command] : commands) {
    for (const int cause : {ENOSPC, EIO}) {
      int failed = 0;
      for (int at = 1;; ++at) {
        ASSERT_LT(at, 400) << command;
        const std::string old = file == "r.json" ? kept("r.json") : "the old one";
        if (file != "r.json") std::ofstream(folder_ / file) << old;
        const int status = run_failing(command, at, cause);
        const std::string now = kept(file.c_str());
        if (status == 0) {
          EXPECT_GT(now.size(), 100U) << command;
          break;
        }
        EXPECT_EQ(now, old) << command << ": change " << at << " failed, " << kept("messages");
        EXPECT_THAT(kept("messages"), testing::Not(testing::IsEmpty())) << command << ": change " << at;
        ++failed;
      }
      EXPECT_GT(failed, 0) << command;
    }
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".triskin-")) << "left behind: " << entry.path();
}

// The state of the boards is written too, and is the same before each run.
TEST_F(Writers, a_recording_that_replaces_another_is_the_old_one_or_begins_to_be_the_new_one) {
  ASSERT_EQ(run("record strip.json --link sim --seconds 1 -o old.mcap").status, 0);
  for (const int cause : {ENOSPC, EIO}) {
    int old_ones = 0, new_ones = 0;
    for (int at = 1;; ++at) {
      ASSERT_LT(at, 400);
      std::filesystem::copy_file(folder_ / "old.mcap", folder_ / "r.mcap",
                                 std::filesystem::copy_options::overwrite_existing);
      const int status = run_failing("record strip.json --link sim --seconds 3 -o r.mcap", at, cause);
      if (status == 0) break;
      if (kept("r.mcap") == kept("old.mcap")) {
        ++old_ones;
        continue;
      }
      ++new_ones;
      EXPECT_THAT(kept("r.mcap"), testing::StartsWith("\x89MCAP0\r\n")) << at;
      EXPECT_THAT(kept("messages"), HasSubstr("r.mcap")) << at;
    }
    EXPECT_GT(old_ones, 0);
    EXPECT_GT(new_ones, 0);
  }
}

// A disk of 5.5 MB: the recording ends with 4 MB left, so its last chunk and its summary fit, and the disk never is
// full. 40 modules at 54 samples a second fill 1.5 MB long before the hour is over.
TEST_F(Writers, a_recording_ends_whole_before_the_disk_is_full) {
  design::write_design(folder_ / "long.json", strip(40));
  ASSERT_EQ(run("flash long.json --link sim").status, 0);
  const std::string record = "record long.json --link sim --seconds 3600 -o r.mcap";
  const std::string line = "cd '" + folder_.string() + "' && " + with_faults("TRISKIN_TEST_DISK_BYTES=5500000") + "'" +
                           program_file() + "' " + record + " > messages 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 2);
  EXPECT_THAT(kept("messages"), HasSubstr("r.mcap: the disk has only "));
  EXPECT_LT(std::filesystem::file_size(folder_ / "r.mcap"), 5'500'000U);
  EXPECT_GT(std::filesystem::file_size(folder_ / "r.mcap"), 1'400'000U);
  const Outcome played = run("replay r.mcap --speed 0 --json");
  EXPECT_EQ(played.status, 0) << played.messages;
  EXPECT_THAT(played.out, HasSubstr("\"complete\":true"));
}

}  // namespace
}  // namespace triskin::test
