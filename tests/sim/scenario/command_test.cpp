// SPDX-License-Identifier: GPL-3.0-or-later
// Tests what a person sees of scenes at the command line.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "app/cli/shell_case.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class SceneCommands : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "d.json", strip(6));
  }
  void scene(const std::string& rest) const {
    write_file_atomically(folder_ / "s.json",
                          "{\"format\":\"triskin-scene\",\"version\":1,\"design\":\"d.json\",\n" + rest + "}");
  }
};

TEST_F(SceneCommands, an_expectation_that_fails_gives_status_1_and_what_was_seen) {
  scene(R"("contacts":[{"module":4,"at_s":1,"radius_mm":12,"force_n":6}],
           "expect":[{"at_s":0.8,"pressed":false},{"at_s":1.5,"module":4,"more_than_n":50}])");
  const Outcome person = run("simulate s.json --check");
  EXPECT_EQ(person.status, 1);
  EXPECT_THAT(person.out, AllOf(HasSubstr("ok      /expect/0"), HasSubstr("FAILED  /expect/1"),
                                HasSubstr("module 4 reports more than 50 N (1 sample: "), HasSubstr("1 of 2")));
  const Outcome program = run("simulate s.json --check --json");
  EXPECT_EQ(program.status, 1);
  const json result = json::parse(program.out);
  EXPECT_EQ(result["failed"], 1);
  EXPECT_EQ(result["expectations"][0]["held"], true);
  EXPECT_EQ(result["expectations"][1]["held"], false);
  scene(R"("contacts":[{"module":4,"at_s":1,"radius_mm":12,"force_n":6}],
           "expect":[{"at_s":1.5,"module":4,"more_than_n":1}])");
  EXPECT_EQ(run("simulate s.json --check").status, 0);
}

TEST_F(SceneCommands, a_bad_scene_gives_status_2_with_file_and_path) {
  scene(R"("expect":[{"at_s":1,"module":4,
           "pressd":true}])");
  const Outcome bad = run("simulate s.json --check");
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.messages, AllOf(HasSubstr("s.json: /expect/0/pressd: "), HasSubstr("\"pressd\" is unknown")));
  scene(R"("seed":1)");
  EXPECT_EQ(run("simulate s.json --check").status, 2);
  EXPECT_EQ(run("simulate s.json --check --listen 127.0.0.1:0").status, 2);
}

TEST_F(SceneCommands, touched_places_become_regions) {
  scene(R"("contacts":[{"module":4,"at_s":1,"until_s":3,"radius_mm":3}])");
  const Outcome made = run("touched s.json -o r.json --max-weight 3 --json");
  EXPECT_EQ(made.status, 0) << made.messages;
  EXPECT_EQ(json::parse(made.out)["touched_modules"], 1);
  EXPECT_EQ(json::parse(made.out)["numbers"], json({0, 1, 2, 3, 4, 5}));
  const json regions = json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(regions["regions"][0]["weight"], 3.0);
  EXPECT_EQ(run("touched s.json -o r.json --max-weight 1").status, 2);
  EXPECT_EQ(run("touched d.json -o other.json").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other.json"));
}

TEST_F(SceneCommands, models_for_simulators_are_written) {
  for (const char* form : {"mjcf -o a.xml", "mjcf-touch -o b.xml --body hand", "taxel-list -o c.json", "npz -o d.npz"})
    EXPECT_EQ(run(std::string("export d.json --format ") + form).status, 0) << form;
  EXPECT_THAT(read_file(folder_ / "a.xml"), HasSubstr("<tactile name=\"strip_tactile\""));
  EXPECT_THAT(read_file(folder_ / "b.xml"),
              AllOf(HasSubstr("<touch name=\"strip_module_5\""), HasSubstr("body1=\"hand\" body2=\"strip\"")));
  EXPECT_EQ(json::parse(read_file(folder_ / "c.json"))["taxels"].size(), 60U);
}

}  // namespace
}  // namespace triskin::test
