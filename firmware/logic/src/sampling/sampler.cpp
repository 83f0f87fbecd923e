// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/sampler.hpp"

#include <algorithm>
#include <new>

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
  samples_ = patch.samples;
  offsets_ = &patch.offsets;
  positive_input_ = patch.positive_input;
  sampling_ = sampling;
  chip_.set_decimation(sampling.decimation);
  for (std::size_t k = 0; k < patch.rows.size(); ++k) {
    if (patch.rows[k].line != line_index) continue;
    ChipState& station = stations_[station_count_++];
    station.row = table_row(k);
    station.address = patch.rows[k].address;
  }
  schedule_.begin(station_count_, sequence_us(), sampling.every, sampling.timing);
  for (ChipState& station : stations()) find(station, now_us);
}

// Adopted modules are the last stations, so the others keep their numbers.
void LineSampler::replace_adopted(std::size_t own_rows, std::span<const wire::AdoptedModule> adopted_modules,
                                  std::size_t kept, std::uint64_t now_us) {
  while (station_count_ > 0 && index_of(stations_[station_count_ - 1].row) >= own_rows + kept) --station_count_;
  const std::size_t first = station_count_;
  for (std::size_t k = kept; k < adopted_modules.size(); ++k) {
    if (adopted_modules[k].line() != line_index_) continue;
    ChipState& station = stations_[station_count_++];
    station = {};
    station.row = table_row(own_rows + k);
    station.address = adopted_modules[k].address();
  }
  schedule_.replace_from(first, station_count_);
  for (ChipState& station : stations().subspan(first)) {
    place_of(station).known = false;  // The stored offsets belong to another chip.
    find(station, now_us);
  }
}

void LineSampler::request_scan() {
  scan_.request();
  recovery_.end_pause();  // This applies even to a line that is left alone.
  idle_until_us_ = 0;
}

void LineSampler::request_check() {
  for (ChipState& station : stations()) {
    find(station, 0);
    station.duplicates.forget();
    station.latch.forget();
    sample_of(station).state = ModuleState::kUnknown;
  }
  idle_until_us_ = 0;
}

void LineSampler::request_offsets() {
  for (ChipState& station : stations()) place_of(station).known = false;
  request_check();
}

bool LineSampler::checked() const {
  return std::ranges::all_of(
      stations(), [&](const ChipState& s) { return samples_[index_of(s.row)].state != ModuleState::kUnknown; });
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
  for (ChipState& station : stations()) {
    if (station.phase == Phase::kFind) find(station, 0);
    if (station.phase == Phase::kFind && station.presence.lost_recently(now_us)) {
      station.phase = Phase::kRun;
      station.duplicates.confirm();
      schedule_.take_up(number_of(station));
    }
    station.configuration.require();
    schedule_.forget_status(number_of(station));
    sample_of(station).state = ModuleState::kUnknown;
  }
}

std::uint64_t LineSampler::next_event_us(std::uint64_t now_us) const {
  if (job_ != Job::kIdle || pausing_) return UINT64_MAX;
  return idle_until_us_ == 0 ? now_us : idle_until_us_;
}

std::uint8_t LineSampler::chip_address() const {
  return layout::cdc_address(job_ == Job::kScan ? scan_.address() : stations_[current_].address);
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
  current_ = due.station;
  job_start_us_ = now_us;
  switch (due.action) {
    case ReadingSchedule::Action::kNothing:
      idle_until_us_ = schedule_.next_us(now_us);
      return;
    case ReadingSchedule::Action::kRead:
      return start(Job::kRead);
    case ReadingSchedule::Action::kTransaction:
      return start_transaction();
    case ReadingSchedule::Action::kRestart:
      return start(Job::kRestart);
    case ReadingSchedule::Action::kStatus:
      return start(Job::kStatus);
  }
}

void LineSampler::start_transaction() {
  switch (current().phase) {
    case Phase::kFind:
      return start(Job::kIdentify);
    case Phase::kConfigure:
      return start(Job::kConfigure);
    case Phase::kFirst:
      return start_probe();
    default:
      return start(Job::kVerify);
  }
}

void LineSampler::start(Job job) {
  job_ = job;
  const std::uint8_t address = chip_address();
  switch (job) {
    case Job::kScan:
    case Job::kIdentify:
    case Job::kIdentifyUnconfigured:
      return chip_.begin_identify(*line_, address);
    case Job::kConfigure:
      return begin_configuration(address);
    case Job::kRead:
    case Job::kProbe:
      return chip_.begin_read(*line_, address);
    case Job::kVerify:
    case Job::kVerifyReading:
      return chip_.begin_verify(*line_, address);
    case Job::kStatus:
      return chip_.begin_status(*line_, address);
    case Job::kRestart:
      return chip_.begin_restart(*line_, address);
    case Job::kIdle:
    case Job::kDrain:
      return;
  }
}

void LineSampler::begin_configuration(std::uint8_t address) {
  const ChipState& station = current();
  const Ad7147::Stages stages{polarity(station.after_configuration), offsets_for(station.after_configuration)};
  if (station.offsets_only) return chip_.begin_offsets(*line_, address, station.configuration_step, stages);
  chip_.begin_configure(*line_, address, station.configuration_step, stages);
}

// Returns the input that the electrodes are connected to, except for the check of two chips at one address.
Ad7147::Polarity LineSampler::polarity(Phase phase) const {
  return (phase == Phase::kOther) != positive_input_ ? Ad7147::Polarity::kPositive : Ad7147::Polarity::kNegative;
}

// The shift is large enough to tell which offsets the results were converted with, and small enough to keep them in
// range.
ad7147::Offsets LineSampler::offsets_for(Phase phase) {
  ad7147::Offsets offsets = current().offsets.offsets();
  if (phase != Phase::kShifted) return offsets;
  constexpr std::uint8_t kShift = 4;
  for (std::uint8_t& o : std::span(offsets).first(LatchProbe::kStages))
    o = static_cast<std::uint8_t>(o < kShift ? o + kShift : o - kShift);
  return offsets;
}

// Sequences that passed unread skip their numbers.
void LineSampler::count_missed() {
  for (std::size_t k = 0; k < station_count_; ++k) {
    const std::uint32_t missed = schedule_.take_missed(k);
    if (stations_[k].phase == Phase::kRun) sample_of(stations_[k]).number += missed;
  }
}

// The result of the transfer may come from another chip, so the transfer is repeated.
void LineSampler::abandon_transfer() {
  if (job_ == Job::kScan)
    scan_.interrupt();
  else if (job_ != Job::kDrain && current().phase != Phase::kRun)
    find(current(), 0);
  job_ = Job::kIdle;
}

void LineSampler::finish(Status status, std::uint64_t now_us) {
  const Job job = job_;
  if (job == Job::kDrain) {
    job_ = Job::kIdle;
    return;
  }
  if (status == Status::kLineStuck) return handle_stuck(now_us);
  recovery_.line_works();
  job_ = Job::kIdle;
  if (job == Job::kScan) {
    if (scan_.answered(status, chip_.finish_identify())) start(Job::kScan);
  } else if (status == Status::kOk) {
    finish_job(job, now_us);
  } else if (++bus_errors_; job == Job::kStatus || job == Job::kRestart) {
    schedule_.failed(current_);
  } else {
    handle_no_answer(now_us);
  }
}

void LineSampler::handle_no_answer(std::uint64_t now_us) {
  if (current().phase == Phase::kRun) current().presence.lost(now_us);
  current().duplicates.forget();
  give_up(ModuleState::kAbsent, now_us);
}

// Ends a job of the current station: another one begins, or the line is idle.
void LineSampler::finish_job(Job job, std::uint64_t now_us) {
  switch (job) {
    case Job::kIdentify:
      return finish_identify(now_us);
    case Job::kIdentifyUnconfigured:
      return give_up(chip_.finish_identify() == Status::kOk ? ModuleState::kLostConfiguration : ModuleState::kWrongId,
                     now_us);
    case Job::kConfigure:
      return finish_configure();
    case Job::kRead:
      return finish_read(now_us);
    case Job::kProbe:
      return finish_probe();
    case Job::kVerify:
    case Job::kVerifyReading:
      return finish_verify(job, now_us);
    case Job::kStatus:
      if (lasted_us() > kStatus_us) return schedule_.failed(current_);
      return schedule_.status_read(current_, chip_.status(), line_->ended_us(),
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

// The chip is not read until it has been found; it is asked for from `at_us` on.
void LineSampler::find(ChipState& station, std::uint64_t at_us) {
  station.phase = Phase::kFind;
  station.presence.ask_at(at_us);
  schedule_.stop(number_of(station));
  schedule_.plan_transaction(number_of(station), at_us, ReadingSchedule::kShort_us);
}

// The module has no data until it has been found again.
void LineSampler::give_up(ModuleState state, std::uint64_t now_us) {
  ChipState& station = current();
  station.presence.failed(job_start_us_, now_us, sequence_us());
  find(station, station.presence.ask_us());
  sample_of(station).store_failure(state);
  sample_of(station).publish(now_us);
}

void LineSampler::finish_identify(std::uint64_t now_us) {
  if (chip_.finish_identify() != Status::kOk) return give_up(ModuleState::kWrongId, now_us);
  begin_offsets();
  configure(current().duplicates.passed() ? Phase::kFirst : Phase::kOther);
}

// The earlier offsets are tried first, because the chip may be another one of the same kind.
void LineSampler::begin_offsets() {
  PlaceOffsets& place = place_of(current());
  const bool same = place.known && place.device_id == chip_.device_id();
  if (same)
    current().offsets.begin(place.steps);
  else
    current().offsets.begin();
  if (!same) current().duplicates.forget();
  place.device_id = chip_.device_id();
  place.known = same;
  place.state = wire::OffsetState::kSearching;
}

// Handles the case that one chip answers and its offsets are final.
void LineSampler::settle_offsets() {
  const ChipState& station = current();
  PlaceOffsets& place = place_of(station);
  place.outside = station.offsets.outside();
  place.latching = station.latch.latching();
  const bool changed = !place.known || place.steps != station.offsets.offsets();
  if (changed) {
    ++place.searches;
    place.steps = station.offsets.offsets();
    place.known = place.to_store = true;
    sample_of(station).compensation.restart();
  }
  if (place.outside != 0)
    place.state = wire::OffsetState::kOutside;
  else
    place.state = place.searches == 0 ? wire::OffsetState::kKept : wire::OffsetState::kFound;
}

// The end of the transfer tells when the sequence began, unless the transfer was slowed down.
bool LineSampler::must_repeat_start() {
  if (lasted_us() > kRestart_us && ++repeats_ < kMaxRepeats) return true;
  repeats_ = 0;
  return false;
}

// Configures step by step, between the readings of the line's other chips.
void LineSampler::configure(Phase next) {
  ChipState& station = current();
  station.phase = Phase::kConfigure;
  station.after_configuration = next;
  station.configuration_step = 0;
  station.offsets_only = false;
  schedule_.stop(current_);
  schedule_.plan_transaction(current_, 0, ReadingSchedule::kLong_us);
}

// Configures only the offsets of the first stages in this way.
void LineSampler::configure_offsets(Phase next) {
  configure(next);
  current().offsets_only = true;
}

void LineSampler::finish_configure() {
  ChipState& station = current();
  if (station.phase != Phase::kConfigure) return;  // A new check was requested in the meantime.
  const bool last = station.configuration_step + 1 == configuration_steps();
  if (last && must_repeat_start()) return;
  if (station.offsets_only && station.configuration_step == 0) station.offsets_begun_us = line_->ended_us();
  if (++station.configuration_step < configuration_steps()) return;
  station.phase = station.after_configuration;
  station.configuration.confirmed();
  station.frozen.restart();
  schedule_.start(current_, line_->ended_us(), station.latch.latching());
  if (station.phase == Phase::kFirst) plan_probe();
}

// The offsets have just changed, and no sequence has ended since the results were read, so the results can now show
// whether they change stage by stage.
void LineSampler::plan_probe() {
  ChipState& station = current();
  station.latch.skip();
  const std::uint64_t shortest_us = sequence_us() / 100 * LatchProbe::kEnd_percent;
  if (!station.offsets_only || line_->ended_us() - station.offsets_begun_us > shortest_us) return;
  const std::uint64_t after_us = sequence_us() / 100 * LatchProbe::kBegin_percent;
  schedule_.plan_transaction(current_, line_->ended_us() + after_us, ReadingSchedule::kBurst_us);
}

void LineSampler::start_probe() {
  const std::uint64_t late_us = sequence_us() / 100 * (LatchProbe::kEnd_percent - LatchProbe::kBegin_percent);
  if (job_start_us_ + ReadingSchedule::kBurst_us <= schedule_.transaction_us(current_) + late_us)
    return start(Job::kProbe);
  schedule_.cancel_transaction(current_);
}

void LineSampler::finish_probe() {
  if (current().phase != Phase::kFirst) return;  // A new check was requested in the meantime.
  if (lasted_us() <= ReadingSchedule::kBurst_us) current().latch.store(chip_.results());
  schedule_.cancel_transaction(current_);
}

void LineSampler::finish_read(std::uint64_t now_us) {
  ChipState& station = current();
  results_ = chip_.results();
  read_ended_us_ = line_->ended_us();
  burst_us_ = std::min(burst_us_, static_cast<std::uint32_t>(lasted_us()));
  switch (station.phase) {
    case Phase::kOther:
      if (station.offsets.adjust(results_, polarity(Phase::kOther))) return configure(Phase::kOther);
      station.duplicates.store_other(results_);
      return configure(Phase::kFirst);
    case Phase::kShifted:
      station.duplicates.store_other(results_);
      return configure_offsets(Phase::kFirst);
    case Phase::kFirst:
      if (!finish_first_reading(now_us)) return;
      break;
    default:
      break;
  }
  if (station.phase != Phase::kRun) return;  // A new check was requested in the meantime.
  if (positive_input_) {
    for (std::uint16_t& r : results_) r = static_cast<std::uint16_t>(~r);
  }
  if (station.configuration.needed_for(results_)) return start(Job::kVerifyReading);
  if (station.configuration.due_after_reading()) schedule_.plan_transaction(current_, 0, ReadingSchedule::kShort_us);
  use_results(now_us);
}

// Returns true if the results count; a check that must be repeated, or failed, has none.
bool LineSampler::finish_first_reading(std::uint64_t now_us) {
  ChipState& station = current();
  schedule_.cancel_transaction(current_);
  if (station.duplicates.passed() && station.latch.wanted()) {
    finish_probing(now_us);
    return false;
  }
  if (station.duplicates.passed()) {
    if (station.offsets.adjust(results_, polarity(Phase::kFirst))) {
      configure(Phase::kFirst);
      return false;
    }
    begin_run();
    return true;
  }
  switch (station.duplicates.compare(results_)) {
    case DuplicateCheck::Verdict::kSingle:
      if (station.latch.wanted()) {
        configure_offsets(Phase::kShifted);
        return false;
      }
      begin_run();
      return true;
    case DuplicateCheck::Verdict::kSuspected:
      configure(Phase::kOther);
      return false;
    case DuplicateCheck::Verdict::kDuplicate:
      give_up(ModuleState::kDuplicate, now_us);
      find(station, now_us + DuplicateCheck::kPause_us);
      return false;
  }
  return false;
}

// While it was unknown how the chip shows its results, they may be of two sequences, so they are not published.
void LineSampler::finish_probing(std::uint64_t now_us) {
  ChipState& station = current();
  station.latch.compare(station.duplicates.other(), results_);
  if (station.latch.wanted()) return configure_offsets(Phase::kShifted);
  begin_run();
  (void)schedule_.read(current_, now_us);
  schedule_.set_latching(current_, station.latch.latching());
}

void LineSampler::begin_run() {
  settle_offsets();
  current().phase = Phase::kRun;
}

void LineSampler::finish_verify(Job job, std::uint64_t now_us) {
  if (current().phase != Phase::kRun) return;  // A new check was requested in the meantime.
  // The power dipped, or this is another chip.
  if (!chip_.configuration_holds()) return start(Job::kIdentifyUnconfigured);
  current().configuration.confirmed();
  schedule_.cancel_transaction(current_);
  if (job == Job::kVerifyReading) use_results(now_us);
}

void LineSampler::use_results(std::uint64_t now_us) {
  ChipState& station = current();
  const bool whole = schedule_.in_time(current_, read_ended_us_, burst_us_);
  const std::optional<std::uint64_t> end_us = schedule_.read(current_, now_us);
  if (!end_us) return;
  if (!whole) {
    ++sample_of(station).number;  // A sample without its reading is lost, so its number is skipped.
    return;
  }
  sample_of(station).store(results_, station.frozen.add(results_));
  sample_of(station).publish(*end_us);
}

void LineSampler::handle_stuck(std::uint64_t now_us) {
  const bool scanning = job_ == Job::kScan;
  job_ = Job::kIdle;
  ++bus_errors_;
  if (recovery_.held_low(now_us)) recovery_.recovered(line_->recover() == Status::kOk);
  for (current_ = 0; current_ < station_count_; ++current_) {
    if (current().phase == Phase::kRun) current().presence.lost(now_us);
    give_up(ModuleState::kLineStuck, now_us);
    find(current(), recovery_.stuck() ? now_us + sequence_us() : now_us);
  }
  current_ = 0;
  if (scanning) scan_.line_stuck(!recovery_.stuck());
}

}  // namespace triskin::fw
