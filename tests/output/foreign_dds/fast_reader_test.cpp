// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes of ROS 2 read with Fast DDS by default, as here, with its own CDR; they must find every number equal. Readers
// of another DDS are in tests/output/bridge.
#include "fast_reader.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "fast_types.hpp"
#include "output/bridge/overloaded_stream.hpp"
#include "settings.hpp"
#include "support/strip_design.hpp"
#include "triskin/bridge/bridge.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::foreign {
namespace {

constexpr std::uint64_t kStart_ns = 1'700'000'000'250'000'000;
constexpr std::uint64_t kPeriod_ns = 36'900'000;
constexpr double kOnePercent = 0.01;

recording::ModuleSample sample_of(int module, std::uint32_t number) {
  recording::ModuleSample s;
  s.module = layout::ModuleId{module};
  s.link_time_us = 5'000'000 + number * 36'900ULL;
  s.sampled_ns = kStart_ns + number * kPeriod_ns;
  s.error_us = 700;
  s.sample.node_address = static_cast<std::uint8_t>(module / 4 + 1);
  s.sample.module = static_cast<std::uint8_t>(module % 4);
  s.sample.sample = number;
  s.sample.device_time_us = 1'000'000 + number * 36'900ULL;
  s.sample.valid = module == 3 ? 0xFF7 : 0xFFF;
  s.sample.state = wire::ModuleState::kOk;
  for (std::size_t t = 0; t < s.sample.value.size(); ++t)
    s.sample.value[t] =
        static_cast<std::uint16_t>(30'000 + module * 100 + static_cast<int>(number) * 13 + static_cast<int>(t));
  return s;
}

bridge::BridgeOptions options_of(double points_hz) {
  bridge::BridgeOptions o;
  o.part = "arm";
  o.points_hz = points_hz;
  return o;
}

float float_at(const PointCloud2& cloud, std::size_t at) {
  float v = 0.0F;
  std::memcpy(&v, cloud.data.data() + at, sizeof v);
  return v;
}

TEST(FastDds, raw_samples_arrive_whole_and_the_writer_is_announced_as_ROS_does) {
  const std::uint32_t id = domain_with();
  const design::Design design = test::strip(8, 4);
  const auto domain = join_loopback(id);
  bridge::Bridge bridge(*domain, design, options_of(0.0), kStart_ns);
  Participant participant(id);
  FastReader<RawFrame> reader(participant, "rt/skin/arm/raw", "triskin_msgs::msg::dds_::RawFrame_", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  const Announced writer = participant.announced("rt/skin/arm/raw");
  EXPECT_EQ(writer.type, "triskin_msgs::msg::dds_::RawFrame_");
  EXPECT_EQ(writer.user_data, "typehash=" + std::string(bridge::kRaw.hash) + ";");
  EXPECT_TRUE(writer.reliable);
  EXPECT_FALSE(writer.latched);
  for (std::uint32_t number = 1; number <= 50; ++number)
    for (int module = 0; module < 8; ++module) bridge.add(sample_of(module, number));
  bridge.flush();
  std::size_t samples = 0;
  const auto compare = [&](const RawFrame& raw, std::uint64_t /*sequence*/) {
    ASSERT_EQ(raw.module.size(), 4U);
    ASSERT_EQ(raw.value.size(), 48U);
    EXPECT_EQ(raw.sampled_ns, kStart_ns + raw.sample * kPeriod_ns);
    EXPECT_EQ(raw.link_time_us, 5'000'000 + raw.sample * 36'900ULL);
    EXPECT_EQ(raw.error_us, 700U);
    for (std::size_t k = 0; k < 4; ++k, ++samples) {
      const recording::ModuleSample wanted = sample_of(static_cast<int>(raw.module[k]), raw.sample);
      EXPECT_EQ(raw.node, wanted.sample.node_address);
      EXPECT_EQ(raw.row[k], wanted.sample.module);
      EXPECT_EQ(raw.valid[k], wanted.sample.valid);
      for (std::size_t t = 0; t < 12; ++t) ASSERT_EQ(raw.value[12 * k + t], wanted.sample.value[t]);
    }
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(compare), samples >= 400; })) << samples;
  EXPECT_EQ(samples, 400U);
}

TEST(FastDds, points_have_place_normal_and_value_of_every_taxel) {
  const std::uint32_t id = domain_with();
  const design::Design design = test::strip(40, 4);  // Each message has 15 kB, several packets of Ethernet.
  const auto domain = join_loopback(id);
  bridge::Bridge bridge(*domain, design, options_of(10.0), kStart_ns);
  Participant participant(id);
  FastReader<PointCloud2> reader(participant, "rt/skin/arm/points", "sensor_msgs::msg::dds_::PointCloud2_", false,
                                 false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  for (std::uint32_t number = 1; number <= 20; ++number)
    for (int module = 0; module < 40; ++module) bridge.add(sample_of(module, number));
  const auto wiring = design::wiring_of(design);
  std::uint64_t newest = 0;
  const auto compare = [&](const PointCloud2& cloud, std::uint64_t sequence) {
    newest = sequence;
    EXPECT_EQ(cloud.header.frame_id, "skin_arm");
    ASSERT_EQ(cloud.width, 480U);
    ASSERT_EQ(cloud.point_step, 32U);
    ASSERT_EQ(cloud.data.size(), 480U * 32U);
    ASSERT_EQ(cloud.fields.size(), 10U);
    EXPECT_EQ(cloud.fields[7].name, "value");
    EXPECT_EQ(cloud.fields[7].offset, 28U);
    const std::uint64_t stamp_ns = static_cast<std::uint64_t>(cloud.header.sec) * 1'000'000'000 + cloud.header.nanosec;
    const auto number = static_cast<std::uint32_t>((stamp_ns - kStart_ns) / kPeriod_ns);
    for (std::size_t m = 0; m < 40; ++m) {
      const auto poses = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
      for (std::size_t t = 0; t < 12; ++t) {
        const std::size_t at = (12 * m + t) * 32;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const int a = static_cast<int>(axis);
          ASSERT_EQ(float_at(cloud, at + 4 * axis), static_cast<float>(poses[t].position_mm[a] / 1000.0));
          ASSERT_EQ(float_at(cloud, at + 12 + 4 * axis), static_cast<float>(poses[t].normal[a]));
        }
        // The cloud is sent with the first sample of its number, which is module 0. The others are one older, or not
        // there yet.
        const std::uint32_t of = m == 0 ? number : number - 1;
        std::uint16_t value = 0;
        std::memcpy(&value, cloud.data.data() + at + 28, sizeof value);
        const recording::ModuleSample wanted = sample_of(static_cast<int>(m), of);
        ASSERT_EQ(value, of == 0 ? 0 : wanted.sample.value[t]) << m << " " << t << " of sample " << number;
        ASSERT_EQ(cloud.data[at + 30], of > 0 && (wanted.sample.valid >> t & 1U) != 0 ? 1 : 0);
      }
    }
  };
  const std::uint64_t published = bridge.published().points;
  EXPECT_GE(published, 7U);  // There are 19 · 36.9 ms at 10 Hz, and the first.
  EXPECT_TRUE(wait_until([&] { return reader.take(compare), newest >= published; })) << newest;
}

TEST(FastDds, who_comes_late_gets_the_layout) {
  const std::uint32_t id = domain_with();
  const design::Design design = test::with_gaps(test::strip(8, 4));
  const auto domain = join_loopback(id);
  const bridge::Bridge bridge(*domain, design, options_of(0.0), kStart_ns);
  Participant participant(id);
  FastReader<SkinLayout> reader(participant, "rt/skin/arm/layout", "triskin_msgs::msg::dds_::SkinLayout_", true, true);
  const auto wiring = design::wiring_of(design);
  const auto compare = [&](const SkinLayout& layout, std::uint64_t /*sequence*/) {
    EXPECT_EQ(layout.name, design.name);
    EXPECT_EQ(layout.design_id, design.design_id);
    ASSERT_EQ(layout.position.size(), 8U * 36U);
    ASSERT_EQ(layout.corner.size(), 8U * 9U);
    EXPECT_EQ(layout.patch, (std::vector<std::int32_t>{0, 0, 0, 0, 2, 2, 2, 2}));
    EXPECT_EQ(layout.module, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 12, 13, 14}));
    for (std::size_t m = 0; m < 8; ++m) {
      const auto poses = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
      for (std::size_t k = 0; k < 36; ++k)
        EXPECT_EQ(layout.position[36 * m + k],
                  static_cast<float>(poses[k / 3].position_mm[static_cast<int>(k % 3)] / 1000.0));
      for (std::size_t k = 0; k < 9; ++k)
        EXPECT_EQ(layout.corner[9 * m + k],
                  static_cast<float>(design.layout.modules[m].corner_mm[k / 3][static_cast<int>(k % 3)] / 1000.0));
    }
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(compare) == 1; }));
  EXPECT_TRUE(participant.announced("rt/skin/arm/layout").latched);
}

TEST(FastDds, contacts_have_place_force_area_and_taxels) {
  const std::uint32_t id = domain_with();
  const design::Design design = test::strip(8, 4);
  const auto domain = join_loopback(id);
  bridge::BridgeOptions options = options_of(0.0);
  options.calibration.newton_per_count = 0.001;
  bridge::Bridge bridge(*domain, design, options, kStart_ns);
  Participant participant(id);
  FastReader<Contacts> reader(participant, "rt/skin/arm/contacts", "triskin_msgs::msg::dds_::Contacts_", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  const std::vector<recording::PressedTaxel> taxels{
      {layout::ModuleId{5}, layout::TaxelIndex{3}, 6000.0, {10.0, 20.0, 30.0}, {0.0, 0.0, 1.0}},
      {layout::ModuleId{5}, layout::TaxelIndex{4}, 2000.0, {18.0, 20.0, 30.0}, {0.0, 0.0, 1.0}},
      {layout::ModuleId{1}, layout::TaxelIndex{0}, 500.0, {90.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}};
  bridge.add_contacts(recording::gather_contacts(taxels, 390.0), kStart_ns + 7);
  bridge.add_contacts({}, kStart_ns + 8);
  std::vector<Contacts> came;
  EXPECT_TRUE(wait_until([&] {
    reader.take([&](const Contacts& c, std::uint64_t) { came.push_back(c); });
    return came.size() == 2;
  }));
  ASSERT_EQ(came.size(), 2U);
  EXPECT_TRUE(came[1].contacts.empty());
  EXPECT_EQ(came[0].header.nanosec, 250'000'007U);
  EXPECT_EQ(came[0].force_unit, "N");
  ASSERT_EQ(came[0].contacts.size(), 2U);
  const Contact& strong = came[0].contacts[0];
  EXPECT_EQ(strong.position, (std::array{0.012, 0.02, 0.03}));  // The mean is (6 · 10 + 2 · 18) / 8.
  EXPECT_EQ(strong.normal, (std::array{0.0, 0.0, 1.0}));
  EXPECT_DOUBLE_EQ(strong.force, 8.0);
  EXPECT_DOUBLE_EQ(strong.area, 78e-6);
  EXPECT_EQ(strong.module, (std::vector<std::uint32_t>{5, 5}));
  EXPECT_EQ(strong.taxel, (std::vector<std::uint8_t>{3, 4}));
  EXPECT_EQ(strong.change, (std::vector<float>{6000.0F, 2000.0F}));
  EXPECT_EQ(strong.taxel_position, (std::vector<float>{0.01F, 0.02F, 0.03F, 0.018F, 0.02F, 0.03F}));
  EXPECT_EQ(came[0].contacts[1].normal[0], 1.0);
}

// Holds the numbers of the received samples, by module.
using Seen = std::map<std::uint32_t, std::set<std::uint32_t>>;

std::uint64_t gaps_of(const Seen& seen) {
  std::uint64_t gaps = 0;
  for (const auto& [module, numbers] : seen) gaps += *numbers.rbegin() - *numbers.begin() + 1 - numbers.size();
  return gaps;
}

// The bus is too slow, and the network drops one packet of a hundred: a reliable reader has exactly the samples that
// the stream reports as received.
TEST(FastDds, losses_at_a_reliable_reader_are_those_that_are_told_although_packets_are_lost) {
  const std::uint32_t id = domain_with();
  hardware::Scene scene;
  scene.design = test::strip(8, 4);
  const design::Design design = scene.design;
  scene.effects.bus_bit_rate = 80'000;
  scene.effects.bus_data_bit_rate = 80'000;
  hardware::SimLink link(std::move(scene));
  session::Bus bus(link);
  (void)deploy::flash(bus, design);
  const auto domain = join_loopback(id);
  bridge::Bridge bridge(*domain, design, options_of(0.0), kStart_ns);
  Participant participant(id, kOnePercent);
  FastReader<RawFrame> reader(participant, "rt/skin/arm/raw", "triskin_msgs::msg::dds_::RawFrame_", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  // The simulation hands over all messages at once, and the writer keeps 2,000 for what must be sent again.
  const session::StreamReport told = bridge::stream_overloaded(bus, design, bridge, 14'000'000, kStart_ns);
  ASSERT_LT(told.total.received, 2'000U);
  ASSERT_GT(told.total.lost(), 500U);
  Seen seen;
  std::size_t received = 0;
  const auto count = [&](const RawFrame& raw, std::uint64_t /*sequence*/) {
    for (const std::uint32_t module : raw.module) {
      EXPECT_TRUE(seen[module].insert(raw.sample).second) << "twice";
      ++received;
    }
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(count), received >= told.total.received; })) << received;
  EXPECT_EQ(received, told.total.received);
  EXPECT_EQ(told.total.expected - received, told.total.lost());
  // The reader cannot know what was lost before the first and behind the last sample of a module, which is a few for
  // each.
  EXPECT_LE(gaps_of(seen), told.total.lost());
  EXPECT_GE(gaps_of(seen) + 8 * 8, told.total.lost());
  EXPECT_EQ(reader.lost(), 0);
}

// With best effort, the reader must count exactly what was published and did not arrive, by the numbers of the
// messages, by the numbers of the samples in them, and by Fast DDS itself.
TEST(FastDds, losses_at_a_best_effort_reader_are_what_was_published_and_did_not_come) {
  const std::uint32_t id = domain_with();
  const design::Design design = test::strip(4, 4);
  const auto domain = join_loopback(id);
  bridge::Bridge bridge(*domain, design, options_of(0.0), kStart_ns);
  Participant participant(id, kOnePercent);
  FastReader<RawFrame> reader(participant, "rt/skin/arm/raw", "triskin_msgs::msg::dds_::RawFrame_", false, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  std::uint64_t received = 0, first = 0, newest = 0, in_a_row = 0;
  Seen seen;
  const auto count = [&](const RawFrame& raw, std::uint64_t sequence) {
    EXPECT_GT(sequence, newest);
    if (received == 0) first = sequence;
    in_a_row = sequence == newest + 1 ? in_a_row + 1 : 1;
    newest = sequence;
    for (const std::uint32_t module : raw.module) seen[module].insert(raw.sample);
    ++received;
  };
  std::uint32_t number = 0;
  const auto publish = [&] {
    ++number;
    for (int module = 0; module < 4; ++module) bridge.add(sample_of(module, number));
    bridge.flush();
  };
  while (number < 3000) {
    publish();
    if (number % 50 == 0) (void)wait_until([&] { return reader.take(count), newest == number; }, 0.05);
  }
  // Reads until the last one, because no reader can know what is lost after the last message. Fast DDS does not tell of
  // a loss directly before the last message either.
  while ((newest < number || in_a_row < 2) && number < 3100) {
    publish();
    (void)wait_until([&] { return reader.take(count), newest == number; }, 0.2);
  }
  const std::uint64_t lost = bridge.published().raw - received;
  std::printf("%llu of %u messages lost\n", static_cast<unsigned long long>(lost), number);
  ASSERT_EQ(newest, bridge.published().raw);
  EXPECT_GT(lost, 5U);  // The expectation is 30.
  EXPECT_LT(lost, 100U);
  EXPECT_EQ(newest - received, lost);
  ASSERT_FALSE(seen.empty());
  for (std::uint32_t module = 0; module < 4; ++module)
    EXPECT_EQ(number - seen[module].size(), lost) << "module " << module;
  // Fast DDS tells of a loss in a thread of its own, and cannot know what was lost before the first message.
  const std::uint64_t known = lost - (first - 1);
  (void)wait_until([&] { return static_cast<std::uint64_t>(reader.lost()) >= known; }, 2.0);
  EXPECT_EQ(static_cast<std::uint64_t>(reader.lost()), known);
}

}  // namespace
}  // namespace triskin::foreign
