// SPDX-License-Identifier: GPL-3.0-or-later
// These tests run the program on narrow and low terminals, without a size, with TERM=dumb or none, with NO_COLOR, and
// with closed or full standard descriptors. A small emulator reports what a person would see.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/cli/shell_case.hpp"
#include "app/cli/terminal_screen.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/design/design.hpp"

namespace triskin::test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kOtherPage = "\033[?1049h";
constexpr const char* kFirstPage = "\033[?1049l";

class Terminals : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", strip(24, 6));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  [[nodiscard]] std::string with(const std::string& variables, const std::string& arguments) const {
    return fmt::format("cd '{}' && exec env {} XDG_STATE_HOME=state {} {}", folder_.string(), variables, program_file(),
                       arguments);
  }
  // Returns what `live` writes during one second of its time.
  [[nodiscard]] std::string live(const std::string& variables, int columns, int rows) const {
    TerminalProgram program(with(variables, "live strip.json --link sim --seconds 1"), columns, rows);
    std::string text = program.read_all();
    EXPECT_EQ(program.status(), 0) << text;
    return text;
  }
};

// Returns the bytes between entering and leaving the alternate screen.
std::string page_of(const std::string& text) {
  const std::size_t begin = text.find(kOtherPage), end = text.rfind(kFirstPage);
  return begin == std::string::npos || end == std::string::npos ? "" : text.substr(begin, end - begin);
}

TEST_F(Terminals, live_stays_within_screens_of_any_size) {
  for (const auto& [columns, rows] :
       std::vector<std::pair<int, int>>{{200, 60}, {80, 24}, {40, 10}, {20, 5}, {10, 3}, {1, 1}, {7, 50}}) {
    const std::string page = page_of(live("TERM=xterm", columns, rows));
    ASSERT_FALSE(page.empty()) << columns;
    Screen screen(static_cast<std::size_t>(columns), static_cast<std::size_t>(rows));
    screen.write(page);
    EXPECT_EQ(screen.wraps(), 0) << columns << " columns";
    EXPECT_EQ(screen.scrolls(), 0) << rows << " rows";
    if (columns < 40) continue;
    EXPECT_THAT(screen.lines().front(), HasSubstr("samples"));
    EXPECT_THAT(screen.lines(), testing::Contains(HasSubstr("q: end")));
  }
}

// Each Chinese letter of the name takes two columns.
TEST_F(Terminals, wide_letters_do_not_break_the_page) {
  const std::string name = "皮膚模塊設計檔案右前臂外殼.json";
  std::filesystem::copy_file(folder_ / "strip.json", folder_ / name);
  for (const int columns : {30, 21, 20, 8}) {
    TerminalProgram program(with("TERM=xterm", fmt::format("live {} --link sim --seconds 1", name)), columns, 12);
    Screen screen(static_cast<std::size_t>(columns), 12);
    screen.write(page_of(program.read_all()));
    EXPECT_EQ(program.status(), 0);
    EXPECT_EQ(screen.wraps() + screen.scrolls(), 0) << columns;
  }
}

TEST_F(Terminals, a_terminal_that_does_not_tell_its_size_has_80_columns_and_24_rows) {
  Screen screen(80, 24);
  screen.write(page_of(live("TERM=vt100", 0, 0)));
  EXPECT_EQ(screen.wraps() + screen.scrolls(), 0);
  EXPECT_THAT(screen.lines().front(), HasSubstr("samples"));
}

TEST_F(Terminals, without_a_known_terminal_there_are_lines_and_no_sequences) {
  for (const char* variables : {"TERM=dumb", "-u TERM", "TERM="}) {
    const std::string text = live(variables, 80, 24);
    EXPECT_THAT(text, Not(HasSubstr("\033"))) << variables;
    EXPECT_THAT(text, HasSubstr("samples"));
  }
}

// NO_COLOR counts if it is set and not empty, whatever its value (https://no-color.org).
TEST_F(Terminals, no_color_is_kept) {
  constexpr const char* kColour = "\033[48;";
  EXPECT_THAT(live("TERM=xterm NO_COLOR=", 80, 24), HasSubstr(kColour));
  EXPECT_THAT(live("-u NO_COLOR TERM=xterm", 80, 24), HasSubstr(kColour));
  EXPECT_THAT(live("TERM=xterm NO_COLOR=1", 80, 24), Not(HasSubstr(kColour)));
  EXPECT_THAT(live("TERM=xterm NO_COLOR=0", 80, 24), Not(HasSubstr(kColour)));
}

TEST_F(Terminals, ctrl_z_gives_the_terminal_back_and_goes_on_where_it_was) {
  TerminalProgram program(with("TERM=xterm", "live strip.json --link sim"), 80, 24);
  (void)program.read_until("q: end");
  program.signal(SIGTSTP);
  ASSERT_TRUE(program.is_stopped());
  EXPECT_THAT(program.read_until(kFirstPage), HasSubstr("\033[?25h"));
  program.signal(SIGCONT);
  program.type('q');
  const std::string text = program.read_all();
  EXPECT_EQ(program.status(), 0);
  const std::size_t back = text.find(kFirstPage);
  EXPECT_NE(text.find(kOtherPage, back), std::string::npos) << "the page did not come back";
  EXPECT_GT(text.rfind(kFirstPage), text.rfind(kOtherPage));
}

TEST_F(Terminals, ctrl_c_and_a_closed_window_leave_no_page_behind) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    TerminalProgram program(with("TERM=xterm", "live strip.json --link sim"), 80, 24);
    (void)program.read_until("q: end");
    program.signal(number);
    const std::string text = program.read_all();
    EXPECT_GT(text.rfind(kFirstPage), text.rfind(kOtherPage)) << number;
  }
}

class Bars : public Terminals {
 protected:
  void SetUp() override {
    Terminals::SetUp();
    if (!program_has_solvers()) GTEST_SKIP() << "built without the solvers";
    ASSERT_EQ(run("generate forearm -o arm.obj --size-mm 170 --faces 200").status, 0);
  }
  [[nodiscard]] std::string design(const std::string& variables, int columns, int rows) const {
    TerminalProgram program(with(variables, "design arm.obj -o arm.json --time-limit-s 3 --threads 1"), columns, rows);
    std::string text = program.read_all();
    EXPECT_EQ(program.status(), 0) << text;
    return text;
  }
};

// Splits a text into its bars, each with everything up to the next one.
std::vector<std::string> bars_of(const std::string& text) {
  std::vector<std::string> bars;
  for (const char* begin : {"[#", "[."}) {
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1))
      bars.push_back(text.substr(at, text.find_first_of("\r\n\033", at) - at));
  }
  return bars;
}
std::size_t letters_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

TEST_F(Bars, stay_in_one_line_and_vanish) {
  for (const int columns : {120, 80, 40, 20}) {
    const std::string text = design("TERM=xterm", columns, 50);
    const std::vector<std::string> bars = bars_of(text);
    ASSERT_FALSE(bars.empty());
    for (const std::string& bar : bars) EXPECT_LT(letters_of(bar), static_cast<std::size_t>(columns)) << bar;
    if (columns > 60) {
      EXPECT_THAT(bars, testing::Contains(testing::ContainsRegex("\\] [0-9]+ s left, "))) << text;
    }
    Screen screen(static_cast<std::size_t>(columns), 50);
    screen.write(text);
    EXPECT_THAT(screen.lines(), Each(Not(HasSubstr("[#")))) << text;
    EXPECT_THAT(screen.lines(), Each(Not(HasSubstr("[.")))) << text;
    EXPECT_THAT(screen.lines(), testing::Contains(HasSubstr("arm: ")));
  }
}

TEST_F(Bars, are_lines_where_the_terminal_cannot_go_back) {
  const std::string text = design("TERM=dumb", 80, 24);
  EXPECT_THAT(text, Not(HasSubstr("\033")));
  EXPECT_THAT(bars_of(text), testing::IsEmpty());
  EXPECT_THAT(text, HasSubstr("… "));
}

TEST_F(Terminals, help_fits_the_width_that_columns_or_the_terminal_say) {
  for (const int columns : {40, 60, 100}) {
    TerminalProgram program(with("-u COLUMNS TERM=xterm", "record --help"), columns, 24);
    Screen screen(static_cast<std::size_t>(columns), 400);
    const std::string text = program.read_all();
    EXPECT_THAT(text, HasSubstr("Usage"));
    screen.write(text);
    EXPECT_EQ(screen.wraps(), 0) << columns;
  }
  for (const char* columns : {"0", "-5", "abc", "99999999999"}) {
    TerminalProgram program(with(fmt::format("TERM=xterm COLUMNS={}", columns), "--help"), 80, 24);
    EXPECT_THAT(program.read_all(), HasSubstr("Usage"));
    EXPECT_EQ(program.status(), 0) << columns;
  }
}

// A file opened while a standard descriptor is closed would get its number and receive the messages.
TEST_F(Terminals, messages_do_not_get_into_files_when_descriptors_are_closed) {
  for (const char* closed : {">&- 2>&- <&-", "2>&-", "<&-", ">/dev/null 2>&-"}) {
    (void)std::system(line(fmt::format("record strip.json --link sim --seconds 1 -o r.mcap {}", closed)).c_str());
    const Outcome o = run("replay r.mcap --speed 0 --json");
    EXPECT_EQ(o.status, 0) << closed << o.messages;
    EXPECT_THAT(o.messages, Not(HasSubstr("recover"))) << closed;
    EXPECT_THAT(read_file(folder_ / "r.mcap"), Not(HasSubstr("Simulated; "))) << closed;
  }
}

TEST_F(Terminals, what_does_not_reach_standard_output_is_status_2) {
  for (const char* arguments :
       {"--version", "--help", "help record", "verify strip.json --link sim", "verify strip.json --link sim --json"}) {
    const Outcome o = run(std::string(arguments) + " >/dev/full");
    EXPECT_EQ(o.status, 2) << arguments;
    EXPECT_THAT(o.messages, HasSubstr("standard output: cannot write")) << arguments;
  }
}

}  // namespace
}  // namespace triskin::test
