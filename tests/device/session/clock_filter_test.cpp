// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/clock_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>

namespace triskin::session {
namespace {

constexpr double kSecond_us = 1e6;
constexpr double kAllowed_us = 500.0;  // Issue 22 asks for this after 10 s, with jitter of 1 ms.

std::uint64_t whole(double us) {
  return static_cast<std::uint64_t>(us);
}

// Models a controller whose clock reads start + (time since power-up) · (1 + ppm), and the delay from it to here.
struct Modelled {
  double ppm = 0.0;
  double powered_us = 3e6;                  // The time is by the link's clock.
  double shown_us = 70e6;                   // The controller's own clock shows this at that time.
  double min_us = 100.0;                    // No frame takes less time.
  double jitter_us = 1000.0;                // The jitter is added and uniform.
  std::function<double(double)> more_us{};  // Returns a further delay for frames that are sent at a time.
  [[nodiscard]] std::uint64_t device_us(double link_us) const {
    return whole(shown_us + (link_us - powered_us) * (1.0 + ppm * 1e-6));
  }
};

class Way {
 public:
  Way(const Modelled& model, unsigned seed) : model_(model), random_(seed) {}
  Modelled& model() { return model_; }
  ClockFilter& filter() { return filter_; }

  // Sends samples of 16 modules at 54 Hz from `from_s` to `to_s` and one answer per second; calls `check` for each.
  void play(double from_s, double to_s, const std::function<void(double true_us, const LinkTime&)>& check) {
    for (double t = from_s * kSecond_us; t < to_s * kSecond_us; t += kSecond_us / (54.0 * 16.0)) {
      if (answers && t >= next_answer_us_) {
        const double sent = t, made = delivered(sent), received = std::max(delivered(made), last_us_);
        filter_.exchanged(whole(sent), model_.device_us(made), whole(received));
        last_us_ = received;
        next_answer_us_ = t + kSecond_us;
      }
      // Frames arrive in order, as a controller sends them.
      last_us_ = std::max(last_us_, delivered(t));
      filter_.arrived(model_.device_us(t), whole(last_us_));
      check(t, filter_.at(model_.device_us(t), whole(last_us_)));
    }
  }
  bool answers = true;

 private:
  double delivered(double sent_us) {
    const double jitter = std::uniform_real_distribution<double>(0.0, model_.jitter_us)(random_);
    return sent_us + model_.min_us + jitter + (model_.more_us ? model_.more_us(sent_us) : 0.0);
  }
  Modelled model_;
  std::mt19937 random_;
  ClockFilter filter_;
  double last_us_ = 0.0, next_answer_us_ = 0.0;
};

// Requires that the error is never above its bound, and after `settled_s` within the allowed one.
auto holds(double settled_s, double allowed_us, double* worst_us = nullptr) {
  return [=](double true_us, const LinkTime& time) {
    const double error = std::abs(static_cast<double>(time.link_us) - true_us);
    if (time.error_us != LinkTime::kUnbounded) {
      ASSERT_LE(error, time.error_us + 1.0) << "at " << true_us * 1e-6 << " s";
    }
    if (true_us < settled_s * kSecond_us) return;
    ASSERT_NE(time.error_us, LinkTime::kUnbounded);
    ASSERT_LE(error, allowed_us) << "at " << true_us * 1e-6 << " s";
    if (worst_us != nullptr) *worst_us = std::max(*worst_us, error);
  };
}

// In this case worked by hand the controller shows 1,000 less than the link, and every path takes between 200 and 300.
TEST(ClockFilter, bounds_an_offset_by_a_request_and_its_answer) {
  ClockFilter filter;
  filter.exchanged(10'000, 9'200, 10'500);  // The difference is 800 … 1,300.
  const LinkTime now = filter.at(9'200);
  EXPECT_EQ(now.link_us, 10'501U);  // The result is the latest possible time, with one µs of resolution.
  EXPECT_GE(now.error_us, 501U);
  EXPECT_LE(now.error_us, 504U);
  filter.arrived(9'300, 10'500);  // The difference is at most 1,200.
  EXPECT_NEAR(static_cast<double>(filter.at(9'300).link_us), 10'500.0, 2.0);
  EXPECT_NEAR(filter.at(9'300).error_us, 401.0, 4.0);
}

TEST(ClockFilter, knows_nothing_and_says_so) {
  ClockFilter filter;
  EXPECT_EQ(filter.at(5).error_us, LinkTime::kUnbounded);
  filter.arrived(1'000, 5'000);
  EXPECT_EQ(filter.at(1'000).error_us, LinkTime::kUnbounded) << "samples alone do not bound a delay that all have";
  EXPECT_FALSE(filter.bounded());
}

TEST(ClockFilter, is_within_half_a_millisecond_after_ten_seconds) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    for (const double ppm : {-100.0, 100.0}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(ppm) + " ppm");
      Way run({.ppm = ppm}, seed);
      double worst_us = 0.0;
      run.play(3.0, 23.0, holds(13.0, kAllowed_us, &worst_us));
      EXPECT_NEAR(run.filter().drift_ppm(), -ppm, 20.0);
      EXPECT_EQ(run.filter().restarts(), 0);
      RecordProperty("worst_us", std::to_string(worst_us));
      if (HasFatalFailure()) return;
    }
  }
}

// Frames are repeatedly late by up to 0.3 s and then arrive all at once.
TEST(ClockFilter, bears_bursts) {
  Way run({.ppm = 100.0,
           .more_us = [](double t) { return std::fmod(t, 0.7e6) < 0.3e6 ? 0.3e6 - std::fmod(t, 0.7e6) : 0.0; }},
          5);
  run.play(3.0, 23.0, holds(13.0, kAllowed_us));
}

// A queue that grows for five seconds looks like a slow clock, but the answers and the earlier samples show otherwise.
TEST(ClockFilter, a_delay_that_grows_stays_within_the_bound) {
  Way run({.ppm = -100.0, .more_us = [](double t) { return t > 12e6 && t < 17e6 ? 2e-3 * (t - 12e6) : 0.0; }}, 6);
  run.play(3.0, 25.0, holds(13.0, 2'000.0));
}

// Nobody can see a delay that all frames have: it is in the bound and not in the estimate.
TEST(ClockFilter, a_constant_delay_is_in_the_bound) {
  Way run({.ppm = 20.0, .min_us = 5'000.0}, 7);
  run.play(3.0, 15.0, holds(1e9, 0.0));
  const LinkTime end = run.filter().at(run.model().device_us(15e6));
  EXPECT_GE(end.error_us, 5'000U);
  EXPECT_NEAR(static_cast<double>(end.link_us), 15e6 + 5'000.0, 300.0);
}

TEST(ClockFilter, follows_a_controller_that_starts_anew) {
  Way run({.ppm = 100.0}, 8);
  run.play(3.0, 8.0, holds(1e9, 0.0));
  run.model().powered_us = 9e6;
  run.model().shown_us = 0.0;
  run.play(9.0, 25.0, holds(19.0, kAllowed_us));
  EXPECT_EQ(run.filter().restarts(), 1);
}

// The clock did not go back, so only an answer shows that all samples before it were late by an unknown time.
TEST(ClockFilter, an_answer_uncovers_a_start_that_looks_like_a_delay) {
  Way run({.ppm = 0.0, .shown_us = 0.0}, 9);
  run.play(3.0, 4.0, holds(1e9, 0.0));
  run.model().powered_us = 20e6;
  run.model().shown_us = 1.5e6;
  run.play(20.0, 35.0, [](double, const LinkTime&) {});
  run.play(35.0, 36.0, holds(30.0, kAllowed_us));
  EXPECT_GE(run.filter().restarts(), 1);
}

TEST(ClockFilter, learns_an_internal_oscillator) {
  Way run({.ppm = 9'000.0}, 10);
  run.play(3.0, 8.0, [](double, const LinkTime&) {});
  run.play(8.0, 23.0, holds(18.0, kAllowed_us));
  EXPECT_NEAR(run.filter().drift_ppm(), -9'000.0 / 1.009, 200.0);
}

TEST(ClockFilter, counters_of_32_bit_may_pass_their_end) {
  Way run({.ppm = -100.0, .shown_us = 4294.967296e6 - 5e6}, 11);
  run.play(3.0, 20.0, holds(13.0, kAllowed_us));
}

// The host's clock, as a time service slews it: its rate changes every ten to forty seconds.
class SlewedClock {
 public:
  SlewedClock(double step_ppm, unsigned seed) : step_ppm_(step_ppm), random_(seed) {}
  // `true_us` must not decrease.
  double read(double true_us) {
    while (true_us >= next_us_) {
      shown_us_ += (next_us_ - since_us_) * (1.0 + rate_ppm_ * 1e-6);
      since_us_ = next_us_;
      rate_ppm_ = std::uniform_int_distribution<int>(-1, 1)(random_) * step_ppm_;
      next_us_ += std::uniform_real_distribution<double>(10e6, 40e6)(random_);
    }
    return shown_us_ + (true_us - since_us_) * (1.0 + rate_ppm_ * 1e-6);
  }

 private:
  double step_ppm_, rate_ppm_ = 0.0, shown_us_ = 0.0, since_us_ = 0.0, next_us_ = 30e6;
  std::mt19937 random_;
};

// Ten million samples with TRISKIN_SAMPLES=10000000. A bound that says "unknown" claims nothing, so those are counted.
TEST(ClockFilter, holds_its_bound_while_a_time_service_slews_the_hosts_clock) {
  const char* text = std::getenv("TRISKIN_SAMPLES");
  const std::uint64_t samples = text != nullptr ? std::strtoull(text, nullptr, 10) : 600'000;
  for (const double step_ppm : {50.0, 150.0, 500.0}) {
    for (const double controller_ppm : {-100.0, 100.0}) {
      SlewedClock host(step_ppm, 17);
      Modelled model{.ppm = controller_ppm, .powered_us = 0.0};
      std::mt19937 random(18);
      std::uniform_real_distribution<double> delay_us(100.0, 1'100.0);
      ClockFilter filter;
      std::uint64_t outside = 0, unknown = 0;
      double worst_us = 0.0, mean_bound_us = 0.0, next_answer_us = 0.0, sent_us = 0.0;
      for (std::uint64_t k = 0; k < samples / 6; ++k) {
        const double t = 3e6 + static_cast<double>(k) * kSecond_us / 864.0;
        // The frames of one controller keep their order, and each takes 0.1 to 1.1 ms.
        sent_us = std::max(sent_us, t);
        if (t >= next_answer_us) {
          const double asked = host.read(sent_us), made_us = sent_us + delay_us(random);
          sent_us = made_us + delay_us(random);
          filter.exchanged(whole(asked), model.device_us(made_us), whole(host.read(sent_us)));
          next_answer_us = t + kSecond_us;
          continue;
        }
        const double true_us = host.read(sent_us);
        const std::uint64_t stamp = model.device_us(sent_us);
        sent_us += delay_us(random);
        const auto heard = whole(host.read(sent_us));
        filter.arrived(stamp, heard);
        const LinkTime time = filter.at(stamp, heard);
        const double error = std::abs(static_cast<double>(time.link_us) - true_us);
        if (time.error_us == LinkTime::kUnbounded) {
          ++unknown;
          continue;
        }
        outside += error > time.error_us + 1.0 ? 1 : 0;
        worst_us = std::max(worst_us, error);
        mean_bound_us += time.error_us / static_cast<double>(samples / 6);
      }
      EXPECT_EQ(outside, 0U) << step_ppm << " ppm";
      EXPECT_LT(unknown, samples / 6 / 1000) << step_ppm << " ppm";
      std::printf(
          "steps of %.0f ppm, controller %+.0f ppm, seeds 17, 18: %llu samples, %llu outside, %llu unknown; worst "
          "error %.0f us, mean bound %.0f us\n",
          step_ppm, controller_ppm, static_cast<unsigned long long>(samples / 6),
          static_cast<unsigned long long>(outside), static_cast<unsigned long long>(unknown), worst_us, mean_bound_us);
    }
  }
}

}  // namespace
}  // namespace triskin::session
