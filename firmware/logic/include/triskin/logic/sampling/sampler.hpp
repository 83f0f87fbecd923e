// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/address_scan.hpp"
#include "triskin/logic/sampling/configuration_check.hpp"
#include "triskin/logic/sampling/duplicate_check.hpp"
#include "triskin/logic/sampling/frozen_taxels.hpp"
#include "triskin/logic/sampling/latch_probe.hpp"
#include "triskin/logic/sampling/line_recovery.hpp"
#include "triskin/logic/sampling/module_sample.hpp"
#include "triskin/logic/sampling/offset_search.hpp"
#include "triskin/logic/sampling/presence.hpp"
#include "triskin/logic/sampling/reading_schedule.hpp"
#include "triskin/logic/sampling/table_row.hpp"
#include "triskin/logic/storage/offset_store.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// How the converters of a patch are run.
struct Sampling {
  wire::Decimation decimation = wire::Decimation::k256;
  std::uint8_t every = 1;  ///< 1..255: each n-th sequence is read
  wire::SamplingTiming timing = wire::SamplingTiming::kTracked;
  bool operator==(const Sampling&) const = default;
};

/// Drives one line: finds, configures, checks and reads its chips. step() never waits. It makes the transfers and hands
/// their results to the parts that decide: AddressScan (what answers), Presence (when an address is asked for its
/// chip), OffsetSearch (what each stage takes away), DuplicateCheck (one chip or two), LatchProbe (when a chip shows
/// its results), ConfigurationCheck (when to read it back), ReadingSchedule (whose transfer is due), LineRecovery (what
/// to do about a line that is held low). One bad chip or line stops no other.
class LineSampler {
 public:
  /// What all lines share. Samples and offsets outlive the sampler, the table need not.
  struct Patch {
    std::span<const layout::ModuleRow> rows;  ///< rows of the table
    std::span<ModuleSample> samples;          ///< one per row
    OffsetBook& offsets;
    bool positive_input = false;  ///< the electrodes hang there: results are turned round
  };
  /// Forgets everything but the offsets and starts anew with those modules of the table that hang on this line.
  void begin(I2cLine& line, std::uint8_t line_index, const Patch& patch, const Sampling& sampling,
             std::uint64_t now_us);
  /// Replaces the modules that the table does not know: adopted module k has row `own_rows` + k and is read where it
  /// says. The modules of the table and the first `kept` adopted modules go on as they were. Between pause() and
  /// resume(), when no transfer is under way.
  void replace_adopted(std::size_t own_rows, std::span<const wire::AdoptedModule> adopted_modules, std::size_t kept,
                       std::uint64_t now_us);
  /// Also without a table: finds what answers at the four addresses; scan() has the result.
  void request_scan();
  /// Finds, configures and checks every chip of the line again.
  void request_check();
  /// The same, and the offsets are searched from the beginning.
  void request_offsets();
  /// Every chip of the table has been through its checks, or cannot be.
  [[nodiscard]] bool checked() const;
  /// Starts nothing new until resume(). True: no transfer is under way.
  [[nodiscard]] bool pause();
  /// Goes on after pause(): chips that were read before go on when they still hold their configuration.
  void resume(std::uint64_t now_us);
  /// Does what is due.
  void step(std::uint64_t now_us);
  /// What the last scan of the addresses found.
  [[nodiscard]] const LineScan& scan() const { return scan_.result(); }
  /// True while SDA or SCL is held low.
  [[nodiscard]] bool stuck() const { return recovery_.stuck(); }
  /// Bus clears since the sampler began.
  [[nodiscard]] std::uint32_t recoveries() const { return recovery_.count(); }
  /// Transfers that failed since the sampler was made.
  [[nodiscard]] std::uint32_t bus_errors() const { return bus_errors_; }
  /// When step() has something to do after `now_us`; max while a transfer is under way (the line reports its own end).
  [[nodiscard]] std::uint64_t next_event_us(std::uint64_t now_us) const;

 private:
  // The transfer that is under way.
  enum class Job : std::uint8_t {
    kIdle,
    kDrain,  // one of before begin(): its end alone counts
    kScan,
    kIdentify,
    kIdentifyUnconfigured,  // the chip does not hold its configuration: is it an AD7147 still?
    kConfigure,
    kRead,
    kProbe,  // results in mid-sequence, for LatchProbe
    kVerify,
    kVerifyReading,  // the results that were read count only when the configuration holds
    kStatus,
    kRestart
  };
  // Goal that a chip is on the way to. Readings of kOther (the input that is not used), kShifted (the one that is,
  // with other offsets) and kFirst (as it is used) are not published: they belong to the checks.
  enum class Phase : std::uint8_t { kFind, kConfigure, kOther, kShifted, kFirst, kRun };
  // One address of the line that the table has a module at.
  struct ChipState {
    TableRow row{};
    std::uint8_t address = 0;  // Address on the line, 0..3.
    Phase phase = Phase::kFind, after_configuration = Phase::kFind;
    std::uint8_t configuration_step = 0;
    bool offsets_only = false;           // The configuration under way sets offsets only.
    std::uint64_t offsets_begun_us = 0;  // Time of the restart before the offsets.
    Presence presence;
    OffsetSearch offsets;
    DuplicateCheck duplicates;
    LatchProbe latch;
    ConfigurationCheck configuration;
    FrozenTaxels frozen;
  };

  [[nodiscard]] std::uint64_t lasted_us() const { return line_->ended_us() - line_->started_us(); }
  [[nodiscard]] bool must_repeat_start();
  void start_next(std::uint64_t now_us);
  void start_transaction();
  void start(Job job);
  void finish(Status status, std::uint64_t now_us);
  void abandon_transfer();
  void handle_no_answer(std::uint64_t now_us);
  void handle_stuck(std::uint64_t now_us);
  void finish_job(Job job, std::uint64_t now_us);
  void finish_identify(std::uint64_t now_us);
  void begin_offsets();
  void settle_offsets();
  void finish_configure();
  void plan_probe();
  void start_probe();
  void finish_read(std::uint64_t now_us);
  void finish_probe();
  [[nodiscard]] bool finish_first_reading(std::uint64_t now_us);
  void finish_probing(std::uint64_t now_us);
  void begin_run();
  void finish_verify(Job job, std::uint64_t now_us);
  void use_results(std::uint64_t now_us);
  void count_missed();
  void find(ChipState& station, std::uint64_t at_us);
  void configure(Phase next);
  void configure_offsets(Phase next);
  [[nodiscard]] int configuration_steps() {
    return current().offsets_only ? Ad7147::kOffsetSteps : Ad7147::kConfigurationSteps;
  }
  void begin_configuration(std::uint8_t address);
  void give_up(wire::ModuleState state, std::uint64_t now_us);
  [[nodiscard]] ChipState& current() { return stations_[current_]; }
  [[nodiscard]] Ad7147::Polarity polarity(Phase phase) const;
  [[nodiscard]] ad7147::Offsets offsets_for(Phase phase);
  [[nodiscard]] PlaceOffsets& place_of(const ChipState& station) {
    return (*offsets_)[static_cast<std::size_t>(line_index_) * layout::kAddressesPerLine + station.address];
  }
  [[nodiscard]] ModuleSample& sample_of(const ChipState& station) { return samples_[index_of(station.row)]; }
  [[nodiscard]] std::size_t number_of(const ChipState& station) const {
    return static_cast<std::size_t>(&station - stations_.data());
  }
  [[nodiscard]] std::uint8_t chip_address() const;
  [[nodiscard]] std::uint32_t sequence_us() const { return ad7147::sequence_us(sampling_.decimation); }
  [[nodiscard]] std::span<ChipState> stations() { return {stations_.data(), station_count_}; }
  [[nodiscard]] std::span<const ChipState> stations() const { return {stations_.data(), station_count_}; }

  I2cLine* line_ = nullptr;
  std::uint8_t line_index_ = 0;
  std::span<ModuleSample> samples_;
  OffsetBook* offsets_ = nullptr;
  bool positive_input_ = false;
  Sampling sampling_;
  std::array<ChipState, layout::kAddressesPerLine> stations_{};
  std::size_t station_count_ = 0, current_ = 0;  // current_ is the chip whose transfer is under way.
  Ad7147 chip_;
  ad7147::Results results_{};
  AddressScan scan_;
  ReadingSchedule schedule_;
  LineRecovery recovery_;
  Job job_ = Job::kIdle;
  bool pausing_ = false;
  int repeats_ = 0;                                      // Repeats of the transfer that starts a sequence.
  std::uint32_t burst_us_ = ReadingSchedule::kBurst_us;  // The shortest burst so far: nobody slowed it down.
  std::uint64_t job_start_us_ = 0, read_ended_us_ = 0;
  std::uint64_t idle_until_us_ = 0;  // Nothing is due before; 0: the schedule has changed since it was asked.
  std::uint32_t bus_errors_ = 0;
};

}  // namespace triskin::fw
