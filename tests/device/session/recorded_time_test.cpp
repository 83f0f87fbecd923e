// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the time of a sample in a recording, and recordings of 0.1, which have none.
#include <gtest/gtest.h>

#include <vector>

#include "triskin/recording/messages.hpp"

namespace triskin::session {
namespace {

constexpr std::uint64_t kFirst_ns = 1'700'000'000'123'456'000;

std::vector<recording::ModuleSample> frame() {
  std::vector<recording::ModuleSample> samples(4);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].module = layout::ModuleId{k};
    samples[k].link_time_us = 900 + k;
    samples[k].sample.module = static_cast<std::uint8_t>(k);
    samples[k].sample.sample = 7;
    samples[k].sample.device_time_us = 5'000 - 300 * k;  // Lines are not read in the order of the frame.
    samples[k].sampled_ns = kFirst_ns - 300'000 * k;
    samples[k].error_us = 850;
  }
  return samples;
}

TEST(RecordedTime, comes_back_with_its_bound) {
  EXPECT_EQ(recording::decode_raw(recording::encode_raw(frame())), frame());
}

}  // namespace
}  // namespace triskin::session
