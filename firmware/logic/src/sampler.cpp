// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampler.hpp"

#include <algorithm>

namespace triskin::fw {

using wire::ModuleState;

namespace {

constexpr bool in_range(std::uint16_t raw) { return raw != 0 && raw != 0xFFFF; }

}  // namespace

void LineSampler::begin(I2cLine& line, std::uint8_t line_index, const layout::PatchImage& table, std::span<ModuleSample> samples,
                        std::uint64_t now_us) {
  const bool busy = job_ != Job::kIdle && line_ == &line;
  *this = LineSampler{};
  if (busy) job_ = Job::kDrain;  // a transfer of before must end first
  line_ = &line;
  samples_ = samples;
  for (std::size_t k = 0; k < table.module_count; ++k) {
    const layout::ModuleRow& row = table.modules[k];
    if (row.line != line_index) continue;
    Slot& slot = slots_[slot_count_++];
    slot.module = static_cast<std::uint8_t>(k);
    slot.address = row.address;
  }
  next_cycle_us_ = now_us;
}

void LineSampler::request_scan() {
  scan_ = {};
  scan_requested_ = true;
  if (job_ == Job::kIdle) next_cycle_us_ = 0;  // also a line that is left alone
}

void LineSampler::request_check() {
  for (std::size_t k = 0; k < slot_count_; ++k) {
    slots_[k].phase = Phase::kFind;
    slots_[k].single = false;
    slots_[k].ready_us = 0;
    samples_[slots_[k].module].state = ModuleState::kUnknown;
  }
}

bool LineSampler::rest() {
  resting_ = true;
  return job_ == Job::kIdle;
}

void LineSampler::resume(std::uint64_t now_us) {
  resting_ = false;
  stuck_ = false;
  recoveries_in_row_ = 0;
  verify_all_ = true;
  next_cycle_us_ = now_us;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    Slot& slot = slots_[k];
    if (slot.phase == Phase::kFind) slot.ready_us = 0;
    if (slot.phase == Phase::kFind && slot.lost_us != 0 && now_us - slot.lost_us < kRecent_us) {  // the old route was to blame
      slot.phase = Phase::kRun;
      slot.single = true;
    }
    samples_[slots_[k].module].state = ModuleState::kUnknown;
  }
}

bool LineSampler::checked() const {
  return std::all_of(slots_.begin(), slots_.begin() + static_cast<std::ptrdiff_t>(slot_count_),
                     [&](const Slot& s) { return samples_[s.module].state != ModuleState::kUnknown; });
}

std::uint64_t LineSampler::next_event_us() const { return job_ == Job::kIdle && !resting_ ? next_cycle_us_ : UINT64_MAX; }

std::uint8_t LineSampler::chip_address() const {
  return static_cast<std::uint8_t>(layout::kFirstCdcAddress + (job_ == Job::kScan ? scan_address_ : slots_[slot_].address));
}

bool LineSampler::step(std::uint64_t now_us) {
  if (job_ == Job::kIdle) return !resting_ && now_us >= next_cycle_us_ && start_cycle(now_us);
  const std::optional<Status> done = line_->poll();
  if (done.has_value() && resting_) {  // what it brought is read again
    scan_requested_ = scan_requested_ || job_ == Job::kScan;
    if (job_ == Job::kConfigure || job_ == Job::kIdentify) slots_[slot_].phase = Phase::kFind;
    job_ = Job::kIdle;
    return false;
  }
  return done.has_value() && finish(*done, now_us);
}

bool LineSampler::start_cycle(std::uint64_t now_us) {
  next_cycle_us_ = now_us + kPeriod_us;
  ++cycle_;
  slot_ = 0;
  if (!scan_requested_) return start_slot(now_us);
  scan_requested_ = false;
  scan_address_ = 0;
  start_scan_step();
  return false;
}

void LineSampler::start_scan_step() {
  job_ = Job::kScan;
  chip_.begin_identify(*line_, chip_address());
}

// What the next chip needs that can be done now: to be found, its configuration looked at, or read. True: nothing is left.
bool LineSampler::start_slot(std::uint64_t now_us) {
  while (slot_ < slot_count_ && now_us < slots_[slot_].ready_us) ++slot_;
  if (slot_ == slot_count_) {
    job_ = Job::kIdle;
    verify_all_ = false;
    return true;
  }
  Slot& slot = slots_[slot_];
  slot.verified = false;
  if (slot.phase == Phase::kFind) {
    job_ = Job::kIdentify;
    chip_.begin_identify(*line_, chip_address());
  } else if (slot.phase == Phase::kRun && (verify_all_ || cycle_ % kVerifyEvery == 0)) {
    job_ = Job::kVerify;
    chip_.begin_verify(*line_, chip_address());
  } else {
    job_ = Job::kRead;
    chip_.begin_read(*line_, chip_address());
  }
  return false;
}

bool LineSampler::finish(Status status, std::uint64_t now_us) {
  if (job_ == Job::kDrain) {
    job_ = Job::kIdle;
    return false;
  }
  if (status == Status::kLineStuck) {
    handle_stuck(now_us);
    return true;  // the cycle has ended, without data
  }
  recoveries_in_row_ = 0;
  stuck_ = false;
  return job_ == Job::kScan ? finish_scan_step(status, now_us) : finish_job(status, now_us);
}

bool LineSampler::finish_scan_step(Status status, std::uint64_t now_us) {
  const auto bit = static_cast<std::uint8_t>(1U << scan_address_);
  if (status == Status::kOk) {
    scan_.answers |= bit;
    if (chip_.finish_identify() != Status::kOk) scan_.wrong_id |= bit;
  }
  if (++scan_address_ < layout::kAddressesPerLine) {
    start_scan_step();
    return false;
  }
  scan_.done = true;
  return start_slot(now_us);
}

bool LineSampler::finish_job(Status status, std::uint64_t now_us) {
  if (status != Status::kOk) {
    ++bus_errors_;
    lose(slots_[slot_], now_us);
    slots_[slot_].single = false;  // who comes back may be another, or two
    return give_up(ModuleState::kAbsent, now_us);
  }
  switch (job_) {
    case Job::kIdentify:
      if (chip_.finish_identify() != Status::kOk) return give_up(ModuleState::kWrongId, now_us);
      configure(slots_[slot_].single ? Phase::kMeasure : Phase::kMirror);
      return false;
    case Job::kConfigure: return finish_configure(now_us);
    case Job::kVerify: return finish_verify(now_us);
    default: return finish_read(now_us);
  }
}

// The module has no data until it has been found again.
bool LineSampler::give_up(ModuleState state, std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  slot.phase = Phase::kFind;
  samples_[slot.module].valid = 0;
  samples_[slot.module].state = state;
  return next_slot(now_us);
}

void LineSampler::lose(Slot& slot, std::uint64_t now_us) {
  if (slot.phase == Phase::kRun) slot.lost_us = now_us;
}

void LineSampler::configure(Phase phase) {
  slots_[slot_].phase = phase;
  job_ = Job::kConfigure;
  configure_step_ = 0;
  const auto polarity = phase == Phase::kMirror ? Ad7147::Polarity::kPositive : Ad7147::Polarity::kNegative;
  chip_.begin_configure(*line_, chip_address(), configure_step_, polarity);
}

bool LineSampler::finish_configure(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  if (++configure_step_ < Ad7147::kConfigurationSteps) {
    const auto polarity = slot.phase == Phase::kMirror ? Ad7147::Polarity::kPositive : Ad7147::Polarity::kNegative;
    chip_.begin_configure(*line_, chip_address(), configure_step_, polarity);
    return false;
  }
  slot.ready_us = now_us + kSettle_us;
  slot.still = {};
  return next_slot(now_us);
}

bool LineSampler::finish_verify(std::uint64_t now_us) {
  if (!chip_.configuration_holds()) return give_up(ModuleState::kLostConfiguration, now_us);  // a power dip
  slots_[slot_].verified = true;
  job_ = Job::kRead;
  chip_.begin_read(*line_, chip_address());
  return false;
}

bool LineSampler::finish_read(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  if (slot.phase == Phase::kFind) return next_slot(now_us);  // a new check was asked for meanwhile
  if (slot.phase == Phase::kMirror) {
    slot.mirrored = chip_.results();
    configure(Phase::kMeasure);
    return false;
  }
  if (slot.phase == Phase::kMeasure) {
    if (!slot.single && !check_single(now_us)) return next_slot(now_us);
    if (job_ == Job::kConfigure) return false;  // the check is done once more
    slot.phase = Phase::kRun;
  }
  const bool extreme = !std::ranges::all_of(chip_.results(), in_range);
  if (extreme && !slot.verified) {  // a chip without configuration reads like this too: look before calling it saturated
    job_ = Job::kVerify;
    chip_.begin_verify(*line_, chip_address());
    return false;
  }
  store_results();
  return next_slot(now_us);
}

// Compares the results of both inputs. False: two chips answer. Starts the check again as long as that is only suspected.
bool LineSampler::check_single(std::uint64_t now_us) {
  Slot& slot = slots_[slot_];
  const ad7147::Results measured = chip_.results();
  std::int64_t deficit = 0;
  int compared = 0;
  for (std::size_t t = 0; t < measured.size(); ++t) {
    if (!in_range(measured[t]) || !in_range(slot.mirrored[t])) continue;
    deficit += 2 * static_cast<std::int64_t>(ad7147::kMidScale) - measured[t] - slot.mirrored[t];
    ++compared;
  }
  if (deficit <= static_cast<std::int64_t>(kMinDeficit) * compared) {
    slot.suspicions = 0;
    slot.single = true;
    return true;
  }
  if (++slot.suspicions < kMinSuspicions) {
    configure(Phase::kMirror);
    return true;
  }
  slot.suspicions = kMinSuspicions - 1;  // seen again in a second: one more look is enough
  slot.phase = Phase::kFind;
  slot.ready_us = now_us + kDuplicatePause_us;
  samples_[slot.module].valid = 0;
  samples_[slot.module].state = ModuleState::kDuplicate;
  return false;
}

void LineSampler::store_results() {
  ModuleSample& sample = samples_[slots_[slot_].module];
  sample.raw = chip_.results();
  std::uint16_t inside = 0;
  for (std::size_t t = 0; t < sample.raw.size(); ++t) {
    if (in_range(sample.raw[t])) inside = static_cast<std::uint16_t>(inside | 1U << t);
  }
  const std::uint16_t frozen = find_frozen(sample.raw) & inside;
  sample.valid = static_cast<std::uint16_t>(inside & ~frozen);
  sample.state = inside != ad7147::kAllStages ? ModuleState::kSaturated : frozen != 0 ? ModuleState::kFrozen : ModuleState::kOk;
  if (!sample.has_baseline) {
    sample.baseline = sample.raw;
    sample.has_baseline = true;
  }
}

// A live converter has noise: a taxel that keeps one value while most others of its chip change is frozen. Readings in which
// little changes say nothing.
std::uint16_t LineSampler::find_frozen(const ad7147::Results& raw) {
  Slot& slot = slots_[slot_];
  int changed = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) changed += raw[t] != slot.last[t] ? 1 : 0;
  std::uint16_t frozen = 0;
  for (std::size_t t = 0; t < raw.size(); ++t) {
    std::uint8_t& still = slot.still[t];
    if (raw[t] != slot.last[t]) still = 0;
    else if (changed >= kLively && still < kFrozenReadings) ++still;
    if (still == kFrozenReadings) frozen = static_cast<std::uint16_t>(frozen | 1U << t);
  }
  slot.last = raw;
  return frozen;
}

bool LineSampler::next_slot(std::uint64_t now_us) {
  ++slot_;
  return start_slot(now_us);
}

void LineSampler::handle_stuck(std::uint64_t now_us) {
  const bool scanning = job_ == Job::kScan;
  job_ = Job::kIdle;
  ++bus_errors_;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    lose(slots_[k], now_us);
    slots_[k].phase = Phase::kFind;
    samples_[slots_[k].module].valid = 0;
    samples_[slots_[k].module].state = ModuleState::kLineStuck;
  }
  stuck_ = true;
  if (recoveries_in_row_ < kMaxRecoveries) {
    ++recoveries_in_row_;
    ++recoveries_;
    stuck_ = line_->recover() != Status::kOk;
  } else {
    recoveries_in_row_ = 0;
    next_cycle_us_ = now_us + kStuckPause_us;
  }
  if (!scanning) return;
  if (!stuck_) {
    request_scan();  // the line is free again: what it answered until now is incomplete
  } else {
    scan_.stuck = true;
    scan_.done = true;
  }
}

}  // namespace triskin::fw
