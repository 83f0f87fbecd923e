// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// What is known about one module of the table.
struct ModuleSample {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::array<std::uint16_t, layout::kTaxelsPerModule> raw{};
  std::array<std::uint16_t, layout::kTaxelsPerModule> baseline{};
  std::uint16_t valid = 0;        ///< bit t: taxel t was read in the last cycle, is inside its range and not frozen
  bool has_baseline = false;
};

/// What answers on a line, whether the table knows it or not.
struct LineScan {
  std::uint8_t answers = 0;   ///< bit a: a chip acknowledges at address a
  std::uint8_t wrong_id = 0;  ///< bit a: and its device id is not an AD7147's
  bool stuck = false;
  bool done = false;
};

/// Drives one line: finds, configures, checks and reads its chips one after the other. step() never waits.
/// A stuck line is recovered at most three times in a row, then left alone for a second; the other lines do not notice.
///
/// Two chips at one address answer together and nobody sees it on the bus: their data are a wired AND. So a chip that was found
/// is read at both inputs of its converter. The two results of one chip mirror each other at mid scale; the wired AND of two
/// chips that differ by d counts is smaller by d at least, because x AND y = (x + y − (x XOR y)) / 2 and x XOR y ≥ |x − y|.
class LineSampler {
 public:
  static constexpr std::uint32_t kPeriod_us = ad7147::kSequence_us;
  /// From the start of a sequence until its results stand: the chip's oscillator may be slow.
  static constexpr std::uint64_t kSettle_us = ad7147::kSequence_us * 5ULL / 4;
  static constexpr int kMaxRecoveries = 3;
  static constexpr std::uint64_t kStuckPause_us = 1'000'000, kDuplicatePause_us = 1'000'000;
  static constexpr std::uint64_t kRecent_us = 100'000;  ///< a chip lost so shortly before a new route is taken up where it was
  static constexpr std::uint32_t kVerifyEvery = 16;  ///< cycles between two looks at a chip's configuration
  static constexpr std::uint32_t kMinDeficit = 32;   ///< mean counts missing that two chips at one address are suspected at
  static constexpr int kMinSuspicions = 3;           ///< in a row: a release between the two readings looks the same once
  static constexpr std::uint8_t kFrozenReadings = 32;  ///< lively readings without a change
  static constexpr int kLively = 6;                  ///< taxels that must change for a reading to be lively

  /// Forgets everything and starts anew with the modules of this line. `samples` has one entry a row of the table and outlives
  /// the sampler.
  void begin(I2cLine& line, std::uint8_t line_index, const layout::PatchImage& table, std::span<ModuleSample> samples,
             std::uint64_t now_us);
  /// Also without a table: reports what answers at the four addresses.
  void request_scan();
  /// Finds, configures and checks every chip of the line again.
  void request_check();
  /// Every chip of the table has been through its checks, or cannot be.
  [[nodiscard]] bool checked() const;
  /// Starts nothing new until resume(). True: no transfer is under way.
  bool rest();
  /// Goes on after rest(): chips that were read before are read again at once when they still hold their configuration.
  void resume(std::uint64_t now_us);
  /// Advances. True when a cycle over all modules of the line has ended in this step.
  bool step(std::uint64_t now_us);
  [[nodiscard]] const LineScan& scan() const { return scan_; }
  [[nodiscard]] bool stuck() const { return stuck_; }
  [[nodiscard]] std::uint32_t recoveries() const { return recoveries_; }
  [[nodiscard]] std::uint32_t bus_errors() const { return bus_errors_; }
  /// When step() has something to do; max while a transfer is under way (the line reports its own end).
  [[nodiscard]] std::uint64_t next_event_us() const;

 private:
  enum class Job : std::uint8_t { kIdle, kDrain, kScan, kIdentify, kConfigure, kVerify, kRead };
  enum class Phase : std::uint8_t { kFind, kMirror, kMeasure, kRun };
  struct Slot {
    std::uint8_t module = 0, address = 0;
    Phase phase = Phase::kFind;
    bool single = false;          ///< found to be one chip since it was last absent
    bool verified = false;        ///< configuration seen in this cycle
    std::uint8_t suspicions = 0;
    std::uint64_t ready_us = 0;   ///< nothing to do before
    std::uint64_t lost_us = 0;    ///< when it was read last and then gave no answer
    ad7147::Results mirrored{}, last{};
    std::array<std::uint8_t, ad7147::kStages> still{};  ///< lively readings without a change
  };

  bool start_cycle(std::uint64_t now_us);
  bool start_slot(std::uint64_t now_us);
  void start_scan_step();
  bool finish(Status status, std::uint64_t now_us);
  bool finish_scan_step(Status status, std::uint64_t now_us);
  bool finish_job(Status status, std::uint64_t now_us);
  bool finish_configure(std::uint64_t now_us);
  bool finish_verify(std::uint64_t now_us);
  bool finish_read(std::uint64_t now_us);
  bool check_single(std::uint64_t now_us);
  void configure(Phase phase);
  void store_results();
  [[nodiscard]] std::uint16_t find_frozen(const ad7147::Results& raw);
  bool give_up(wire::ModuleState state, std::uint64_t now_us);
  bool next_slot(std::uint64_t now_us);
  static void lose(Slot& slot, std::uint64_t now_us);
  void handle_stuck(std::uint64_t now_us);
  [[nodiscard]] std::uint8_t chip_address() const;

  I2cLine* line_ = nullptr;
  std::span<ModuleSample> samples_;
  std::array<Slot, layout::kAddressesPerLine> slots_{};
  std::size_t slot_count_ = 0, slot_ = 0;
  Ad7147 chip_;
  Job job_ = Job::kIdle;
  int configure_step_ = 0;
  std::uint8_t scan_address_ = 0;
  bool scan_requested_ = false, stuck_ = false, resting_ = false, verify_all_ = false;
  LineScan scan_;
  std::uint64_t next_cycle_us_ = 0;
  std::uint32_t cycle_ = 0, recoveries_ = 0, bus_errors_ = 0;
  int recoveries_in_row_ = 0;
};

}  // namespace triskin::fw
