// SPDX-License-Identifier: GPL-3.0-or-later
// A name in a design is text of a stranger. It must stay text in every format that contains it, and on the terminal.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "app/cli/shell_case.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// The name ends texts, attributes, scripts, comments and CDATA of markup; moves a cursor and sets a title; begins a
// formula.
constexpr const char* kHostile =
    "=1+1\x1B]0;owned\x07\x1B[2J</title></text></script></style>--><script>alert(1)</script>]]>\"'><img src=x "
    "onerror=alert(1)> & \xE2\x80\xAE\xC2\x9B\r";

class Names : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::Design d = strip(4, 4);
    d.name = kHostile;
    d.source_file = kHostile;
    design::write_design(folder_ / "strip.json", d);
  }
  // Fails for characters that a terminal or a reader of text must not get.
  static void expect_no_controls(const std::string& text, const std::string& where) {
    for (const char c : text)
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' && c != '\r')
        FAIL() << where << ": control character " << static_cast<int>(c);
    EXPECT_EQ(text.find("\xC2\x9B"), std::string::npos) << where;
  }
};

TEST_F(Names, stay_text_in_every_format_of_markup) {
  for (const char* format : {"picture", "html", "urdf", "sdf", "sheet-svg"}) {
    const Outcome o = run(std::string("export strip.json --format ") + format + " -o file");
    if (o.status == 2 && o.messages.find("was built without") != std::string::npos) continue;
    ASSERT_EQ(o.status, 0) << format << o.messages;
    const std::string text = read_file(folder_ / "file");
    EXPECT_EQ(text.find("<script>alert"), std::string::npos) << format;
    EXPECT_EQ(text.find("<img"), std::string::npos) << format;
    EXPECT_EQ(text.find("onerror=alert(1)>"), std::string::npos) << format;
    expect_no_controls(text, format);
  }
}

// A foreign parser reads the JSON of glTF back; the tables of text must have as many columns as their head.
TEST_F(Names, stay_text_in_json_and_tables) {
  ASSERT_EQ(run("export strip.json --format gltf -o file.gltf").status, 0);
  const std::string gltf = read_file(folder_ / "file.gltf");
  expect_no_controls(gltf, "gltf");
  EXPECT_THAT(nlohmann::json::parse(gltf).dump(), HasSubstr("alert(1)")) << "the name itself is kept";
  for (const char* format : {"taxels", "icub-positions", "icub-skingui", "modules"}) {
    const Outcome o = run(std::string("export strip.json --format ") + format + " -o file." +
                          (std::string(format) == "taxels"         ? "csv"
                           : std::string(format) == "modules"      ? "obj"
                           : std::string(format) == "icub-skingui" ? "ini"
                                                                   : "txt"));
    ASSERT_EQ(o.status, 0) << format << o.messages;
  }
  for (const char* file : {"file.csv", "file.txt", "file.ini", "file.obj"})
    expect_no_controls(read_file(folder_ / file), file);
}

TEST_F(Names, of_a_kind_is_one_field_of_the_table_of_taxels) {
  design::Design d = strip(2, 2);
  d.kinds.kinds.push_back(
      {.name = "=cmd|' /C calc'!A0", .taxels = 12, .dielectric = "", .sensitivity_counts_per_kpa = 80});
  d.layout.modules[1].kind = 1;
  d.design_id = design::design_id_of(d);
  design::write_design(folder_ / "kinds.json", d);
  const Outcome o = run("export kinds.json --format taxels -o file.csv");
  ASSERT_EQ(o.status, 0) << o.messages;
  EXPECT_THAT(read_file(folder_ / "file.csv"), AllOf(HasSubstr(",'=cmd|"), Not(HasSubstr(",=cmd"))));
}

TEST_F(Names, do_not_command_the_terminal) {
  for (const char* command :
       {"check strip.json", "flash strip.json --link sim", "verify strip.json --link sim",
        "live strip.json --link sim --seconds 0.1", "export strip.json --format picture -o file.svg",
        "identify strip.json --patch 0 --limit-s 1 -o b.json --link sim", "flash strip.json --link nonsense",
        "robot new r.json --name 'a\x1B[2J' --bus left=sim"}) {
    const Outcome o = run(command);
    expect_no_controls(o.out, command);
    expect_no_controls(o.messages, command);
  }
}

// Bytes that are no UTF-8 are a legal name of a file.
TEST_F(Names, of_files_may_be_no_utf8) {
  const std::string file = "bad\xFF\xFEname.json";
  std::filesystem::copy_file(folder_ / "strip.json", folder_ / file);
  for (const std::string command : {"check", "export --format picture -o p.svg", "flash --link sim"}) {
    if (command == "check" && !program_has_solvers()) continue;
    const std::size_t space = command.find(' ');
    const std::string text =
        command.substr(0, space) + " '" + file + "'" + (space == std::string::npos ? "" : command.substr(space));
    for (const char* json : {"", " --json"}) {
      const Outcome o = run(text + json);
      EXPECT_LE(o.status, 1) << command << o.messages;
      EXPECT_THAT(o.messages, Not(HasSubstr("internal error")));
    }
  }
}

}  // namespace
}  // namespace triskin::test
