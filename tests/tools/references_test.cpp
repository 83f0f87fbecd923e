// SPDX-License-Identifier: GPL-3.0-or-later
// The reference check must accept what exists and name what is dead: files, headings, sections, commands, options.
#include <gtest/gtest.h>

#include "support/places.hpp"
#include "tools/scratch_tree.hpp"

namespace triskin::tests {
namespace {

class References : public ScratchTree {
 protected:
  void SetUp() override {
    ScratchTree::SetUp();
    write("host/core/base/include/a.hpp", "int a;\n");
    write("docs/page.md", "# Page\n\n## 2. How it is built\n\nText.\n");
  }
  Ran with_readme(const std::string& text, const std::string& arguments = "") {
    write("README.md", text);
    return tool("check_references", arguments);
  }
  void expect_dead(const std::string& text, const std::string& message) {
    const Ran ran = with_readme(text);
    EXPECT_EQ(ran.exit_status, 1) << ran.output;
    EXPECT_NE(ran.output.find(message), std::string::npos) << ran.output;
  }
};

TEST_F(References, accepts_files_and_headings_that_exist) {
  const Ran ran = with_readme(
      "[page](docs/page.md), [part](docs/page.md#2-how-it-is-built), `a.hpp`, host/core/base, "
      "host/core/{base,base/include}/a.hpp "
      "or host/*/*/include; docs/page.md, section 2\n");
  EXPECT_EQ(ran.exit_status, 1) << ran.output;  // One of the two does not exist.
  EXPECT_NE(ran.output.find("no such file: host/core/base/a.hpp"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find(" 1 dead"), std::string::npos) << ran.output;
}

TEST_F(References, names_a_dead_link_with_its_line) {
  expect_dead("# Title\n\n[page](docs/other.md)\n", "README.md:3: no such file: docs/other.md");
}

TEST_F(References, names_a_dead_heading) {
  expect_dead("[page](docs/page.md#how-it-was-built)\n", "no such heading: docs/page.md#how-it-was-built");
}

TEST_F(References, names_a_dead_section) {
  expect_dead("as docs/page.md, section 3 says\n", "no such section: docs/page.md, section 3");
}

TEST_F(References, names_a_dead_path_in_a_page) {
  expect_dead("The table stands in `host/core/base/include/b.hpp`.\n", "no such file: host/core/base/include/b.hpp");
}

TEST_F(References, names_a_header_that_is_not_public) {
  write("host/core/base/include/triskin/base/a.hpp", "int a;\n");
  write("host/core/base/src/triskin/base/b.hpp", "int b;\n");
  const Ran ran = with_readme("[page](docs/page.md): `triskin/base/a.hpp`, `triskin/base/b.hpp`\n");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("no such public header: triskin/base/b.hpp"), std::string::npos) << ran.output;
  EXPECT_EQ(ran.output.find("header: triskin/base/a.hpp"), std::string::npos) << ran.output;
}

TEST_F(References, names_a_dead_file_in_a_comment) {
  write("host/core/base/src/a.cpp", "int a;  // as measure.hpp says (docs/cli.md)\n");
  expect_dead("Text\n", "host/core/base/src/a.cpp:1: no such file: measure.hpp");
  EXPECT_NE(with_readme("Text\n").output.find("no such file: docs/cli.md"), std::string::npos);
}

TEST_F(References, leaves_files_of_examples_alone) {
  const Ran ran =
      with_readme("[page](docs/page.md)\n```\ntriskin design a.obj -o docs/none.md\n```\n`cat docs/no.md`\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
}

TEST_F(References, holds_commands_against_the_program) {
  const std::string program = "--program " + test::program_file();
  EXPECT_EQ(with_readme("`triskin verify a.json --link sim --touch`\n", program).exit_status, 0);
  const Ran command = with_readme("```\ntriskin verfiy a.json\n```\n", program);
  EXPECT_EQ(command.exit_status, 1);
  EXPECT_NE(command.output.find("README.md:2: the program has no command verfiy"), std::string::npos) << command.output;
  const Ran option = with_readme("`triskin verify a.json --no-such`\n", program);
  EXPECT_EQ(option.exit_status, 1);
  EXPECT_NE(option.output.find("triskin verify has no option --no-such"), std::string::npos) << option.output;
}

TEST_F(References, names_a_command_that_the_page_of_commands_lacks) {
  write("docs/cli.md", "`verify`\n");
  const Ran ran = with_readme("[page](docs/page.md)\n", "--program " + test::program_file());
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("docs/cli.md:1: command flash is not listed"), std::string::npos) << ran.output;
  EXPECT_EQ(ran.output.find("command verify is"), std::string::npos) << ran.output;
}

TEST_F(References, says_when_commands_are_not_checked) {
  EXPECT_NE(with_readme("[page](docs/page.md)\n").output.find("commands and options were not checked"),
            std::string::npos);
}

}  // namespace
}  // namespace triskin::tests
