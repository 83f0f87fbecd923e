// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/ad7147.hpp"

#include <gtest/gtest.h>

#include "triskin/hardware/i2c_line.hpp"

namespace triskin::hardware {
namespace {

// Pin p sees 100·p counts, and from 1 s on 1000 more.
class Source final : public CapacitanceSource {
 public:
  [[nodiscard]] double counts(int cin, std::uint64_t at_us) const override {
    return 100.0 * cin + (at_us >= 1'000'000 ? 1000.0 : 0.0);
  }
};

constexpr std::uint16_t kFullPower12Stages = 0x00B0;

// Stage s converts pin s at the negative input: field 01 is at bits 2s of the low word, from pin 7 on of the high word.
void connect_all(Ad7147& chip) {
  for (int s = 0; s < 12; ++s) {
    const auto base = static_cast<std::uint16_t>(0x080 + 8 * s);
    chip.write_register(base, s < 7 ? static_cast<std::uint16_t>(1 << (2 * s)) : std::uint16_t{0}, 0);
    chip.write_register(static_cast<std::uint16_t>(base + 1),
                        s < 7 ? std::uint16_t{0} : static_cast<std::uint16_t>(1 << (2 * (s - 7))), 0);
  }
  chip.write_register(0x000, kFullPower12Stages, 0);
  chip.write_register(0x002, 0x8000, 0);  // The register is CONV_RESET.
}

TEST(Ad7147Chip, holds_reset_values_and_its_id) {
  const Source source;
  Ad7147 chip(source);
  EXPECT_EQ(chip.read_register(0x017, 0), 0x1472);
  EXPECT_EQ(chip.read_register(0x000, 0), 0);
  EXPECT_EQ(chip.read_register(0x00B, 0), 0);
  EXPECT_EQ(chip.read_register(0x7FF, 0), 0);
}

TEST(Ad7147Chip, converts_the_connected_pin_and_falls_with_capacitance_at_the_negative_input) {
  const Source source;
  Ad7147 chip(source);
  connect_all(chip);
  EXPECT_EQ(chip.read_register(0x00B + 5, 50'000), 0x8000 - 500);
  EXPECT_EQ(chip.read_register(0x00B + 11, 50'000), 0x8000 - 1100);
  EXPECT_EQ(chip.read_register(0x00B + 5, 1'100'000), 0x8000 - 1500);
  // The positive input (field 10) rises instead, and an unconnected one gives mid-scale.
  chip.write_register(0x080 + 8 * 5, 2 << 10, 1'100'000);
  EXPECT_EQ(chip.read_register(0x00B + 5, 1'200'000), 0x8000 + 1500);
  chip.write_register(0x080 + 8 * 5, 0, 1'200'000);
  EXPECT_EQ(chip.read_register(0x00B + 5, 1'300'000), 0x8000);
}

TEST(Ad7147Chip, one_afe_step_is_a_twenty_fifth_of_the_half_range) {
  const Source source;
  Ad7147 chip(source);
  connect_all(chip);
  // Stage 0 gets the negative offset 1: 0.32 pF of 8 pF = 32768/25 = 1310.72 counts.
  chip.write_register(0x082, 0x0001, 0);
  EXPECT_EQ(chip.read_register(0x00B, 50'000), 0x8000 + 1311);
  chip.write_register(0x082, 0x0200, 0);
  EXPECT_EQ(chip.read_register(0x00B, 50'000), 0x8000 - 2621);
}

TEST(Ad7147Chip, sequence_times_are_those_of_the_data_sheet) {
  const Source source;
  Ad7147 chip(source);
  for (const auto& [pwr, us] : {std::pair{0x00B0, 36'900}, {0x01B0, 18'400}, {0x02B0, 9'200}, {0x0050, 18'450}}) {
    chip.write_register(0x000, static_cast<std::uint16_t>(pwr), 0);
    EXPECT_EQ(chip.sequence_us(), static_cast<std::uint64_t>(us)) << pwr;
  }
}

TEST(Ad7147Chip, a_result_changes_only_when_its_stage_has_ended) {
  const Source source;
  Ad7147 chip(source);
  connect_all(chip);
  // Stage 2 ends at 3 · 3075 µs, then every 36,900 µs; the last end before 1 s and one sequence after the change are
  // tested.
  EXPECT_EQ(chip.read_register(0x00D, 9'224), 0);
  EXPECT_EQ(chip.read_register(0x00D, 9'225), 0x8000 - 200);
  // 9225 + 26·36900 = 968,625 is before the change at 1 s; 1,005,525 is after it.
  EXPECT_EQ(chip.read_register(0x00D, 1'005'524), 0x8000 - 200);
  EXPECT_EQ(chip.read_register(0x00D, 1'005'525), 0x8000 - 1200);
}

TEST(Ad7147Chip, only_conv_reset_begins_the_sequence_anew_unless_power_control_is_asked_to) {
  const Source source;
  for (const bool restarts : {false, true}) {
    Ad7147 chip(source);
    chip.set_behaviour({.power_control_restarts = restarts});
    connect_all(chip);
    (void)chip.read_register(0x00A, 40'000);
    chip.write_register(0x000, kFullPower12Stages, 40'000);  // The same value is written in mid-sequence.
    // Stage 1 ends at 43,050 µs in the sequence that began at 36,900; stage 0 ends at 43,075 in one that was
    // restarted.
    EXPECT_EQ(chip.read_register(0x00A, 43'080), restarts ? 0x001 : 0x002);
    chip.write_register(0x002, 0x8000, 50'000);
    EXPECT_EQ(chip.read_register(0x002, 50'000), 0);  // The bit clears itself.
    (void)chip.read_register(0x00A, 50'000);
    EXPECT_EQ(chip.read_register(0x00A, 53'074), 0x000);
    EXPECT_EQ(chip.read_register(0x00A, 53'076), 0x001);
  }
}

TEST(Ad7147Chip, a_stop_in_mid_sequence_may_shift_the_results_until_conv_reset) {
  const Source source;
  Ad7147 chip(source);
  chip.set_behaviour({.shifted_after_stop = true});
  connect_all(chip);
  EXPECT_EQ(chip.read_register(0x00B + 5, 50'000), 0x8000 - 500);
  chip.write_register(0x000, 0x01B0, 60'000);
  EXPECT_EQ(chip.read_register(0x00B + 5, 200'000), 0x8000 - 400);
  EXPECT_EQ(chip.read_register(0x00B, 200'000), 0x8000 - 1100);
  chip.write_register(0x002, 0x8000, 200'000);
  EXPECT_EQ(chip.read_register(0x00B + 5, 300'000), 0x8000 - 500);
}

TEST(Ad7147Chip, results_may_change_together_at_the_end_of_the_sequence) {
  const Source source;
  Ad7147 chip(source);
  chip.set_behaviour({.latched_at_end = true});
  connect_all(chip);
  EXPECT_EQ(chip.read_register(0x00B, 36'899), 0);  // Stage 0 ended long ago.
  EXPECT_EQ(chip.read_register(0x00B, 36'900), 0x8000);
  EXPECT_EQ(chip.read_register(0x00B + 11, 36'900), 0x8000 - 1100);
}

TEST(Ad7147Chip, results_from_before_a_change_of_the_setup_stay_until_the_stage_ends) {
  const Source source;
  Ad7147 chip(source);
  connect_all(chip);
  chip.write_register(0x082 + 8 * 5, 0x0001, 50'000);  // The offset has one more step.
  EXPECT_EQ(chip.read_register(0x00B + 5, 50'001), 0x8000 - 500);
  EXPECT_EQ(chip.read_register(0x00B + 5, 36'900 + 6 * 3'075), 0x8000 - 500 + 1311);
}

TEST(Ad7147Chip, complete_status_is_cleared_by_reading) {
  const Source source;
  Ad7147 chip(source);
  connect_all(chip);
  EXPECT_EQ(chip.read_register(0x00A, 3 * 3075), 0x007);
  EXPECT_EQ(chip.read_register(0x00A, 3 * 3075), 0x000);
  EXPECT_EQ(chip.read_register(0x00A, 36'900 + 3075), 0xFF9);
}

TEST(Ad7147Chip, a_power_dip_and_a_software_reset_lose_the_configuration) {
  const Source source;
  Ad7147 chip(source);
  connect_all(chip);
  chip.schedule_power_dip(100'000, 500'000);
  EXPECT_EQ(chip.read_register(0x000, 99'999), kFullPower12Stages);
  EXPECT_EQ(chip.read_register(0x000, 100'000), 0);
  EXPECT_EQ(chip.read_register(0x080, 100'000), 0);
  chip.write_register(0x000, kFullPower12Stages, 200'000);
  EXPECT_EQ(chip.read_register(0x000, 599'999), kFullPower12Stages);
  EXPECT_EQ(chip.read_register(0x000, 1'700'000), 0);  // Several dips have passed.
  chip.write_register(0x001, 0x0FFF, 1'700'001);
  chip.write_register(0x000, 0x0400, 1'700'002);
  EXPECT_EQ(chip.read_register(0x001, 1'700'003), 0);
}

class Line : public testing::Test {
 protected:
  Source source_;
  Ad7147 first_{source_}, second_{source_, 0x1234};
  I2cLineModel line_;

  std::uint16_t read(std::uint8_t address, std::uint16_t reg, std::uint64_t now_us = 0) {
    const auto byte = static_cast<std::uint8_t>(address << 1);
    if (!line_.start(byte, now_us)) return 0xFFFF;
    EXPECT_TRUE(line_.write(static_cast<std::uint8_t>(reg >> 8), now_us));
    EXPECT_TRUE(line_.write(static_cast<std::uint8_t>(reg), now_us));
    EXPECT_TRUE(line_.start(static_cast<std::uint8_t>(byte | 1), now_us));
    const int high = line_.read(true, now_us);
    const int low = line_.read(false, now_us);
    line_.stop(now_us);
    return static_cast<std::uint16_t>(high << 8 | low);
  }
};

TEST_F(Line, transfers_are_big_endian_and_the_address_increments) {
  line_.attach(first_, 0x2D);
  EXPECT_TRUE(line_.start(0x2D << 1, 0));
  for (const int byte : {0x00, 0x80, 0x12, 0x34, 0x56, 0x78})
    EXPECT_TRUE(line_.write(static_cast<std::uint8_t>(byte), 0));
  line_.stop(0);
  EXPECT_EQ(read(0x2D, 0x080), 0x1234);
  EXPECT_EQ(read(0x2D, 0x081), 0x5678);
  EXPECT_EQ(read(0x2D, 0x017), 0x1472);
  EXPECT_EQ(read(0x2C, 0x017), 0xFFFF);  // Nobody answers at this address.
}

TEST_F(Line, two_chips_at_one_address_are_a_wired_and) {
  line_.attach(first_, 0x2C);
  line_.attach(second_, 0x2C);
  EXPECT_EQ(read(0x2C, 0x017), 0x1472 & 0x1234);
}

TEST_F(Line, a_held_sda_is_let_go_by_clock_pulses_and_a_held_scl_never) {
  line_.attach(first_, 0x2C);
  line_.hold_low(I2cLineModel::Signal::kSda, 1000, 3);
  EXPECT_EQ(read(0x2C, 0x017, 999), 0x1472);
  EXPECT_EQ(read(0x2C, 0x017, 1000), 0xFFFF);
  EXPECT_TRUE(line_.scl());
  EXPECT_FALSE(line_.sda());
  line_.pulse_scl(1100);
  line_.pulse_scl(1110);
  EXPECT_FALSE(line_.sda());
  line_.pulse_scl(1120);
  EXPECT_TRUE(line_.sda());
  EXPECT_EQ(read(0x2C, 0x017, 1200), 0x1472);
  line_.hold_low(I2cLineModel::Signal::kScl, 2000, 0);
  EXPECT_EQ(read(0x2C, 0x017, 2000), 0xFFFF);
  for (std::uint64_t k = 0; k < 20; ++k) line_.pulse_scl(2100 + k);
  EXPECT_FALSE(line_.scl());
}

}  // namespace
}  // namespace triskin::hardware
