// SPDX-License-Identifier: GPL-3.0-or-later
// A reader with its own types and the decoder of Cyclone DDS must get what the bridge publishes.
#include "triskin/bridge/bridge.hpp"

#include <gtest/gtest.h>

#include <barrier>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <thread>
#include <vector>

#include "overloaded_stream.hpp"
#include "reader.hpp"
#include "skin.h"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::bridge {
namespace {

using Raw = triskin_msgs_msg_dds__RawFrame_;
using Layout = triskin_msgs_msg_dds__SkinLayout_;
using Contacts = triskin_msgs_msg_dds__Contacts_;
using Cloud = sensor_msgs_msg_dds__PointCloud2_;
using Diagnostics = diagnostic_msgs_msg_dds__DiagnosticArray_;
using Transforms = tf2_msgs_msg_dds__TFMessage_;

constexpr std::uint64_t kStart_ns = 1'700'000'000'250'000'000;

constexpr std::uint32_t kWarmUp = 1'000'000;  // The numbers of samples that a test does not count begin here.

recording::ModuleSample sample_of(int module, std::uint32_t number) {
  recording::ModuleSample s;
  s.module = layout::ModuleId{module};
  s.link_time_us = 5'000'000 + number * 36'900ULL;
  s.sampled_ns = kStart_ns + number * 36'900'000ULL;
  s.error_us = 700;
  s.sample.node_address = static_cast<std::uint8_t>(module / 4 + 1);
  s.sample.module = static_cast<std::uint8_t>(module % 4);
  s.sample.sample = number;
  s.sample.device_time_us = 1'000'000 + number * 36'900ULL;
  s.sample.valid = 0xFFF;
  s.sample.state = wire::ModuleState::kOk;
  for (std::size_t t = 0; t < s.sample.value.size(); ++t)
    s.sample.value[t] =
        static_cast<std::uint16_t>(30'000 + module * 100 + static_cast<int>(number) * 13 + static_cast<int>(t));
  return s;
}

// A reader of Cyclone DDS begins anew with the first heartbeat of a writer, which comes up to a fifth of a second after
// both have found each other. Publishes for longer than that, and until the last message has come.
void warm_up(Bridge& bridge, Reader<Raw>& reader) {
  constexpr std::uint32_t kMin = 60;  // one in 10 ms
  std::uint32_t sent = 0, came = 0;
  EXPECT_TRUE(wait_until([&] {
    reader.take([&](const Raw& raw) { came = raw.sample - kWarmUp + 1; });
    if (sent >= kMin && came == sent) return true;
    bridge.add(sample_of(0, kWarmUp + sent++));
    bridge.flush();
    return false;
  }));
}

class BridgeTest : public testing::Test {
 protected:
  const std::uint32_t domain_id_ = test_domain();
  const design::Design design_ = test::strip(8, 4);
  const std::unique_ptr<Domain> domain_ = join_loopback(domain_id_);
  const dds_entity_t participant_ = dds_create_participant(domain_id_, nullptr, nullptr);
  ~BridgeTest() override { (void)dds_delete(participant_); }
  static BridgeOptions options(double points_hz = 10.0) {
    BridgeOptions o;
    o.part = "arm";
    o.points_hz = points_hz;
    o.pose = {{0.1, 0.2, 0.3}, {0.0, 0.0, 1.0, 0.0}};
    return o;
  }
};

TEST_F(BridgeTest, a_reader_gets_every_raw_sample_and_the_type_hash) {
  Bridge bridge(*domain_, design_, options(0.0), kStart_ns);
  Reader<Raw> reader(participant_, triskin_msgs_msg_dds__RawFrame__desc, "rt/skin/arm/raw", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  EXPECT_EQ(reader.user_data(), "typehash=" + std::string(kRaw.hash) + ";");
  warm_up(bridge, reader);
  const std::uint64_t before = bridge.published().raw;
  for (std::uint32_t number = 1; number <= 50; ++number) {
    for (int module = 0; module < 8; ++module) bridge.add(sample_of(module, number));
  }
  bridge.flush();
  EXPECT_EQ(bridge.published().raw - before, 100U);
  std::size_t samples = 0;
  const auto compare = [&](const Raw& raw) {
    ASSERT_EQ(raw.module_._length, 4U);
    ASSERT_EQ(raw.value._length, 48U);
    EXPECT_EQ(raw.sampled_ns, kStart_ns + raw.sample * 36'900'000ULL);
    EXPECT_EQ(raw.error_us, 700U);
    for (std::uint32_t k = 0; k < raw.module_._length; ++k) {
      const recording::ModuleSample wanted = sample_of(static_cast<int>(raw.module_._buffer[k]), raw.sample);
      EXPECT_EQ(raw.node, wanted.sample.node_address);
      for (std::size_t t = 0; t < 12; ++t) ASSERT_EQ(raw.value._buffer[12 * k + t], wanted.sample.value[t]);
      ++samples;
    }
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(compare), samples >= 400; })) << samples;
  EXPECT_EQ(samples, 400U);
}

TEST_F(BridgeTest, a_raw_frame_names_modules_by_number) {
  Bridge bridge(*domain_, test::with_gaps(design_), options(0.0), kStart_ns);
  Reader<Raw> reader(participant_, triskin_msgs_msg_dds__RawFrame__desc, "rt/skin/arm/raw", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  warm_up(bridge, reader);
  for (int module = 4; module < 8; ++module) bridge.add(sample_of(module, 1));
  bridge.flush();
  std::vector<std::uint32_t> numbers;
  const auto note = [&](const Raw& raw) {
    numbers.assign(raw.module_._buffer, raw.module_._buffer + raw.module_._length);
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(note), !numbers.empty(); }));
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{4, 12, 13, 14}));
}

TEST_F(BridgeTest, points_are_a_cloud_with_the_places_of_the_design) {
  Bridge bridge(*domain_, design_, options(), kStart_ns);
  // rviz and others request sensor data with this quality of service.
  Reader<Cloud> reader(participant_, sensor_msgs_msg_dds__PointCloud2__desc, "rt/skin/arm/points", false, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  EXPECT_EQ(reader.user_data(), "typehash=RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5;");
  for (int module = 0; module < 8; ++module) bridge.add(sample_of(module, 1));
  for (std::uint32_t number = 2; number < 29; ++number) bridge.add(sample_of(0, number));
  EXPECT_EQ(bridge.published().points, 10U);  // There are 27 · 36.9 ms at 10 Hz, and the first.
  std::size_t clouds = 0;
  const auto compare = [&](const Cloud& cloud) {
    ++clouds;
    EXPECT_STREQ(cloud.header.frame_id, "skin_arm");
    ASSERT_EQ(cloud.width, 96U);
    ASSERT_EQ(cloud.data._length, 96U * cloud.point_step);
    ASSERT_EQ(cloud.fields._length, 10U);
    EXPECT_STREQ(cloud.fields._buffer[2].name, "z");
    const auto poses = design::taxels_of(design_.layout.modules[5], design::wiring_of(design_)[5].routed.rotation);
    float xyz[3];
    std::memcpy(xyz, cloud.data._buffer + (5 * 12 + 3) * cloud.point_step, sizeof xyz);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(static_cast<double>(xyz[axis]) * 1000.0, poses[3].position_mm[axis], 1e-3);
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(compare), clouds >= 10; })) << clouds;
}

TEST_F(BridgeTest, who_comes_late_still_gets_layout_and_transform) {
  const design::Design design = test::with_gaps(design_);
  const Bridge bridge(*domain_, design, options(), kStart_ns);
  Reader<Layout> layout(participant_, triskin_msgs_msg_dds__SkinLayout__desc, "rt/skin/arm/layout", true, true);
  Reader<Transforms> transforms(participant_, tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true, true);
  EXPECT_TRUE(wait_until([&] {
    return layout.take([&](const Layout& l) {
      EXPECT_EQ(l.design_id, design.design_id);
      EXPECT_EQ(l.position._length, 8U * 36U);
      EXPECT_EQ(l.patch._buffer[4], 2);  // the number of its controller; without gaps it is 1
      EXPECT_EQ(l.module_._length, 8U);
      EXPECT_EQ(l.module_._buffer[5], 12U);  // its number; without gaps it is 5
    }) == 1;
  }));
  EXPECT_TRUE(wait_until([&] {
    return transforms.take([](const Transforms& t) {
      ASSERT_EQ(t.transforms._length, 1U);
      EXPECT_STREQ(t.transforms._buffer[0].header.frame_id, "base_link");
      EXPECT_STREQ(t.transforms._buffer[0].child_frame_id, "skin_arm");
      EXPECT_EQ(t.transforms._buffer[0].transform.translation.y, 0.2);
      EXPECT_EQ(t.transforms._buffer[0].transform.rotation.z, 1.0);
    }) == 1;
  }));
}

TEST_F(BridgeTest, contacts_and_diagnostics_are_read) {
  Bridge bridge(*domain_, design_, options(), kStart_ns);
  Reader<Contacts> contacts(participant_, triskin_msgs_msg_dds__Contacts__desc, "rt/skin/arm/contacts", true, false);
  Reader<Diagnostics> diagnostics(participant_, diagnostic_msgs_msg_dds__DiagnosticArray__desc, "rt/diagnostics", true,
                                  false);
  ASSERT_TRUE(wait_until([&] { return contacts.matched() && diagnostics.matched() && bridge.readers() == 2; }));
  const std::vector<recording::PressedTaxel> taxels{
      {layout::ModuleId{5}, layout::TaxelIndex{3}, 6000.0, {10.0, 20.0, 30.0}, {0.0, 0.0, 1.0}},
      {layout::ModuleId{5}, layout::TaxelIndex{4}, 2000.0, {18.0, 20.0, 30.0}, {0.0, 0.0, 1.0}}};
  const auto pressed = recording::gather_contacts(taxels, 390.0);
  bridge.add_contacts({}, kStart_ns);  // There was no contact before.
  bridge.add_contacts(pressed, kStart_ns);
  bridge.add_contacts({}, kStart_ns + 1);
  bridge.add_contacts({}, kStart_ns + 2);
  EXPECT_EQ(bridge.published().contacts, 2U);
  const std::vector<Diagnosis> parts{
      {Diagnosis::Level::kWarn, "skin arm: patch 0", "3 lost", "controller 1", {{"lost", "3"}}}};
  bridge.add_diagnostics(parts, kStart_ns);
  std::vector<std::size_t> sizes;
  EXPECT_TRUE(wait_until([&] {
    contacts.take([&](const Contacts& c) {
      sizes.push_back(c.contacts._length);
      EXPECT_STREQ(c.force_unit, "counts");
      if (c.contacts._length == 0) return;
      const auto& contact = c.contacts._buffer[0];
      EXPECT_EQ(contact.position.x, 0.012);  // The mean is (6 · 10 + 2 · 18) / 8.
      EXPECT_EQ(contact.position.z, 0.03);
      EXPECT_EQ(contact.normal.z, 1.0);
      EXPECT_EQ(contact.force, 8000.0);
      EXPECT_DOUBLE_EQ(contact.area, 78e-6);
      ASSERT_EQ(contact.taxel._length, 2U);
      EXPECT_EQ(contact.module_._buffer[0], 5U);
      EXPECT_EQ(contact.taxel._buffer[0], 3);
      EXPECT_FLOAT_EQ(contact.taxel_position._buffer[3], 0.018F);
      EXPECT_FLOAT_EQ(contact.taxel_normal._buffer[5], 1.0F);
      EXPECT_FLOAT_EQ(contact.change._buffer[0], 6000.0F);
    });
    return sizes.size() == 2;
  }));
  EXPECT_EQ(sizes, (std::vector<std::size_t>{1, 0}));
  EXPECT_TRUE(wait_until([&] {
    return diagnostics.take([](const Diagnostics& d) {
      ASSERT_EQ(d.status._length, 1U);
      EXPECT_EQ(d.status._buffer[0].level, 1);
      EXPECT_STREQ(d.status._buffer[0].message, "3 lost");
      EXPECT_STREQ(d.status._buffer[0].values._buffer[0].value, "3");
    }) == 1;
  }));
}

TEST_F(BridgeTest, a_second_publisher_of_the_part_is_noticed_and_its_end_too) {
  const Bridge first(*domain_, design_, options(), kStart_ns);
  EXPECT_EQ(first.other_publishers(), 0);
  {
    const auto other_domain = join_loopback(domain_id_);
    BridgeOptions leg = options();
    leg.part = "leg";
    const Bridge other_part(*other_domain, design_, leg, kStart_ns);
    const Bridge same_part(*other_domain, design_, options(), kStart_ns);
    EXPECT_TRUE(wait_until([&] { return first.other_publishers() == 1; }));
    EXPECT_TRUE(wait_until([&] { return same_part.other_publishers() == 1; }));
    EXPECT_EQ(other_part.other_publishers(), 0);
  }
  EXPECT_TRUE(wait_until([&] { return first.other_publishers() == 0; }));
}

// Each bus of a robot has a thread, and all of them look for other publishers in the same moment at the start.
TEST_F(BridgeTest, buses_use_the_domain_at_the_same_time) {
  constexpr int kBuses = 8, kStarts = 20;
  for (int start = 0; start < kStarts; ++start) {
    const auto domain = join_loopback(domain_id_);
    std::barrier begin(kBuses);
    std::vector<std::string> failures(kBuses);
    {
      std::vector<std::jthread> buses;
      for (int b = 0; b < kBuses; ++b) {
        buses.emplace_back([&, b] {
          begin.arrive_and_wait();
          try {
            for (int look = 0; look < 5; ++look) {
              if (domain->other_writers("/skin/nobody") != 0) failures[static_cast<std::size_t>(b)] = "a writer";
            }
          } catch (const DeviceError& e) {
            failures[static_cast<std::size_t>(b)] = e.what();
          }
        });
      }
    }
    EXPECT_EQ(failures, std::vector<std::string>(kBuses)) << "start " << start;
  }
}

// A simulation in the process could run a hundred times as fast as the skin that it simulates, but two seconds of it
// must take two seconds. The lower bound holds on the slowest machine.
TEST_F(BridgeTest, the_command_is_paced_as_the_skin_is) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("bridge_pace." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  design::write_design(folder / "d.json", design_);
  const std::string program = "XDG_STATE_HOME='" + (folder / "state").string() + "' '" + test::program_file() + "' ";
  const std::string design = "'" + (folder / "d.json").string() + "' --link sim ";
  ASSERT_EQ(std::system((program + "flash " + design + ">/dev/null").c_str()), 0);
  const auto start = std::chrono::steady_clock::now();
  (void)!std::system((program + "bridge " + design + "--seconds 2 --domain " + std::to_string(domain_id_) +
                      " --json >'" + (folder / "out").string() + "'")
                         .c_str());
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1900));
  EXPECT_NE(triskin::read_file(folder / "out").find("\"other_publishers\":0"), std::string::npos);
  std::filesystem::remove_all(folder);
}

// On a bus that is too slow, the samples that the reader misses are those that the stream reports as lost.
TEST_F(BridgeTest, losses_at_the_reader_are_those_that_are_told) {
  hardware::Scene scene;
  scene.design = design_;
  scene.effects.bus_bit_rate = 80'000;
  scene.effects.bus_data_bit_rate = 80'000;
  hardware::SimLink link(std::move(scene));
  session::Bus bus(link);
  (void)deploy::flash(bus, design_);
  Bridge bridge(*domain_, design_, options(0.0), kStart_ns);
  Reader<Raw> reader(participant_, triskin_msgs_msg_dds__RawFrame__desc, "rt/skin/arm/raw", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  warm_up(bridge, reader);
  const session::StreamReport told = stream_overloaded(bus, design_, bridge, 6'000'000, kStart_ns);
  ASSERT_GT(told.total.lost(), 100U);
  std::map<std::uint32_t, std::set<std::uint32_t>> seen;  // The sample numbers are grouped by module.
  std::size_t received = 0;
  const auto count = [&](const Raw& raw) {
    for (std::uint32_t k = 0; k < raw.module_._length; ++k) {
      EXPECT_TRUE(seen[raw.module_._buffer[k]].insert(raw.sample).second) << "twice";
      ++received;
    }
  };
  EXPECT_TRUE(wait_until([&] { return reader.take(count), received >= told.total.received; }));
  EXPECT_EQ(received, told.total.received);
  std::uint64_t gaps = 0;
  for (const auto& [module, numbers] : seen) gaps += *numbers.rbegin() - *numbers.begin() + 1 - numbers.size();
  // The reader cannot know what was lost before the first and behind the last sample of a module, which is a few for
  // each.
  EXPECT_LE(gaps, told.total.lost());
  EXPECT_GE(gaps + 8 * 8, told.total.lost());
  EXPECT_EQ(told.total.expected - received, told.total.lost());
}

TEST(RosTypes, hashes_are_those_of_the_definitions) {
  std::string text;
  for (const RosType* t : all_types())
    text += std::string(t->message.name) + " " + std::string(t->hash) + "\n" + std::string(t->message.definition) +
            "@@@@\n";
  const auto file = std::filesystem::temp_directory_path() / ("types." + std::to_string(::getpid()));
  write_file_atomically(file, text);
  EXPECT_EQ(
      std::system(
          ("python3 '" + test::source_folder() + "/tests/output/bridge/type_hash.py' '" + file.string() + "'").c_str()),
      0);
  std::filesystem::remove(file);
}

std::string msg_file(const std::string& name) {
  return read_file(std::filesystem::path(test::source_folder()) / "host/output/bridge/ros/triskin_msgs/msg" /
                   (name + ".msg"));
}

// ROS nodes build a package with the same messages.
TEST(RosTypes, messages_of_the_package_are_those_of_the_program) {
  for (const RosType* t : {&kRaw, &kLayout, &kContacts}) {
    const std::string name(t->message.name.substr(t->message.name.rfind('/') + 1));
    const std::string definition(t->message.definition);
    EXPECT_EQ(msg_file(name), definition.substr(0, definition.find("=====")));
  }
  const std::string readers(recording::kReadersType.definition);  // This type occurs only in recordings.
  EXPECT_EQ(msg_file("Readers"), readers.substr(0, readers.find("=====")));
  const std::string all(kContacts.message.definition), head = "MSG: triskin_msgs/Contact\n";
  const std::size_t first = all.find(head) + head.size();
  EXPECT_EQ(msg_file("Contact"), all.substr(first, all.find("=====", first) - first));
}

TEST(RosTypes, names_are_those_of_ROS) {
  EXPECT_EQ(dds_name("sensor_msgs/msg/PointCloud2"), "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_EQ(part_name("left arm-2"), "left_arm_2_4148deb5");
  EXPECT_EQ(part_name("2nd"), "p2nd");
}

}  // namespace
}  // namespace triskin::bridge
