// SPDX-License-Identifier: GPL-3.0-or-later
// Tests --help, and the messages about a command line that cannot be read.
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>
#include <sstream>
#include <vector>

#include "app/cli/shell_case.hpp"
#include "support/places.hpp"

namespace triskin::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Help : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    ::unsetenv("COLUMNS");
  }
  void TearDown() override {
    ::unsetenv("COLUMNS");
    ShellCase::TearDown();
  }
};

std::size_t columns(const std::string& line) {
  return static_cast<std::size_t>(std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> commands_of(const std::string& help) {
  static const std::regex row(R"(^  ([a-z][a-z-]*) {2,})");
  std::vector<std::string> names;
  std::smatch m;
  for (const std::string& line : lines_of(help))
    if (std::regex_search(line, m, row)) names.push_back(m[1]);
  return names;
}

TEST_F(Help, commands_stand_in_groups) {
  const std::string text = run("--help").out;
  const auto design = text.find("\nDesign:"), hardware = text.find("\nHardware:"), data = text.find("\nData:"),
             development = text.find("\nSimulation and proofs:");
  ASSERT_NE(development, std::string::npos) << text;
  EXPECT_LT(design, hardware);
  EXPECT_LT(hardware, data);
  EXPECT_LT(data, development);
  EXPECT_GT(text.find("\n  flash "), hardware);
  EXPECT_LT(text.find("\n  flash "), data);
  EXPECT_GT(text.find("\n  record "), data);
}

TEST_F(Help, every_page_fits_the_terminal_without_a_broken_word) {
  std::vector<std::string> pages{"--help", "help links"};
  for (const std::string& command : commands_of(run("--help").out)) pages.push_back(command + " --help");
  ASSERT_GT(pages.size(), program_has_solvers() ? 30U : 20U);
  for (const std::size_t width : {60U, 80U, 120U}) {
    ::setenv("COLUMNS", std::to_string(width).c_str(), 1);
    for (const std::string& page : pages) {
      if (page == "help links" && width < 80) continue;  // This table has one width.
      const Outcome o = run(page);
      EXPECT_EQ(o.status, 0) << page;
      for (const std::string& line : lines_of(o.out)) {
        // Only a single word may be longer than a narrow terminal; 80 columns hold every word.
        const bool one_word = line.find_first_of(' ', line.find_first_not_of(' ')) == std::string::npos;
        EXPECT_TRUE(columns(line) <= width || (width < 80 && one_word)) << page << " at " << width << ": " << line;
      }
    }
  }
}

// No word is lost or cut when the lines become shorter.
TEST_F(Help, the_words_are_the_same_at_every_width) {
  const auto words = [](std::string text) {
    std::vector<std::string> list;
    std::istringstream stream(text);
    for (std::string word; stream >> word;)
      if (word != "\\") list.push_back(word);
    return list;
  };
  ::setenv("COLUMNS", "120", 1);
  const auto wide = words(run("record --help").out);
  ::setenv("COLUMNS", "50", 1);
  EXPECT_EQ(words(run("record --help").out), wide);
}

TEST_F(Help, help_is_a_command_and_has_a_topic_for_links) {
  EXPECT_EQ(run("help").out, run("--help").out);
  EXPECT_EQ(run("help flash").out, run("flash --help").out);
  EXPECT_THAT(run("help links").out, AllOf(HasSubstr("can:IFACE"), HasSubstr("TRISKIN_LINK")));
  const Outcome o = run("help flsh");
  EXPECT_EQ(o.status, 2);
  EXPECT_THAT(o.messages, HasSubstr("did you mean flash?"));
  EXPECT_EQ(run("-V").out, run("--version").out);
}

TEST_F(Help, a_slip_is_answered_in_the_first_line) {
  EXPECT_THAT(lines_of(run("recrod").messages).at(0), HasSubstr("did you mean record?"));
  const Outcome help = run("recrod --help");
  EXPECT_EQ(help.status, 2);
  EXPECT_THAT(lines_of(help.messages).at(0), HasSubstr("did you mean record?"));
  EXPECT_THAT(lines_of(run("record s.json -o r.csv --secnods 1").messages).at(0), HasSubstr("did you mean --seconds?"));
  EXPECT_THAT(run("").messages, StartsWith("triskin: no command is given"));
  EXPECT_THAT(run("verify s.json -link sim").messages,
              StartsWith("triskin: -link is not known here; did you mean --link?\n"));
  EXPECT_THAT(run("view s.json --every 3").messages,
              StartsWith("triskin: --every is not known here; it is an option of "));
  EXPECT_THAT(run("view s.json --nonsense 3").messages, StartsWith("triskin: --nonsense is not known here\n"));
  EXPECT_THAT(run("discover --link simm").messages, HasSubstr("did you mean sim?"));
  EXPECT_THAT(run("discover --link can7").messages, HasSubstr("did you mean can:can7?"));
  EXPECT_THAT(run("live s.json --link sim --seconds 1m").messages,
              HasSubstr("--seconds: 1m is not a number (seconds)\n"));
  write_file_atomically(folder_ / "strip.json", "no json");
  EXPECT_THAT(run("verify stirp.json --link sim").messages, HasSubstr("did you mean strip.json?"));
  EXPECT_THAT(run("verify strip.json --link sim").messages, HasSubstr("is no design file (JSON)"));
}

// Names of types, sets of values and sentences of the library that reads the command line are no words of ours.
TEST_F(Help, no_word_of_the_parser_is_said) {
  ::setenv("COLUMNS", "120", 1);
  for (const std::string& command : commands_of(run("--help").out)) {
    const std::string text = run(command + " --help").out;
    static const std::regex raw(R"(\{(true|false)\}|TEXT:|FLOAT|UINT|:\w+ in \[)");
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, raw)) << command << ": " << found.str() << "\n" << text;
  }
  ::unsetenv("COLUMNS");
  const auto first_line = [&](const char* arguments) { return lines_of(run(arguments).messages).at(0); };
  EXPECT_EQ(first_line("verify --link sim"), "triskin: DESIGN is missing");
  EXPECT_EQ(first_line("--nonsense"), "triskin: --nonsense is not known here");
  EXPECT_EQ(first_line("robot add r.json s.json --xyz-mm 1,2"), "triskin: --xyz-mm: 3 values are needed, 2 given");
  EXPECT_EQ(first_line("identify s.json --link sim --by-hand --finger"),
            "triskin: --by-hand and --finger cannot stand together");
}

TEST_F(Help, a_range_is_said_in_short_numbers_with_its_unit) {
  const Outcome o = run("bring-up s.json --link sim --seconds 5000");
  EXPECT_EQ(o.status, 2);
  EXPECT_THAT(o.messages, StartsWith("triskin: --seconds: 5000 is not between 0.2 and 3600 seconds\n"));
  EXPECT_THAT(run("live s.json --link sim --taxel 12").messages, HasSubstr("--taxel: 12 is not between 0 and 11\n"));
  EXPECT_THAT(run("live s.json --link sim --taxel x").messages, Not(HasSubstr("Could not convert")));
  ::setenv("COLUMNS", "160", 1);  // At 80 columns the range is wrapped.
  EXPECT_THAT(run("bring-up --help").out, HasSubstr("(0.2 to 3600)"));
  ::unsetenv("COLUMNS");
}

}  // namespace
}  // namespace triskin::test
