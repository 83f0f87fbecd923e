// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a flash that somebody ends with Ctrl-C, and one that waits for a cable that was pulled.
#include <gtest/gtest.h>

#include "support/device_fixture.hpp"
#include "support/faulty_link.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/deploy/firmware_update.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::deploy {

using test::FaultyLink;
using test::Fixture;
using test::taking_over;

namespace {

design::Design other_wiring(const design::Design& d) {
  design::Design other = d;
  for (auto& patch : other.patches) std::swap(patch.modules[1].address, patch.modules[2].address);
  other.design_id = design::design_id_of(other);
  return other;
}

std::vector<std::uint8_t> active(Fixture& fixture, int patch) {
  fixture.bus().listen(fixture.bus().now_us() + 1'500'000);  // The transfer under way has timed out by now.
  session::Controller c(fixture.bus(), static_cast<std::uint8_t>(patch + 1));
  return c.read_table(session::bytes_of(session::image_of(fixture.design(), layout::PatchIndex{patch})).size());
}

// Returns how many of the two controllers have their table, by the message. One that ends before the first table has
// nothing to tell of.
int tables_done(const std::string& said) {
  const std::size_t at = said.find(" of 2 controllers have their table");
  return at == std::string::npos ? 0 : said[at - 1] - '0';
}

TEST(Cancelled, at_any_frame_every_controller_has_its_old_or_its_new_table_and_the_message_says_which) {
  int cancelled = 0, with_one_done = 0;
  for (std::uint64_t n = 1;; n += 3) {
    Fixture fixture(12, 6);
    const design::Design old_design = other_wiring(fixture.design());
    (void)flash(fixture.bus(), old_design);
    FaultyLink wire(fixture.bus().link(), false, {}, 1);
    wire.after_send = [&] {
      if (wire.frames >= n) interrupt_request() = true;
    };
    session::Bus bus(wire);
    std::string said;
    try {
      (void)flash(bus, fixture.design(), taking_over());
    } catch (const Cancelled& e) {
      said = e.what();
    }
    const bool too_late = !interrupt_request();
    interrupt_request() = false;
    if (too_late) break;
    int now_new = 0;
    for (int p = 0; p < 2; ++p) {
      const auto now = active(fixture, p),
                 fresh = session::bytes_of(session::image_of(fixture.design(), layout::PatchIndex{p})),
                 old = session::bytes_of(session::image_of(old_design, layout::PatchIndex{p}));
      ASSERT_TRUE(now == fresh || now == old) << "patch " << p << " at frame " << n;
      now_new += now == fresh ? 1 : 0;
    }
    if (!said.empty()) {
      ++cancelled;
      EXPECT_EQ(tables_done(said), now_new) << "frame " << n << ": " << said;
      EXPECT_EQ(said.find("(patches 0)") != std::string::npos, now_new == 1) << "frame " << n << ": " << said;
      with_one_done += now_new == 1 ? 1 : 0;
    }
    EXPECT_EQ(fixture.flash().patches.size(), 2U);  // The work can be completed afterwards.
    for (int p = 0; p < 2; ++p)
      ASSERT_EQ(active(fixture, p), session::bytes_of(session::image_of(fixture.design(), layout::PatchIndex{p}))) << n;
  }
  EXPECT_GT(cancelled, 30);
  EXPECT_GT(with_one_done, 5);
}

TEST(Unplugged, a_flash_that_waits_goes_on_by_itself) {
  for (std::uint64_t n = 20; n < 160; n += 13) {
    Fixture fixture(12, 6);
    FaultyLink wire(fixture.bus().link(), false, {}, 1);
    wire.frames_left = n;
    int looks = 0;
    wire.on_reconnect = [&](FaultyLink& w) {
      if (++looks == 1) throw link::Unreachable("still away");
      w.frames_left.reset();
    };
    FlashOptions options;
    options.wait_s = 20.0;
    std::vector<std::string> said;
    options.say = [&](const std::string& text) { said.push_back(text); };
    session::Bus bus(wire);
    const FlashResult r = flash(bus, fixture.design(), options);
    ASSERT_EQ(r.patches.size(), 2U);
    for (int p = 0; p < 2; ++p)
      EXPECT_EQ(active(fixture, p), session::bytes_of(session::image_of(fixture.design(), layout::PatchIndex{p}))) << n;
    EXPECT_EQ(r.bytes + static_cast<std::size_t>(r.skipped) * 104, 2U * 104)
        << n;  // Bytes written before the cut count as written.
    ASSERT_EQ(said.size(), 2U) << n;
    EXPECT_NE(said[0].find("waiting 20 s for the cable"), std::string::npos) << said[0];
    EXPECT_NE(said[1].find("going on"), std::string::npos) << said[1];
  }
}

TEST(Unplugged, nobody_comes_back_and_the_error_says_what_was_done) {
  Fixture fixture(12, 6);
  FaultyLink wire(fixture.bus().link(), false, {}, 1);
  wire.frames_left = 110;
  FlashOptions options;
  options.wait_s = 3.0;
  options.per_wire = 1;  // The first one is then done when the cable is pulled.
  session::Bus bus(wire);
  try {
    (void)flash(bus, fixture.design(), options);
    FAIL() << "completed without a cable";
  } catch (const link::Unreachable& e) {
    EXPECT_NE(std::string(e.what()).find("1 of 2 controllers have their table (patches 0), the others their old one"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace triskin::deploy
