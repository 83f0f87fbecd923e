// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace triskin::device {

/// When something happened, by the clock of the link.
struct LinkTime {
  static constexpr std::uint32_t kUnbounded = UINT32_MAX;
  std::uint64_t link_us = 0;
  /// The true time lies within ± this; kUnbounded means that nothing bounds it.
  std::uint32_t error_us = kUnbounded;
  bool operator==(const LinkTime&) const = default;
};

/// Tells the time of the link at which a controller did something, from the time that its own clock said. It knows two
/// kinds of facts and assumes of the ways only that nothing arrives before it was sent:
/// - a frame that came at `link_us` was made before that;
/// - what a controller answers was made after the request was sent.
/// All straight lines (offset, drift) that agree with the facts of the last 20 s are a polygon; it bounds the error.
/// The best guess among them is the latest line: no way is shorter than its shortest time, and of many frames some come
/// that fast. A delay that every frame has cannot be seen, so it is in the bound: the answer to a request bounds it,
/// and without one the error has no bound. Clocks run evenly but for 0.1 ppm/s; by quartz within 200 ppm, and a
/// controller that contradicts this is taken for one on its internal oscillator (20,000 ppm). Memory: 4 kB. Cost:
/// constant a sample, some 10 µs four times a second. Threads: one.
class ClockFilter {
 public:
  /// Something that the controller dated `device_us` was here at `link_us`. A controller whose clock went back has
  /// started anew, and everything before is forgotten.
  void arrived(std::uint64_t device_us, std::uint64_t link_us);
  /// The controller dated `device_us` its answer to a request sent at `sent_us`; the answer was here at `received_us`.
  void exchanged(std::uint64_t sent_us, std::uint64_t device_us, std::uint64_t received_us);

  /// Time of the link at `device_us` of the controller, at best within the last 20 s. Unbounded while nothing is known.
  [[nodiscard]] LinkTime at(std::uint64_t device_us) const;
  /// Like at(), for an event whose frame arrived at `link_us`: the result is not later than that.
  [[nodiscard]] LinkTime at(std::uint64_t device_us, std::uint64_t link_us) const;
  /// How much faster the clock of the link runs than the controller's, parts per million; 0 while nothing is known.
  [[nodiscard]] double drift_ppm() const { return best_.drift_ppm; }
  /// True: an answer bounds the error.
  [[nodiscard]] bool bounded() const { return !after_.empty(); }
  /// How often something was forgotten because the clock went back, or contradicted what was known.
  [[nodiscard]] int restarts() const { return restarts_; }

 private:
  // A line: time of the link − time of the controller = offset at reference_s_, and its change, µs/s.
  struct Line {
    double offset_us = 0.0, drift_ppm = 0.0;
  };
  // A fact: at `device_s` the difference is at most, or at least, `difference_us`.
  struct Fact {
    double device_s = 0.0, difference_us = 0.0;
  };
  struct Range {
    double min_us = 0.0, max_us = 0.0;
  };
  void forget();
  void begin(std::uint64_t device_us, std::uint64_t link_us);
  [[nodiscard]] Fact fact(std::uint64_t device_us, double link_us) const;
  void note(const Fact& before);
  void rebuild();
  void build(double since_s);
  void clip(const Fact& fact, double sign, double slack_us);
  void choose();
  void contradicted();
  [[nodiscard]] Range range(double device_s) const;
  [[nodiscard]] double wander_us(double seconds) const;

  double max_drift_ppm_ = 200.0;
  bool started_ = false;
  std::uint64_t device_origin_us_ = 0, link_origin_us_ = 0;
  double newest_s_ = 0.0, reference_s_ = 0.0, bucket_s_ = 0.0;
  std::deque<Fact> before_;    // The tightest of each quarter second: the difference is at most this.
  std::deque<Fact> after_;     // Answers: the difference is at least this.
  std::vector<Line> polygon_;  // Corners of the region that is possible.
  Line best_;
  int restarts_ = 0, contradictions_ = 0;
};

}  // namespace triskin::device
