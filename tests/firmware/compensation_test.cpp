// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/compensation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace triskin::fw {
namespace {

using Taxels = Compensation::Taxels;
constexpr bool is_pad(std::size_t t) {
  return t == 6 || t == 10;
}

// Evaluates the formula of compensation.hpp in real numbers, from its text.
struct Reference {
  std::array<double, layout::kTaxelsPerModule> baseline{}, output{}, gain{};
  double pads_at_start = 0.0;
  bool started = false;
  void add(const Taxels& raw) {
    const double pads = (raw[6] + raw[10]) / 2.0;
    if (!started) pads_at_start = pads;
    for (std::size_t t = 0; t < raw.size(); ++t) {
      const double steady = raw[t] - (is_pad(t) ? 0.0 : gain[t] * (pads - pads_at_start));
      if (!started) baseline[t] = steady;
      const double change = steady - baseline[t];
      output[t] = std::clamp(32768.0 + change, 0.0, 65535.0);
      if (std::abs(change) < 20.0 && !is_pad(t)) baseline[t] += change / 1024.0;
    }
    started = true;
  }
};

TEST(Compensation, IsWithinOneCountOfRealNumbers) {
  std::mt19937 random(20261121);
  double worst = 0.0;
  for (int run = 0; run < 40; ++run) {
    Compensation fixed;
    Reference real;
    for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
      const auto gain = static_cast<std::int16_t>(std::uniform_int_distribution<int>(-32768, 32767)(random));
      fixed.set_gain(t, gain);
      real.gain[t] = gain / 16384.0;
    }
    std::normal_distribution<double> noise(0.0, 3.0);
    std::array<double, layout::kTaxelsPerModule> level{};
    for (double& l : level) l = std::uniform_real_distribution<double>(5'000.0, 60'000.0)(random);
    const double warming = std::uniform_real_distribution<double>(-0.5, 0.5)(random);
    double temperature = 0.0, touch = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      temperature += warming;
      if (k % 500 == 0) touch = k % 1000 == 0 ? 0.0 : std::uniform_real_distribution<double>(-8'000.0, 8'000.0)(random);
      Taxels raw{};
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
        const double value = level[t] + temperature + (is_pad(t) ? 0.0 : touch) + noise(random);
        raw[t] = static_cast<std::uint16_t>(std::clamp(std::lround(value), 1L, 65534L));
      }
      fixed.add(raw, layout::kAllTaxels);
      real.add(raw);
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t)
        worst = std::max(worst, std::abs(fixed.output()[t] - real.output[t]));
    }
  }
  std::printf("fixed point against real numbers: %.3f counts at most in 9.6 million outputs\n", worst);
  EXPECT_LE(worst, 1.0);
}

TEST(Compensation, TemperatureThatAllFeelIsTakenAway) {
  Compensation c;
  Taxels raw{};
  raw.fill(30'000);
  c.add(raw, layout::kAllTaxels);
  for (int k = 0; k < 1'000; ++k) {
    for (auto& r : raw) r = static_cast<std::uint16_t>(r + 5);
    c.add(raw, layout::kAllTaxels);
  }
  EXPECT_EQ(c.change(0), 0);
  EXPECT_EQ(c.change(6), 5'000);  // The pads measure the temperature.
  raw[3] = static_cast<std::uint16_t>(raw[3] - 700);
  c.add(raw, layout::kAllTaxels);
  EXPECT_EQ(c.change(3), -700);
}

TEST(Compensation, ByHand) {
  Compensation c;
  c.set_gain(0, 1 << 13);  // The gain is one half.
  Taxels raw{};
  raw.fill(1'000);
  c.add(raw, layout::kAllTaxels);
  raw[6] = 1'100;
  raw[10] = 1'300;  // The mean is 200.
  c.add(raw, layout::kAllTaxels);
  EXPECT_EQ(c.change(0), -100);
  EXPECT_EQ(c.change(1), -200);
  // Only one pad is valid, so it alone counts.
  Compensation d;
  raw.fill(1'000);
  d.add(raw, layout::kAllTaxels);
  raw[6] = 1'100;
  raw[10] = 0;
  d.add(raw, layout::kAllTaxels & ~(1 << 10));
  EXPECT_EQ(d.change(1), -100);
}

TEST(Compensation, WhatThePadsDoNotExplainFadesAndATouchDoesNot) {
  Compensation c;
  Taxels raw{};
  raw.fill(30'000);
  c.add(raw, layout::kAllTaxels);
  raw[2] = 30'015;
  raw[3] = 29'000;
  for (int k = 0; k < 1024; ++k) c.add(raw, layout::kAllTaxels);
  EXPECT_NEAR(c.change(2), 15.0 / std::exp(1.0), 1.0);
  EXPECT_EQ(c.change(3), -1'000);
}

TEST(Compensation, ATaxelThatWasInvalidStartsWithItsFirstReading) {
  Compensation c;
  Taxels raw{};
  raw.fill(30'000);
  raw[5] = 0xFFFF;
  c.add(raw, layout::kAllTaxels & ~(1 << 5));
  raw[5] = 20'000;
  c.add(raw, layout::kAllTaxels);
  EXPECT_EQ(c.change(5), 0);
  raw[5] = 19'500;
  c.add(raw, layout::kAllTaxels);
  EXPECT_EQ(c.change(5), -500);
}

TEST(Compensation, EndsAtTheEndsOfItsRange) {
  Compensation c;
  Taxels raw{};
  raw.fill(60'000);
  c.add(raw, layout::kAllTaxels);
  raw[0] = 100;
  c.add(raw, layout::kAllTaxels);
  EXPECT_EQ(c.output()[0], 0);
}

}  // namespace
}  // namespace triskin::fw
