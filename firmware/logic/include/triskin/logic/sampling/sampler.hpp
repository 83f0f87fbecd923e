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

/// The settings apply to all converters of a patch.
struct Sampling {
  wire::Decimation decimation = wire::Decimation::k256;
  std::uint8_t every = 1;  ///< Each n-th sequence is read, 1..255.
  wire::SamplingTiming timing = wire::SamplingTiming::kTracked;
  bool operator==(const Sampling&) const = default;
};

/// Drives one line: finds, configures, checks and reads its chips. step() never waits. It makes the transfers and
/// passes their results to the parts that decide: AddressScan (which chips answer), Presence (when an address is asked
/// for its chip), OffsetSearch (the offset of each stage), DuplicateCheck (one chip or two), LatchProbe (when a chip
/// shows its results), ConfigurationCheck (when to read it back), ReadingSchedule (which transfer is due), LineRecovery
/// (how to treat a line that is held low). One bad chip or line does not stop the others.
class LineSampler {
 public:
  /// All lines share these data. Samples and offsets must outlive the sampler, but the table need not.
  struct Patch {
    std::span<const layout::ModuleRow> rows;  ///< The rows are those of the table.
    std::span<ModuleSample> samples;          ///< The samples are indexed by the row of the table.
    OffsetBook& offsets;
    bool positive_input = false;  ///< The electrodes are on the positive input, so results are inverted.
  };
  /// Discards everything except the offsets and starts again with those modules of the table that are on this line.
  void begin(I2cLine& line, std::uint8_t line_index, const Patch& patch, const Sampling& sampling,
             std::uint64_t now_us);
  /// Replaces the modules that are not in the table: adopted module k has row `own_rows` + k and is read at its stated
  /// place. The modules of the table and the first `kept` adopted modules continue unchanged. Call it between pause()
  /// and resume(), when no transfer is running.
  void replace_adopted(std::size_t own_rows, std::span<const wire::AdoptedModule> adopted_modules, std::size_t kept,
                       std::uint64_t now_us);
  /// Requests a scan of the four addresses, which works without a table; scan() has the result.
  void request_scan();
  /// Lets every chip of the line be found, configured and checked again.
  void request_check();
  /// Does the same as request_check(), and searches the offsets from the beginning.
  void request_offsets();
  /// Returns true if every chip of the table has passed its checks, or cannot be checked.
  [[nodiscard]] bool checked() const;
  /// Starts nothing new until resume(). Returns true if no transfer is running.
  [[nodiscard]] bool pause();
  /// Continues after pause(): chips that were read before continue if they still have their configuration.
  void resume(std::uint64_t now_us);
  /// Performs the work that is due.
  void step(std::uint64_t now_us);
  /// Returns the result of the last scan of the addresses.
  [[nodiscard]] const LineScan& scan() const { return scan_.result(); }
  /// Returns true while SDA or SCL is held low.
  [[nodiscard]] bool stuck() const { return recovery_.stuck(); }
  /// Counts bus clears since the sampler started.
  [[nodiscard]] std::uint32_t recoveries() const { return recovery_.count(); }
  /// Counts the transfers that failed since the sampler was made.
  [[nodiscard]] std::uint32_t bus_errors() const { return bus_errors_; }
  /// Returns when step() has work after `now_us`; the largest value while a transfer is running, because the line
  /// reports its end.
  [[nodiscard]] std::uint64_t next_event_us(std::uint64_t now_us) const;

 private:
  // Names the transfer that is running.
  enum class Job : std::uint8_t {
    kIdle,
    kDrain,  // Only the end of this transfer counts, because it is from before begin().
    kScan,
    kIdentify,
    kIdentifyUnconfigured,  // The chip has lost its configuration, so its id is read to see if it is still an AD7147.
    kConfigure,
    kRead,
    kProbe,  // These results are read in mid-sequence, for LatchProbe.
    kVerify,
    kVerifyReading,  // The results that were read count only if the configuration is correct.
    kStatus,
    kRestart
  };
  // Each chip has one of these goals. Readings of kOther (the unused input), kShifted (the used one with other offsets)
  // and kFirst (as it is used) are not published, because they belong to the checks.
  enum class Phase : std::uint8_t { kFind, kConfigure, kOther, kShifted, kFirst, kRun };
  // Each address of the line at which the table has a module has this state.
  struct ChipState {
    TableRow row{};
    std::uint8_t address = 0;  // The address on the line is 0..3.
    Phase phase = Phase::kFind, after_configuration = Phase::kFind;
    std::uint8_t configuration_step = 0;
    bool offsets_only = false;           // The present configuration sets only offsets.
    std::uint64_t offsets_begun_us = 0;  // The sequence was restarted at this time, before the offsets.
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
  std::size_t station_count_ = 0, current_ = 0;  // The running transfer belongs to chip current_.
  Ad7147 chip_;
  ad7147::Results results_{};
  AddressScan scan_;
  ReadingSchedule schedule_;
  LineRecovery recovery_;
  Job job_ = Job::kIdle;
  bool pausing_ = false;
  int repeats_ = 0;                                      // The transfer that starts a sequence was repeated this often.
  std::uint32_t burst_us_ = ReadingSchedule::kBurst_us;  // The shortest burst so far was not slowed down by any chip.
  std::uint64_t job_start_us_ = 0, read_ended_us_ = 0;
  // Nothing is due before this time; 0 means that the schedule has changed since it was asked.
  std::uint64_t idle_until_us_ = 0;
  std::uint32_t bus_errors_ = 0;
};

}  // namespace triskin::fw
