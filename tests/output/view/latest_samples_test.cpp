// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/latest_samples.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "triskin/view/frame_track.hpp"

namespace triskin::test {
namespace {

using view::LatestSamples;

view::PressureSample sample_of(double below_rest_counts) {
  view::PressureSample sample{wire::ModuleState::kOk, layout::kAllTaxels, {}};
  sample.below_rest_counts.fill(below_rest_counts);
  return sample;
}

std::uint64_t le(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t k = size; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

int change(const std::string& frame, std::size_t record, std::size_t taxel) {
  const std::size_t at = LatestSamples::kHeaderBytes + record * LatestSamples::kRecordBytes + 8 + 2 * taxel;
  return static_cast<std::int16_t>(le(frame, at, 2));
}

TEST(LatestSamples, sends_each_module_once_after_it_changed) {
  LatestSamples skin(3);
  std::uint64_t seen = 0;
  EXPECT_TRUE(skin.frame_since(seen).empty());
  skin.add(layout::SkinModule{0}, sample_of(10), 1'000'000);
  skin.add(layout::SkinModule{2}, sample_of(10), 1'250'000);
  const std::string frame = skin.frame_since(seen);
  ASSERT_EQ(frame.size(), LatestSamples::kHeaderBytes + 2 * LatestSamples::kRecordBytes);
  EXPECT_EQ(le(frame, 2, 2), 2U);
  EXPECT_EQ(std::bit_cast<double>(le(frame, 8, 8)), 1250.0);
  EXPECT_EQ(le(frame, 16, 2), 0U);
  EXPECT_EQ(le(frame, 22, 2), 250U);  // The unit is ms older than the newest.
  EXPECT_EQ(le(frame, 48, 2), 2U);
  EXPECT_TRUE(skin.frame_since(seen).empty());
  skin.add(layout::SkinModule{1}, sample_of(10), 1'300'000);
  EXPECT_EQ(le(skin.frame_since(seen), 16, 2), 1U);
}

TEST(LatestSamples, pressure_is_below_rest_to_the_nearest_count) {
  LatestSamples skin(1);
  std::uint64_t seen = 0;
  skin.add(layout::SkinModule{0}, sample_of(210.4), 0);
  EXPECT_EQ(change(skin.frame_since(seen), 0, 3), -210);
  skin.add(layout::SkinModule{0}, sample_of(-200.0), 0);
  EXPECT_EQ(change(skin.frame_since(seen), 0, 3), 200);
}

TEST(LatestSamples, holds_changes_within_16_bits) {
  LatestSamples skin(1);
  std::uint64_t seen = 0;
  skin.add(layout::SkinModule{0}, sample_of(-65'535), 0);
  EXPECT_EQ(change(skin.frame_since(seen), 0, 0), 32767);
}

TEST(LatestSamples, ignores_modules_that_the_design_lacks) {
  LatestSamples skin(2);
  std::uint64_t seen = 0;
  skin.add(layout::SkinModule{2}, sample_of(1), 0);
  skin.add(layout::SkinModule::none(), sample_of(1), 0);
  EXPECT_TRUE(skin.frame_since(seen).empty());
}

// Two modules send every 20 ms for 100 ms: the samples at 0 and 20 ms make the first frame, those at 40 and 60 the
// second.
TEST(ViewFrameTrack, gathers_the_samples_of_33_ms_into_a_frame) {
  view::FrameTrack track(2, 10'000);
  for (int k = 0; k < 6; ++k) {
    for (int module = 0; module < 2; ++module)
      track.add(layout::SkinModule{module}, sample_of(100.0 + k), 5'000'000 + 20'000 * k);
  }
  const std::string bytes = track.finish();
  std::vector<double> times_ms;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t size = le(bytes, at, 4);
    ASSERT_EQ(size, LatestSamples::kHeaderBytes + 2 * LatestSamples::kRecordBytes);
    times_ms.push_back(std::bit_cast<double>(le(bytes, at + 4 + 8, 8)));
    at += 4 + size;
  }
  EXPECT_EQ(at, bytes.size());
  EXPECT_EQ(times_ms, (std::vector<double>{20, 60, 100}));
  EXPECT_EQ(change(bytes.substr(at - LatestSamples::kHeaderBytes - 2 * LatestSamples::kRecordBytes), 1, 3), -105);
  EXPECT_FALSE(track.is_cut());
}

// One module sends every 20 ms for 300 ms and is touched from 100 ms until 220 ms. Frames end at 20, 60, 100 … ms.
// Contacts are asked behind the first frame and then behind each that is at least 100 ms later, and once at the end;
// they are written where there are any or were any before.
TEST(ViewFrameTrack, has_the_contacts_at_the_time_of_their_frame) {
  std::int64_t taken_us = 0;
  view::FrameTrack track(1, 10'000, [&] {
    std::vector<LatestSamples::Contact> contacts;
    if (taken_us >= 100'000 && taken_us < 220'000)
      contacts.push_back({.taxels = {3}, .position_mm = {1, 2, 3}, .change_counts = static_cast<double>(taken_us)});
    return contacts;
  });
  for (std::int64_t time_us = 0; time_us <= 300'000; time_us += 20'000) {
    track.advance_to(time_us);
    taken_us = time_us;
    track.add(layout::SkinModule{0}, sample_of(100.0), time_us);
  }
  const std::string bytes = track.finish();
  std::vector<std::pair<double, std::string>> told;
  double frame_ms = -1.0;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = le(bytes, at, 4);
    const double time_ms = std::bit_cast<double>(le(bytes, at + 4 + 8, 8));
    if (le(bytes, at + 4, 1) == LatestSamples::kContactsKind) {
      EXPECT_EQ(time_ms, frame_ms) << "contacts stand behind their frame";
      const auto entry = nlohmann::json::parse(bytes.substr(at + 4 + LatestSamples::kHeaderBytes, size - 16));
      told.emplace_back(time_ms, entry["contacts"].empty() ? "" : entry["contacts"][0]["change_counts"].dump());
    }
    frame_ms = time_ms;
    at += 4 + size;
  }
  EXPECT_EQ(told, (std::vector<std::pair<double, std::string>>{{140, "140000.0"}, {260, ""}}));
}

TEST(ViewFrameTrack, drops_what_exceeds_its_limit) {
  view::FrameTrack track(1, 120);  // A frame takes 4 + 16 + 32 bytes.
  for (int k = 0; k < 10; ++k) track.add(layout::SkinModule{0}, sample_of(10), 40'000 * k);
  EXPECT_EQ(track.finish().size(), 104U);
  EXPECT_TRUE(track.is_cut());
  EXPECT_TRUE(view::FrameTrack(1, 100).finish().empty());
}

}  // namespace
}  // namespace triskin::test
