// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/address_scan.hpp"
#include "triskin/logic/sampling/chip_setup.hpp"
#include "triskin/logic/sampling/configuration_check.hpp"
#include "triskin/logic/sampling/frozen_taxels.hpp"
#include "triskin/logic/sampling/line_recovery.hpp"
#include "triskin/logic/sampling/module_reading.hpp"
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

/// Drives one line: finds, configures, checks and reads its chips. step() never waits. It moves bytes only; others
/// decide: ReadingSchedule (which transfer is due), ChipSetup (what a chip needs until its readings count), Presence
/// (when an address is asked for its chip), ConfigurationCheck (when it is read back), AddressScan (which chips
/// answer), LineRecovery (how to treat a line that is held low). One bad chip or line does not stop the others.
class LineSampler {
 public:
  /// All lines share these data. Readings and offsets must outlive the sampler, but the table need not.
  struct Patch {
    std::span<const layout::ModuleRow> rows;  ///< of the table
    std::span<ModuleReading> readings;        ///< indexed by the row of the table
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
  // The transfer that is running.
  enum class Job : std::uint8_t {
    kIdle,
    kDrain,  // only its end counts: it was started for something that is over
    kScan,
    kIdentify,
    kIdentifyUnconfigured,  // the chip has lost its configuration; is it still an AD7147?
    kConfigure,
    kRead,
    kProbe,          // of results in mid-sequence
    kVerify,         // the mark of the place
    kVerifyReading,  // the results that were read count only if the mark is right
    kStatus,
    kRestart
  };
  // A configuration is written in several transfers, between the readings of the line's other chips.
  struct Configuration {
    bool running = false, offsets_only = false;
    std::uint8_t step = 0;
    std::uint64_t begun_us = 0;  // the end of its first transfer
    [[nodiscard]] int steps() const { return offsets_only ? Ad7147::kOffsetSteps : Ad7147::kConfigurationSteps; }
  };
  // One AD7147 on this line.
  struct Chip {
    TableRow row{};
    std::uint8_t address = 0;  // on the line, 0..3
    ChipSetup setup;
    Configuration configuration;
    Presence presence;
    ConfigurationCheck check;
    FrozenTaxels frozen;
    bool was_read = false;  // since it was found; its samples are numbered from then on
  };

  [[nodiscard]] Chip& add_chip(TableRow row, std::uint8_t address);
  void start_next(std::uint64_t now_us);
  void start_transaction(Chip& chip);
  void start(Job job);
  void finish(Status status, std::uint64_t now_us);
  void finish_configure(Chip& chip);
  void finish_read(Chip& chip, std::uint64_t now_us);
  void handle_stuck(bool scanning, std::uint64_t now_us);
  void abandon_transfer();
  void find(Chip& chip, std::uint64_t at_us);
  void give_up(Chip& chip, wire::ModuleState state, std::uint64_t now_us);
  void configure(Chip& chip, bool offsets_only);
  void publish(Chip& chip, std::uint64_t now_us);
  void count_missed();
  [[nodiscard]] bool must_repeat_start();
  [[nodiscard]] std::uint64_t lasted_us() const { return line_->ended_us() - line_->started_us(); }
  [[nodiscard]] std::size_t place_number(const Chip& chip) const {
    return static_cast<std::size_t>(line_index_) * layout::kAddressesPerLine + chip.address;
  }
  [[nodiscard]] PlaceOffsets& place_of(const Chip& chip) { return (*offsets_)[place_number(chip)]; }
  [[nodiscard]] std::uint16_t mark_of(const Chip& chip) const { return ad7147::mark(place_number(chip)); }
  [[nodiscard]] ModuleReading& reading_of(const Chip& chip) { return readings_[index_of(chip.row)]; }
  [[nodiscard]] std::size_t number_of(const Chip& chip) const {
    return static_cast<std::size_t>(&chip - chips_.data());
  }
  [[nodiscard]] std::uint32_t sequence_us() const { return ad7147::sequence_us(sampling_.decimation); }
  [[nodiscard]] std::span<Chip> chips() { return {chips_.data(), chip_count_}; }
  [[nodiscard]] std::span<const Chip> chips() const { return {chips_.data(), chip_count_}; }

  I2cLine* line_ = nullptr;
  std::uint8_t line_index_ = 0;
  std::span<ModuleReading> readings_;
  OffsetBook* offsets_ = nullptr;
  bool positive_input_ = false;
  Sampling sampling_;
  std::array<Chip, layout::kAddressesPerLine> chips_{};
  std::size_t chip_count_ = 0, current_ = 0;  // the running transfer belongs to chip current_
  Ad7147 driver_;
  ad7147::Results results_{};
  AddressScan scan_;
  ReadingSchedule schedule_;
  LineRecovery recovery_;
  Job job_ = Job::kIdle;
  bool pausing_ = false;
  int repeats_ = 0;                                      // of the transfer that starts a sequence
  std::uint32_t burst_us_ = ReadingSchedule::kBurst_us;  // the shortest so far was not slowed down by any chip
  std::uint64_t job_start_us_ = 0, read_ended_us_ = 0;
  std::uint64_t idle_until_us_ = 0;  // nothing is due before; 0: the schedule has changed since it was asked
  std::uint32_t bus_errors_ = 0;
};

}  // namespace triskin::fw
