// SPDX-License-Identifier: GPL-3.0-or-later
// A controller that is simulated by its table must send what the firmware sends.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "frames.hpp"
#include "support/strip_design.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::test {
namespace {

hardware::Scene by_table(hardware::Scene scene) {
  scene.levels.assign(scene.design.patches.size(), hardware::ControllerLevel::kTable);
  return scene;
}

struct Difference {
  std::size_t samples = 0;
  std::size_t exchanged = 0;  ///< So many frames have another place in the order.
  /// Frames that changed places arrived at most this far apart, with the firmware or by the table.
  std::uint64_t most_exchanged_us = 0;
  std::uint64_t most_device_us = 0, most_arrival_us = 0;
  /// Samples of one controller that changed places were taken at most this far apart, by the nearer of both levels.
  std::uint64_t most_exchanged_device_us = 0;
};

using ById = std::map<std::uint32_t, std::vector<SentFrame>>;

ById by_id(const std::vector<SentFrame>& frames) {
  ById map;
  for (const SentFrame& f : frames) map[f.frame.id].push_back(f);
  return map;
}

std::uint64_t apart(std::uint64_t a, std::uint64_t b) {
  return a > b ? a - b : b - a;
}

// Returns how far apart, in `frames`, two frames arrive at most that change places in the order of `order`.
std::uint64_t most_exchanged(const std::vector<SentFrame>& order, const std::vector<SentFrame>& frames) {
  const ById others = by_id(frames);
  std::map<std::uint32_t, std::size_t> passed;
  std::uint64_t latest_us = 0, most_us = 0;
  for (const SentFrame& f : order) {
    const std::uint64_t at_us = others.at(f.frame.id).at(passed[f.frame.id]++).at_us;
    latest_us = std::max(latest_us, at_us);
    most_us = std::max(most_us, latest_us - at_us);
  }
  return most_us;
}

struct Sent {
  std::uint32_t id;
  std::uint64_t device_us;
};
using Key = std::pair<unsigned, int>;  // A node and a line of its patch, or −1 for all.

// Samples in the order in which they were sent.
std::map<Key, std::vector<Sent>> orders(const std::vector<SentFrame>& frames, const design::Design& design) {
  std::map<unsigned, layout::PatchImage> tables;
  for (const layout::PatchIndex p : design::patches_here(design)) {
    const layout::PatchImage image = session::image_of(design, p);
    tables.emplace(static_cast<unsigned>(image.node_address), image);
  }
  std::map<Key, std::vector<Sent>> sent;
  for (const SentFrame& f : frames) {
    const auto sample = wire::decode_full(f.frame);
    if (!sample) continue;
    const int line = tables.at(sample->node_address).modules.at(sample->module).line;
    sent[{sample->node_address, line}].push_back({f.frame.id, sample->device_time_us});
    sent[{sample->node_address, -1}].push_back({f.frame.id, sample->device_time_us});
  }
  return sent;
}

// Chips of a line are read one after the other, so that their samples keep their order whatever an estimate says.
void compare_orders(const std::vector<SentFrame>& firmware, const std::vector<SentFrame>& table,
                    const design::Design& design, Difference& found) {
  constexpr std::size_t kNear = 2 * layout::kMaxModules;
  const auto a = orders(firmware, design), b = orders(table, design);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [key, list] : a) {
    if (key.second >= 0) {
      EXPECT_TRUE(std::ranges::equal(list, b.at(key), {}, &Sent::id, &Sent::id))
          << "node " << key.first << ", line " << key.second;
      continue;
    }
    const std::vector<Sent>& other = b.at(key);
    std::map<std::uint32_t, std::vector<std::size_t>> places;
    for (std::size_t k = 0; k < other.size(); ++k) places[other[k].id].push_back(k);
    std::map<std::uint32_t, std::size_t> passed;
    std::vector<std::size_t> place;  // of each sample of the firmware in the order of the table
    for (const Sent& s : list) place.push_back(places.at(s.id).at(passed[s.id]++));
    for (std::size_t k = 0; k < place.size(); ++k) {
      for (std::size_t before = k < kNear ? 0 : k - kNear; before < k; ++before) {
        if (place[before] < place[k]) continue;
        const auto least = std::min(apart(list[before].device_us, list[k].device_us),
                                    apart(other[place[before]].device_us, other[place[k]].device_us));
        found.most_exchanged_device_us = std::max(found.most_exchanged_device_us, least);
      }
      EXPECT_LE(apart(place[k], k), kNear);
    }
  }
}

// Frames with one identifier must be equal but for their two times, and keep their order.
void compare(const std::vector<SentFrame>& firmware, const std::vector<SentFrame>& table, Difference& found) {
  ASSERT_EQ(firmware.size(), table.size());
  for (std::size_t k = 0; k < firmware.size(); ++k) found.exchanged += firmware[k].frame.id != table[k].frame.id;
  const ById a = by_id(firmware), b = by_id(table);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [id, list] : a) {
    ASSERT_TRUE(b.contains(id)) << id;
    const std::vector<SentFrame>& other = b.at(id);
    ASSERT_EQ(list.size(), other.size()) << id;
    for (std::size_t k = 0; k < list.size(); ++k) {
      found.most_arrival_us = std::max(found.most_arrival_us, apart(list[k].at_us, other[k].at_us));
      auto x = wire::decode_full(list[k].frame), y = wire::decode_full(other[k].frame);
      if (!x || !y) {
        ASSERT_EQ(list[k].frame.payload().size(), other[k].frame.payload().size());
        continue;  // The account of the stream has the time of its answer.
      }
      ++found.samples;
      found.most_device_us = std::max(found.most_device_us, apart(x->device_time_us, y->device_time_us));
      x->device_time_us = y->device_time_us = 0;
      ASSERT_TRUE(*x == *y) << fmt::format("module {}, sample {} and {}", x->module, x->sample, y->sample);
    }
  }
  found.most_exchanged_us = std::max(most_exchanged(firmware, table), most_exchanged(table, firmware));
}

class Levels : public testing::TestWithParam<std::string> {};

TEST_P(Levels, send_equal_frames) {
  hardware::Scene scene = hardware::read_scene(scene_folder() / (GetParam() + ".json"));
  // The firmware restarts a sequence when three chips of a line drift towards each other; the table does not.
  scene.effects.converters.drawn = false;
  Difference found;
  const bool brown_out = scene.effects.pads.supply.has_value();
  const auto firmware = frames_of(scene, 12.0), table = frames_of(by_table(scene), 12.0);
  compare(firmware, table, found);
  compare_orders(firmware, table, scene.design, found);
  fmt::print(
      "{}: {} samples, device times differ by at most {} us, arrivals by {} us, {} exchanged over {} us, of one "
      "controller over {} us\n",
      GetParam(), found.samples, found.most_device_us, found.most_arrival_us, found.exchanged, found.most_exchanged_us,
      found.most_exchanged_device_us);
  EXPECT_GT(found.samples, 5000U);
  // The firmware refines its estimates of the chips' clocks to 34 us, the table continues the last one.
  constexpr std::uint64_t kEstimate_us = 40;
  EXPECT_LE(found.most_device_us, kEstimate_us);
  // That a chip falls silent, the firmware sees at the beginning of a reading and the table at its end.
  EXPECT_LE(found.most_arrival_us, brown_out ? 300U : 100U);
  // Chips of one controller that are on different lines end their sequences together now and then: their set-up leaves
  // them a phase, which a set-up that is shorter by a register moves. If a sample is before another one by one level
  // and behind it by the other, the two distances add up to the two errors of the estimates, and the nearer is one at
  // most.
  // A module that falls silent has the time of the reading's beginning or of its end, 800 us later at most.
  EXPECT_LE(found.most_exchanged_device_us, brown_out ? 800U : kEstimate_us);
  // Arrivals of different controllers: the farther distance is both errors at most.
  EXPECT_LE(found.most_exchanged_us, brown_out ? 300U : 2 * kEstimate_us);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Levels, testing::ValuesIn(ready_scenes()));

// Without a table the firmware would run all the time, and the test above would show nothing.
TEST(TableLevel, takes_over_and_wakes_the_firmware_for_a_request) {
  hardware::Scene scene;
  scene.design = strip(6);
  scene.effects.converters.drawn = false;
  scene.levels = {hardware::ControllerLevel::kTable};
  const auto transferred = [](scenario::RunningSkin& skin) {
    return skin.hardware().skin().line(layout::PatchIndex{0}, 0).bytes();
  };
  scenario::RunningSkin skin(scene, {}, {});
  skin.run_until(3'000'000);
  const std::uint64_t before = transferred(skin);
  skin.run_until(6'000'000);
  EXPECT_EQ(transferred(skin), before);
  skin.hardware().send(wire::who_is_there());
  skin.run_until(6'010'000);
  // Four chips of line 0 are read 27 times a second, each time with at least 28 bytes.
  EXPECT_GT(transferred(skin), before + std::uint64_t{3} * 4 * 26 * 28);
  skin.run_until(9'000'000);
  const std::uint64_t again = transferred(skin);
  skin.run_until(10'000'000);
  EXPECT_EQ(transferred(skin), again);
}

// A limited bus delays frames, and the same must wait, be paced and counted.
TEST(TableLevel, sends_equal_frames_on_a_limited_bus) {
  hardware::Scene scene;
  scene.design = strip(48);
  scene.effects.converters.drawn = false;
  scene.effects.noise_counts = 3.0;
  scene.effects.bus_bit_rate = 1'000'000;
  scene.effects.bus_data_bit_rate = 2'000'000;
  Difference found;
  compare(frames_of(scene, 6.0), frames_of(by_table(scene), 6.0), found);
  EXPECT_GT(found.samples, 5000U);
  EXPECT_LE(found.most_device_us, 40U);
}

}  // namespace
}  // namespace triskin::test
