// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/clock_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace triskin::session {
namespace {

constexpr double kWindow_s = 20.0, kBucket_s = 0.25;
constexpr double kBack_s = 0.5;            // Frames of one controller overtake each other by less than this.
constexpr double kResolution_us = 1.0;     // Both clocks are read in whole µs.
constexpr double kFar_us = 1e9;            // The large value (1,000 s) stands for "no answer has bounded it".
constexpr double kInternal_ppm = 20'000;   // A microcontroller without quartz has this tolerance.
constexpr double kWander_ppm_per_s = 0.1;  // between two changes of a rate
constexpr double kHostSlew_ppm =
    500.0;  // A time service slews the host's clock by at most this (adjtimex(2), MAXFREQ).
constexpr int kPatience = 2;
constexpr double kSecond_us = 1e6;

double since(std::uint64_t origin_us, std::uint64_t us) {
  return static_cast<double>(static_cast<std::int64_t>(us - origin_us));
}

}  // namespace

double ClockFilter::wander_us(double seconds) const {
  return 0.5 * kWander_ppm_per_s * seconds * seconds;
}

ClockFilter::Fact ClockFilter::fact(std::uint64_t device_us, double link_us) const {
  const double device = since(device_origin_us_, device_us);
  return {device / kSecond_us, link_us - device};
}

void ClockFilter::forget() {
  started_ = false;
  before_.clear();
  after_.clear();
  polygon_.clear();
  best_ = {};
}

// If the clock went back, the controller has restarted.
void ClockFilter::begin(std::uint64_t device_us, std::uint64_t link_us) {
  if (started_ && since(device_origin_us_, device_us) / kSecond_us + kBack_s < newest_s_) {
    forget();
    ++restarts_;
  }
  if (started_) return;
  started_ = true;
  device_origin_us_ = device_us;
  link_origin_us_ = link_us;
  newest_s_ = reference_s_ = 0.0;
}

void ClockFilter::arrived(std::uint64_t device_us, std::uint64_t link_us) {
  begin(device_us, link_us);
  note(fact(device_us, since(link_origin_us_, link_us)));
}

// Keeps the tightest fact of each quarter second; a fact that does not cut the polygon changes nothing.
void ClockFilter::note(const Fact& before) {
  newest_s_ = std::max(newest_s_, before.device_s);
  if (before_.empty() || before.device_s >= bucket_s_ + kBucket_s) {
    before_.push_back(before);
    bucket_s_ = before.device_s;
    return rebuild();
  }
  const auto tightness = [this](const Fact& f) { return f.difference_us - best_.drift_ppm * f.device_s; };
  if (tightness(before) < tightness(before_.back())) before_.back() = before;
  if (before.difference_us + kResolution_us >= range(before.device_s).max_us) return;
  clip(before, 1.0, 0.0);
  if (polygon_.empty()) return contradicted();
  choose();
}

// Both facts are kept in any case: if earlier facts belong to another clock, they will contradict these.
void ClockFilter::exchanged(std::uint64_t sent_us, std::uint64_t device_us, std::uint64_t received_us) {
  begin(device_us, received_us);
  before_.push_back(fact(device_us, since(link_origin_us_, received_us)));
  after_.push_back(fact(device_us, since(link_origin_us_, sent_us)));
  bucket_s_ = before_.back().device_s;
  newest_s_ = std::max(newest_s_, bucket_s_);
  rebuild();
}

// Old facts are removed. The last answer stays however old it is, but clock drift weakens it.
void ClockFilter::rebuild() {
  while (before_.size() > 1 && before_.front().device_s < newest_s_ - kWindow_s) before_.pop_front();
  while (after_.size() > 1 && after_.front().device_s < newest_s_ - kWindow_s) after_.pop_front();
  build(-std::numeric_limits<double>::infinity());
  if (polygon_.empty()) return contradicted();
  choose();
}

void ClockFilter::build(double since_s) {
  reference_s_ = newest_s_;
  const double middle = before_.empty() ? after_.back().difference_us : before_.back().difference_us;
  const double low = middle - kFar_us, high = middle + kFar_us, d = max_drift_ppm_ + kHostSlew_ppm;
  polygon_ = {{low, -d}, {high, -d}, {high, d}, {low, d}};
  for (const auto& [facts, sign] : {std::pair{&before_, 1.0}, std::pair{&after_, -1.0}}) {
    for (const Fact& f : *facts) {
      if (f.device_s >= since_s) clip(f, sign, wander_us(newest_s_ - f.device_s));
    }
  }
}

// Clips the polygon (Sutherland and Hodgman): keeps the lines below (sign 1) or above (−1) the fact.
void ClockFilter::clip(const Fact& fact, double sign, double slack_us) {
  const double at_s = fact.device_s - reference_s_;
  const auto room = [&](const Line& l) {
    return sign * (fact.difference_us - l.offset_us - l.drift_ppm * at_s) + slack_us + kResolution_us;
  };
  std::vector<Line> kept;
  kept.reserve(polygon_.size() + 1);
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    const Line &p = polygon_[k], &q = polygon_[(k + 1) % polygon_.size()];
    const double room_p = room(p), room_q = room(q);
    if (room_p >= 0.0) kept.push_back(p);
    if ((room_p >= 0.0) == (room_q >= 0.0)) continue;
    const double share = room_p / (room_p - room_q);
    kept.push_back({std::lerp(p.offset_us, q.offset_us, share), std::lerp(p.drift_ppm, q.drift_ppm, share)});
  }
  polygon_ = std::move(kept);
}

// Chooses the latest line in the middle of the facts: of the lines below all of them, the one with the smallest sum of
// distances.
void ClockFilter::choose() {
  double middle_s = 0.0;
  for (const Fact& f : before_) middle_s += (f.device_s - reference_s_) / static_cast<double>(before_.size());
  const auto height = [middle_s](const Line& l) { return l.offset_us + l.drift_ppm * middle_s; };
  double top = -std::numeric_limits<double>::infinity();
  for (const Line& l : polygon_) top = std::max(top, height(l));
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Line& l : polygon_) {
    if (height(l) < top - kResolution_us) continue;
    least = std::min(least, l.drift_ppm);
    most = std::max(most, l.drift_ppm);
  }
  const double drift = 0.5 * (least + most);
  best_ = {top - drift * middle_s, drift};
}

// No line explains all facts, so the older ones are dropped first. If the rest still contradicts itself, the clock is a
// different one.
void ClockFilter::contradicted() {
  ++restarts_;
  // A step of the host's rate contradicts the lines. Only what contradicts the certain bounds as well is another clock.
  if (const Range r = certain(newest_s_); r.min_us > r.max_us && ++contradictions_ > kPatience)
    max_drift_ppm_ = kInternal_ppm;
  for (double span_s = kWindow_s / 2; span_s > 0.0; span_s = span_s > kBucket_s ? span_s / 2 : 0.0) {
    const double since_s = newest_s_ - span_s;
    build(since_s);
    if (polygon_.empty()) continue;
    std::erase_if(before_, [=](const Fact& f) { return f.device_s < since_s; });
    std::erase_if(after_, [=](const Fact& f) { return f.device_s < since_s; });
    return choose();
  }
  if (before_.size() > 1) before_.erase(before_.begin(), before_.end() - 1);
  after_.clear();
  build(-std::numeric_limits<double>::infinity());
  choose();
}

ClockFilter::Range ClockFilter::range(double device_s) const {
  Range r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Line& l : polygon_) {
    const double v = l.offset_us + l.drift_ppm * (device_s - reference_s_);
    r.min_us = std::min(r.min_us, v);
    r.max_us = std::max(r.max_us, v);
  }
  return r;
}

// Each fact holds at any other time, less what the clocks may have moved apart since, whatever their rates did.
ClockFilter::Range ClockFilter::certain(double device_s) const {
  const double rate_ppm = max_drift_ppm_ + kHostSlew_ppm;
  Range r{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const Fact& f : before_)
    r.max_us = std::min(r.max_us, f.difference_us + rate_ppm * std::abs(device_s - f.device_s));
  for (const Fact& f : after_)
    r.min_us = std::max(r.min_us, f.difference_us - rate_ppm * std::abs(device_s - f.device_s));
  r.max_us += kResolution_us;
  return r;
}

LinkTime ClockFilter::at(std::uint64_t device_us) const {
  return at(device_us, std::numeric_limits<std::uint64_t>::max());
}

LinkTime ClockFilter::at(std::uint64_t device_us, std::uint64_t link_us) const {
  if (!started_) return {link_us == std::numeric_limits<std::uint64_t>::max() ? 0 : link_us, LinkTime::kUnbounded};
  const double device = since(device_origin_us_, device_us), at_s = device / kSecond_us;
  Range r = certain(at_s);
  if (link_us != std::numeric_limits<std::uint64_t>::max())
    r.max_us = std::min(r.max_us, since(link_origin_us_, link_us) - device);
  const bool possible = r.min_us <= r.max_us + kResolution_us;
  double best = best_.offset_us + best_.drift_ppm * (at_s - reference_s_);
  best = possible ? std::min(std::max(best, r.min_us), r.max_us) : r.max_us;
  const double error = std::max(r.max_us - best, best - r.min_us) + kResolution_us;
  // Added as integers, because doubles of more than 2^53 µs have no single microseconds.
  const std::int64_t later_us = std::llround(device + best);
  const std::uint64_t back_us = later_us < 0 ? static_cast<std::uint64_t>(-later_us) : 0;
  const std::uint64_t us = later_us < 0 ? link_origin_us_ - std::min(link_origin_us_, back_us)
                                        : link_origin_us_ + static_cast<std::uint64_t>(later_us);
  if (!bounded() || !possible || error >= static_cast<double>(LinkTime::kUnbounded)) return {us, LinkTime::kUnbounded};
  return {us, static_cast<std::uint32_t>(std::ceil(error))};
}

}  // namespace triskin::session
