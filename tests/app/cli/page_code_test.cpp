// SPDX-License-Identifier: GPL-3.0-or-later
// Commands accept the text of a QR code of the assembly sheet instead of a design file.
#include <gmock/gmock.h>

#include "shell_case.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using testing::HasSubstr;

class PageCodeArgument : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    const design::Design d = strip(6, 3);
    design::write_design(folder_ / "b.json", d);
    design::write_design(folder_ / "a.json", strip(5, 3));
    write_file_atomically(folder_ / "notes.json", fmt::format("{{\"design_id\":\"{:016x}\"}}", d.design_id));
    id_ = fmt::format("{:016x}", d.design_id);
  }
  std::string id_;
};

TEST_F(PageCodeArgument, finds_the_design_in_the_folder_and_names_the_controller) {
  ASSERT_EQ(run("flash b.json --link sim").status, 0);
  const Outcome outcome = run("verify triskin:" + id_ + "/1/7 --link sim --no-touch");
  EXPECT_EQ(outcome.status, 0) << outcome.messages;
  EXPECT_THAT(outcome.out, HasSubstr("b.json, page 7 of its assembly sheet: controller 1"));
  EXPECT_THAT(outcome.out, HasSubstr("6 of 6 modules ok"));
}

TEST_F(PageCodeArgument, refuses_a_code_of_another_design_or_none) {
  const Outcome other = run("verify triskin:0123456789abcdef/0/1 --link sim");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.messages, HasSubstr("none of the 3 files *.json in this folder"));
  EXPECT_EQ(run("view triskin:" + id_ + "/2/1 --no-open --link none").status, 2);
  const Outcome none = run("view triskin:" + id_ + " --no-open --link none");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.messages, HasSubstr("triskin:DESIGNID/PATCH/PAGE"));
}

TEST_F(PageCodeArgument, export_of_a_recording_is_a_page_only) {
  const Outcome outcome = run("export touch.mcap --format urdf");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.messages, HasSubstr("--format html"));
}

}  // namespace
}  // namespace triskin::test
