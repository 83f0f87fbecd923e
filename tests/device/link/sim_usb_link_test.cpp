// SPDX-License-Identifier: GPL-3.0-or-later
// Simulates controllers as USB devices behind one hub, in virtual time.
#include <gtest/gtest.h>

#include <map>

#include "support/device_fixture.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::link {

using test::fault;

namespace {

std::unique_ptr<hardware::SimUsbLink> simulated_hub(int modules, int per_patch,
                                                    std::vector<hardware::Fault> faults = {}) {
  hardware::Scene scene;
  scene.design = test::strip(modules, per_patch);
  scene.faults = std::move(faults);
  return std::make_unique<hardware::SimUsbLink>(std::move(scene));
}

diagnose::VerifyResult verified(session::Bus& bus, const design::Design& design) {
  diagnose::VerifyOptions options;
  options.touch = true;
  options.actuator = touch_actuator_of(bus.link());
  return verify(bus, design, options);
}

TEST(SimUsbLink, flash_and_verify_need_no_can_bus) {
  const auto link = simulated_hub(12, 4);
  session::Bus bus(*link);
  const deploy::FlashResult flashed = deploy::flash(bus, test::strip(12, 4));
  EXPECT_EQ(flashed.patches.size(), 3U);
  const diagnose::VerifyResult r = verified(bus, test::strip(12, 4));
  EXPECT_EQ(r.modules_ok, 12);
  EXPECT_EQ(r.touched, 12);
  EXPECT_TRUE(r.findings.empty());
  // Each device has its own wire.
  EXPECT_EQ((std::set{link->wire_of(1), link->wire_of(2), link->wire_of(3)}), (std::set{1, 2, 3}));
  EXPECT_EQ(link->skin().bus_busy_us(), 0U);
}

TEST(SimUsbLink, finds_what_is_wrong_as_a_can_bus_does) {
  const auto link = simulated_hub(8, 8, {fault(hardware::FaultKind::kSwappedChips, 1, 6)});
  session::Bus bus(*link);
  deploy::flash(bus, test::strip(8, 8));
  const diagnose::VerifyResult r = verified(bus, test::strip(8, 8));
  ASSERT_FALSE(r.findings.empty());
  EXPECT_EQ(r.findings[0].kind, diagnose::FindingKind::kSwappedModules);
}

// 16 requests to a known device take 16 / 19 ms of the hub; requests to nobody go to all three devices.
TEST(SimUsbLink, the_hub_carries_19_packets_a_millisecond) {
  const auto link = simulated_hub(6, 2);
  session::Bus bus(*link);
  deploy::flash(bus, test::strip(6, 2));
  bus.listen(bus.now_us() + 100'000);
  wire::CanFrame request;
  request.extended = true;
  request.size = 1;
  for (const auto& [node, devices] : {std::pair{2, 1U}, std::pair{99, 3U}}) {
    request.id = wire::physical_id(static_cast<std::uint8_t>(node), wire::kTesterAddress);
    const std::uint64_t packets = link->packets(), from_us = link->now_us();
    for (int k = 0; k < 16; ++k) link->send(request);
    EXPECT_EQ(link->packets() - packets, 16 * devices);
    // The last one is under way. The first waits for at most one, and each begins at a whole microsecond.
    const double took_us = static_cast<double>(link->now_us() - from_us);
    EXPECT_GE(took_us, (16.0 * devices - 1) * 1000 / 19);
    EXPECT_LE(took_us, 16.0 * devices * (1000.0 / 19 + 1));
  }
}

TEST(SimUsbLink, a_frame_longer_than_a_packet_is_refused) {
  const auto link = simulated_hub(2, 2);
  wire::CanFrame f;
  f.fd = true;
  f.size = 64;
  EXPECT_THROW(link->send(f), DeviceError);
}

session::StreamReport streamed(hardware::SimUsbLink& link, const design::Design& design, double seconds) {
  session::Bus bus(link);
  deploy::flash(bus, design);
  bus.listen(bus.now_us() + 2'000'000);  // The offsets are found by now.
  session::StreamOptions options;
  options.overload = true;
  session::Stream stream(bus, design, [](const session::ModuleSample&) {}, options);
  stream.run_until(bus.now_us() + static_cast<std::uint64_t>(seconds * 1e6));
  stream.finish();
  return stream.report();
}

// 16 modules give 434 samples a second; the hub carries 19,000 packets.
TEST(SimUsbLink, every_sample_of_twenty_controllers_arrives) {
  const auto link = simulated_hub(320, 16);
  const session::StreamReport r = streamed(*link, test::strip(320, 16), 3.0);
  EXPECT_TRUE(r.complete()) << session::sentences(r).at(0);
  EXPECT_NEAR(static_cast<double>(r.total.expected), 320 * 3.0 / 0.0369, 0.02 * 320 * 3.0 / 0.0369);
}

// 48 controllers are 10 % too much for one hub: missing samples are counted, and no controller is starved for another.
// Leases begin one after the other, each after the frames that wait on the full hub.
TEST(SimUsbLink, what_a_full_hub_cannot_carry_is_counted_and_shared) {
  hardware::Scene scene;
  scene.design = test::strip(48 * 16, 16);
  scene.effects.converters.drawn = false;  // The shares below are those of sequences of nominal length.
  hardware::SimUsbLink link(scene);
  const session::StreamReport r = streamed(link, scene.design, 3.0);
  EXPECT_FALSE(r.complete());
  std::map<int, session::SampleCounts> patches;
  for (const session::ModuleCounts& m : r.modules) {
    EXPECT_EQ(m.counts.expected, m.counts.received + m.counts.lost()) << m.module;
    patches[m.module / 16] += m.counts;
  }
  EXPECT_EQ(patches.size(), 48U);
  EXPECT_LE(r.total.received, link.packets());
  EXPECT_GT(r.total.dropped, r.total.lost() / 2);
  double least = 1.0, most = 0.0;
  for (const auto& [patch, counts] : patches) {
    const double share = static_cast<double>(counts.received) / static_cast<double>(counts.expected);
    least = std::min(least, share);
    most = std::max(most, share);
  }
  EXPECT_GE(least, 0.9 * most) << least << " … " << most;
  EXPECT_NEAR(most, 19'000.0 * 0.0369 / (48 * 16), 0.05);  // The ratio is packets over due samples.
}

}  // namespace
}  // namespace triskin::link
