// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampler.hpp"

#include <algorithm>
#include <utility>

namespace triskin::fw {

using wire::ModuleState;

namespace {

constexpr std::uint64_t kAfterStatus_us =
    25;  // from the sampling of the status, as its first byte is read, to the end of the transfer

constexpr bool in_range(std::uint16_t raw) {
  return raw != 0 && raw != 0xFFFF;
}

}  // namespace

void LineSampler::begin(I2cLine& line, std::uint8_t line_index, const layout::PatchImage& table,
                        std::span<ModuleSample> samples, const Sampling& sampling, std::uint64_t now_us) {
  const bool busy = job_ != Job::kIdle && line_ == &line;
  *this = LineSampler{};
  if (busy) job_ = Job::kDrain;  // a transfer of before must end first
  line_ = &line;
  samples_ = samples;
  sampling_ = sampling;
  chip_.set_decimation(sampling.decimation);
  for (std::size_t k = 0; k < table.module_count; ++k) {
    const layout::ModuleRow& row = table.modules[k];
    if (row.line != line_index) continue;
    Slot& slot = slots_[slot_count_++];
    slot.module = static_cast<std::uint8_t>(k);
    slot.address = row.address;
    slot.ready_us = now_us;
  }
}

void LineSampler::request_scan() {
  scan_ = {};
  scan_requested_ = true;
  paused_until_us_ = 0;  // also a line that is left alone
  idle_until_us_ = 0;
}

void LineSampler::request_check() {
  for (Slot& slot : slots()) {
    slot.phase = Phase::kFind;
    slot.single = false;
    slot.ready_us = 0;
    samples_[slot.module].state = ModuleState::kUnknown;
  }
  idle_until_us_ = 0;
}

bool LineSampler::rest() {
  resting_ = true;
  idle_until_us_ = 0;
  return job_ == Job::kIdle;
}

void LineSampler::resume(std::uint64_t now_us) {
  resting_ = stuck_ = false;
  recoveries_in_row_ = 0;
  paused_until_us_ = idle_until_us_ = 0;
  for (Slot& slot : slots()) {
    if (slot.phase == Phase::kFind) slot.ready_us = 0;
    if (slot.phase == Phase::kFind && slot.lost_us != 0 &&
        now_us - slot.lost_us < kRecent_us) {  // the old route was to blame
      slot.phase = Phase::kRun;
      slot.single = true;
    }
    slot.recheck = true;
    slot.clear_wanted = false;
    slot.status_us = 0;
    samples_[slot.module].state = ModuleState::kUnknown;
  }
}

void LineSampler::lose(Slot& slot, std::uint64_t now_us) {
  if (slot.phase == Phase::kRun) slot.lost_us = now_us;
}

bool LineSampler::checked() const {
  return std::ranges::all_of(slots(), [&](const Slot& s) { return samples_[s.module].state != ModuleState::kUnknown; });
}

std::uint64_t LineSampler::next_event_us(std::uint64_t now_us) const {
  if (job_ != Job::kIdle || resting_) return UINT64_MAX;
  return idle_until_us_ == 0 ? now_us : idle_until_us_;
}

// When choose() does something, or drops a look, if nothing is begun before.
std::uint64_t LineSampler::next_choice_us(std::uint64_t now_us) const {
  const std::uint64_t reading = next_reading_us();
  std::uint64_t next = reading;
  for (const Slot& slot : slots()) {
    const std::uint64_t other = other_due_us(slot);
    if (other == UINT64_MAX) continue;
    const std::uint64_t start = std::max(other, now_us);
    if (start + other_length_us(slot) <= reading)
      next = std::min(next, start);
    else if (slot.status_us != 0)
      next = std::min(next, last_look_us(slot) + 1);
  }
  return next;
}

std::uint8_t LineSampler::chip_address() const {
  return static_cast<std::uint8_t>(layout::kFirstCdcAddress +
                                   (job_ == Job::kScan ? scan_address_ : slots_[slot_].address));
}

void LineSampler::step(std::uint64_t now_us) {
  if (job_ == Job::kIdle && now_us < idle_until_us_) return;
  if (job_ != Job::kIdle) {
    const std::optional<Status> done = line_->poll();
    if (!done) return;
    if (!resting_) {
      finish(*done, now_us);
    } else {  // what it brought is asked for again
      scan_requested_ = scan_requested_ || job_ == Job::kScan;
      Slot& slot = slots_[slot_];
      if (job_ != Job::kScan && job_ != Job::kDrain && slot.phase != Phase::kRun) slot.phase = Phase::kFind;
      job_ = Job::kIdle;
    }
  }
  if (job_ != Job::kIdle || resting_) return;
  idle_until_us_ = paused_until_us_;
  if (now_us < paused_until_us_) return;
  paused_until_us_ = 0;
  if (scan_requested_) {
    scan_requested_ = false;
    scan_address_ = 0;
    start_scan_step();
  } else {
    choose(now_us);
    if (job_ == Job::kIdle) idle_until_us_ = next_choice_us(now_us);
  }
}

void LineSampler::start_scan_step() {
  job_ = Job::kScan;
  chip_.begin_identify(*line_, chip_address());
}

std::uint64_t LineSampler::reading_due_us(const Slot& slot) const {
  return slot.reading() ? slot.clock.read_us() : UINT64_MAX;
}

// What can be done between readings: finding and configuring, checking the configuration, reading the status for the
// clock's sake.
std::uint64_t LineSampler::other_due_us(const Slot& slot) {
  if (slot.phase == Phase::kFind) return slot.ready_us;
  if (slot.phase == Phase::kConfigure || slot.verify_wanted) return 0;
  if (slot.restart_wanted) return slot.ready_us;
  if (slot.clear_wanted) return slot.clock.began_us();
  return slot.status_us != 0 ? look_start_us(slot) : UINT64_MAX;
}

// The status is sampled when its high byte is read: five bytes after the start.
std::uint64_t LineSampler::look_start_us(const Slot& slot) {
  constexpr std::uint64_t kSampled_us = 120;
  return slot.clock.stage_end_us(slot.look_stage) - kSampled_us;
}

// The next stage whose end can be looked at: the one before it ends after the present reading of the status, too, and
// proves that the chip converts.
void LineSampler::plan_look(Slot& slot) {
  constexpr std::uint64_t kApart_us = 50;
  while (++slot.look_stage < ad7147::kStages) {
    if (slot.clock.stage_end_us(slot.look_stage - 1) > slot.status_us + slot.clock.doubt_us() / 2 + kApart_us) return;
  }
  slot.status_us = 0;
}

// A look that came too late would tell little: the next stage does as well.
void LineSampler::drop_late_look(Slot& slot, std::uint64_t now_us) {
  while (slot.status_us != 0 && now_us > last_look_us(slot)) plan_look(slot);
}

std::uint64_t LineSampler::last_look_us(const Slot& slot) {
  return look_start_us(slot) + 30 + slot.clock.doubt_us() / 8;
}

std::uint64_t LineSampler::next_reading_us() const {
  std::uint64_t next = UINT64_MAX;
  for (const Slot& slot : slots()) next = std::min(next, reading_due_us(slot));
  return next;
}

// Of the readings that are due, the one whose sequence ends first; something else only when no reading falls due before
// its end.
void LineSampler::choose(std::uint64_t now_us) {
  std::uint64_t first_end_us = UINT64_MAX;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    skip_missed(slots_[k], now_us);
    drop_late_look(slots_[k], now_us);
    if (reading_due_us(slots_[k]) > now_us || slots_[k].clock.end_us() >= first_end_us) continue;
    first_end_us = slots_[k].clock.end_us();
    slot_ = k;
  }
  if (first_end_us != UINT64_MAX) return start_reading(now_us);
  const std::uint64_t reading_us = next_reading_us();
  for (std::size_t k = 0; k < slot_count_; ++k) {
    if (other_due_us(slots_[k]) > now_us || now_us + other_length_us(slots_[k]) > reading_us) continue;
    slot_ = k;
    return start_other(now_us);
  }
}

// A sequence whose results cannot be read whole any more is lost; its number is left out.
void LineSampler::skip_missed(Slot& slot, std::uint64_t now_us) {
  if (!slot.reading()) return;
  while (now_us > slot.clock.last_start_us()) {
    slot.status_us = 0;
    if (slot.to_pass == 0) {
      slot.to_pass = sampling_.every;
      if (slot.phase == Phase::kRun) {
        ++samples_[slot.module].number;
        ++lost_;
      }
    }
    advance(slot);
  }
  if (slot.restart_wanted || !slot.clock.uncertain()) return;  // it is read no more as the window has gone
  slot.restart_wanted = true;
  slot.clear_wanted = false;
  slot.ready_us = now_us;
}

// On to the sequence that is to be sampled, or one before it when the period is not known that well.
void LineSampler::advance(Slot& slot) {
  slot.passed = slot.clock.may_pass(std::max(slot.to_pass, std::uint32_t{1}));
  slot.to_pass -= std::min(slot.to_pass, slot.passed);
  slot.clock.next(slot.passed);
}

void LineSampler::start_reading(std::uint64_t now_us) {
  job_start_us_ = now_us;
  slots_[slot_].status_us = 0;
  job_ = Job::kRead;
  chip_.begin_read(*line_, chip_address());
}

void LineSampler::start_other(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  job_start_us_ = now_us;
  if (slot.phase == Phase::kFind) {
    job_ = Job::kIdentify;
    chip_.begin_identify(*line_, chip_address());
  } else if (slot.phase == Phase::kConfigure) {
    job_ = Job::kConfigure;
    const auto polarity = slot.next_phase == Phase::kMirror ? Ad7147::Polarity::kPositive : Ad7147::Polarity::kNegative;
    chip_.begin_configure(*line_, chip_address(), slot.step, polarity);
  } else if (slot.verify_wanted) {
    verify();
  } else if (slot.restart_wanted) {
    job_ = Job::kRestart;
    chip_.begin_restart(*line_, chip_address());
  } else {
    job_ = slot.clear_wanted ? Job::kClear : Job::kLook;
    chip_.begin_status(*line_, chip_address());
  }
}

void LineSampler::finish(Status status, std::uint64_t now_us) {
  if (job_ == Job::kDrain) {
    job_ = Job::kIdle;
    return;
  }
  if (status == Status::kLineStuck) return handle_stuck(now_us);
  recoveries_in_row_ = 0;
  stuck_ = false;
  if (job_ == Job::kScan) return finish_scan_step(status);
  if (status == Status::kOk) return finish_job(now_us);
  ++bus_errors_;
  if (const Job job = job_; job == Job::kClear || job == Job::kLook || job == Job::kRestart) {  // the reading will tell
    Slot& slot = slots_[slot_];
    slot.clear_wanted = slot.restart_wanted = false;
    slot.status_us = 0;
    job_ = Job::kIdle;
    return;
  }
  lose(slots_[slot_], now_us);
  slots_[slot_].single = false;  // who comes back may be another, or two
  give_up(ModuleState::kAbsent, now_us);
}

void LineSampler::finish_scan_step(Status status) {
  const auto bit = static_cast<std::uint8_t>(1U << scan_address_);
  if (status == Status::kOk) {
    scan_.answers |= bit;
    if (chip_.finish_identify() != Status::kOk) scan_.wrong_id |= bit;
  }
  if (++scan_address_ < layout::kAddressesPerLine) return start_scan_step();
  scan_.done = true;
  job_ = Job::kIdle;
}

// Ends a job of the present chip: another one begins, or the line is idle.
void LineSampler::finish_job(std::uint64_t now_us) {
  const Job job = job_;
  job_ = Job::kIdle;
  switch (job) {
    case Job::kIdentify:
      return finish_identify(now_us);
    case Job::kConfigure:
      return finish_configure();
    case Job::kVerify:
      return finish_verify(now_us);
    case Job::kRead:
      return finish_read(now_us);
    case Job::kClear:
      return finish_clear();
    case Job::kLook:
      return finish_look();
    case Job::kRestart:
      return finish_restart();
    default:
      return;
  }
}

// The module has no data until it has been found again.
void LineSampler::give_up(ModuleState state, std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  job_ = Job::kIdle;
  slot.phase = Phase::kFind;
  slot.clear_wanted = slot.verify_wanted = slot.restart_wanted = slot.lost = false;
  slot.status_us = 0;
  slot.ready_us += sequence_us();  // in step, however long each attempt waited for the line
  if (slot.ready_us <= now_us) slot.ready_us = job_start_us_ + sequence_us();
  samples_[slot.module].valid = 0;
  samples_[slot.module].state = state;
  publish(now_us);
}

void LineSampler::publish(std::uint64_t time_us) {
  ModuleSample& sample = samples_[slots_[slot_].module];
  ++sample.number;
  sample.time_us = time_us;
  sample.fresh = true;
  sample.unheard = 0;
}

void LineSampler::finish_identify(std::uint64_t now_us) {
  if (chip_.finish_identify() != Status::kOk) return give_up(ModuleState::kWrongId, now_us);
  if (slots_[slot_].lost) return give_up(ModuleState::kLostConfiguration, now_us);
  configure(slots_[slot_].single ? Phase::kMeasure : Phase::kMirror);
}

// Step by step, between the readings of the line's other chips.
void LineSampler::configure(Phase next) {
  Slot& slot = slots_[slot_];
  slot.phase = Phase::kConfigure;
  slot.next_phase = next;
  slot.step = 0;
  slot.clear_wanted = slot.verify_wanted = slot.restart_wanted = false;
  slot.status_us = 0;
}

void LineSampler::finish_configure() {
  Slot& slot = slots_[slot_];
  if (slot.phase != Phase::kConfigure || ++slot.step < Ad7147::kConfigurationSteps)
    return;  // or a new check was asked for meanwhile
  slot.phase = slot.next_phase;
  slot.clock.start(line_->ended_us(), sequence_us());
  slot.clear_wanted = true;
  slot.to_pass = 0;
  slot.passed = 1;
  slot.unverified = 0;
  slot.frozen.restart();
}

void LineSampler::finish_read(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  if (slot.phase == Phase::kFind) return;  // a new check was asked for meanwhile
  results_ = chip_.results();
  if (slot.phase == Phase::kMirror) {
    slot.mirrored = results_;
    return configure(Phase::kMeasure);
  }
  if (slot.phase == Phase::kMeasure && !slot.single) check_single(now_us);
  if (slot.phase == Phase::kConfigure || slot.phase == Phase::kFind) return;  // the check is done once more, or failed
  slot.phase = Phase::kRun;
  // A chip without configuration reads like one at the end of its range: look before calling it saturated.
  if (std::exchange(slot.recheck, false) || !std::ranges::all_of(results_, in_range)) return verify();
  slot.verify_wanted = ++slot.unverified >= kVerifyEvery;
  finish_sequence(now_us);
}

void LineSampler::verify() {
  job_ = Job::kVerify;
  chip_.begin_verify(*line_, chip_address());
}

void LineSampler::finish_verify(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  if (slot.phase == Phase::kFind) return;
  if (!chip_.configuration_holds()) {  // a power dip, or another chip was put in its place
    slot.lost = true;
    job_ = Job::kIdentify;
    return chip_.begin_identify(*line_, chip_address());
  }
  slot.unverified = 0;
  if (!std::exchange(slot.verify_wanted, false)) finish_sequence(now_us);
}

// The results stand. When the next ones could not be read in their window, or the prediction is doubtful, the chip
// begins anew a little later: no results are lost by that, and the new beginning is known exactly.
void LineSampler::finish_sequence(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  if (slot.to_pass == 0) {
    store_results();
    publish(slot.clock.end_us());
    slot.to_pass = sampling_.every;
  }
  advance(slot);
  slot.clear_wanted = slot.clock.look_wanted();
  slot.restart_wanted = would_miss(slot) || slot.clock.uncertain();
  if (!slot.restart_wanted) return;
  slot.clear_wanted = false;
  slot.ready_us = restart_moment_us(slot, now_us);
}

// The next moment, within a sequence, from which this chip's end is far from those of the line's other chips: their
// clocks differ, and ends that are near meet again soon. Where there is no such moment, the one that is farthest.
std::uint64_t LineSampler::restart_moment_us(const Slot& slot, std::uint64_t now_us) const {
  constexpr std::uint64_t kApart_us = 200, kFar_us = 2 * kBurst_us;
  std::uint64_t best_us = now_us, best_distance_us = 0;
  Slot tried = slot;
  for (std::uint64_t at_us = now_us; at_us < now_us + slot.clock.period_us(); at_us += kApart_us) {
    tried.clock.restart(at_us);
    std::uint64_t distance_us = kFar_us;
    for (const Slot& other : slots()) {
      if (&other != &slot && other.reading()) distance_us = std::min(distance_us, end_distance(tried, other));
    }
    if (distance_us <= best_distance_us) continue;
    best_us = at_us;
    best_distance_us = distance_us;
    if (distance_us == kFar_us) break;
  }
  return best_us;
}

void LineSampler::finish_restart() {
  Slot& slot = slots_[slot_];
  slot.restart_wanted = false;
  slot.status_us = 0;
  if (!slot.reading()) return;  // a new check was asked for meanwhile
  slot.clock.restart(line_->ended_us());
  slot.to_pass += slot.passed - 1;
  if (slot.to_pass > 0) advance(slot);
  slot.clear_wanted = slot.clock.look_wanted();
}

void LineSampler::finish_clear() {
  Slot& slot = slots_[slot_];
  slot.clear_wanted = false;
  if (!slot.reading()) return;
  slot.status_us = line_->ended_us() - kAfterStatus_us;
  slot.look_stage = 0;
  plan_look(slot);
}

void LineSampler::finish_look() {
  Slot& slot = slots_[slot_];
  if (!slot.reading() || slot.status_us == 0) return;
  slot.status_us = line_->ended_us() - kAfterStatus_us;
  const int stage = slot.look_stage;
  const unsigned before_and_this = chip_.status() >> (stage - 1) & 3U;
  if ((before_and_this & 1U) == 0) {  // it does not convert, which reading back its configuration finds
    slot.status_us = 0;
    return;
  }
  slot.clock.looked(slot.status_us, stage, (before_and_this & 2U) != 0);
  if (slot.clock.look_wanted()) return plan_look(slot);
  slot.status_us = 0;
}

// The end of another chip's sequence that is nearest to the end of this one's.
std::uint64_t LineSampler::end_near(const Slot& slot, const Slot& other) {
  const std::uint64_t end = slot.clock.end_us(), period = other.clock.period_us();
  std::uint64_t other_end = other.clock.end_us();
  while (other_end + period / 2 < end) other_end += period;
  while (other_end > end + period / 2) other_end -= period;
  return other_end;
}

std::uint64_t LineSampler::end_distance(const Slot& slot, const Slot& other) {
  const std::uint64_t end = slot.clock.end_us(), other_end = end_near(slot, other);
  return other_end > end ? other_end - end : end - other_end;
}

// Whether the readings before it, in the order in which the sequences end, leave this chip's next one too late.
bool LineSampler::would_miss(const Slot& slot) const {
  const std::uint64_t end = slot.clock.end_us(), early = end - std::min(end, slot.clock.read_us());
  std::array<std::uint64_t, layout::kAddressesPerLine> ends{};  // 0: not before it
  std::size_t count = 0;
  for (const Slot& other : slots()) {
    if (&other == &slot || !other.reading()) continue;
    if (const std::uint64_t e = end_near(slot, other); e <= end) ends[count++] = e;
  }
  std::ranges::sort(ends);
  std::uint64_t free_us = 0;
  for (const std::uint64_t e : ends) free_us = e == 0 ? 0 : std::max(free_us, e - early) + kBurst_us;
  return free_us > slot.clock.last_start_us();
}

// Compares the results of both inputs. Starts the check again as long as two chips are only suspected.
void LineSampler::check_single(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  std::int64_t deficit = 0;
  int compared = 0;
  for (std::size_t t = 0; t < results_.size(); ++t) {
    if (!in_range(results_[t]) || !in_range(slot.mirrored[t])) continue;
    deficit += 2 * static_cast<std::int64_t>(ad7147::kMidScale) - results_[t] - slot.mirrored[t];
    ++compared;
  }
  if (deficit <= static_cast<std::int64_t>(kMinDeficit) * compared) {
    slot.suspicions = 0;
    slot.single = true;
    return;
  }
  if (++slot.suspicions < kMinSuspicions) return configure(Phase::kMirror);
  slot.suspicions = kMinSuspicions - 1;  // seen again in a second: one more look is enough
  give_up(ModuleState::kDuplicate, now_us);
  slot.ready_us = now_us + kDuplicatePause_us;
}

void LineSampler::store_results() {
  ModuleSample& sample = samples_[slots_[slot_].module];
  sample.raw = results_;
  std::uint16_t inside = 0;
  for (std::size_t t = 0; t < sample.raw.size(); ++t) {
    if (in_range(sample.raw[t])) inside = static_cast<std::uint16_t>(inside | 1U << t);
  }
  const std::uint16_t frozen = slots_[slot_].frozen.add(sample.raw) & inside;
  sample.valid = static_cast<std::uint16_t>(inside & ~frozen);
  sample.state = inside != ad7147::kAllStages ? ModuleState::kSaturated
                 : frozen != 0                ? ModuleState::kFrozen
                                              : ModuleState::kOk;
  sample.compensation.add(sample.raw, sample.valid);
}

void LineSampler::handle_stuck(std::uint64_t now_us) {
  const bool scanning = job_ == Job::kScan;
  job_ = Job::kIdle;
  ++bus_errors_;
  stuck_ = true;
  if (recoveries_in_row_ < kMaxRecoveries) {
    ++recoveries_in_row_;
    ++recoveries_;
    stuck_ = line_->recover() != Status::kOk;
  } else {
    recoveries_in_row_ = 0;
    paused_until_us_ = now_us + kStuckPause_us;
  }
  for (slot_ = 0; slot_ < slot_count_; ++slot_) {
    lose(slots_[slot_], now_us);
    give_up(ModuleState::kLineStuck, now_us);
    slots_[slot_].ready_us = stuck_ ? now_us + sequence_us() : now_us;
  }
  slot_ = 0;
  if (!scanning) return;
  if (!stuck_) {
    request_scan();  // the line is free again: what it answered until now is incomplete
  } else {
    scan_.stuck = true;
    scan_.done = true;
  }
}

}  // namespace triskin::fw
