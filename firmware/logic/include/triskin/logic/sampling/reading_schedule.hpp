// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/sequence_clock.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::fw {

/// Divides the time of one line among its chips: it says which transfer is due and learns how each one ended. Each
/// chip is read once a sequence, in the window in which its twelve results belong together (SequenceClock). Everything
/// else on the line begins only when no window opens before its end: transactions of the caller (identify, configure,
/// verify), restarts of a sequence, and readings of the status, which refine the clocks. When three chips of a line
/// come to end at the same time, so that one could not be read in its window, one begins its next sequence anew a
/// little later.
///
/// With SamplingTiming::kTimer none of that is done: each chip is read once a nominal sequence, whatever it converts
/// then. That is for comparison with installed boards.
///
/// Pure: it makes no transfer and knows no clock but `now_us`. Stations are numbered from 0 in the order in which the
/// caller keeps them; a station that is neither started nor has an transaction asks for nothing. The earliest end goes
/// first among readings, the lowest number among other transfers. Cost: no call but read() visits more than the four
/// stations; read() tries up to 185 moments for a restart.
class ReadingSchedule {
 public:
  static constexpr std::size_t kStations = layout::kAddressesPerLine;
  static constexpr std::uint64_t kNever_us = UINT64_MAX;
  static constexpr std::uint64_t kBurst_us = 800;  ///< a reading, and until the next transfer can begin
  static constexpr std::uint64_t kShort_us =
      250;                                        ///< a restart, a reading of the status, an transaction of a few bytes
  static constexpr std::uint64_t kLong_us = 500;  ///< an transaction that writes the setup of a stage

  enum class Action : std::uint8_t {
    kNothing,
    kRead,         ///< twelve results: then read(), or nothing when they do not count
    kTransaction,  ///< what the caller planned for the station: it stays planned until it is changed or cancelled
    kRestart,      ///< of the sequence: then restarted()
    kStatus,       ///< the stage-complete status: then status_read()
  };
  struct Due {
    Action action = Action::kNothing;
    std::size_t station = 0;
    bool operator==(const Due&) const = default;
  };

  /// Once, before all else: sequences of `stations` chips last `nominal_us`, and each `every`-th (1..255) is sampled.
  void begin(std::size_t stations, std::uint32_t nominal_us, std::uint8_t every,
             wire::SamplingTiming timing = wire::SamplingTiming::kTracked);

  /// Sets the number of chips to `stations`; those from `first` on are new to the schedule and have no transfer under
  /// way.
  void replace_from(std::size_t first, std::size_t stations);

  /// The station asks for a transfer of the caller's, not before `at_us`, that takes `length_us` at most. One at a
  /// time: the last one counts.
  void plan_transaction(std::size_t station, std::uint64_t at_us, std::uint64_t length_us);
  /// When the transaction of the station may begin; kNever_us: it has none.
  [[nodiscard]] std::uint64_t transaction_us(std::size_t station) const { return plans_[station].transaction_us; }
  /// The station asks for no transaction any more.
  void cancel_transaction(std::size_t station);

  /// The chip's first sequence was started at `at_us`; nothing is known about its oscillator. No transaction is left.
  /// `latching`: when it shows its results.
  void start(std::size_t station, std::uint64_t at_us, wire::Latching latching = wire::Latching::kEachStage);
  /// When the chip shows its results, which was not known at its start.
  void set_latching(std::size_t station, wire::Latching latching);
  /// The chip is not read any more.
  void stop(std::size_t station);
  /// A stopped chip is read again, as if it had gone on converting.
  void take_up(std::size_t station);
  /// The status of a chip may have been read by others, or not at all: refinements begin anew.
  void forget_status(std::size_t station);

  /// What is to begin at `now_us`. Passes over sequences whose window has closed, see take_missed().
  [[nodiscard]] Due due(std::uint64_t now_us);
  /// When due() gives or changes something after `now_us`, if nothing is begun before.
  [[nodiscard]] std::uint64_t next_us(std::uint64_t now_us) const;

  /// A burst that ended on the line at `ended_us` was over before its results could be of two sequences: one that
  /// nobody slows down lasts `burst_us`. One that a chip has slowed down, or that was made again, may not be.
  [[nodiscard]] bool in_time(std::size_t station, std::uint64_t ended_us, std::uint32_t burst_us) const {
    constexpr std::uint64_t kLatency_us = 20;
    return by_timer_ || ended_us <= plans_[station].close_us + burst_us + kLatency_us;
  }
  /// The results of the present sequence stand, at `now_us`. Result: when it ended, µs (by a timer: now); empty: it is
  /// not one that is sampled.
  [[nodiscard]] std::optional<std::uint64_t> read(std::size_t station, std::uint64_t now_us);
  /// The transfer of the status ended on the line at `ended_us`; bit s of `status`: stage s was converted since the
  /// last one.
  void status_read(std::size_t station, std::uint16_t status, std::uint64_t ended_us);
  /// The transfer that restarts the sequence ended on the line at `ended_us`.
  void restarted(std::size_t station, std::uint64_t ended_us);
  /// A restart or a reading of the status was not acknowledged: the next reading tells more.
  void failed(std::size_t station);
  /// Sequences that were to be sampled and came and went unread since this was asked last.
  [[nodiscard]] std::uint32_t take_missed(std::size_t station) { return std::exchange(plans_[station].missed, 0U); }

 private:
  struct Plan {
    bool running = false;  // Read once per sequence.
    bool clear_wanted = false, restart_wanted = false;
    int refine_stage = 0;          // Stage whose end the next status is to show.
    std::uint32_t to_pass = 0;     // Sequences until the one to be sampled; 0: the present one.
    std::uint32_t passed = 1;      // Sequences by which the clock advanced.
    std::uint32_t missed = 0;      // Returned by take_missed().
    std::uint64_t status_us = 0;   // Time at which this sequence's status was read, and so cleared; 0: not yet.
    std::uint64_t restart_us = 0;  // Time at which the sequence is to be restarted.
    std::uint64_t transaction_us = kNever_us, transaction_length_us = 0;
    SequenceClock clock;
    // Times from the clock, computed once after each change: due() compares them all the time, and the clock has to
    // divide.
    std::uint64_t open_us = 0, close_us = 0, end_us = 0;  // Window of the reading, and end of the present sequence.
    bool uncertain = false;
    void clock_changed();
  };

  [[nodiscard]] static std::uint64_t reading_us(const Plan& plan);
  [[nodiscard]] static std::uint64_t other_us(const Plan& plan);
  [[nodiscard]] static std::uint64_t other_length_us(const Plan& plan);
  [[nodiscard]] static Action other_action(const Plan& plan);
  [[nodiscard]] static std::uint64_t refine_start_us(const Plan& plan);
  [[nodiscard]] static std::uint64_t last_refine_us(const Plan& plan);
  [[nodiscard]] std::uint64_t next_reading_us() const;
  [[nodiscard]] Due due_reading(std::uint64_t now_us) const;
  [[nodiscard]] Due due_other(std::uint64_t now_us) const;
  void pass_missed(Plan& plan, std::uint64_t now_us) const;
  static void plan_refinement(Plan& plan);
  static void refine(Plan& plan, std::uint16_t status);
  void advance(Plan& plan) const;
  void set_timer(Plan& plan, std::uint64_t at_us) const;
  [[nodiscard]] bool would_miss(const Plan& plan) const;
  [[nodiscard]] std::uint64_t restart_moment_us(const Plan& plan, std::uint64_t now_us) const;
  [[nodiscard]] std::span<const Plan> plans() const { return {plans_.data(), count_}; }

  std::array<Plan, kStations> plans_{};
  std::size_t count_ = 0;
  std::uint32_t nominal_us_ = 0;
  std::uint8_t every_ = 1;
  bool by_timer_ = false;
};

}  // namespace triskin::fw
