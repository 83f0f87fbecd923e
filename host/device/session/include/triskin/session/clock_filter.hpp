// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace triskin::session {

/// The time of an event is given by the clock of the link.
struct LinkTime {
  static constexpr std::uint32_t kUnbounded = UINT32_MAX;
  std::uint64_t link_us = 0;
  /// The true time lies within ± this; kUnbounded means that no bound is known.
  std::uint32_t error_us = kUnbounded;
  bool operator==(const LinkTime&) const = default;
};

/// Converts a time stamp of a controller's own clock to the time of the link. It uses two kinds of facts, and its only
/// assumption about transmission is that nothing arrives before it was sent:
/// - a frame that arrived at `link_us` was made before that;
/// - an answer of a controller was made after the request was sent.
/// The bound follows from these facts alone: each holds at any other time, less what the two clocks can have moved
/// apart since. With quartz they are within 200 ppm, and a time service may slew the host's clock by 500 ppm more, at
/// any moment, so an answer that is a second old bounds the time to within 0.7 ms of its own bound. The estimate
/// assumes more: all straight lines (offset, drift) that agree with the facts of the last 20 s form a polygon, and the
/// best of them is the latest line, since no transmission is faster than its shortest time, and among many frames some
/// come that fast. After a step of the rate the estimate is worse for some seconds; the bound holds. A delay that all
/// frames share is invisible, so the bound includes it: the answer to a request limits it, and without an answer the
/// error has no bound. A controller that contradicts these bounds three times is treated as running on its
/// internal oscillator (20,000 ppm). Memory: 4 kB. Cost: 0.1 µs per sample, some 10 µs four times a second. Threads:
/// one.
class ClockFilter {
 public:
  /// Adds the fact that something with the controller's time `device_us` arrived at `link_us`. If the controller's
  /// clock went back, the controller has restarted, and all earlier facts are discarded.
  void arrived(std::uint64_t device_us, std::uint64_t link_us);
  /// Adds the fact that the controller stamped `device_us` on its answer to a request sent at `sent_us`; the answer
  /// arrived at `received_us`.
  void exchanged(std::uint64_t sent_us, std::uint64_t device_us, std::uint64_t received_us);

  /// Returns the time of the link at `device_us` of the controller; estimates are best within the last 20 s. The error
  /// is unbounded while nothing is known, and when the facts exclude each other.
  [[nodiscard]] LinkTime at(std::uint64_t device_us) const;
  /// Works like at(), for an event whose frame arrived at `link_us`; the result is never later than that.
  [[nodiscard]] LinkTime at(std::uint64_t device_us, std::uint64_t link_us) const;
  /// Returns by how much the clock of the link runs faster than the controller's, in parts per million; 0 while nothing
  /// is known.
  [[nodiscard]] double drift_ppm() const { return best_.drift_ppm; }
  /// Returns true if an answer bounds the error.
  [[nodiscard]] bool bounded() const { return !after_.empty(); }
  /// Counts how often facts were discarded because the clock went back or contradicted them.
  [[nodiscard]] int restarts() const { return restarts_; }

 private:
  // The difference between the time of the link and that of the controller is a line: an offset at reference_s_, and
  // its change in µs/s.
  struct Line {
    double offset_us = 0.0, drift_ppm = 0.0;
  };
  // At `device_s` the difference is at most, or at least, `difference_us`.
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
  [[nodiscard]] Range certain(double device_s) const;
  [[nodiscard]] double wander_us(double seconds) const;

  double max_drift_ppm_ = 200.0;  // of the controller's clock
  bool started_ = false;
  std::uint64_t device_origin_us_ = 0, link_origin_us_ = 0;
  double newest_s_ = 0.0, reference_s_ = 0.0, bucket_s_ = 0.0;
  std::deque<Fact> before_;    // Each entry is the tightest upper bound of the difference within a quarter of a second.
  std::deque<Fact> after_;     // Each answer gives a lower bound of the difference.
  std::vector<Line> polygon_;  // The corners enclose all lines that are still possible.
  Line best_;
  int restarts_ = 0, contradictions_ = 0;
};

}  // namespace triskin::session
