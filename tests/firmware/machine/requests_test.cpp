// SPDX-License-Identifier: GPL-3.0-or-later
// Sends diagnostic requests beside the full stream of sixteen modules.
#include <random>

#include "sampling_bench.hpp"

namespace triskin::machine {
namespace {

class Requests : public Sampling, public ::testing::WithParamInterface<bool> {};

TEST_P(Requests, AreAnsweredAtAnyMomentOfTheStream) {
  on_posix = GetParam();
  start(16, {wire::Decimation::k64, 1});
  const std::vector<std::vector<std::uint8_t>> asked{
      {0x22, 0xFD, 0x03}, {0x22, 0xFD, 0x10}, {0x19, 0x02, 0xFF}, {0x31, 0x01, 0x02, 0x02}, {0x31, 0x03, 0x02, 0x02}};
  std::mt19937 random(5);
  for (int k = 0; k < 600; ++k) {
    run_for(random() % 3000);
    const auto& q = asked[random() % asked.size()];
    const auto answer = request(q);
    ASSERT_GE(answer.size(), 2U) << "request " << k;
    EXPECT_EQ(answer[0], q[0] + 0x40) << "request " << k;
    EXPECT_EQ(answer[1], q[1]) << "request " << k;
  }
  if (!on_posix) expect_no_violation();
}

INSTANTIATE_TEST_SUITE_P(Boards, Requests, ::testing::Bool(),
                         [](const auto& tested) { return std::string(tested.param ? "posix" : "machine"); });

}  // namespace
}  // namespace triskin::machine
