// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that would silently do nothing must be refused, and the boards of one scene must not remember the faults of
// another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "scene_case.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/hardware/virtual_skin.hpp"
#include "triskin/layout/flash_pages.hpp"

namespace triskin::hardware {
namespace {

namespace fs = std::filesystem;
using test::strip;
using testing::AllOf;
using testing::HasSubstr;

class SceneTrust : public SceneCase {
 protected:
  [[nodiscard]] std::string error_with(const std::string& rest) const {
    return error_of(R"({"format":"triskin-scene","version":1,"design":"d.json",)" + rest + "}");
  }
};

TEST_F(SceneTrust, a_contact_five_metres_off_the_skin_is_refused_with_its_distance) {
  // The highest taxel lies on z = 0.
  EXPECT_THAT(error_with(R"("contacts":[{"position_mm":[15,9,5000]}])"),
              AllOf(HasSubstr("/contacts/0"), HasSubstr("no taxel feels this contact"), HasSubstr("5000.0 mm")));
  EXPECT_EQ(error_with(R"("contacts":[{"position_mm":[15,9,5]}])"), "no error");
}

TEST_F(SceneTrust, a_moving_contact_counts_along_its_path) {
  EXPECT_EQ(error_with(R"("contacts":[{"position_mm":[15,9,500],"to_mm":[15,9,0],"until_s":2}])"), "no error");
  EXPECT_THAT(error_with(R"("contacts":[{"position_mm":[15,9,500],"to_mm":[15,9,20],"until_s":2}])"),
              HasSubstr("20.0 mm"));
}

TEST_F(SceneTrust, a_contact_on_a_pad_that_feels_nothing_is_refused) {
  for (const char* pad : {"6", "10"}) {
    const std::string contact = std::string(R"("contacts":[{"module":1,"taxel":)") + pad + "}]";
    EXPECT_THAT(error_with(contact), AllOf(HasSubstr("/contacts/0/taxel"), HasSubstr("feels no finger"))) << pad;
  }
  EXPECT_EQ(error_with(R"("contacts":[{"module":1,"taxel":5}])"), "no error");
}

TEST_F(SceneTrust, a_key_that_stands_twice_is_refused) {
  EXPECT_THAT(error_with(R"("contacts":[{"module":1,"force_n":1,"force_n":20}])"),
              AllOf(HasSubstr("\"force_n\""), HasSubstr("twice")));
  EXPECT_THAT(error_with(R"("seed":1,"effects":{},"seed":2)"), HasSubstr("\"seed\""));
  EXPECT_EQ(error_with(R"("contacts":[{"module":1,"force_n":1},{"module":2,"force_n":20}])"), "no error");
}

TEST_F(SceneTrust, text_that_is_not_json_is_said_without_names_of_the_library) {
  const std::string error = error_with(R"("seed":1,, )");
  EXPECT_THAT(error, AllOf(HasSubstr("s.json"), HasSubstr("line 1, column"), Not(HasSubstr("json.exception"))));
}

// Returns true if the fault pages of a board hold a record.
bool remembers(const fs::path& folder) {
  const FlashMemory flash(VirtualSkin::kFlashBytes, folder / "controller_1.flash");
  const auto pages = flash.bytes().subspan(layout::kFirstFaultPage * FlashMemory::kPageBytes,
                                           layout::kFaultPages * FlashMemory::kPageBytes);
  return std::ranges::any_of(pages, [](std::uint8_t b) { return b != 0xFF; });
}

// Writes what the firmware writes when it notes a fault.
void note_fault(const fs::path& folder) {
  FlashMemory flash(VirtualSkin::kFlashBytes, folder / "controller_1.flash");
  const std::array<std::uint8_t, 8> record{1, 2, 3, 4, 5, 6, 7, 8};
  ASSERT_TRUE(flash.program(layout::kFirstFaultPage * FlashMemory::kPageBytes, record));
  ASSERT_TRUE(flash.program(0, record));  // The slot holds a table.
}

TEST_F(SceneTrust, faults_of_one_scene_are_not_remembered_in_another_but_tables_are) {
  Scene healthy;
  healthy.design = strip(6);
  Scene faulty = healthy;
  Fault removed;
  removed.module = layout::ModuleId{2};
  faulty.faults.push_back(removed);
  const fs::path state = folder_ / "state";
  {
    const VirtualSkin skin(faulty, state);
  }
  note_fault(state);
  {
    const VirtualSkin skin(faulty, state);
  }
  EXPECT_TRUE(remembers(state)) << "the same scene keeps its memory";
  Scene touched = faulty;
  touched.contacts.push_back({});
  {
    const VirtualSkin skin(touched, state);
  }
  EXPECT_TRUE(remembers(state)) << "contacts are no other hardware";
  {
    const VirtualSkin skin(healthy, state);
  }
  EXPECT_FALSE(remembers(state));
  const FlashMemory flash(VirtualSkin::kFlashBytes, state / "controller_1.flash");
  EXPECT_EQ(flash.bytes()[0], 1) << "tables stay";
}

}  // namespace
}  // namespace triskin::hardware
