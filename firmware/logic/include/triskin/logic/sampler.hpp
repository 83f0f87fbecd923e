// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/compensation.hpp"
#include "triskin/logic/frozen_taxels.hpp"
#include "triskin/logic/sequence_clock.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// How the converters of a patch are run.
struct Sampling {
  wire::Decimation decimation = wire::Decimation::k256;
  std::uint8_t every = 1;  ///< 1..255: each n-th sequence is read
  bool operator==(const Sampling&) const = default;
};

/// What is known about one module of the table.
struct ModuleSample {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::array<std::uint16_t, layout::kTaxelsPerModule> raw{};
  std::uint16_t valid = 0;    ///< bit t: taxel t was read in the last sequence, is inside its range and not frozen
  std::uint32_t number = 0;   ///< counts the sequences that were to be read: one left out is a lost sample
  std::uint64_t time_us = 0;  ///< end of the sequence
  bool fresh = false;         ///< set by the sampler with each reading or failure, cleared by who sends it on
  std::uint8_t unheard = 0;   ///< nominal sequences since the sampler said something
  Compensation compensation;
};

/// What answers on a line, whether the table knows it or not.
struct LineScan {
  std::uint8_t answers = 0;   ///< bit a: a chip acknowledges at address a
  std::uint8_t wrong_id = 0;  ///< bit a: and its device id is not an AD7147's
  bool stuck = false;
  bool done = false;
};

/// Drives one line: finds, configures, checks and reads its chips. step() never waits. Each chip is read once a
/// sequence, in the window in which its twelve results belong together (SequenceClock): nothing is torn, repeated or
/// left out. When three chips of a line come to end at the same time, so that one could not be read in its window, one
/// begins its next sequence anew a little later. A stuck line is recovered at most three times in a row, then left
/// alone for a second; the other lines do not notice.
///
/// Two chips at one address answer together and nobody sees it on the bus: their data are a wired AND. So a chip that
/// was found is read at both inputs of its converter. The two results of one chip mirror each other at mid scale; the
/// wired AND of two chips that differ by d counts is smaller by d at least, because x AND y = (x + y − (x XOR y)) / 2
/// and x XOR y ≥ |x − y|.
class LineSampler {
 public:
  static constexpr int kMaxRecoveries = 3;
  static constexpr std::uint64_t kStuckPause_us = 1'000'000, kDuplicatePause_us = 1'000'000;
  static constexpr std::uint32_t kVerifyEvery = 16;  ///< readings between two looks at a chip's configuration
  static constexpr std::uint32_t kMinDeficit =
      32;  ///< mean counts missing that two chips at one address are suspected at
  static constexpr std::uint64_t kRecent_us =
      100'000;                              ///< a chip lost so shortly before a new route is taken up where it was
  static constexpr int kMinSuspicions = 3;  ///< in a row: a release between the two readings looks the same once
  static constexpr std::uint64_t kBurst_us = 800;  ///< on the line, and until the next transfer can begin
  static constexpr std::uint64_t kStep_us = 500,
                                 kShort_us = 250;  ///< a step of the configuration; other transfers beside a reading:
                                                   ///< begun only when no reading falls due meanwhile

  /// Forgets everything and starts anew with the modules of this line. `samples` has one entry a row of the table and
  /// outlives the sampler.
  void begin(I2cLine& line, std::uint8_t line_index, const layout::PatchImage& table, std::span<ModuleSample> samples,
             const Sampling& sampling, std::uint64_t now_us);
  /// Also without a table: reports what answers at the four addresses.
  void request_scan();
  /// Finds, configures and checks every chip of the line again.
  void request_check();
  /// Every chip of the table has been through its checks, or cannot be.
  [[nodiscard]] bool checked() const;
  /// Starts nothing new until resume(). True: no transfer is under way.
  bool rest();
  /// Goes on after rest(): chips that were read before go on when they still hold their configuration.
  void resume(std::uint64_t now_us);
  /// Does what is due.
  void step(std::uint64_t now_us);
  [[nodiscard]] const LineScan& scan() const { return scan_; }
  [[nodiscard]] bool stuck() const { return stuck_; }
  [[nodiscard]] std::uint32_t recoveries() const { return recoveries_; }
  [[nodiscard]] std::uint32_t bus_errors() const { return bus_errors_; }
  [[nodiscard]] std::uint32_t lost_sequences() const { return lost_; }  ///< came and went unread
  /// When step() has something to do after `now_us`; max while a transfer is under way (the line reports its own end).
  [[nodiscard]] std::uint64_t next_event_us(std::uint64_t now_us) const;

 private:
  enum class Job : std::uint8_t {
    kIdle,
    kDrain,
    kScan,
    kIdentify,
    kConfigure,
    kRead,
    kVerify,
    kClear,
    kLook,
    kRestart
  };
  enum class Phase : std::uint8_t { kFind, kConfigure, kMirror, kMeasure, kRun };
  struct Slot {
    std::uint8_t module = 0, address = 0;
    Phase phase = Phase::kFind, next_phase = Phase::kFind;  ///< next: after the configuration
    std::uint8_t step = 0;                                  ///< of the configuration
    bool single = false;                                    ///< found to be one chip since it was last absent
    bool lost = false;                                      ///< its configuration is; who answers there is asked for
    bool clear_wanted = false, verify_wanted = false, restart_wanted = false;
    std::uint64_t status_us = 0;  ///< when the status was read, and so cleared, in this sequence; 0: not yet
    int look_stage = 0;           ///< whose end is looked at next
    std::uint8_t suspicions = 0, unverified = 0;  ///< readings since the configuration was seen
    bool recheck = false;                         ///< the next reading counts only when the configuration holds
    std::uint32_t to_pass = 0;                    ///< sequences until the one that is to be sampled: 0, the present one
    std::uint32_t passed = 0;                     ///< sequences that the clock went on by
    std::uint64_t lost_us = 0;                    ///< when it was read last and then gave no answer
    std::uint64_t ready_us = 0;                   ///< when to look for the chip again, or to begin its sequence anew
    SequenceClock clock;
    ad7147::Results mirrored{};
    FrozenTaxels frozen;
    [[nodiscard]] bool reading() const {
      return phase != Phase::kFind && phase != Phase::kConfigure;
    }  ///< once a sequence
  };

  void choose(std::uint64_t now_us);
  [[nodiscard]] std::uint64_t reading_due_us(const Slot& slot) const;
  [[nodiscard]] static std::uint64_t other_due_us(const Slot& slot);
  [[nodiscard]] static std::uint64_t other_length_us(const Slot& slot) {
    return slot.phase == Phase::kConfigure ? kStep_us : kShort_us;
  }
  [[nodiscard]] std::uint64_t next_reading_us() const;
  void skip_missed(Slot& slot, std::uint64_t now_us);
  void start_reading(std::uint64_t now_us);
  void start_other(std::uint64_t now_us);
  void start_scan_step();
  void finish(Status status, std::uint64_t now_us);
  void finish_scan_step(Status status);
  void finish_job(std::uint64_t now_us);
  void finish_identify(std::uint64_t now_us);
  void finish_configure();
  void finish_verify(std::uint64_t now_us);
  void finish_read(std::uint64_t now_us);
  void finish_clear();
  void finish_look();
  [[nodiscard]] std::uint64_t next_choice_us(std::uint64_t now_us) const;
  [[nodiscard]] static std::uint64_t look_start_us(const Slot& slot);
  [[nodiscard]] static std::uint64_t last_look_us(const Slot& slot);
  static void plan_look(Slot& slot);
  static void drop_late_look(Slot& slot, std::uint64_t now_us);
  void finish_sequence(std::uint64_t now_us);
  void finish_restart();
  void check_single(std::uint64_t now_us);
  void configure(Phase next);
  void verify();
  void store_results();
  void publish(std::uint64_t time_us);
  [[nodiscard]] static std::uint64_t end_near(const Slot& slot, const Slot& other);
  [[nodiscard]] static std::uint64_t end_distance(const Slot& slot, const Slot& other);
  [[nodiscard]] bool would_miss(const Slot& slot) const;
  [[nodiscard]] std::uint64_t restart_moment_us(const Slot& slot, std::uint64_t now_us) const;
  static void advance(Slot& slot);
  void give_up(wire::ModuleState state, std::uint64_t now_us);
  static void lose(Slot& slot, std::uint64_t now_us);
  void handle_stuck(std::uint64_t now_us);
  [[nodiscard]] std::uint8_t chip_address() const;
  [[nodiscard]] std::uint32_t sequence_us() const { return ad7147::sequence_us(sampling_.decimation); }
  [[nodiscard]] std::span<Slot> slots() { return {slots_.data(), slot_count_}; }
  [[nodiscard]] std::span<const Slot> slots() const { return {slots_.data(), slot_count_}; }

  I2cLine* line_ = nullptr;
  std::span<ModuleSample> samples_;
  Sampling sampling_;
  std::array<Slot, layout::kAddressesPerLine> slots_{};
  std::size_t slot_count_ = 0, slot_ = 0;
  Ad7147 chip_;
  ad7147::Results results_{};
  Job job_ = Job::kIdle;
  std::uint8_t scan_address_ = 0;
  bool scan_requested_ = false, stuck_ = false, resting_ = false;
  LineScan scan_;
  std::uint64_t paused_until_us_ = 0, job_start_us_ = 0;
  std::uint64_t idle_until_us_ = 0;  // choose() would do nothing before; 0: it was not asked since something changed
  std::uint32_t recoveries_ = 0, bus_errors_ = 0, lost_ = 0;
  int recoveries_in_row_ = 0;
};

}  // namespace triskin::fw
