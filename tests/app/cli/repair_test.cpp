// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the bench as a person meets it: repair, dump, and the two hours of docs/examples.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "app/cli/shell_case.hpp"
#include "support/page_block.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Bench : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(8, 8));
  }
  void write_scene(const std::string& faults) const {
    write_file_atomically(folder_ / "scene.json",
                          R"({"format":"triskin-scene","version":1,"design":"strip.json","faults":[)" + faults + "]}");
  }
};

constexpr const char* kRemoved3 = R"({"kind":"removed_chip","module":3})";
constexpr const char* kScene = " --link sim --scene scene.json";

TEST_F(Bench, repair_has_nothing_to_do_on_a_healthy_skin) {
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  const Outcome o = run("repair strip.json --link sim --json </dev/null");
  EXPECT_EQ(o.status, 0) << o.messages;
  const json result = json::parse(o.out);
  EXPECT_EQ(result["findings_before"], 0);
  EXPECT_EQ(result["tared"], false);
  EXPECT_TRUE(result["simulated"]);
}

TEST_F(Bench, repair_says_when_a_finding_is_still_there_and_can_skip_it) {
  write_scene(kRemoved3);
  ASSERT_EQ(run(std::string("flash strip.json") + kScene).status, 0);
  write_file_atomically(folder_ / "answers", "\ns\n");
  const Outcome o = run(std::string("repair strip.json") + kScene + " <answers");
  EXPECT_EQ(o.status, 1);
  EXPECT_THAT(o.out, AllOf(HasSubstr("finding 1 of 1:"), HasSubstr("still there"),
                           HasSubstr("0 mended, 1 skipped; 1 finding left"), Not(HasSubstr("tared"))));
}

// Fresh boards are flashed, the chip is back when the link is opened anew, and the tare is last.
TEST_F(Bench, repair_flashes_checks_again_and_tares) {
  write_file_atomically(folder_ / "answers", "\n\n");
  const Outcome o = run("repair strip.json --link sim <answers");
  EXPECT_EQ(o.status, 0) << o.out << o.messages;
  EXPECT_THAT(o.out, AllOf(HasSubstr("not_flashed"), HasSubstr("The tables are written next."), HasSubstr("mended"),
                           HasSubstr("tared"), HasSubstr("1 mended, 0 skipped; 0 findings left")));
  EXPECT_EQ(run("verify strip.json --link sim").status, 0);
}

TEST_F(Bench, the_terminal_and_the_report_have_the_same_steps) {
  write_scene(std::string(kRemoved3) + R"(,{"kind":"swapped_chips","module":1,"other":6})");
  ASSERT_EQ(run(std::string("flash strip.json") + kScene).status, 0);
  const Outcome o = run(std::string("verify strip.json --report r.txt") + kScene);
  EXPECT_EQ(o.status, 1);
  std::istringstream report(read_file(folder_ / "r.txt"));
  int steps = 0;
  for (std::string step; std::getline(report, step);) {
    if (!std::regex_search(step, std::regex("^ +[0-9]+\\. "))) continue;
    EXPECT_THAT(o.out, HasSubstr(step));
    ++steps;
  }
  EXPECT_GT(steps, 15);
}

TEST_F(Bench, dump_prints_what_controllers_say_of_themselves) {
  const Outcome o = run("dump strip.json --link sim --ask --frames 3");
  EXPECT_EQ(o.status, 1) << o.messages;
  EXPECT_THAT(o.out, AllOf(HasSubstr("Simulated"), HasSubstr("18E0FFF1   [0]"), HasSubstr("who is there?"),
                           HasSubstr("claim: unique id"), HasSubstr("node address 1, no table"), HasSubstr("3 frames"),
                           HasSubstr("has no table, so nothing of the skin comes; run triskin flash first")));
  std::istringstream lines(run("dump strip.json --link sim --ask --frames 3 --json").out);
  std::string first;
  ASSERT_TRUE(std::getline(lines, first));
  EXPECT_EQ(json::parse(first)["meaning"], "who is there?");
}

TEST_F(Bench, a_slip_is_asked_about_in_the_first_line) {
  const std::string messages = run("dumpp --link sim").messages;
  EXPECT_THAT(messages.substr(0, messages.find('\n')), HasSubstr("did you mean dump?"));
}

class Hours : public ShellCase {
 protected:
  void expect_page(const std::string& script) const {
    if (!program_has_solvers()) GTEST_SKIP() << "built without the solvers";
    const std::string command = "cd '" + folder_.string() + "' && TRISKIN='" + program_file() + "' '" +
                                source_folder() + "/docs/examples/" + script + "' hour >out 2>messages";
    fs::create_directories(folder_ / "hour");
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0) << read_file(folder_ / "messages");
    const std::string out = read_file(folder_ / "out");
    const auto wanted = page_block("examples.md", script + "`");
    ASSERT_GT(wanted.size(), 5U);
    EXPECT_EQ(missing_line(wanted, out), "") << out;
  }
};

TEST_F(Hours, from_mesh_to_sheet) {
  expect_page("from_mesh_to_sheet.sh");
}

TEST_F(Hours, from_bare_boards_to_a_calibrated_patch_with_four_mistakes) {
  expect_page("from_bare_boards.sh");
}

}  // namespace
}  // namespace triskin::test
