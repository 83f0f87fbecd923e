// SPDX-License-Identifier: GPL-3.0-or-later
// Flashes over a bus that loses, doubles, reorders and delays frames, that is unplugged, or that has another tester: no
// wrong table is ever active, the error tells what happened, and another run completes the work.
#include <gtest/gtest.h>

#include <cstdio>

#include "support/device_fixture.hpp"
#include "support/faulty_link.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::session {

using test::FaultyLink;
using test::Fixture;
using test::taking_over;

namespace {

design::Design other_wiring(const design::Design& d) {
  design::Design other = d;
  std::swap(other.patches[0].modules[1].address, other.patches[0].modules[2].address);
  other.design_id = design::design_id_of(other);
  return other;
}

// Asks for the active table over the undisturbed bus.
std::vector<std::uint8_t> active(Fixture& fixture, std::size_t bytes) {
  fixture.bus().listen(fixture.bus().now_us() + 2'000'000);  // The transfer under way has timed out by now.
  Controller c(fixture.bus(), 1);
  return c.active_table().present() ? c.read_table(bytes) : std::vector<std::uint8_t>{};
}

class Wires : public testing::TestWithParam<bool> {};  // The parameter selects FD or classic frames.

TEST_P(Wires, unplugged_after_any_frame_of_a_flash_then_plugged_in_and_repeated) {
  int failed = 0;
  for (std::uint64_t n = 0;; ++n) {
    Fixture fixture(16);
    const design::Design old_design = other_wiring(fixture.design());
    (void)deploy::flash(fixture.bus(), old_design);
    const auto old_image = bytes_of(image_of(old_design, layout::PatchIndex{0})),
               new_image = bytes_of(image_of(fixture.design(), layout::PatchIndex{0}));
    FaultyLink wire(fixture.bus().link(), GetParam(), {}, 1);
    wire.frames_left = n;
    Bus bus(wire);
    bool completed = true;
    try {
      (void)flash(bus, fixture.design(), taking_over());
    } catch (const DeviceError& e) {
      completed = false;
      ++failed;
      EXPECT_NE(std::string(e.what()).find("answer"), std::string::npos) << e.what();
    }
    const auto now = active(fixture, new_image.size());
    ASSERT_TRUE(now == old_image || now == new_image) << "frame " << n;
    wire.frames_left.reset();
    (void)flash(bus, fixture.design(), taking_over());
    ASSERT_EQ(active(fixture, new_image.size()), new_image) << "frame " << n;
    if (completed) break;
  }
  EXPECT_GT(failed, GetParam() ? 40 : 100);
}

TEST_P(Wires, frames_lost_doubled_reordered_and_delayed) {
  int failed = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Fixture fixture(16);
    const design::Design old_design = other_wiring(fixture.design());
    (void)deploy::flash(fixture.bus(), old_design);
    const auto old_image = bytes_of(image_of(old_design, layout::PatchIndex{0})),
               new_image = bytes_of(image_of(fixture.design(), layout::PatchIndex{0}));
    const unsigned rate = 1 + seed % 2;
    FaultyLink wire(fixture.bus().link(), GetParam(), {rate, rate, rate, rate}, seed);
    Bus bus(wire);
    bool completed = false;
    std::string trail;
    for (int attempt = 0; attempt < 30 && !completed; ++attempt) {
      try {
        completed = flash(bus, fixture.design(), taking_over()).patches.size() == 1;
      } catch (const DeviceError& e) {
        ++failed;
        EXPECT_GT(std::string(e.what()).size(), 30U) << e.what();
        trail += std::string("\n") + e.what();
      }
      const auto now = active(fixture, new_image.size());
      ASSERT_TRUE(now == old_image || now == new_image) << "seed " << seed;
    }
    ASSERT_TRUE(completed) << "seed " << seed << trail;
    ASSERT_EQ(active(fixture, new_image.size()), new_image) << "seed " << seed;
  }
  EXPECT_GT(failed, 0);  // Without failures, the disturbance had no effect.
}

TEST_P(Wires, another_tester_asks_in_between) {
  Fixture fixture(16);
  FaultyLink wire(fixture.bus().link(), GetParam(), {}, 1);
  int asked = 0;
  wire.after_send = [&] {
    if (wire.frames % 29 != 0) return;
    wire::CanFrame f;
    f.id = wire::physical_id(1, wire::kTesterAddress);
    f.extended = true;
    f.size = 8;
    f.data = {3, 0x22, 0xFD, asked++ % 2 == 0 ? std::uint8_t{0x01} : std::uint8_t{0x05}};
    fixture.bus().link().send(f);
  };
  Bus bus(wire);
  bool completed = false;
  for (int attempt = 0; attempt < 20 && !completed; ++attempt) {
    try {
      completed = flash(bus, fixture.design(), taking_over()).patches.size() == 1;
    } catch (const DeviceError&) {
    }
  }
  EXPECT_TRUE(completed);
  EXPECT_GT(asked, 0);
  const auto image = bytes_of(image_of(fixture.design(), layout::PatchIndex{0}));
  EXPECT_EQ(active(fixture, image.size()), image);
}

INSTANTIATE_TEST_SUITE_P(Formats, Wires, testing::Bool(), [](const auto& p) { return p.param ? "fd" : "classic"; });

TEST(BusTime, a_table_of_sixteen_modules_takes_less_than_a_tenth_of_a_second) {
  hardware::Scene scene;
  scene.design = test::strip(16);
  scene.effects.bus_bit_rate = 1'000'000;
  hardware::SimLink sim(std::move(scene));
  FaultyLink classic(sim, false, {}, 1);  // The link injects no faults: it only restricts the bus to classic frames.
  Bus bus(classic);
  const std::uint64_t start_us = sim.skin().bus_busy_us();
  const deploy::FlashResult r = deploy::flash(bus, sim.skin().scene().design);
  const std::uint64_t busy_us = sim.skin().bus_busy_us() - start_us;
  EXPECT_EQ(r.bytes, 32 + 16 * 12U);
  EXPECT_LT(busy_us, 100'000U);
  RecordProperty("bus_time_us", static_cast<int>(busy_us));
  std::printf("bus time of a table of 16 modules, written and read back, 1 Mbit/s classic: %.1f ms, %llu frames\n",
              static_cast<double>(busy_us) * 1e-3, static_cast<unsigned long long>(classic.frames));
}

}  // namespace
}  // namespace triskin::session
