// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the checks of pages: their length, and whether their commands give what the page says.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "support/places.hpp"
#include "tools/scratch_tree.hpp"

namespace triskin::tests {
namespace {

std::string words(int count) {
  std::string text;
  for (int k = 0; k < count; ++k) text += "word ";
  return text + "\n";
}

class PageLength : public ScratchTree {
 protected:
  Ran with_page(const std::string& name, const std::string& text) {
    write("README.md", "Short.\n");
    write("docs/" + name, text);
    return tool("check_pages", "");
  }
};

TEST_F(PageLength, accepts_1200_words_and_names_a_page_with_more) {
  EXPECT_EQ(with_page("page.md", words(1200)).exit_status, 0);
  const Ran ran = with_page("page.md", words(1201));
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("docs/page.md: 1201 words"), std::string::npos) << ran.output;
}

TEST_F(PageLength, leaves_generated_tables_and_code_out) {
  const std::string generated = "<!-- options:live -->\n" + words(900) + "<!-- /options:live -->\n";
  const std::string code = "```\n" + words(900) + "```\n";
  EXPECT_EQ(with_page("page.md", words(1000) + generated + code).exit_status, 0);
}

TEST_F(PageLength, lets_references_and_measurements_be_long) {
  EXPECT_EQ(with_page("protocol.md", words(5000)).exit_status, 0);
  write("docs/measurements/lattice.md", words(5000));
  EXPECT_EQ(with_page("page.md", "Short.\n").exit_status, 0);
}

class PageCommands : public ScratchTree {
 protected:
  // check_readme takes the page and the folder of the program, which is a script here.
  Ran with_page(const std::string& text) {
    write("page.md", text);
    write("bin/triskin", "#!/bin/sh\necho \"module 3: 17 counts\"\nexit ${1:-0}\n");
    std::filesystem::permissions(root_ / "bin/triskin", std::filesystem::perms::owner_all);
    return run("python3 " + test::source_folder() + "/tools/check_readme " + (root_ / "page.md").string() + " " +
               (root_ / "bin").string());
  }
};

TEST_F(PageCommands, accepts_what_the_program_says) {
  const Ran ran = with_page("```console\n$ triskin\nmodule 3: … counts\n```\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
  EXPECT_NE(ran.output.find("1 of 1 commands"), std::string::npos) << ran.output;
}

TEST_F(PageCommands, refuses_another_output_and_an_unexpected_status) {
  EXPECT_EQ(with_page("```console\n$ triskin\nmodule 4: … counts\n```\n").exit_status, 1);
  EXPECT_EQ(with_page("```console\n$ triskin 1\n```\n").exit_status, 1);
  EXPECT_EQ(with_page("```console\n$ triskin 3\nmodule 3: … counts\n```\n").exit_status, 1);
}

TEST_F(PageCommands, refuses_a_page_without_commands) {
  EXPECT_EQ(with_page("Text.\n").exit_status, 1);
}

TEST_F(PageCommands, writes_a_named_block_to_its_file) {
  const Ran ran =
      with_page("```python\n# join.py\nprint('joined')\n```\n\n```console\n$ python3 join.py\njoined\n```\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
}

TEST_F(PageCommands, counts_what_is_left_out_without_the_python_module) {
  const Ran ran = with_page("```console\n$ triskin\n```\n\n```console needs-python-module\n$ python3 read.py\n```\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
  EXPECT_NE(ran.output.find("1 left out without the Python module"), std::string::npos) << ran.output;
}

}  // namespace
}  // namespace triskin::tests
