// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampler.hpp"

#include <algorithm>

namespace triskin::fw {

using wire::ModuleState;

void LineSampler::begin(I2cLine& line, std::uint8_t line_index, const layout::PatchImage& table, std::span<ModuleSample> samples,
                        std::uint64_t now_us) {
  *this = LineSampler{};
  line_ = &line;
  samples_ = samples;
  for (std::size_t k = 0; k < table.module_count; ++k) {
    const layout::ModuleRow& row = table.modules[k];
    if (row.line == line_index) slots_[slot_count_++] = {static_cast<std::uint8_t>(k), row.address, false};
  }
  next_cycle_us_ = now_us;
}

std::uint64_t LineSampler::next_event_us() const { return job_ == Job::kIdle ? next_cycle_us_ : UINT64_MAX; }

std::uint8_t LineSampler::chip_address() const {
  return static_cast<std::uint8_t>(layout::kFirstCdcAddress + (job_ == Job::kScan ? scan_address_ : slots_[slot_].address));
}

bool LineSampler::step(std::uint64_t now_us) {
  if (job_ == Job::kIdle) {
    if (now_us >= next_cycle_us_) start_cycle(now_us);
    return false;
  }
  const std::optional<Status> done = line_->poll();
  return done.has_value() && finish(*done, now_us);
}

void LineSampler::start_cycle(std::uint64_t now_us) {
  next_cycle_us_ = now_us + kPeriod_us;
  ++cycle_;
  slot_ = 0;
  if (scan_requested_) {
    scan_requested_ = false;
    scan_address_ = 0;
    start_scan_step();
  } else if (slot_count_ > 0) {
    start_slot();
  }
}

void LineSampler::start_scan_step() {
  job_ = Job::kScan;
  chip_.begin_identify(*line_, chip_address());
}

// What a chip needs next: to be found, its configuration looked at, or read.
void LineSampler::start_slot() {
  job_ = !slots_[slot_].configured ? Job::kIdentify : cycle_ % kVerifyEvery == 0 ? Job::kVerify : Job::kRead;
  if (job_ == Job::kIdentify) chip_.begin_identify(*line_, chip_address());
  else if (job_ == Job::kVerify) chip_.begin_verify(*line_, chip_address());
  else chip_.begin_read(*line_, chip_address());
}

bool LineSampler::finish(Status status, std::uint64_t now_us) {
  if (status == Status::kLineStuck) {
    handle_stuck(now_us);
    return true;  // the cycle has ended, without data
  }
  recoveries_in_row_ = 0;
  if (job_ != Job::kScan) return finish_job(status);
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
  if (slot_count_ == 0) {
    job_ = Job::kIdle;
    return true;
  }
  start_slot();
  return false;
}

bool LineSampler::finish_job(Status status) {
  Slot& slot = slots_[slot_];
  ModuleSample& sample = samples_[slot.module];
  if (status != Status::kOk) {
    ++bus_errors_;
    slot.configured = false;
    sample.valid = 0;
    sample.state = ModuleState::kAbsent;
    return next_slot();
  }
  switch (job_) {
    case Job::kIdentify:
      if (chip_.finish_identify() != Status::kOk) {
        sample.valid = 0;
        sample.state = ModuleState::kWrongId;
        return next_slot();
      }
      job_ = Job::kConfigure;
      configure_step_ = 0;
      chip_.begin_configure(*line_, chip_address(), configure_step_);
      return false;
    case Job::kConfigure:
      if (++configure_step_ < Ad7147::kConfigurationSteps) {
        chip_.begin_configure(*line_, chip_address(), configure_step_);
        return false;
      }
      slot.configured = true;  // first results stand after one conversion sequence: read in the next cycle
      return next_slot();
    case Job::kVerify:
      if (!chip_.configuration_holds()) {  // a power dip: found here, configured again in the next cycle
        slot.configured = false;
        sample.valid = 0;
        sample.state = ModuleState::kLostConfiguration;
        return next_slot();
      }
      job_ = Job::kRead;
      chip_.begin_read(*line_, chip_address());
      return false;
    default: store_results(sample); return next_slot();
  }
}

void LineSampler::store_results(ModuleSample& sample) {
  sample.raw = chip_.results();
  sample.valid = 0;
  for (std::size_t t = 0; t < sample.raw.size(); ++t) {
    if (sample.raw[t] != 0 && sample.raw[t] != 0xFFFF) sample.valid = static_cast<std::uint16_t>(sample.valid | 1U << t);
  }
  sample.state = sample.valid == ad7147::kAllStages ? ModuleState::kOk : ModuleState::kSaturated;
  if (!sample.has_baseline) {
    sample.baseline = sample.raw;
    sample.has_baseline = true;
  }
}

bool LineSampler::next_slot() {
  if (++slot_ < slot_count_) {
    start_slot();
    return false;
  }
  job_ = Job::kIdle;
  return true;
}

void LineSampler::handle_stuck(std::uint64_t now_us) {
  job_ = Job::kIdle;
  ++bus_errors_;
  for (std::size_t k = 0; k < slot_count_; ++k) {
    slots_[k].configured = false;
    samples_[slots_[k].module].valid = 0;
    samples_[slots_[k].module].state = ModuleState::kLineStuck;
  }
  scan_.stuck = true;
  scan_.done = true;
  if (recoveries_in_row_ < kMaxRecoveries) {
    ++recoveries_in_row_;
    ++recoveries_;
    if (line_->recover() == Status::kOk) scan_.stuck = false;
  } else {
    recoveries_in_row_ = 0;
    next_cycle_us_ = now_us + kStuckPause_us;
  }
}

}  // namespace triskin::fw
