// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/icub_stream.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>
#include <map>

#include "support/device_fixture.hpp"
#include "triskin/session/patch_offsets.hpp"

namespace triskin::session {

using test::Fixture;

namespace {

TEST(IcubStream, reads_our_controllers_as_skin_boards) {
  Fixture fixture(20);
  fixture.flash();
  wait_for_set_up(fixture.bus());
  std::map<std::pair<int, int>, wire::IcubTaxels> rest, pressed;
  auto* to = &rest;
  {
    IcubStream stream(fixture.bus(), [&](const wire::IcubTaxels& t) {
      if (!t.not_connected) (*to)[{t.board, t.module}] = t;
    });
    ASSERT_EQ(stream.boards().size(), 2U);
    EXPECT_EQ(stream.boards()[1].address, 2);
    stream.run_until(fixture.bus().now_us() + 400'000);
    EXPECT_EQ(rest.size(), 20U);
    to = &pressed;
    (void)fixture.skin().press_module(layout::ModuleId{17});  // The module is on board 2, triangle 1.
    stream.run_until(fixture.bus().now_us() + 400'000);
    EXPECT_EQ(stream.lost(), 0U);
    EXPECT_GE(stream.frames(), 32U * 12);  // Places without a module have frames, too.
  }
  // Twice the data sheet's 3 counts peak to peak and slow noise of 2 · 2 counts are less than three steps of 4 counts.
  constexpr int kNoise = 3;
  const auto changed = [&](int board, int module) {
    int taxels = 0;
    for (std::size_t t = 0; t < 12; ++t)
      taxels += std::abs(pressed[{board, module}].value[t] - rest[{board, module}].value[t]) > kNoise ? 1 : 0;
    return taxels;
  };
  EXPECT_GE(changed(2, 1), 8);
  EXPECT_EQ(changed(1, 3), 0);
}

// Acts as a board of the iCub, written down from its documentation: answers the discovery and sends what it was told to
// send.
class Mtb4 final : public link::Link {
 public:
  void send(const wire::CanFrame& f) override {
    sent.push_back(f);
    if (f.id == 0x70F) inbox.push_back(frame(0x730, {0xFF, 11, 3, 7, 1}));
    if (f.id == 0x203 && f.data[0] == 0x07 && f.data[1] == 0) {
      inbox.push_back(frame(0x435, {0x40, 240, 239, 238, 237, 236, 235, 234}));
      inbox.push_back(frame(0x435, {0xC0, 100, 101, 102, 103, 104, 0, 0}));
      inbox.push_back(frame(0x436, {0xC0, 1, 1, 1, 1, 1, 0, 0}));  // Its first frame was lost.
    }
  }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    if (inbox.empty()) {
      now = std::max(now, until_us);
      return std::nullopt;
    }
    const wire::CanFrame f = inbox.front();
    inbox.pop_front();
    return f;
  }
  [[nodiscard]] std::uint64_t now_us() const override { return now; }
  [[nodiscard]] bool fd() const override { return false; }
  [[nodiscard]] std::uint64_t answer_us() const override { return 1; }
  [[nodiscard]] std::string name() const override { return "mtb4"; }
  static wire::CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    wire::CanFrame f;
    f.id = id;
    f.size = static_cast<std::uint8_t>(bytes.size());
    std::ranges::copy(bytes, f.data.begin());
    return f;
  }
  std::deque<wire::CanFrame> inbox;
  std::vector<wire::CanFrame> sent;
  std::uint64_t now = 0;
};

TEST(IcubStream, reads_a_board_that_is_not_ours) {
  Mtb4 board;
  Bus bus(board);
  std::vector<wire::IcubTaxels> got;
  {
    IcubStream stream(bus, [&](const wire::IcubTaxels& t) { got.push_back(t); });
    ASSERT_EQ(stream.boards().size(), 1U);
    EXPECT_EQ(stream.boards()[0].address, 3);
    EXPECT_EQ(stream.boards()[0].version_minor, 7);
    stream.run_until(1'000'000);
    EXPECT_EQ(stream.lost(), 1U);
  }
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].board, 3);
  EXPECT_EQ(got[0].module, 5);
  EXPECT_EQ(got[0].value, (std::array<std::uint8_t, 12>{240, 239, 238, 237, 236, 235, 234, 100, 101, 102, 103, 104}));
  // The host sends discovery, board, triangles and start, and stops at the end.
  ASSERT_EQ(board.sent.size(), 5U);
  EXPECT_EQ(board.sent[1], Mtb4::frame(0x203, {0x4D, 0, 50, 245}));
  EXPECT_EQ(board.sent[2], Mtb4::frame(0x203, {0x50, 0, 15, 6, 1, 0, 0x22}));
  EXPECT_EQ(board.sent[4], Mtb4::frame(0x203, {0x07, 1}));
}

TEST(IcubStream, nobody_there_is_a_device_error) {
  Fixture fixture(4);
  fixture.skin().plug(false);
  EXPECT_THROW(IcubStream(fixture.bus(), {}), DeviceError);
}

}  // namespace
}  // namespace triskin::session
