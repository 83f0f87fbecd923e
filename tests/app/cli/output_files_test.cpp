// SPDX-License-Identifier: GPL-3.0-or-later
// Files that commands write must keep what coreutils would keep: modes, links, names (docs/measurements/robustness.md).
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "app/cli/shell_case.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(4, 4));
  }
  [[nodiscard]] unsigned mode_of(const std::string& name) const {
    struct stat found{};
    return ::stat((folder_ / name).c_str(), &found) == 0 ? found.st_mode & 0777 : 0;
  }
  [[nodiscard]] Outcome export_to(const std::string& name) const {
    return run("export strip.json --format taxels -o '" + name + "'");
  }
};

TEST_F(OutputFiles, a_new_file_follows_the_umask) {
  const ::mode_t before = ::umask(0027);
  const Outcome made = export_to("new.csv");
  ::umask(before);
  EXPECT_EQ(made.status, 0) << made.messages;
  EXPECT_EQ(mode_of("new.csv"), 0640U);
}

TEST_F(OutputFiles, an_existing_file_keeps_its_mode) {
  std::ofstream(folder_ / "old.csv") << "old";
  fs::permissions(folder_ / "old.csv", fs::perms(0604));
  EXPECT_EQ(export_to("old.csv").status, 0);
  EXPECT_EQ(mode_of("old.csv"), 0604U);
  EXPECT_GT(read_file(folder_ / "old.csv").size(), 100U);
}

TEST_F(OutputFiles, a_link_to_nothing_makes_its_target) {
  fs::create_symlink("target.csv", folder_ / "dangling.csv");
  EXPECT_EQ(export_to("dangling.csv").status, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "dangling.csv"));
  EXPECT_GT(read_file(folder_ / "target.csv").size(), 100U);
}

// A temporary name beside the target must not be longer than file systems allow.
TEST_F(OutputFiles, the_longest_name_is_written) {
  const std::string name = std::string(251, 'n') + ".csv";
  const Outcome made = export_to(name);
  EXPECT_EQ(made.status, 0) << made.messages;
  EXPECT_TRUE(fs::exists(folder_ / name));
}

TEST_F(OutputFiles, no_temporary_file_stays) {
  EXPECT_EQ(export_to("t.csv").status, 0);
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "t.csv" || name == "strip.json" || name == "out" || name == "messages" || name == "state")
        << name;
  }
}

TEST_F(OutputFiles, neither_home_nor_a_folder_for_temporary_files_is_needed) {
  const std::string command = "cd '" + folder_.string() + "' && exec env -i TMPDIR=/nonexistent " + program_file() +
                              " export strip.json --format taxels -o t.csv >out 2>messages";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0) << read_file(folder_ / "messages");
  EXPECT_GT(read_file(folder_ / "t.csv").size(), 100U);
}

class MeshStreams : public OutputFiles {
 protected:
  void SetUp() override {
    OutputFiles::SetUp();
    if (!program_has_solvers()) GTEST_SKIP() << "built without the solvers";
    ASSERT_EQ(run("generate forearm --size-mm 150 --faces 600 -o part.obj").status, 0)
        << read_file(folder_ / "messages");
    ASSERT_EQ(run("extract part.obj -o file.obj").status, 0) << read_file(folder_ / "messages");
  }
  [[nodiscard]] int shell(const std::string& before, const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && " + before + " " + program_file() + " " + arguments + " >out 2>messages";
    return WEXITSTATUS(std::system(command.c_str()));
  }
};

// A pipe can be read once and has no length, so all readers work from memory.
TEST_F(MeshStreams, a_mesh_may_come_through_a_pipe) {
  EXPECT_EQ(shell("cat part.obj |", "extract - -o dash.obj"), 0) << read_file(folder_ / "messages");
  EXPECT_EQ(shell("cat part.obj |", "extract /dev/stdin -o stdin.obj"), 0) << read_file(folder_ / "messages");
  EXPECT_EQ(shell("exec 3<part.obj;", "extract /dev/fd/3 -o fd.obj"), 0) << read_file(folder_ / "messages");
  for (const char* made : {"dash.obj", "stdin.obj", "fd.obj"})
    EXPECT_EQ(read_file(folder_ / made), read_file(folder_ / "file.obj")) << made;
}

// A command must report an unusable output before a long search, not after it.
TEST_F(MeshStreams, the_place_of_the_result_is_tried_before_the_work) {
  const Outcome o = run("design part.obj -o /nonexistent/d.json --time-limit-s 600");
  EXPECT_EQ(o.status, 2);
  EXPECT_NE(o.messages.find("/nonexistent"), std::string::npos) << o.messages;
  EXPECT_EQ(o.messages.find("controllers"), std::string::npos) << o.messages;
}

}  // namespace
}  // namespace triskin::test
