// SPDX-License-Identifier: GPL-3.0-or-later
// Times are in µs. A sequence lasts 9,200 nominally, so 8,832 to 9,568 where the oscillator is known to 4 %. When it
// was started at T, ± 25, then
//   it ends in                      T + 8,807 … T + 9,593, the middle is T + 9,200;
//   its reading may start from      T + 9,033   the last result comes 585 later, 25 of margin after T + 9,593;
//                          until    T + 9,383   the first one comes 135 later, 25 before T + 8,807 + 8,832 / 12;
//   it has begun for certain at     T + 761     one shortest period before T + 9,593.
#include "triskin/logic/sampling/reading_schedule.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <vector>

namespace triskin::fw {

void PrintTo(const ReadingSchedule::Due& due, std::ostream* out) {
  *out << "action " << static_cast<int>(due.action) << " of chip " << due.chip;
}

namespace {

using Action = ReadingSchedule::Action;
using Due = ReadingSchedule::Due;

constexpr std::uint32_t kNominal_us = 9'200, kTolerance_percent = 4;
constexpr std::uint64_t kT = 1'000'000;
constexpr Due kNothing{};

ReadingSchedule schedule_of(std::size_t chips, std::uint8_t every = 1) {
  ReadingSchedule schedule;
  schedule.begin(chips, kNominal_us, every, wire::SamplingTiming::kTracked, kTolerance_percent);
  return schedule;
}

// Starts a chip at `at_us` whose status is not wanted.
void start_without_status(ReadingSchedule& schedule, std::size_t chip, std::uint64_t at_us) {
  schedule.start(chip, at_us);
  schedule.forget_status(chip);
}

TEST(ReadingSchedule, AChipThatIsNotStartedAsksForNothing) {
  ReadingSchedule schedule = schedule_of(4);
  EXPECT_EQ(schedule.due(kT), kNothing);
  EXPECT_EQ(schedule.next_us(kT), ReadingSchedule::kNever_us);
}

TEST(ReadingSchedule, AReadingIsDueWithinItsWindow) {
  ReadingSchedule schedule = schedule_of(1);
  start_without_status(schedule, 0, kT);
  EXPECT_EQ(schedule.due(kT + 9'032), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 9'032), kT + 9'033);
  EXPECT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
  EXPECT_EQ(schedule.due(kT + 9'383), (Due{Action::kRead, 0}));  // It was requested again because it was not begun.
  EXPECT_EQ(schedule.read(0, kT + 10'000), kT + 9'200);
  EXPECT_EQ(schedule.take_missed(0), 0U);
}

TEST(ReadingSchedule, ASequenceWhoseWindowHasClosedIsMissed) {
  ReadingSchedule schedule = schedule_of(1);
  start_without_status(schedule, 0, kT);
  EXPECT_EQ(schedule.due(kT + 9'384), kNothing);
  EXPECT_EQ(schedule.take_missed(0), 1U);
  EXPECT_EQ(schedule.take_missed(0), 0U);
}

// One of three sequences is sampled: the first one is missed, and the second one, which is not read either, was not
// meant to be sampled.
TEST(ReadingSchedule, OnlySequencesThatWereToBeSampledAreMissed) {
  ReadingSchedule schedule = schedule_of(1, 3);
  start_without_status(schedule, 0, kT);
  (void)schedule.due(kT + 9'384);
  (void)schedule.due(kT + 18'300);
  EXPECT_EQ(schedule.take_missed(0), 1U);
}

// Without a reading of the status the second sequence ends in T + 17,639 … T + 19,161: 1,522 wide, too wide for a
// window, 18,601 … 18,214. The third one is 2,258 wide, of which 2 * (736 + 2 * 25) = 1,572 come from the period
// alone: the clock is uncertain and the sequence is begun anew at once. Nothing is due before T + 28,169.
TEST(ReadingSchedule, AnUncertainClockBeginsAnew) {
  ReadingSchedule schedule = schedule_of(1);
  start_without_status(schedule, 0, kT);
  EXPECT_EQ(schedule.due(kT + 9'384), kNothing);
  EXPECT_EQ(schedule.due(kT + 18'300), (Due{Action::kRestart, 0}));
  EXPECT_EQ(schedule.take_missed(0), 2U);
  schedule.restarted(0, kT + 18'350);
  EXPECT_EQ(schedule.due(kT + 18'350 + 761), (Due{Action::kStatus, 0}));
  schedule.forget_status(0);
  EXPECT_EQ(schedule.due(kT + 18'350 + 9'032), kNothing);
  EXPECT_EQ(schedule.due(kT + 18'350 + 9'033), (Due{Action::kRead, 0}));
}

// The two were started 100 apart: at T + 9,133 the windows of both are open, and the one that closes first is read
// first.
TEST(ReadingSchedule, TheEarliestEndIsReadFirst) {
  ReadingSchedule schedule = schedule_of(2);
  start_without_status(schedule, 1, kT);
  start_without_status(schedule, 0, kT + 100);
  EXPECT_EQ(schedule.due(kT + 9'133), (Due{Action::kRead, 1}));
  EXPECT_TRUE(schedule.read(1, kT + 9'300));
  EXPECT_EQ(schedule.due(kT + 9'300), (Due{Action::kRead, 0}));
}

// The expected time is 500 before T + 9,033.
TEST(ReadingSchedule, ATransactionEndsBeforeTheNextWindowOpens) {
  ReadingSchedule schedule = schedule_of(2);
  start_without_status(schedule, 0, kT);
  schedule.plan_transaction(1, kT + 100, ReadingSchedule::kLong_us);
  EXPECT_EQ(schedule.due(kT + 99), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 99), kT + 100);
  EXPECT_EQ(schedule.due(kT + 100), (Due{Action::kTransaction, 1}));
  EXPECT_EQ(schedule.due(kT + 8'533), (Due{Action::kTransaction, 1}));
  EXPECT_EQ(schedule.due(kT + 8'534), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 8'534), kT + 9'033);
  schedule.plan_transaction(1, 0, ReadingSchedule::kShort_us);
  EXPECT_EQ(schedule.due(kT + 8'783), (Due{Action::kTransaction, 1}));
  EXPECT_EQ(schedule.due(kT + 8'784), kNothing);
  schedule.cancel_transaction(1);
  EXPECT_EQ(schedule.due(kT + 5'000), kNothing);
}

// Transactions of two chips are ordered by number, and precede the status for which both chips wait.
TEST(ReadingSchedule, ATransactionComesBeforeTheStatus) {
  ReadingSchedule schedule = schedule_of(2);
  schedule.start(0, kT);
  schedule.start(1, kT);
  schedule.plan_transaction(0, kT + 2'000, ReadingSchedule::kShort_us);
  schedule.plan_transaction(1, kT + 1'000, ReadingSchedule::kShort_us);
  EXPECT_EQ(schedule.due(kT + 1'000), (Due{Action::kTransaction, 1}));
  EXPECT_EQ(schedule.due(kT + 2'000), (Due{Action::kTransaction, 0}));
  schedule.cancel_transaction(0);
  EXPECT_EQ(schedule.due(kT + 2'000), (Due{Action::kStatus, 0}));
}

TEST(ReadingSchedule, AStoppedChipIsNotReadAndGoesOnWhenTakenUp) {
  ReadingSchedule schedule = schedule_of(1);
  schedule.start(0, kT);
  schedule.stop(0);
  schedule.plan_transaction(0, kT + 20'000, ReadingSchedule::kShort_us);
  EXPECT_EQ(schedule.due(kT + 9'033), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 9'033), kT + 20'000);
  schedule.plan_transaction(0, 0, ReadingSchedule::kShort_us);
  schedule.take_up(0);
  EXPECT_EQ(schedule.due(kT + 5'000), kNothing);
  EXPECT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
}

// The status is cleared first, from T + 25 on.
TEST(ReadingSchedule, TheStatusIsClearedWhenTheSequenceHasBegun) {
  ReadingSchedule schedule = schedule_of(1);
  schedule.start(0, kT);
  EXPECT_EQ(schedule.due(kT + 24), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 24), kT + 25);
  EXPECT_EQ(schedule.due(kT + 25), (Due{Action::kStatus, 0}));
}

// The status was cleared at T + 875 (25 before the end of its transfer). Stages end 766 apart, stage 11 at T + 9,200:
// stage 0 at T + 767, stage 1 at T + 1,534, stage 2 at T + 2,300. Two stages of a period that is known to 736 are known
// to 123, and 50 by the start: the stage before the wanted one must end 86 and 50 after T + 875, that is after T +
// 1,011: stage 1. So stage 2 is the first. The chip samples the status 120 after the start of a transfer: T + 2,180, at
// most 30 + (3 · 736 / 12 + 50) / 8 = 59 later.
struct Refinement : testing::Test {
  ReadingSchedule schedule = schedule_of(1);
  void SetUp() override {
    schedule.start(0, kT);
    ASSERT_EQ(schedule.due(kT + 761), (Due{Action::kStatus, 0}));
    schedule.status_read(0, 0, kT + 900);
  }
};

TEST_F(Refinement, BeginsWithTheFirstStageThatCanShowIt) {
  EXPECT_EQ(schedule.due(kT + 2'179), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 900), kT + 2'180);
  EXPECT_EQ(schedule.due(kT + 2'180), (Due{Action::kStatus, 0}));
  EXPECT_EQ(schedule.due(kT + 2'239), (Due{Action::kStatus, 0}));
}

// Cleared at T + 1,400 instead, the stage before must end after T + 1,536. Stage 2 does, stage 1 does not: stage 3 is
// the first, from T + 3,067 − 120 on.
TEST_F(Refinement, BeginsLaterWhenTheStatusWasClearedLater) {
  schedule.start(0, kT);
  schedule.status_read(0, 0, kT + 1'425);
  EXPECT_EQ(schedule.next_us(kT + 1'425), kT + 2'947);
}

// It is too late for stage 2. Stage 3 ends at T + 3,067, and the status is read from T + 2,947 on.
TEST_F(Refinement, TakesTheNextStageWhenItIsTooLate) {
  EXPECT_EQ(schedule.due(kT + 2'240), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 2'240), kT + 2'947);
  EXPECT_EQ(schedule.due(kT + 2'947), (Due{Action::kStatus, 0}));
}

// Stages 1 and 2 had ended at T + 2,300 (± 25, as the start): twelve last 4 * 2,350 = 9,400 at the longest, instead of
// 9,568. Nine stages remain, 7,050: the sequence ends by T + 9,375 instead of T + 9,593, and the window opens 218
// earlier.
TEST_F(Refinement, AStageThatHasEndedOpensTheWindowEarlier) {
  schedule.status_read(0, 0b0110, kT + 2'325);
  schedule.forget_status(0);
  EXPECT_EQ(schedule.due(kT + 8'814), kNothing);
  EXPECT_EQ(schedule.due(kT + 8'815), (Due{Action::kRead, 0}));
}

// Stage 2 had not ended at T + 2,300: twelve last 4 · 2,250 = 9,000 at least, nine 6,750: the sequence ends after
// T + 9,025 instead of T + 8,807, a stage lasts 750 instead of 736 (less the clock's wander and rounding, 1 each). The
// window closes at T + 9,025 + 750 − 135 − 25 = T + 9,615.
TEST_F(Refinement, AStageThatHasNotEndedKeepsTheWindowOpen) {
  schedule.status_read(0, 0b0010, kT + 2'325);
  schedule.forget_status(0);
  EXPECT_EQ(schedule.due(kT + 9'613), (Due{Action::kRead, 0}));
  EXPECT_EQ(schedule.due(kT + 9'616), kNothing);
  EXPECT_EQ(schedule.take_missed(0), 1U);
}

// Stage 1 had ended long before T + 2,300 in any case. Without its bit the chip does not convert, so reading the status
// again is useless, and the window stays as it was.
TEST_F(Refinement, AChipThatDoesNotConvertRefinesNothing) {
  schedule.status_read(0, 0b0100, kT + 2'325);
  EXPECT_EQ(schedule.next_us(kT + 2'325), kT + 9'033);
}

TEST_F(Refinement, EndsWhenTheStatusIsNotAcknowledged) {
  schedule.failed(0);
  EXPECT_EQ(schedule.next_us(kT + 2'325), kT + 9'033);
}

// A due reading ends the search for a stage, at the latest. A status that says at T + 9,800 that stage 11 has not
// ended, but stage 10 has, would contradict the clock and move the window.
TEST_F(Refinement, EndsWithTheReading) {
  EXPECT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
  schedule.status_read(0, 1U << 10, kT + 9'825);
  EXPECT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
}

// Three chips end together and a reading takes 800 of the line: one of the others could not be read in its window. The
// one that has just been read, at T + 9,673, begins anew at a moment from which its end, 9,200 later, is 1,600 from
// theirs (T + 18,400), in steps of 200: 9,673 + 6 · 200 = 10,873; 10,673 + 9,200 would be 1,473 from them.
TEST(ReadingSchedule, OfThreeChipsThatEndTogetherOneBeginsLater) {
  ReadingSchedule schedule = schedule_of(3);
  for (std::size_t k = 0; k < 3; ++k) start_without_status(schedule, k, kT);
  ASSERT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
  EXPECT_EQ(schedule.read(0, kT + 9'673), kT + 9'200);
  EXPECT_EQ(schedule.due(kT + 10'872), kNothing);
  EXPECT_EQ(schedule.next_us(kT + 10'872), kT + 10'873);
  EXPECT_EQ(schedule.due(kT + 10'873), (Due{Action::kRestart, 0}));
}

// One of three sequences is sampled: the one that has just been read. The one that begins anew at R is not: the clock
// continues to the next, whose status is cleared from R + 25 + 2 · 9,568 − 8,832 = R + 10,329 on, not from R + 761
// on.
TEST(ReadingSchedule, ARestartedSequenceThatIsNotSampledIsPassedOver) {
  ReadingSchedule schedule = schedule_of(3, 3);
  for (std::size_t k = 0; k < 3; ++k) start_without_status(schedule, k, kT);
  ASSERT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
  ASSERT_TRUE(schedule.read(0, kT + 9'673));
  schedule.stop(1);
  schedule.stop(2);
  ASSERT_EQ(schedule.due(kT + 10'873), (Due{Action::kRestart, 0}));
  constexpr std::uint64_t kR = kT + 11'000;
  schedule.restarted(0, kR);
  EXPECT_EQ(schedule.due(kR + 10'328), kNothing);
  EXPECT_EQ(schedule.due(kR + 10'329), (Due{Action::kStatus, 0}));
}

// A restart because of an uncertain clock is not acknowledged, so the clock is as uncertain as before.
TEST(ReadingSchedule, ARestartThatFailedIsTriedAgainWhileTheClockIsUncertain) {
  ReadingSchedule schedule = schedule_of(1);
  start_without_status(schedule, 0, kT);
  (void)schedule.due(kT + 9'384);
  ASSERT_EQ(schedule.due(kT + 18'300), (Due{Action::kRestart, 0}));
  schedule.failed(0);
  EXPECT_EQ(schedule.due(kT + 18'500), (Due{Action::kRestart, 0}));
}

// A failed restart because of others that end at the same time is not repeated: the next reading finds out whether it
// is still needed.
TEST(ReadingSchedule, ARestartThatFailedIsNotTriedAgainForTheSakeOfOthers) {
  ReadingSchedule schedule = schedule_of(3);
  for (std::size_t k = 0; k < 3; ++k) start_without_status(schedule, k, kT);
  ASSERT_EQ(schedule.due(kT + 9'033), (Due{Action::kRead, 0}));
  ASSERT_TRUE(schedule.read(0, kT + 9'673));
  ASSERT_EQ(schedule.due(kT + 10'873), (Due{Action::kRestart, 0}));
  schedule.failed(0);
  EXPECT_EQ(schedule.due(kT + 10'973), kNothing);
}

// Simulates a chip whose sequences last exactly 9,200, and a line that serves it alone: 145 for the status (sampled 25
// before its end), 640 for a reading, 110 for a restart.
struct Line {
  ReadingSchedule schedule;
  std::uint64_t now_us = kT, started_us = kT, status_us = kT;
  std::vector<std::uint64_t> sampled{};
  int restarts = 0, statuses = 0;
  std::uint32_t status_length_us = 145, after_status_us = 25;
  std::uint64_t period_us = kNominal_us;

  // Stage s ends (s + 1) / 12 of a period after the start, and every period after that.
  [[nodiscard]] std::uint16_t status_at(std::uint64_t at_us) const {
    unsigned bits = 0;
    for (unsigned s = 0; s < 12; ++s) {
      const auto ends = [&](std::uint64_t t) { return (t - started_us + period_us * (11 - s) / 12) / period_us; };
      bits |= ends(at_us) > ends(status_us) ? 1U << s : 0U;
    }
    return static_cast<std::uint16_t>(bits);
  }
  void serve() {
    switch (schedule.due(now_us).action) {
      case Action::kRead:
        now_us += 640;
        if (const auto end_us = schedule.read(0, now_us)) sampled.push_back(*end_us);
        return;
      case Action::kStatus: {
        const std::uint64_t sampled_us = now_us + status_length_us - after_status_us;
        const std::uint16_t status = status_at(sampled_us);
        status_us = sampled_us;
        now_us += status_length_us;
        ++statuses;
        return schedule.status_read(0, status, now_us, status_length_us);
      }
      case Action::kRestart:
        now_us += 110;
        ++restarts;
        started_us = status_us = now_us;
        return schedule.restarted(0, now_us);
      default:
        now_us = schedule.next_us(now_us);
    }
  }
};

// Sequences 1, 4, 7 … of the chip end at T + 9,200, T + 36,800, T + 64,400 …; the schedule knows it to ± 150.
TEST(ReadingSchedule, SamplesEachThirdSequence) {
  Line line{schedule_of(1, 3)};
  line.schedule.start(0, kT);
  while (line.sampled.size() < 200) line.serve();
  for (std::size_t k = 0; k < line.sampled.size(); ++k)
    EXPECT_NEAR(static_cast<double>(line.sampled[k]), static_cast<double>(kT + 9'200 + 27'600 * k), 150.0) << k;
  EXPECT_EQ(line.schedule.take_missed(0), 0U);
  EXPECT_EQ(line.restarts, 0);
}

TEST(ReadingSchedule, SamplesEachSequenceOfAChipThatIsAlone) {
  Line line{schedule_of(1)};
  line.schedule.start(0, kT);
  while (line.sampled.size() < 2'000) line.serve();
  for (std::size_t k = 0; k < line.sampled.size(); ++k)
    EXPECT_NEAR(static_cast<double>(line.sampled[k]), static_cast<double>(kT + 9'200 + 9'200 * k), 150.0) << k;
  EXPECT_EQ(line.schedule.take_missed(0), 0U);
  EXPECT_EQ(line.restarts, 0);
}

// The data sheet's limits of the oscillator are unknown: until the first end is measured, ± 12 % are possible. A chip
// that shows its results stage by stage is read in its first sequence if the status can be read meanwhile, and in each
// one after that.
TEST(ReadingSchedule, SamplesAChipWhoseOscillatorIsFarOff) {
  for (const int percent : {-12, -10, -8, -5, 5, 8, 10, 12}) {
    for (const wire::Latching latching : {wire::Latching::kEachStage, wire::Latching::kEndOfSequence}) {
      Line line;
      line.schedule.begin(1, kNominal_us, 1);
      line.period_us = static_cast<std::uint64_t>(92 * (100 + percent));
      line.schedule.start(0, kT, latching);
      while (line.sampled.size() < 500) line.serve();
      for (std::size_t k = 0; k < line.sampled.size(); ++k)
        ASSERT_NEAR(static_cast<double>(line.sampled[k]), static_cast<double>(kT + (k + 1) * line.period_us), 150.0)
            << percent << " %, sequence " << k;
      EXPECT_EQ(line.schedule.take_missed(0), 0U) << percent << " %";
      EXPECT_EQ(line.restarts, 0) << percent << " %";
    }
  }
}

// SCL that rises in 300 ns makes each bit 17 % longer, so the chip samples the status later. The schedule begins
// earlier, hence learns as much from each status and needs no more of them.
TEST(ReadingSchedule, SlowEdgesNeedNoMoreStatuses) {
  constexpr std::size_t kSequences = 1'000;
  const auto statuses = [](std::uint32_t length_us, std::uint32_t after_us) {
    Line line{schedule_of(1)};
    line.status_length_us = length_us;
    line.after_status_us = after_us;
    line.schedule.start(0, kT);
    while (line.sampled.size() < kSequences) line.serve();
    EXPECT_EQ(line.schedule.take_missed(0), 0U);
    EXPECT_EQ(line.restarts, 0);
    return line.statuses;
  };
  const int fast = statuses(145, 25), slow = statuses(170, 29);
  std::printf("%d readings of the status with fast edges, %d with slow ones, in %zu sequences\n", fast, slow,
              kSequences);
  EXPECT_LE(slow, fast + fast / 10);
}

// A burst of 640 µs may begin until the window closes, but one that was slowed down ends later.
TEST(ReadingSchedule, ABurstThatEndedTooLateIsNotInTime) {
  ReadingSchedule schedule;
  schedule.begin(1, 9'200, 1);
  schedule.start(0, 1'000'000);
  SequenceClock clock;
  clock.start(1'000'000, 9'200);
  EXPECT_TRUE(schedule.in_time(0, clock.last_start_us() + 640, 640));
  EXPECT_TRUE(schedule.in_time(0, clock.last_start_us() + 640 + 20, 640));
  EXPECT_FALSE(schedule.in_time(0, clock.last_start_us() + 640 + 21, 640));
}

// With a timer the first reading is due when the slowest converter has ended its sequence, 105 % of the nominal one
// after the start (9,660), and then one every 9,200. One that would end within the next one is missed: 8,400 later.
ReadingSchedule by_timer(std::size_t chips, std::uint8_t every = 1) {
  ReadingSchedule schedule;
  schedule.begin(chips, kNominal_us, every, wire::SamplingTiming::kTimer, kTolerance_percent);
  return schedule;
}

TEST(ReadingByTimer, IsDueOnceANominalSequenceAndAsksForNothingElse) {
  ReadingSchedule schedule = by_timer(1);
  schedule.start(0, kT);
  EXPECT_EQ(schedule.next_us(kT), kT + 9'660) << "no status, no restart";
  EXPECT_EQ(schedule.due(kT + 9'659), kNothing);
  EXPECT_EQ(schedule.due(kT + 9'660), (Due{Action::kRead, 0}));
  EXPECT_TRUE(schedule.in_time(0, kT + 100'000, 700)) << "nobody asks what the chip converts meanwhile";
  EXPECT_EQ(schedule.read(0, kT + 10'400), kT + 10'400) << "its time is that of the reading";
  EXPECT_EQ(schedule.next_us(kT + 10'400), kT + 18'860);
  schedule.status_read(0, 0xFFF, kT + 11'000);
  EXPECT_EQ(schedule.next_us(kT + 11'000), kT + 18'860);
}

TEST(ReadingByTimer, OneThatComesTooLateIsMissed) {
  ReadingSchedule schedule = by_timer(1);
  schedule.start(0, kT);
  EXPECT_EQ(schedule.due(kT + 18'060), (Due{Action::kRead, 0}));
  EXPECT_EQ(schedule.due(kT + 18'061), kNothing);
  EXPECT_EQ(schedule.take_missed(0), 1U);
  EXPECT_EQ(schedule.next_us(kT + 18'061), kT + 18'860);
}

TEST(ReadingByTimer, EachThirdOneOnly) {
  ReadingSchedule schedule = by_timer(1, 3);
  schedule.start(0, kT);
  EXPECT_TRUE(schedule.read(0, kT + 9'660));
  EXPECT_EQ(schedule.next_us(kT + 10'000), kT + 9'660 + 27'600);
  EXPECT_TRUE(schedule.read(0, kT + 37'260));
}

// Four chips that were started one after the other are read in the same order, and planned transactions have their
// place between them.
TEST(ReadingByTimer, SharesTheLineAmongItsChips) {
  ReadingSchedule schedule = by_timer(2);
  schedule.start(0, kT);
  schedule.start(1, kT + 300);
  schedule.plan_transaction(1, kT, ReadingSchedule::kShort_us);
  EXPECT_EQ(schedule.due(kT + 1'000), (Due{Action::kTransaction, 1}));
  EXPECT_EQ(schedule.due(kT + 9'500), kNothing) << "it would end after a reading falls due";
  EXPECT_EQ(schedule.due(kT + 9'960), (Due{Action::kRead, 0}));
  EXPECT_TRUE(schedule.read(0, kT + 10'700));
  EXPECT_EQ(schedule.due(kT + 10'700), (Due{Action::kRead, 1}));
}

}  // namespace
}  // namespace triskin::fw
