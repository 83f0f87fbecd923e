// SPDX-License-Identifier: GPL-3.0-or-later
// During a press of ten minutes the report must not change, warm or cold, while the installed skins lose it after half
// a minute.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shared_skin.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/skin/live_monitor.hpp"

namespace triskin::hardware {
namespace {

constexpr std::uint64_t kSecond_us = 1'000'000;

struct Press {
  const char* name;
  double force_n;
  double drift_counts_per_s;  // All taxels drift, as when a skin warms or cools.
};
void PrintTo(const Press& p, std::ostream* out) {
  *out << p.name;
}

class LongPress : public testing::TestWithParam<Press> {};

TEST_P(LongPress, stays_within_two_percent_of_its_value_at_ten_seconds) {
  hardware::Scene scene;
  scene.design = test::strip(2);
  scene.effects.noise_counts = 3.0;
  scene.effects.drift_counts_per_s = GetParam().drift_counts_per_s;
  hardware::SimLink link(std::move(scene));
  session::Bus bus(link);
  deploy::FlashOptions flash_options;
  flash_options.take_over = true;
  (void)deploy::flash(bus, link.skin().scene().design, flash_options);
  bus.listen(bus.now_us() + 3 * kSecond_us);  // The offsets are found by now.

  skin::LiveMonitor monitor(link.skin().scene().design);
  session::Stream stream(bus, link.skin().scene().design, [&](const session::ModuleSample& f) { monitor.add(f); });
  stream.run_until(bus.now_us() + kSecond_us);
  EXPECT_TRUE(monitor.touches().pressed().empty());
  hardware::Contact finger;
  finger.position_mm = hardware::center_of(link.skin().scene().design, layout::ModuleId{0});
  finger.from_us = bus.now_us();
  finger.radius_mm = 8.0;
  finger.force_n = GetParam().force_n;
  const int id = link.skin().skin().press(finger);
  const std::uint64_t begin_us = bus.now_us();
  const auto sum_at = [&](std::uint64_t second) {
    // We take the mean of a second, because noise of a single sample is no loss of the contact.
    double sum = 0.0;
    constexpr int kLooks = 10;
    for (int k = 0; k < kLooks; ++k) {
      stream.run_until(begin_us + second * kSecond_us + static_cast<std::uint64_t>(k) * kSecond_us / kLooks);
      for (const double change : monitor.touches().change(layout::ModuleId{0})) sum += change / kLooks;
    }
    return sum;
  };
  const double at_start = sum_at(10);
  ASSERT_GT(at_start, 100.0);
  EXPECT_FALSE(monitor.touches().pressed().empty());
  double least = at_start, most = at_start;
  for (std::uint64_t second = 20; second <= 600; second += 10) {
    const double sum = sum_at(second);
    least = std::min(least, sum);
    most = std::max(most, sum);
  }
  std::printf("%s: %.0f counts at 10 s, %.2f … %.2f %% of it until 600 s\n", GetParam().name, at_start,
              100.0 * least / at_start, 100.0 * most / at_start);
  // The mean of ten looks at the sum over ten taxels scatters by 3 counts, and so does the value it is compared with.
  constexpr double kScatter_counts = 4.0 * layout::kNoise_counts * std::numbers::sqrt2;
  EXPECT_GE(least, 0.98 * at_start - kScatter_counts);
  EXPECT_LE(most, 1.02 * at_start + kScatter_counts);
  link.skin().release(id);
  stream.run_until(bus.now_us() + kSecond_us);
  EXPECT_TRUE(monitor.touches().pressed().empty()) << "no ghost is left behind";
  stream.finish();
  EXPECT_EQ(stream.lost(), 0U);
  EXPECT_GT(stream.frames(), 29'500U) << "two modules each 36.9 ms, or a tenth longer, for 600 s and more";
}
INSTANTIATE_TEST_SUITE_P(Cases, LongPress,
                         testing::Values(Press{"firm", 2.0, 0.0}, Press{"light", 0.4, 0.0},
                                         Press{"firm_cooling", 2.0, 2.0}, Press{"firm_warming", 2.0, -2.0}),
                         [](const auto& p) { return std::string(p.param.name); });

}  // namespace
}  // namespace triskin::hardware
