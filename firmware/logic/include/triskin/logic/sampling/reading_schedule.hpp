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

/// Divides the time of one line among its chips: it says which transfer is due and learns how each one ended. Each chip
/// is read once per sequence, in the window in which its twelve results belong together (SequenceClock). All other work
/// on the line starts only if it ends before the next window opens: transactions of the caller (identify, configure,
/// verify), restarts of a sequence, and readings of the status, which refine the clocks. When the sequences of three
/// chips of a line would end at the same time, so that one could not be read in its window, one of them restarts its
/// sequence a little later.
///
/// With SamplingTiming::kTimer, each chip is simply read once per nominal sequence, whatever it converts then. This
/// mode allows a comparison with installed boards.
///
/// The class makes no transfers and knows no clock except `now_us`. Chips are numbered from 0 in the caller's order;
/// a chip that is neither started nor has a transaction asks for nothing. Among readings the earliest end has
/// priority, among other transfers the lowest number. Cost: no call except read() visits more than the four chips;
/// read() tries up to 185 moments for a restart.
class ReadingSchedule {
 public:
  static constexpr std::size_t kChips = layout::kAddressesPerLine;
  static constexpr std::uint64_t kNever_us = UINT64_MAX;
  /// A reading takes this long, including the time until the next transfer can start.
  static constexpr std::uint64_t kBurst_us = 800;
  static constexpr std::uint64_t kShort_us =
      250;  ///< A restart, a reading of the status, or a transaction of a few bytes takes this long.
  static constexpr std::uint64_t kLong_us = 500;  ///< A transaction that writes the setup of a stage takes this long.

  enum class Action : std::uint8_t {
    kNothing,
    kRead,         ///< The caller reads twelve results and then calls read(), or nothing when they do not count.
    kTransaction,  ///< The caller's transaction stays planned until it is changed or cancelled.
    kRestart,      ///< The caller restarts the sequence and then calls restarted().
    kStatus,       ///< The caller reads the stage-complete status and then calls status_read().
  };
  struct Due {
    Action action = Action::kNothing;
    std::size_t chip = 0;
    bool operator==(const Due&) const = default;
  };

  /// Must be called first: sequences of `chips` chips last `nominal_us` ± `tolerance_percent`, and each `every`-th
  /// (1..255) is sampled.
  void begin(std::size_t chips, std::uint32_t nominal_us, std::uint8_t every,
             wire::SamplingTiming timing = wire::SamplingTiming::kTracked,
             std::uint32_t tolerance_percent = SequenceClock::kTolerance_percent);

  /// Sets the number of chips to `chips`; those from `first` on are new to the schedule and have no running
  /// transfer.
  void replace_from(std::size_t first, std::size_t chips);

  /// Plans a transfer of the caller's for the chip, not before `at_us`, that takes at most `length_us`. A new plan
  /// replaces the last one.
  void plan_transaction(std::size_t chip, std::uint64_t at_us, std::uint64_t length_us);
  /// Returns when the transaction of the chip may begin; kNever_us means that it has none.
  [[nodiscard]] std::uint64_t transaction_us(std::size_t chip) const { return plans_[chip].transaction_us; }
  /// Cancels the chip's transaction.
  void cancel_transaction(std::size_t chip);

  /// Notes that the chip's first sequence was started at `at_us`; its oscillator is unknown, and no transaction is
  /// left. `latching` says when it shows its results.
  void start(std::size_t chip, std::uint64_t at_us, wire::Latching latching = wire::Latching::kEachStage);
  /// Sets when the chip shows its results, which was not known at its start.
  void set_latching(std::size_t chip, wire::Latching latching);
  /// Stops reading the chip.
  void stop(std::size_t chip);
  /// Reads a stopped chip again, as if it had continued to convert.
  void take_up(std::size_t chip);
  /// Restarts the refinement, because the status of a chip may have been read by others, or not at all.
  void forget_status(std::size_t chip);

  /// Returns what must begin at `now_us`. Sequences whose window has closed are skipped; see take_missed().
  [[nodiscard]] Due due(std::uint64_t now_us);
  /// Returns when the result of due() will change after `now_us` if nothing is started before.
  [[nodiscard]] std::uint64_t next_us(std::uint64_t now_us) const;

  /// Returns true if a burst that ended on the line at `ended_us` was over before its results could belong to two
  /// sequences. An undisturbed burst lasts `burst_us`; one that a chip has slowed down, or that was repeated, may take
  /// too long.
  [[nodiscard]] bool in_time(std::size_t chip, std::uint64_t ended_us, std::uint32_t burst_us) const {
    constexpr std::uint64_t kLatency_us = 20;
    return by_timer_ || ended_us <= plans_[chip].close_us + burst_us + kLatency_us;
  }
  /// Notes that the results of the present sequence are available at `now_us`. Returns when it ended in µs (by a
  /// timer: now), or nothing if it is not one that is sampled.
  [[nodiscard]] std::optional<std::uint64_t> read(std::size_t chip, std::uint64_t now_us);
  /// An undisturbed transfer of the status lasts this long when SCL has no rise time.
  static constexpr std::uint32_t kFastestStatus_us = 145;
  /// Notes that the transfer of the status ended on the line at `ended_us`, `length_us` after its start; bit s of
  /// `status` says that stage s was converted since the last one. The shortest transfer so far tells how slow the edges
  /// of this line are.
  void status_read(std::size_t chip, std::uint16_t status, std::uint64_t ended_us,
                   std::uint32_t length_us = kFastestStatus_us);
  /// Notes that the transfer that restarts the sequence ended on the line at `ended_us`.
  void restarted(std::size_t chip, std::uint64_t ended_us);
  /// Notes that a restart or a reading of the status was not acknowledged; the next reading will tell more.
  void failed(std::size_t chip);
  /// Returns how many sequences that had to be sampled passed unread since the last call.
  [[nodiscard]] std::uint32_t take_missed(std::size_t chip) { return std::exchange(plans_[chip].missed, 0U); }

 private:
  struct Plan {
    bool running = false;  // The chip is read once per sequence.
    bool clear_wanted = false, restart_wanted = false;
    int refine_stage = 0;       // The next status should show the end of this stage.
    std::uint32_t to_pass = 0;  // So many sequences pass before the one to be sampled; 0 means the present one.
    std::uint32_t passed = 1;   // The clock advanced by so many sequences.
    std::uint32_t missed = 0;   // take_missed() returns this number.
    // The status of this sequence was read, and so cleared, at this time; 0 means not yet.
    std::uint64_t status_us = 0;
    std::uint64_t restart_us = 0;  // The sequence must be restarted at this time.
    std::uint64_t transaction_us = kNever_us, transaction_length_us = 0;
    SequenceClock clock;
    // These times come from the clock and are computed once after each change, because due() compares them all the time
    // and the clock has to divide.
    // The window of the reading opens and closes at the first two times, and the present sequence ends at the third.
    std::uint64_t open_us = 0, close_us = 0, end_us = 0;
    bool uncertain = false;
    void clock_changed();
  };

  [[nodiscard]] static std::uint64_t reading_us(const Plan& plan);
  [[nodiscard]] std::uint64_t other_us(const Plan& plan) const;
  [[nodiscard]] static std::uint64_t other_length_us(const Plan& plan);
  [[nodiscard]] static Action other_action(const Plan& plan);
  [[nodiscard]] std::uint64_t refine_start_us(const Plan& plan) const;
  [[nodiscard]] std::uint64_t last_refine_us(const Plan& plan) const;
  [[nodiscard]] std::uint32_t after_status_us() const;
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

  std::array<Plan, kChips> plans_{};
  std::size_t count_ = 0;
  std::uint32_t nominal_us_ = 0, tolerance_percent_ = SequenceClock::kTolerance_percent;
  std::uint32_t status_us_ = 0;  // The shortest transfer of a status so far took this long; 0 means none.
  std::uint8_t every_ = 1;
  bool by_timer_ = false;
};

}  // namespace triskin::fw
