// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/reading_schedule.hpp"

#include <algorithm>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

namespace {

// Returns the end of another chip's sequence that is nearest to the end of this one's.
std::uint64_t end_near(const SequenceClock& clock, const SequenceClock& other) {
  const std::uint64_t end = clock.end_us(), period = other.period_us();
  std::uint64_t other_end = other.end_us();
  while (other_end + period / 2 < end) other_end += period;
  while (other_end > end + period / 2) other_end -= period;
  return other_end;
}

std::uint64_t end_distance(const SequenceClock& clock, const SequenceClock& other) {
  const std::uint64_t end = clock.end_us(), other_end = end_near(clock, other);
  return other_end > end ? other_end - end : end - other_end;
}

}  // namespace

void ReadingSchedule::Plan::clock_changed() {
  open_us = clock.read_us();
  close_us = clock.last_start_us();
  end_us = clock.end_us();
  uncertain = clock.uncertain();
}

void ReadingSchedule::begin(std::size_t chips, std::uint32_t nominal_us, std::uint8_t every,
                            wire::SamplingTiming timing, std::uint32_t tolerance_percent) {
  by_timer_ = timing == wire::SamplingTiming::kTimer;
  count_ = chips;
  nominal_us_ = nominal_us;
  tolerance_percent_ = tolerance_percent;
  every_ = every;
}

void ReadingSchedule::replace_from(std::size_t first, std::size_t chips) {
  for (std::size_t k = first; k < plans_.size(); ++k) plans_[k] = {};
  count_ = chips;
}

void ReadingSchedule::plan_transaction(std::size_t chip, std::uint64_t at_us, std::uint64_t length_us) {
  plans_[chip].transaction_us = at_us;
  plans_[chip].transaction_length_us = length_us;
}

void ReadingSchedule::cancel_transaction(std::size_t chip) {
  plans_[chip].transaction_us = kNever_us;
}

void ReadingSchedule::start(std::size_t chip, std::uint64_t at_us, wire::Latching latching) {
  Plan& plan = plans_[chip];
  plan = Plan{};
  plan.running = true;
  // The first sequence of the slowest converter is over then.
  if (by_timer_) return set_timer(plan, at_us + nominal_us_ / 100 * (100 + tolerance_percent_ + 1));
  plan.clear_wanted = true;
  plan.clock.start(at_us, nominal_us_, latching, tolerance_percent_);
  plan.clock_changed();
}

// Plans a reading at `at_us`, which is missed if the next one becomes due before its end.
void ReadingSchedule::set_timer(Plan& plan, std::uint64_t at_us) const {
  plan.open_us = plan.end_us = at_us;
  plan.close_us = at_us + nominal_us_ - kBurst_us;
}

void ReadingSchedule::set_latching(std::size_t chip, wire::Latching latching) {
  if (by_timer_) return;
  plans_[chip].clock.set_latching(latching);
  plans_[chip].clock_changed();
}

void ReadingSchedule::stop(std::size_t chip) {
  Plan& plan = plans_[chip];
  plan.running = plan.clear_wanted = plan.restart_wanted = false;
  plan.status_us = 0;
}

void ReadingSchedule::take_up(std::size_t chip) {
  plans_[chip].running = true;
  cancel_transaction(chip);
}

void ReadingSchedule::forget_status(std::size_t chip) {
  plans_[chip].clear_wanted = false;
  plans_[chip].status_us = 0;
}

std::uint64_t ReadingSchedule::reading_us(const Plan& plan) {
  return plan.running ? plan.open_us : kNever_us;
}

// Returns the time for other transfers between readings.
std::uint64_t ReadingSchedule::other_us(const Plan& plan) const {
  if (plan.transaction_us != kNever_us) return plan.transaction_us;
  if (plan.restart_wanted) return plan.restart_us;
  if (plan.clear_wanted) return plan.clock.began_us();
  return plan.status_us != 0 ? refine_start_us(plan) : kNever_us;
}

std::uint64_t ReadingSchedule::other_length_us(const Plan& plan) {
  return plan.transaction_us != kNever_us ? plan.transaction_length_us : kShort_us;
}

ReadingSchedule::Action ReadingSchedule::other_action(const Plan& plan) {
  if (plan.transaction_us != kNever_us) return Action::kTransaction;
  return plan.restart_wanted ? Action::kRestart : Action::kStatus;
}

// A transfer of the status has 58 bits: two bytes for the register's address, a repeated start, then two bytes. The
// chip samples the status when the high byte is sent, ten bits before the end. Slow edges of SCL lengthen all bits.
std::uint32_t ReadingSchedule::after_status_us() const {
  constexpr std::uint32_t kBits = 58, kBitsAfter = 10;
  return (status_us_ == 0 ? kFastestStatus_us : status_us_) * kBitsAfter / kBits;
}

std::uint64_t ReadingSchedule::refine_start_us(const Plan& plan) const {
  const std::uint32_t length_us = status_us_ == 0 ? kFastestStatus_us : status_us_;
  return plan.clock.stage_end_us(plan.refine_stage) - (length_us - after_status_us());
}

// A later status would say little; the end of the next stage serves as well.
std::uint64_t ReadingSchedule::last_refine_us(const Plan& plan) const {
  constexpr std::uint64_t kLate_us = 30;
  return refine_start_us(plan) + kLate_us + plan.clock.stage_doubt_us(plan.refine_stage) / 8;
}

// Chooses the next stage whose end the status can show. The stage before it must also end after the present reading of
// the status, which proves that the chip converts.
void ReadingSchedule::plan_refinement(Plan& plan) {
  constexpr std::uint64_t kApart_us = 50;
  while (++plan.refine_stage < ad7147::kStages) {
    const int before = plan.refine_stage - 1;
    if (plan.clock.stage_end_us(before) > plan.status_us + plan.clock.stage_doubt_us(before) / 2 + kApart_us) return;
  }
  plan.status_us = 0;
}

std::uint64_t ReadingSchedule::next_reading_us() const {
  std::uint64_t next = kNever_us;
  for (const Plan& plan : plans()) next = std::min(next, reading_us(plan));
  return next;
}

std::uint64_t ReadingSchedule::next_us(std::uint64_t now_us) const {
  const std::uint64_t reading = next_reading_us();
  std::uint64_t next = reading;
  for (const Plan& plan : plans()) {
    const std::uint64_t other = other_us(plan);
    if (other == kNever_us) continue;
    const std::uint64_t start = std::max(other, now_us);
    if (start + other_length_us(plan) <= reading)
      next = std::min(next, start);
    else if (plan.status_us != 0)
      next = std::min(next, last_refine_us(plan) + 1);
  }
  return next;
}

ReadingSchedule::Due ReadingSchedule::due(std::uint64_t now_us) {
  for (std::size_t k = 0; k < count_; ++k) {
    pass_missed(plans_[k], now_us);
    while (plans_[k].status_us != 0 && now_us > last_refine_us(plans_[k])) plan_refinement(plans_[k]);
  }
  const Due reading = due_reading(now_us);
  if (reading.action == Action::kNothing) return due_other(now_us);
  plans_[reading.chip].status_us = 0;
  return reading;
}

// Returns the due reading whose sequence ends first.
ReadingSchedule::Due ReadingSchedule::due_reading(std::uint64_t now_us) const {
  Due first;
  std::uint64_t first_end_us = kNever_us;
  for (std::size_t k = 0; k < count_; ++k) {
    if (reading_us(plans_[k]) > now_us || plans_[k].end_us >= first_end_us) continue;
    first_end_us = plans_[k].end_us;
    first = {Action::kRead, k};
  }
  return first;
}

// Returns another transfer if no reading becomes due before its end.
ReadingSchedule::Due ReadingSchedule::due_other(std::uint64_t now_us) const {
  const std::uint64_t next_reading = next_reading_us();
  for (std::size_t k = 0; k < count_; ++k) {
    if (other_us(plans_[k]) > now_us || now_us + other_length_us(plans_[k]) > next_reading) continue;
    return {other_action(plans_[k]), k};
  }
  return {};
}

// A sequence whose results can no longer be read consistently is lost.
void ReadingSchedule::pass_missed(Plan& plan, std::uint64_t now_us) const {
  if (!plan.running) return;
  while (now_us > plan.close_us) {
    plan.status_us = 0;
    if (plan.to_pass == 0) {
      plan.to_pass = every_;
      ++plan.missed;
    }
    advance(plan);
  }
  if (plan.restart_wanted || !plan.uncertain) return;  // The window has passed, so it is no longer read.
  plan.restart_wanted = true;
  plan.clear_wanted = false;
  plan.restart_us = now_us;
}

// Moves on to the sequence to be sampled, or the one before it if the period is not known well enough.
void ReadingSchedule::advance(Plan& plan) const {
  if (by_timer_) {
    const std::uint32_t passed = std::max(plan.to_pass, std::uint32_t{1});
    plan.to_pass = 0;
    return set_timer(plan, plan.open_us + std::uint64_t{passed} * nominal_us_);
  }
  plan.passed = plan.clock.may_pass(std::max(plan.to_pass, std::uint32_t{1}));
  plan.to_pass -= std::min(plan.to_pass, plan.passed);
  plan.clock.next(plan.passed);
  plan.clock_changed();
}

// When the next results could not be read in their window, or the prediction is doubtful, the chip restarts a little
// later. This loses no results, and the new start is known exactly.
std::optional<std::uint64_t> ReadingSchedule::read(std::size_t chip, std::uint64_t now_us) {
  Plan& plan = plans_[chip];
  std::optional<std::uint64_t> sampled;
  if (plan.to_pass == 0) {
    sampled = by_timer_ ? now_us : plan.end_us;
    plan.to_pass = every_;
  }
  advance(plan);
  if (by_timer_) return sampled;
  plan.clear_wanted = plan.clock.refinement_wanted();
  plan.restart_wanted = would_miss(plan) || plan.uncertain;
  if (!plan.restart_wanted) return sampled;
  plan.clear_wanted = false;
  plan.restart_us = restart_moment_us(plan, now_us);
  return sampled;
}

void ReadingSchedule::restarted(std::size_t chip, std::uint64_t ended_us) {
  Plan& plan = plans_[chip];
  plan.restart_wanted = false;
  plan.status_us = 0;
  if (!plan.running) return;  // The chip was stopped in the meantime.
  plan.clock.restart(ended_us);
  plan.clock_changed();
  plan.to_pass += plan.passed - 1;
  if (plan.to_pass > 0) advance(plan);
  plan.clear_wanted = plan.clock.refinement_wanted();
}

void ReadingSchedule::failed(std::size_t chip) {
  Plan& plan = plans_[chip];
  plan.clear_wanted = plan.restart_wanted = false;
  plan.status_us = 0;
}

// The first reading clears the status of earlier sequences; each one after it may refine the clock.
void ReadingSchedule::status_read(std::size_t chip, std::uint16_t status, std::uint64_t ended_us,
                                  std::uint32_t length_us) {
  Plan& plan = plans_[chip];
  if (!plan.running) return;  // The chip was stopped in the meantime.
  status_us_ = status_us_ == 0 ? length_us : std::min(status_us_, length_us);
  const std::uint64_t sampled_us = ended_us - after_status_us();
  if (plan.clear_wanted) {
    plan.clear_wanted = false;
    plan.refine_stage = 0;
    plan.status_us = sampled_us;
    plan_refinement(plan);
  } else if (plan.status_us != 0) {
    plan.status_us = sampled_us;
    refine(plan, status);
  }
}

void ReadingSchedule::refine(Plan& plan, std::uint16_t status) {
  const int stage = plan.refine_stage;
  const unsigned before_and_this = status >> (stage - 1) & 3U;
  if ((before_and_this & 1U) == 0) {  // The chip does not convert, which reading back its configuration will reveal.
    plan.status_us = 0;
    return;
  }
  plan.clock.refine(plan.status_us, stage, (before_and_this & 2U) != 0);
  plan.clock_changed();
  if (plan.clock.refinement_wanted()) return plan_refinement(plan);
  plan.status_us = 0;
}

// Returns true if the earlier readings, in the order in which the sequences end, leave this chip's next one too late.
bool ReadingSchedule::would_miss(const Plan& plan) const {
  const std::uint64_t end = plan.end_us, early = end - std::min(end, plan.open_us);
  std::array<std::uint64_t, kChips> ends{};
  std::size_t count = 0;
  for (const Plan& other : plans()) {
    if (&other == &plan || !other.running) continue;
    const std::uint64_t e = end_near(plan.clock, other.clock);
    if (e > end) continue;
    // We insert in order because the library's sort is recursive, and the stack needs a bound.
    std::size_t at = count++;
    for (; at > 0 && ends[at - 1] > e; --at) ends[at] = ends[at - 1];
    ends[at] = e;
  }
  std::uint64_t free_us = 0;
  for (const std::uint64_t e : std::span(ends).first(count)) free_us = std::max(free_us, e - early) + kBurst_us;
  return free_us > plan.close_us;
}

// Returns the next moment, within a sequence, from which this chip's end is far from those of the line's other chips.
// Their clocks differ, so ends that are near will soon meet again. If there is no such moment, the one that is farthest
// is returned.
std::uint64_t ReadingSchedule::restart_moment_us(const Plan& plan, std::uint64_t now_us) const {
  constexpr std::uint64_t kApart_us = 200, kFar_us = 2 * kBurst_us;
  std::uint64_t best_us = now_us, best_distance_us = 0;
  SequenceClock tried = plan.clock;
  for (std::uint64_t at_us = now_us; at_us < now_us + plan.clock.period_us(); at_us += kApart_us) {
    tried.restart(at_us);
    std::uint64_t distance_us = kFar_us;
    for (const Plan& other : plans()) {
      if (&other != &plan && other.running) distance_us = std::min(distance_us, end_distance(tried, other.clock));
    }
    if (distance_us <= best_distance_us) continue;
    best_us = at_us;
    best_distance_us = distance_us;
    if (distance_us == kFar_us) break;
  }
  return best_us;
}

}  // namespace triskin::fw
