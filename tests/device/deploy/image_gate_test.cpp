// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever is wrong with an image, both paths of the host refuse it with the same gate, and no flash is touched.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>

#include "device/deploy/firmware_file.hpp"
#include "support/device_fixture.hpp"
#include "support/temp_folder.hpp"
#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/layout/image_check.hpp"

namespace triskin::deploy {
namespace {

using test::Fixture;

constexpr std::uint32_t kNew = 0x01000000, kOld = 0x00000100;

std::array<std::uint8_t, 8> other_board() {
  auto hardware = wire::kPartNumber;
  hardware[7] = '2';
  return hardware;
}

void put(FirmwarePackage& p, int slot, std::size_t at, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k)
    p.bytes[p.head.offset(slot) + at + k] = static_cast<std::uint8_t>(value >> (8 * k));
}

FirmwarePackage good() {
  return test::make_firmware({.fill = 2, .version = kNew});
}

struct Case {
  const char* name;
  FirmwarePackage package;
  const char* words;
};

std::vector<Case> cases() {
  std::vector<Case> list{
      {"older", test::make_firmware({.fill = 2, .version = kOld}), "the package has 0.0.1; --allow-older takes it"},
      {"foreign hardware", test::make_firmware({.fill = 2, .version = kNew, .hardware = other_board()}),
       "the image for slot A is for a board \"TRISKIN2\", these are \"TRISKIN1\""},
      {"unlabelled", test::make_firmware({.fill = 2, .labelled = false, .version = kNew}),
       "the image for slot A has no label"},
      {"other chip", good(), "the image for slot B is linked for another microcontroller"},
      {"other slot", good(), "the image for slot B is linked for address 0x08004000, the slot begins at 0x08040000"},
      {"another version than the head", good(), "is of another version than the head says"}};
  put(list[3].package, 1, 0, 0x10004000);  // The stack is in memory that these boards do not have.
  put(list[4].package, 1, layout::kLabelOffset + 20, layout::kSlotOrigins[0]);
  list[5].package.head.firmware_version += 0x100;
  return list;
}

using Path = std::function<std::string(Fixture&, const FirmwarePackage&, const UpdateOptions&)>;

// Returns why the path refuses the package; empty if it was written.
std::string by_broadcast(Fixture& fixture, const FirmwarePackage& package, const UpdateOptions& options) {
  const UpdateBus all{&fixture.bus(), fixture.bus().discover()};
  const BroadcastResult r = broadcast_firmware(std::array{all}, package, options);
  return r.complete() ? "" : r.boards.at(0).why;
}
std::string by_loader(Fixture& fixture, const FirmwarePackage& package, const UpdateOptions& options) {
  const FirmwareResult r = update_firmware(fixture.bus(), fixture.bus().discover().at(0), package, options);
  return r.bytes > 0 ? "" : "equal";
}
const std::array<std::pair<const char*, Path>, 2> kPaths{{{"broadcast", by_broadcast}, {"one by one", by_loader}}};

std::string refusal(const Path& path, Fixture& fixture, const FirmwarePackage& package,
                    const UpdateOptions& options = {}) {
  try {
    return path(fixture, package, options);
  } catch (const Error& e) {
    return e.what();
  }
}

// The controller runs version 0.2.0 by its label, and what the simulated application was built as by its hello.
Fixture running() {
  Fixture fixture(2);
  fixture.flash();
  test::install(fixture.skin(), 0, 0, test::make_firmware({.fill = 1}));
  fixture.bus().listen(fixture.bus().now_us() + 100'000);
  return fixture;
}

TEST(ImageGate, each_path_refuses_each_wrong_image_with_its_reason) {
  for (const auto& [path_name, path] : kPaths) {
    for (const Case& c : cases()) {
      Fixture fixture = running();
      const std::uint64_t operations = fixture.skin().slots(0).operations();
      const std::string why = refusal(path, fixture, c.package);
      EXPECT_NE(why.find(c.words), std::string::npos) << path_name << ", " << c.name << ": " << why;
      EXPECT_EQ(fixture.skin().slots(0).operations(), operations) << path_name << ", " << c.name;
    }
    Fixture fixture = running();
    EXPECT_EQ(refusal(path, fixture, good()), "") << path_name;
  }
}

TEST(ImageGate, an_older_image_and_one_of_another_board_are_asked_for_by_name) {
  for (const auto& [name, path] : kPaths) {
    Fixture fixture = running();
    EXPECT_EQ(refusal(path, fixture, cases()[0].package, {.allow_older = true}), "") << name;
    // The package is right for what was asked for; the board is not, and says so itself.
    Fixture other = running();
    const std::uint64_t operations = other.skin().slots(0).operations();
    const std::string why = refusal(path, other, cases()[1].package, {.hardware = other_board()});
    EXPECT_NE(why.find(name == kPaths[0].first ? "other hardware" : "is a board \"TRISKIN1\""), std::string::npos)
        << why;
    EXPECT_EQ(other.skin().slots(0).operations(), operations) << name;
  }
}

TEST(ImageGate, a_file_that_was_cut_off_is_no_package) {
  const test::TempFolder folder;
  const auto bytes = test::package_bytes({.fill = 2, .version = kNew});
  std::ofstream(folder / "cut.tsf", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size() - 8));
  EXPECT_INPUT_ERROR((void)read_firmware(folder / "cut.tsf"), "cut.tsf: is cut off: 2072 bytes, its head says 2080");
}

}  // namespace
}  // namespace triskin::deploy
