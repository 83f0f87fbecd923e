// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the checks of pages: columns, index, and whether their commands give what the page says.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "support/places.hpp"
#include "tools/scratch_tree.hpp"

namespace triskin::tests {
namespace {

class PageForm : public ScratchTree {
 protected:
  void SetUp() override {
    ScratchTree::SetUp();
    write("README.md", "[page](docs/page.md), [measurements](docs/measurements/README.md)\n");
    write("docs/measurements/README.md", "[lattice](lattice.md)\n");
  }
  Ran with_page(const std::string& name, const std::string& text) {
    write("docs/" + name, text);
    return tool("check_pages", "");
  }
};

TEST_F(PageForm, accepts_120_columns_and_names_a_longer_line) {
  const std::string line = "ä " + std::string(118, 'x');  // columns, not bytes
  EXPECT_EQ(with_page("page.md", "# Page\n\n" + line + "\n").exit_status, 0);
  const Ran ran = with_page("page.md", "# Page\n\n" + line + "x\n");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("docs/page.md:3: 121 columns"), std::string::npos) << ran.output;
}

TEST_F(PageForm, lets_tables_code_and_generated_text_be_wide) {
  const std::string wide = "x " + std::string(130, 'x') + "\n";
  const std::string page = "| " + wide + "```\n" + wide + "```\n<!-- figure:a -->\n" + wide + "<!-- /figure:a -->\n";
  EXPECT_EQ(with_page("page.md", page).exit_status, 0);
  EXPECT_EQ(with_page("page.md", page + wide).exit_status, 1);
}

TEST_F(PageForm, names_a_page_that_the_index_lacks) {
  EXPECT_EQ(with_page("measurements/lattice.md", "Text.\n").exit_status, 0);
  const Ran page = with_page("lost.md", "Text.\n");
  EXPECT_EQ(page.exit_status, 1);
  EXPECT_NE(page.output.find("docs/lost.md: no link to it in README.md"), std::string::npos) << page.output;
  const Ran measured = with_page("measurements/lost.md", "Text.\n");
  EXPECT_NE(measured.output.find("docs/measurements/lost.md: no link to it in docs/measurements/README.md"),
            std::string::npos)
      << measured.output;
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
