// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/sampler.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace triskin::fw {

using wire::ModuleState;

namespace {

// Transfers whose time matters take at most this long if no chip slows them down: 57 and 47 bits at 290 kHz.
constexpr std::uint64_t kStatus_us = 200, kRestart_us = 170;
// More repeats do not help: on a slower line the start time is not known more precisely.
constexpr int kMaxRepeats = 3;

}  // namespace

void LineSampler::begin(I2cLine& line, std::uint8_t line_index, const Patch& patch, const Sampling& sampling,
                        std::uint64_t now_us) {
  const bool busy = job_ != Job::kIdle && line_ == &line;
  // The object is constructed in place, because a copy would take a kilobyte of the stack.
  ::new (static_cast<void*>(this)) LineSampler;
  if (busy) job_ = Job::kDrain;
  line_ = &line;
  line_index_ = line_index;
  readings_ = patch.readings;
  offsets_ = &patch.offsets;
  positive_input_ = patch.positive_input;
  sampling_ = sampling;
  driver_.set_decimation(sampling.decimation);
  for (std::size_t k = 0; k < patch.rows.size(); ++k) {
    if (patch.rows[k].line == line_index) (void)add_chip(table_row(k), patch.rows[k].address);
  }
  schedule_.begin(chip_count_, sequence_us(), sampling.every, sampling.timing);
  for (Chip& chip : chips()) find(chip, now_us);
}

LineSampler::Chip& LineSampler::add_chip(TableRow row, std::uint8_t address) {
  Chip& chip = chips_[chip_count_++];
  chip = {};
  chip.row = row;
  chip.address = address;
  chip.setup.begin(positive_input_);
  return chip;
}

// Adopted modules are the last chips, so the others keep their numbers.
void LineSampler::replace_adopted(std::size_t own_rows, std::span<const wire::AdoptedModule> adopted_modules,
                                  std::size_t kept, std::uint64_t now_us) {
  while (chip_count_ > 0 && index_of(chips_[chip_count_ - 1].row) >= own_rows + kept) --chip_count_;
  const std::size_t first = chip_count_;
  for (std::size_t k = kept; k < adopted_modules.size(); ++k) {
    if (adopted_modules[k].line() != line_index_) continue;
    const Chip& chip = add_chip(table_row(own_rows + k), adopted_modules[k].address());
    place_of(chip).known = false;  // The stored offsets belong to another chip.
  }
  schedule_.replace_from(first, chip_count_);
  for (Chip& chip : chips().subspan(first)) find(chip, now_us);
}

void LineSampler::request_scan() {
  scan_.request();
  recovery_.end_pause();  // This applies even to a line that is left alone.
  idle_until_us_ = 0;
}

void LineSampler::request_check() {
  for (Chip& chip : chips()) {
    find(chip, 0);
    chip.setup.forget_checks();
    reading_of(chip).state = ModuleState::kUnknown;
  }
  idle_until_us_ = 0;
}

void LineSampler::request_offsets() {
  for (Chip& chip : chips()) place_of(chip).known = false;
  request_check();
}

bool LineSampler::checked() const {
  return std::ranges::all_of(
      chips(), [&](const Chip& chip) { return readings_[index_of(chip.row)].state != ModuleState::kUnknown; });
}

bool LineSampler::pause() {
  pausing_ = true;
  idle_until_us_ = 0;
  return job_ == Job::kIdle;
}

void LineSampler::resume(std::uint64_t now_us) {
  pausing_ = false;
  recovery_.restart();
  idle_until_us_ = 0;
  for (Chip& chip : chips()) {
    if (chip.setup.state() == ChipSetup::State::kFind) {
      find(chip, 0);
      if (chip.presence.lost_recently(now_us)) {
        chip.setup.take_up();
        schedule_.take_up(number_of(chip));
      }
    }
    chip.check.require();
    schedule_.forget_status(number_of(chip));
    reading_of(chip).state = ModuleState::kUnknown;
  }
}

std::uint64_t LineSampler::next_event_us(std::uint64_t now_us) const {
  if (job_ != Job::kIdle || pausing_) return UINT64_MAX;
  return idle_until_us_ == 0 ? now_us : idle_until_us_;
}

void LineSampler::step(std::uint64_t now_us) {
  if (job_ != Job::kIdle) {
    const std::optional<Status> done = line_->poll();
    if (!done) return;
    if (pausing_)
      abandon_transfer();
    else
      finish(*done, now_us);
  }
  if (job_ != Job::kIdle || pausing_ || now_us < idle_until_us_) return;
  idle_until_us_ = recovery_.paused_until_us();
  if (now_us < idle_until_us_) return;
  recovery_.end_pause();
  start_next(now_us);
}

void LineSampler::start_next(std::uint64_t now_us) {
  if (scan_.requested()) {
    scan_.begin();
    return start(Job::kScan);
  }
  const ReadingSchedule::Due due = schedule_.due(now_us);
  count_missed();
  current_ = due.chip;
  job_start_us_ = now_us;
  switch (due.action) {
    case ReadingSchedule::Action::kNothing:
      idle_until_us_ = schedule_.next_us(now_us);
      return;
    case ReadingSchedule::Action::kRead:
      return start(Job::kRead);
    case ReadingSchedule::Action::kTransaction:
      return start_transaction(chips_[current_]);
    case ReadingSchedule::Action::kRestart:
      return start(Job::kRestart);
    case ReadingSchedule::Action::kStatus:
      return start(Job::kStatus);
  }
}

void LineSampler::start_transaction(Chip& chip) {
  if (chip.configuration.running) return start(Job::kConfigure);
  if (chip.setup.state() == ChipSetup::State::kFind) return start(Job::kIdentify);
  if (chip.setup.runs() || chip.check.due()) return start(Job::kVerify);
  // A reading in mid-sequence says nothing when it ends after the sequence of the fastest chip.
  const std::uint64_t late_us = sequence_us() / 100 * (LatchProbe::kEnd_percent - LatchProbe::kBegin_percent);
  if (job_start_us_ + ReadingSchedule::kBurst_us <= schedule_.transaction_us(current_) + late_us)
    return start(Job::kProbe);
  schedule_.cancel_transaction(current_);
}

void LineSampler::start(Job job) {
  job_ = job;
  const Chip& chip = chips_[current_];
  const std::uint8_t address = layout::cdc_address(job == Job::kScan ? scan_.address() : chip.address);
  switch (job) {
    case Job::kScan:
    case Job::kIdentify:
    case Job::kIdentifyUnconfigured:
      return driver_.begin_identify(*line_, address);
    case Job::kConfigure:
      if (chip.configuration.offsets_only)
        return driver_.begin_offsets(*line_, address, chip.configuration.step, chip.setup.stages());
      return driver_.begin_configure(*line_, address, chip.configuration.step, chip.setup.stages(),
                                     chip.setup.marks() ? mark_of(chip) : std::uint16_t{0});
    case Job::kRead:
    case Job::kProbe:
      return driver_.begin_read(*line_, address);
    case Job::kVerify:
    case Job::kVerifyReading:
      return driver_.begin_verify(*line_, address);
    case Job::kStatus:
      return driver_.begin_status(*line_, address);
    case Job::kRestart:
      return driver_.begin_restart(*line_, address);
    case Job::kIdle:
    case Job::kDrain:
      return;
  }
}

// Sequences that passed unread skip their numbers. None is missing before the first one that was read: Application
// numbers what a module without data reports.
void LineSampler::count_missed() {
  for (Chip& chip : chips()) {
    const std::uint32_t missed = schedule_.take_missed(number_of(chip));
    if (missed == 0) continue;
    if (chip.was_read) reading_of(chip).number += missed;
    if (chip.check.due_after_missing()) schedule_.plan_transaction(number_of(chip), 0, ReadingSchedule::kShort_us);
  }
}

// The result of the transfer may come from another chip, so the transfer is repeated.
void LineSampler::abandon_transfer() {
  const Job job = std::exchange(job_, Job::kIdle);
  if (job == Job::kScan)
    scan_.interrupt();
  else if (job != Job::kDrain && !chips_[current_].setup.runs())
    find(chips_[current_], 0);
}

void LineSampler::finish(Status status, std::uint64_t now_us) {
  const Job job = std::exchange(job_, Job::kIdle);
  if (job == Job::kDrain) return;
  if (status == Status::kLineStuck) return handle_stuck(job == Job::kScan, now_us);
  recovery_.line_works();
  if (job == Job::kScan) {
    if (scan_.answered(status, driver_.finish_identify())) start(Job::kScan);
    return;
  }
  Chip& chip = chips_[current_];
  if (status != Status::kOk) {
    ++bus_errors_;
    if (job == Job::kStatus || job == Job::kRestart) return schedule_.failed(current_);
    if (chip.setup.runs()) {
      chip.presence.lost(now_us);
      for (Chip& other : chips()) other.check.require();  // It may answer at another address now.
    }
    chip.setup.forget_chip();
    return give_up(chip, ModuleState::kAbsent, now_us);
  }
  switch (job) {
    case Job::kIdentify:
      if (driver_.finish_identify() != Status::kOk) return give_up(chip, ModuleState::kWrongId, now_us);
      (void)chip.setup.on_identity(driver_.device_id(), place_of(chip));
      return configure(chip, false);
    case Job::kIdentifyUnconfigured:
      chip.setup.forget_chip();
      return give_up(chip,
                     driver_.finish_identify() == Status::kOk ? ModuleState::kLostConfiguration : ModuleState::kWrongId,
                     now_us);
    case Job::kConfigure:
      return finish_configure(chip);
    case Job::kRead:
      return finish_read(chip, now_us);
    case Job::kProbe:
      if (lasted_us() <= ReadingSchedule::kBurst_us) chip.setup.on_middle(driver_.results());
      return schedule_.cancel_transaction(current_);
    case Job::kVerify:
    case Job::kVerifyReading:
      // The power dipped, this is another chip, or a second one has joined it.
      if (driver_.mark() != mark_of(chip)) return start(Job::kIdentifyUnconfigured);
      chip.check.confirmed();
      schedule_.cancel_transaction(current_);
      if (job == Job::kVerifyReading) publish(chip, now_us);
      return;
    case Job::kStatus:
      if (lasted_us() > kStatus_us) return schedule_.failed(current_);
      return schedule_.status_read(current_, driver_.status(), line_->ended_us(),
                                   static_cast<std::uint32_t>(lasted_us()));
    case Job::kRestart:
      if (must_repeat_start()) return start(Job::kRestart);
      return schedule_.restarted(current_, line_->ended_us());
    case Job::kIdle:
    case Job::kDrain:
    case Job::kScan:
      return;
  }
}

void LineSampler::configure(Chip& chip, bool offsets_only) {
  chip.configuration = {.running = true, .offsets_only = offsets_only};
  schedule_.stop(current_);
  schedule_.plan_transaction(current_, 0, ReadingSchedule::kLong_us);
}

void LineSampler::finish_configure(Chip& chip) {
  Configuration& configuration = chip.configuration;
  const bool last = configuration.step + 1 == configuration.steps();
  if (last && must_repeat_start()) return;
  if (configuration.step == 0) configuration.begun_us = line_->ended_us();
  if (++configuration.step < configuration.steps()) return;
  configuration.running = false;
  chip.check.confirmed();
  chip.check.require();
  chip.frozen.restart();
  const std::uint64_t started_us = line_->ended_us();
  schedule_.start(current_, started_us, chip.setup.latching());
  // A reading in mid-sequence tells how the chip shows its results if no sequence ended while the offsets changed.
  const std::uint64_t shortest_us = sequence_us() / 100 * LatchProbe::kEnd_percent;
  if (chip.setup.state() == ChipSetup::State::kLatching && started_us - configuration.begun_us <= shortest_us)
    schedule_.plan_transaction(current_, started_us + sequence_us() / 100 * LatchProbe::kBegin_percent,
                               ReadingSchedule::kBurst_us);
}

void LineSampler::finish_read(Chip& chip, std::uint64_t now_us) {
  results_ = driver_.results();
  read_ended_us_ = line_->ended_us();
  burst_us_ = std::min(burst_us_, static_cast<std::uint32_t>(lasted_us()));
  if (!chip.setup.runs()) {
    schedule_.cancel_transaction(current_);
    const std::uint32_t searches = place_of(chip).searches;
    const ChipSetup::Next next = chip.setup.on_results(results_, place_of(chip));
    if (place_of(chip).searches != searches) reading_of(chip).compensation.restart();
    switch (next) {
      case ChipSetup::Next::kConfigure:
        return configure(chip, false);
      case ChipSetup::Next::kConfigureOffsets:
        return configure(chip, true);
      case ChipSetup::Next::kDuplicate:
        give_up(chip, ModuleState::kDuplicate, now_us);
        return find(chip, now_us + DuplicateCheck::kPause_us);
      case ChipSetup::Next::kSkip:
        (void)schedule_.read(current_, now_us);
        return schedule_.set_latching(current_, chip.setup.latching());
      case ChipSetup::Next::kUse:
        break;
    }
  }
  if (positive_input_) {
    for (std::uint16_t& r : results_) r = static_cast<std::uint16_t>(~r);
  }
  if (chip.check.needed_for(results_)) return start(Job::kVerifyReading);
  if (chip.check.due_after_reading()) schedule_.plan_transaction(current_, 0, ReadingSchedule::kShort_us);
  publish(chip, now_us);
}

void LineSampler::publish(Chip& chip, std::uint64_t now_us) {
  const bool whole = schedule_.in_time(current_, read_ended_us_, burst_us_);
  const std::optional<std::uint64_t> end_us = schedule_.read(current_, now_us);
  if (!end_us) return;
  ModuleReading& reading = reading_of(chip);
  if (!whole) {
    if (chip.was_read) ++reading.number;  // A sequence without a reading is lost, so its number is skipped.
    return;
  }
  chip.was_read = true;
  reading.store(results_, chip.frozen.add(results_));
  reading.publish(*end_us);
}

// The end of the transfer tells when the sequence began, unless the transfer was slowed down.
bool LineSampler::must_repeat_start() {
  if (lasted_us() > kRestart_us && ++repeats_ < kMaxRepeats) return true;
  repeats_ = 0;
  return false;
}

// The chip is not read until it has been found; it is asked for from `at_us` on.
void LineSampler::find(Chip& chip, std::uint64_t at_us) {
  if (job_ != Job::kIdle && job_ != Job::kScan && current_ == number_of(chip)) job_ = Job::kDrain;
  chip.setup.find();
  chip.was_read = false;
  chip.configuration.running = false;
  chip.presence.ask_at(at_us);
  schedule_.stop(number_of(chip));
  schedule_.plan_transaction(number_of(chip), at_us, ReadingSchedule::kShort_us);
}

// The module has no data until it has been found again.
void LineSampler::give_up(Chip& chip, ModuleState state, std::uint64_t now_us) {
  chip.presence.failed(job_start_us_, now_us, sequence_us());
  find(chip, chip.presence.ask_us());
  reading_of(chip).store_failure(state);
  reading_of(chip).publish(now_us);
}

void LineSampler::handle_stuck(bool scanning, std::uint64_t now_us) {
  ++bus_errors_;
  if (recovery_.held_low(now_us)) recovery_.recovered(line_->recover() == Status::kOk);
  for (Chip& chip : chips()) {
    if (chip.setup.runs()) chip.presence.lost(now_us);
    give_up(chip, ModuleState::kLineStuck, now_us);
    find(chip, recovery_.stuck() ? now_us + sequence_us() : now_us);
  }
  current_ = 0;
  if (scanning) scan_.line_stuck(!recovery_.stuck());
}

}  // namespace triskin::fw
