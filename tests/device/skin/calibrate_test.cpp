// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the conversion of counts: lines worked by hand, a ramp and steps on a simulated skin whose taxels differ, and
// forces of known contacts.
#include "triskin/skin/calibrate.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include "support/device_fixture.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::skin {

using test::fault;
using test::Fixture;
using test::taking_over;

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Points = std::vector<skin::CalibrationPoint>;

class CalibrationFolder : public testing::Test {
 protected:
  CalibrationFolder() : folder_(fs::temp_directory_path() / fmt::format("triskin_calibrate.{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~CalibrationFolder() override { fs::remove_all(folder_); }
  fs::path folder_;
};

// The points are on a line of 150 counts/kPa, so the scatter is 0.
TEST(FitSensitivity, of_points_on_a_line_is_its_slope) {
  const Points points{{0, 32'768, 40}, {10, 31'268, 40}, {20, 29'768, 40}};
  const auto line = skin::fit_sensitivity(points);
  ASSERT_TRUE(line);
  EXPECT_DOUBLE_EQ(line->sensitivity.counts_per_kpa, 150.0);
  EXPECT_DOUBLE_EQ(line->rest_counts, 32'768.0);
  EXPECT_NEAR(line->sensitivity.error_percent, 0.0, 1e-9);  // Sums of 1e4 are rounded.
  EXPECT_NEAR(line->sensitivity.residual_kpa, 0.0, 1e-9);
}

// The values 0, 1600, 2900 counts below rest belong to 0, 10, 20 kPa. Means are 10 kPa and 1500 counts, so the slope is
// ((-10)(-1500) + 0 + 10 * 1400) / 200 = 145 and the points lie -50, +100, -50 counts off the line. The variance of the
// slope is 15000 / (3 − 2) / 200 = 75; Student's t of one degree of freedom is 12.706, so the bound is 12.706 ·
// 8.6603 / 145 = 75.89 %. From the rest value the middle point shows 1600 / 145 = 11.034 kPa: 1.034 too much.
TEST(FitSensitivity, states_its_error) {
  const Points points{{0, 32'768, 1}, {10, 31'168, 1}, {20, 29'868, 1}};
  const auto line = skin::fit_sensitivity(points);
  ASSERT_TRUE(line);
  EXPECT_DOUBLE_EQ(line->sensitivity.counts_per_kpa, 145.0);
  EXPECT_NEAR(line->sensitivity.error_percent, 75.89, 0.005);
  EXPECT_NEAR(line->sensitivity.residual_kpa, 1.034, 0.0005);
}

TEST(FitSensitivity, a_mean_of_more_samples_weighs_more) {
  // With the weights 1, 1, 8 the line passes nearer to the third point than with equal weights.
  const Points equal{{0, 3'000, 1}, {10, 1'400, 1}, {20, 100, 1}};
  const Points weighted{{0, 3'000, 1}, {10, 1'400, 1}, {20, 100, 8}};
  const auto off = [](const auto& points) {
    const auto line = skin::fit_sensitivity(points);
    double kpa = 0.0, counts = 0.0, weight = 0.0;
    for (const skin::CalibrationPoint& p : points) {
      kpa += p.samples * p.pressure_kpa;
      counts += p.samples * p.value_counts;
      weight += p.samples;
    }
    return std::abs(points[2].value_counts -
                    (counts / weight - line->sensitivity.counts_per_kpa * (20.0 - kpa / weight)));
  };
  EXPECT_LT(off(weighted), off(equal));
}

TEST(FitSensitivity, needs_three_pressures_and_values_that_fall) {
  EXPECT_FALSE(skin::fit_sensitivity(Points{{0, 100, 1}, {10, 50, 1}, {10, 49, 1}}));
  EXPECT_FALSE(skin::fit_sensitivity(Points{{0, 100, 1}, {10, 100, 1}, {20, 100, 1}}));
  EXPECT_FALSE(skin::fit_sensitivity(Points{{0, 100, 1}, {10, 110, 1}, {20, 120, 1}}));
}

TEST(PressureSteps, begin_with_rest_and_go_module_by_module) {
  const std::array kpa{5.0, 10.0};
  const auto text = [](const std::vector<skin::PressureStep>& steps) {
    std::string all;
    for (const skin::PressureStep& s : steps) all += fmt::format("{:g}@{} ", s.pressure_kpa, s.module.value());
    return all;
  };
  EXPECT_EQ(text(skin::pressure_steps(kpa, {})), "0@-1 5@-1 10@-1 ");
  EXPECT_EQ(text(skin::pressure_steps(kpa, std::array{layout::ModuleId{0}, layout::ModuleId{1}})),
            "0@-1 5@0 10@0 5@1 10@1 ");
}

TEST_F(CalibrationFolder, a_ramp_is_read_and_interpolated) {
  const fs::path file = folder_ / "gauge.csv";
  write_file_atomically(file, "time_s,kpa\n1,0\n3,10\n\n5,4\n");
  const skin::PressureRamp ramp(file);
  EXPECT_FALSE(ramp.by_calendar());
  EXPECT_DOUBLE_EQ(ramp.max_kpa(), 10.0);
  EXPECT_FALSE(ramp.kpa(0.5));
  EXPECT_DOUBLE_EQ(*ramp.kpa(2.0), 5.0);
  EXPECT_DOUBLE_EQ(*ramp.kpa(4.5), 5.5);
  EXPECT_DOUBLE_EQ(*ramp.kpa(5.0), 4.0);
  EXPECT_FALSE(ramp.kpa(5.5));
}

TEST_F(CalibrationFolder, a_ramp_that_cannot_be_used_is_named_with_its_line) {
  const fs::path file = folder_ / "gauge.csv";
  const auto error_of = [&](const std::string& text) -> std::string {
    write_file_atomically(file, text);
    try {
      const skin::PressureRamp ramp(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("s,bar\n1,2\n"), HasSubstr("line 1"));
  EXPECT_THAT(error_of("time_s,kpa\n1,2\n1,3\n"), HasSubstr("line 3: the time does not rise"));
  EXPECT_THAT(error_of("time_s,kpa\n1,2\n2;3\n"), HasSubstr("line 3: \"2;3\" is no number"));
  EXPECT_THAT(error_of("time_s,kpa\n1,2\n2,-3\n"), HasSubstr("below 0"));
  EXPECT_THAT(error_of("time_s,kpa\n1,2\n"), HasSubstr("two lines"));
}

design::BoardCalibration small_board(const std::string& serial) {
  design::BoardCalibration board{serial, 0x1234, layout::PatchIndex{0}, 1, "", wire::CalibrationMethod::kSteps, 40.0,
                                 39.0,   {}};
  board.places.push_back({1, 2, {}});
  board.places[0].taxels[3] = {150.5, 0.25, 0.125};
  return board;
}

TEST_F(CalibrationFolder, the_store_counts_revisions_and_forgets) {
  const skin::CalibrationStore store(folder_ / "kept");
  const std::string serial = "0102030405060708090A0B0C";
  EXPECT_FALSE(store.read(serial));
  const auto first = store.renew(small_board(serial));
  EXPECT_EQ(first.revision, 1);
  EXPECT_EQ(first.made.size(), std::string("2026-11-22T17:30:00Z").size());
  EXPECT_EQ(store.renew(small_board(serial)).revision, 2);
  ASSERT_TRUE(store.read(serial));
  EXPECT_EQ(store.read(serial)->places, first.places);
  EXPECT_TRUE(store.forget(serial));
  EXPECT_FALSE(store.read(serial));
  EXPECT_FALSE(store.forget(serial));
}

TEST_F(CalibrationFolder, one_of_another_patch_or_design_is_not_used) {
  Fixture fixture(4);
  fixture.flash();
  const auto claims = fixture.bus().discover();
  const skin::CalibrationStore store(folder_ / "kept");
  design::BoardCalibration board = small_board(session::to_text(claims.at(0).unique_id));
  board.design_id = fixture.design().design_id;
  board.places.clear();
  for (const auto& routed : fixture.design().patches[0].modules)
    board.places.push_back({routed.line, routed.address, {}});
  store.write(board);
  EXPECT_TRUE(skin::calibration_of(fixture.design(), claims, {}, {}, store).skin.complete());
  board.design_id ^= 1;
  store.write(board);
  const skin::FoundCalibration found = skin::calibration_of(fixture.design(), claims, {}, {}, store);
  EXPECT_FALSE(found.skin.complete());
  EXPECT_EQ(found.of_others.size(), 1U);
  EXPECT_TRUE(skin::calibration_of(fixture.design(), claims, std::array{board}, {}, store).skin.complete())
      << "a file that is named";
  board.design_id ^= 1;
  board.places.pop_back();
  store.write(board);
  EXPECT_EQ(skin::calibration_of(fixture.design(), claims, {}, {}, store).skin.missing(), 1U);
}

// 195 counts/kPa · 2^8 = 49,920 is the greatest number below 65,536: the unit is 1/256. 150.5 is 38,528 of it; 0.001
// less than 105 is 26,879.7 of it, which is rounded to 105. Errors and residuals are the module's worst, rounded up.
TEST(ControllerCalibration, has_the_numbers_of_the_calibration_as_far_as_its_bytes_go) {
  design::BoardCalibration board{"0102030405060708090A0B0C",
                                 0x1234,
                                 layout::PatchIndex{3},
                                 7,
                                 "2026-11-22T17:30:00Z",
                                 wire::CalibrationMethod::kRamp,
                                 40.0,
                                 38.97114,
                                 {}};
  board.places.push_back({1, 2, {}});
  board.places[0].taxels[3] = {150.5, 0.251, 0.125};
  board.places[0].taxels[4] = {195.0, 0.1, 0.0161};
  board.places[0].taxels[5] = {104.999, 0.1, 0.0};
  const wire::Calibration kept = session::to_wire(board);
  EXPECT_EQ(kept.exponent, 8);
  EXPECT_EQ(kept.made_unix_s, 1'795'368'600U);
  ASSERT_EQ(kept.count, 1);
  EXPECT_EQ(kept.places[0].place, 6);
  EXPECT_EQ(kept.places[0].sensitivity, (decltype(kept.places[0].sensitivity){0, 0, 0, 38'528, 49'920, 26'880}));
  EXPECT_EQ(kept.places[0].error, 26);
  EXPECT_EQ(kept.places[0].residual_pa, 125);
  const design::BoardCalibration back = session::from_wire(kept, board.serial);
  EXPECT_EQ(back.places[0].taxels[3], (design::TaxelSensitivity{150.5, 0.26, 0.125}));
  EXPECT_EQ(back.places[0].taxels[5].counts_per_kpa, 105.0);
  EXPECT_EQ(back.places[0].taxels[0], design::TaxelSensitivity{});
  EXPECT_EQ(back.made, board.made);
  EXPECT_EQ(back.method, wire::CalibrationMethod::kRamp);
  EXPECT_EQ(back.patch, 3);
  EXPECT_EQ(back.revision, 7);
  EXPECT_NEAR(back.taxel_area_mm2, 38.97114, 0.5e-4);
  EXPECT_EQ(session::to_wire(back), kept);
}

// Makes a calibration of the design's first patch, as `calibrate` would.
design::BoardCalibration board_of(Fixture& fixture, int revision) {
  const auto claims = fixture.bus().discover();
  design::BoardCalibration board = small_board(session::to_text(claims.at(0).unique_id));
  board.design_id = fixture.design().design_id;
  board.revision = revision;
  board.made = "2026-11-22T17:30:00Z";
  board.places.clear();
  for (const auto& routed : fixture.design().patches[0].modules) {
    board.places.push_back({routed.line, routed.address, {}});
    board.places.back().taxels[0] = {150.0 + revision, 0.1, 0.01};
    board.places.back().taxels[1] = {140.0, 0.2, 0.02};
  }
  return board;
}

TEST_F(CalibrationFolder, a_file_with_an_unknown_method_is_refused) {
  const design::BoardCalibration board{"0102030405060708090A0B0C",
                                       0x1234,
                                       layout::PatchIndex{3},
                                       7,
                                       "2026-11-22T17:30:00Z",
                                       wire::CalibrationMethod::kRamp,
                                       40.0,
                                       38.97114,
                                       {}};
  std::string text = design::calibration_text(std::span(&board, 1));
  EXPECT_EQ(design::parse_calibration(text, "a.json").at(0).method, wire::CalibrationMethod::kRamp);
  text.replace(text.find("\"ramp\""), 6, "\"rmap\"");
  try {
    (void)design::parse_calibration(text, "a.json");
    FAIL() << "it was read";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("steps, weights or ramp"), std::string::npos) << e.what();
  }
}

TEST_F(CalibrationFolder, the_controllers_own_goes_before_that_of_this_computer) {
  Fixture fixture(4);
  fixture.flash();
  const auto claims = fixture.bus().discover();
  const skin::CalibrationStore store(folder_ / "kept");
  const auto used = [&] {
    const auto kept = kept_in_controllers(fixture.bus(), fixture.design(), claims);
    return skin::calibration_of(fixture.design(), claims, {}, kept, store);
  };
  EXPECT_EQ(used().skin.modules(), 0U);
  ASSERT_TRUE(keep_in_controller(fixture.bus(), claims.at(0), board_of(fixture, 2)));
  EXPECT_EQ(used().in_controllers, 1U);
  EXPECT_EQ(used().skin.boards().at(0).revision, 2);
  EXPECT_EQ(used().skin.boards().at(0).places[0].taxels[0].error_percent, 0.2) << "the module's worst";
  store.write(board_of(fixture, 2));
  EXPECT_EQ(used().in_controllers, 1U);
  EXPECT_EQ(used().skin.boards().at(0).places[0].taxels[0].error_percent, 0.1) << "the same, with more to it";
  store.write(board_of(fixture, 1));
  EXPECT_EQ(used().skin.boards().at(0).revision, 2);
  EXPECT_EQ(store.renew(board_of(fixture, 1), 7).revision, 8) << "no revision twice";
  EXPECT_TRUE(forget_in_controller(fixture.bus(), claims.at(0)));
  EXPECT_FALSE(forget_in_controller(fixture.bus(), claims.at(0)));
  EXPECT_EQ(used().in_controllers, 0U);
  EXPECT_EQ(used().skin.boards().at(0).revision, 8);
}

TEST_F(CalibrationFolder, a_controller_refuses_that_of_another_design) {
  Fixture fixture(4);
  fixture.flash();
  const auto claims = fixture.bus().discover();
  ASSERT_TRUE(keep_in_controller(fixture.bus(), claims.at(0), board_of(fixture, 2)));
  design::BoardCalibration other = board_of(fixture, 3);
  other.design_id ^= 1;
  EXPECT_FALSE(keep_in_controller(fixture.bus(), claims.at(0), other));
  const auto kept = kept_in_controllers(fixture.bus(), fixture.design(), claims);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].revision, 2);
}

// Simulates a skin whose taxels differ by ± 30 %. Converters are ideal, so that its noise is the one that a test gives
// and the truth is that of the pads; `drawn` ones have gains and noise of their own.
class SpreadSkin {
 public:
  explicit SpreadSkin(int modules, double noise_counts = 0.0, std::vector<hardware::Fault> faults = {},
                      hardware::PressureCurve pressure = {}, bool drawn = false) {
    hardware::Scene scene;
    scene.effects.converters.drawn = drawn;
    scene.design = test::strip(modules);
    scene.seed = 7;
    scene.effects.sensitivity_spread = 0.3;
    scene.effects.noise_counts = noise_counts;
    scene.faults = std::move(faults);
    scene.pressure = std::move(pressure);
    link_ = std::make_unique<hardware::SimLink>(std::move(scene));
    bus_ = std::make_unique<session::Bus>(*link_);
    (void)deploy::flash(*bus_, design(), taking_over());
    bus_->listen(bus_->now_us() + kOffsets_us);
  }
  [[nodiscard]] const design::Design& design() const { return link_->skin().scene().design; }
  [[nodiscard]] session::Bus& bus() { return *bus_; }
  [[nodiscard]] hardware::VirtualSkin& skin() { return link_->skin(); }
  [[nodiscard]] link::TouchActuator& actuator() { return *link_; }

  skin::CalibrationOutcome by_steps(std::span<const double> kpa, bool by_module = false) {
    skin::CalibrateOptions options;
    layout::ModuleId last = layout::ModuleId::none();
    options.apply = [&, this](const skin::PressureStep& step) {
      if (last != step.module) actuator().pressurize(last, 0.0);
      actuator().pressurize(last = step.module, step.pressure_kpa);
    };
    std::vector<layout::ModuleId> each(by_module ? design().layout.modules.size() : 0);
    std::iota(each.begin(), each.end(), layout::ModuleId{});
    auto outcome = skin::calibrate_by_steps(bus(), design(), skin::pressure_steps(kpa, each), options);
    actuator().pressurize(last, 0.0);
    return outcome;
  }
  [[nodiscard]] design::SkinCalibration calibration(const skin::CalibrationOutcome& outcome) {
    return skin::calibration_of(design(), bus_->discover(), outcome.boards, {}, skin::CalibrationStore("/nonexistent"))
        .skin;
  }
  // Returns the largest relative error of a sensitivity, comparing the calibration with the pads and the gains of the
  // chips.
  [[nodiscard]] double worst_error(const design::SkinCalibration& calibration) const {
    double worst = 0.0;
    for (layout::ModuleId m; m < static_cast<int>(design().layout.modules.size()); ++m) {
      const hardware::Ad7147Behaviour& chip = link_->skin().skin().chip(m).behaviour();
      for (layout::TaxelIndex t; t < layout::kTaxelsPerModule; ++t) {
        if (!layout::measures_pressure(static_cast<std::size_t>(t))) continue;
        // Pads are at the negative input.
        const double truth = link_->skin().skin().module(m).counts_per_kpa(t) * chip.gain * chip.neg_gain_ratio;
        worst = std::max(worst, std::abs(calibration.counts_per_kpa({m, t}) / truth - 1.0));
      }
    }
    return worst;
  }
  // Returns the force of all present presses.
  [[nodiscard]] double force_n(const design::SkinCalibration& calibration, const design::RestValues& rest) {
    skin::TouchMap map(design(), {rest, {}});
    session::Stream stream(*bus_, design(), [&](const session::ModuleSample& f) { map.add(f); });
    stream.run_until(bus_->now_us() + kLook_us);
    stream.finish();
    double sum = 0.0;
    for (const skin::PressedTaxel& t : map.pressed()) sum += calibration.force_n({t.module, t.taxel}, t.change_counts);
    return sum;
  }

 private:
  static constexpr std::uint64_t kOffsets_us = 2'000'000, kLook_us = 300'000;
  std::unique_ptr<hardware::SimLink> link_;
  std::unique_ptr<session::Bus> bus_;
};

constexpr std::array kSteps{5.0, 10.0, 20.0, 30.0, 40.0};

// Expects that every taxel is calibrated within the stated error. A mean of 27 samples scatters by 3/√27 = 0.58
// counts, so the slope of five steps to 40 kPa, whose Σ(p − 21)² is 820, scatters by 0.02 counts/kPa, 0.3 % of 7.
// Student's t for three degrees of freedom is 3.2, and of eighty taxels the worst scatter seems twice as large.
void expect_errors_as_stated(SpreadSkin& skin, const skin::CalibrationOutcome& outcome, const char* what) {
  EXPECT_TRUE(outcome.without.empty());
  const auto calibration = skin.calibration(outcome);
  ASSERT_TRUE(calibration.complete());
  const double worst = skin.worst_error(calibration);
  std::printf("%s: worst error %.3f %%, stated %.3f %%\n", what, 100.0 * worst, outcome.quality.worst_percent);
  EXPECT_LE(100.0 * worst, outcome.quality.worst_percent);
  EXPECT_LE(outcome.quality.worst_percent, 1.9);
}

TEST(Calibrate, steps_find_the_sensitivity_of_every_taxel_within_the_error_that_is_stated) {
  SpreadSkin skin(8, 3.0);
  const skin::CalibrationOutcome outcome = skin.by_steps(kSteps);
  EXPECT_EQ(outcome.quality.taxels, 80U);
  expect_errors_as_stated(skin, outcome, "80 taxels of 7 … 13 counts/kPa by steps");
}

TEST(Calibrate, a_taxel_that_does_not_follow_is_named_and_has_none) {
  constexpr layout::TaxelId kFrozen{layout::ModuleId{2}, layout::TaxelIndex{5}};
  hardware::Fault frozen = fault(hardware::FaultKind::kFrozenTaxel, kFrozen.module);
  frozen.taxel = kFrozen.taxel;
  SpreadSkin skin(4, 3.0, {frozen});
  const skin::CalibrationOutcome outcome = skin.by_steps(kSteps);
  EXPECT_THAT(outcome.without, testing::ElementsAre(kFrozen));
  EXPECT_EQ(outcome.quality.missing, 1U);
  EXPECT_EQ(skin.calibration(outcome).counts_per_kpa(kFrozen), 0.0);
  EXPECT_TRUE(skin.calibration(outcome).complete());
}

TEST(Calibrate, weights_on_each_module_give_what_steps_on_all_give) {
  SpreadSkin skin(4);
  const auto calibration = skin.calibration(skin.by_steps(kSteps, true));
  // Samples are whole counts, so the slope errs by up to 0.5·Σ|p − 21 kPa| / 820 kPa² = 0.034 of 7 counts/kPa.
  EXPECT_LE(skin.worst_error(calibration), 0.005);
}

// A person ends it while the third of four modules is pressed: two are measured, and nothing is said of the others.
TEST(Calibrate, modules_that_were_done_count_when_a_person_ends_it) {
  SpreadSkin skin(4);
  skin::CalibrateOptions options;
  options.settle_s = 0.2;
  options.hold_s = 0.3;
  options.apply = [&](const skin::PressureStep& step) {
    if (step.module == 2 && step.pressure_kpa == 20.0) throw Cancelled("Ctrl-C");
    skin.actuator().pressurize(step.module, step.pressure_kpa);
  };
  constexpr std::array kAll{layout::ModuleId{0}, layout::ModuleId{1}, layout::ModuleId{2}, layout::ModuleId{3}};
  const auto steps = skin::pressure_steps(std::array{10.0, 20.0, 40.0}, kAll);
  const skin::CalibrationOutcome outcome = skin::calibrate_by_steps(skin.bus(), skin.design(), steps, options);
  EXPECT_THAT(outcome.measured, testing::ElementsAre(0, 1));
  ASSERT_EQ(outcome.boards.size(), 1U);
  EXPECT_EQ(outcome.boards[0].places.size(), 2U);
  EXPECT_TRUE(outcome.without.empty());
  options.apply = [](const skin::PressureStep&) { throw Cancelled("Ctrl-C"); };
  EXPECT_THROW((void)skin::calibrate_by_steps(skin.bus(), skin.design(), steps, options), Cancelled);
}

TEST_F(CalibrationFolder, a_ramp_that_rises_and_falls_finds_the_same) {
  const fs::path file = folder_ / "gauge.csv";
  write_file_atomically(file, "time_s,kpa\n6,0\n8,0\n18,40\n28,0\n29,0\n");
  SpreadSkin skin(4, 3.0, {}, hardware::PressureCurve({{8'000'000, 0.0}, {18'000'000, 40.0}, {28'000'000, 0.0}}));
  ASSERT_LT(skin.bus().now_us(), 8'000'000U);
  skin::CalibrateOptions options;
  const skin::CalibrationOutcome outcome =
      skin::calibrate_by_ramp(skin.bus(), skin.design(), skin::PressureRamp(file), options);
  expect_errors_as_stated(skin, outcome, "40 taxels by a ramp of 4 kPa/s");
}

// 20 kPa on one module of 389.7 mm² are 7.794 N.
TEST(Calibrate, the_force_of_a_known_pressure_is_right_and_before_it_is_counts) {
  SpreadSkin skin(4, 3.0);
  const design::SkinCalibration none;
  EXPECT_FALSE(none.complete());
  const skin::CalibrationOutcome outcome = skin.by_steps(kSteps);
  const auto calibration = skin.calibration(outcome);
  skin.actuator().pressurize(layout::ModuleId{1}, 20.0);
  const double force = skin.force_n(calibration, outcome.rest);
  const double truth = 20.0 * design::kModuleArea_mm2 * 1e-3;
  std::printf("20 kPa on a module: %.4f N, truth %.4f N\n", force, truth);
  EXPECT_NEAR(truth, 7.794, 0.001);
  // Four deviations of the mean of ten taxels, each of which has 0.32 kPa of noise from its sample and its rest value.
  EXPECT_NEAR(force / truth, 1.0, 4.0 * 0.32 / std::sqrt(10.0) / 20.0);
}

// The gain of a converter is part of what is calibrated. 20 kPa are 140 counts or more; slow noise of up to ± 2 counts
// in the sample and in the rest value are 2.9 % of them at most, and as much at both ends of the steps is 1 % of the
// slope.
TEST(Calibrate, the_force_is_right_with_converters_of_any_gain) {
  SpreadSkin skin(4, 0.0, {}, {}, true);
  const skin::CalibrationOutcome outcome = skin.by_steps(kSteps);
  const auto calibration = skin.calibration(outcome);
  skin.actuator().pressurize(layout::ModuleId{1}, 20.0);
  const double truth = 20.0 * design::kModuleArea_mm2 * 1e-3;
  EXPECT_NEAR(skin.force_n(calibration, outcome.rest) / truth, 1.0, 0.039);
  // A stage's own gain is off by up to 0.2 %, it remembers up to 0.2 % of its neighbour's change, which is 1.3 / 0.7
  // times as large at most, and the curve of 50 counts has a slope of 0.1 % within a third of the range.
  EXPECT_LE(skin.worst_error(calibration), 0.029 + 0.002 + 0.004 + 0.001);
}

// Makes a flat skin that is large enough for a finger in its middle: tiles as in tile.hpp.
std::vector<design::Vec3> taxels_of_a_field() {
  using design::kHeight_mm;
  constexpr int kReach = 5;
  std::vector<design::Vec3> places;
  for (int j = -kReach; j < kReach; ++j) {
    for (int i = -kReach; i < kReach; ++i) {
      const design::Vec3 at{30.0 * i + 15.0 * j, kHeight_mm * j, 0}, right{30, 0, 0}, top{15, kHeight_mm, 0};
      for (const bool up : {true, false}) {
        design::PlacedModule m;
        m.corner_mm = up ? std::array{at, design::Vec3(at + right), design::Vec3(at + top)}
                         : std::array{design::Vec3(at + right), design::Vec3(at + right + top), design::Vec3(at + top)};
        const auto taxels = design::taxels_of(m, (i + 2 * j + 3 * kReach) % 3);
        for (std::size_t t = 0; t < taxels.size(); ++t) {
          if (layout::measures_pressure(t)) places.push_back(taxels[t].position_mm);
        }
      }
    }
  }
  return places;
}

// Ten taxels per module limit what can be known of the force of a round finger, even with exact sensitivities:
// docs/calibration.md has the numbers.
TEST(ForceOfFingers, is_right_in_the_mean_and_scatters_by_the_pitch) {
  const std::vector<design::Vec3> taxels = taxels_of_a_field();
  const double area_mm2 = design::kModuleArea_mm2 / layout::kPressureTaxelsPerModule;
  std::mt19937_64 random(1);
  constexpr int kFingers = 2000;
  for (const auto& [radius_mm, max_scatter] :
       {std::pair{4.0, 0.35}, {6.0, 0.20}, {8.0, 0.12}, {10.0, 0.08}, {12.0, 0.06}, {15.0, 0.04}, {20.0, 0.025}}) {
    std::vector<double> shares;
    for (int k = 0; k < kFingers; ++k) {
      hardware::Touch touch;
      touch.contact.radius_mm = radius_mm;
      touch.contact.force_n = 2.0;
      touch.contact.position_mm = {std::uniform_real_distribution<double>(-15, 15)(random),
                                   std::uniform_real_distribution<double>(-13, 13)(random), 0};
      double force_n = 0.0;
      for (const design::Vec3& at : taxels) force_n += 1e-3 * touch.pressure_kpa(at, 0) * area_mm2;
      shares.push_back(force_n / touch.contact.force_n);
    }
    double mean = 0.0, squares = 0.0;
    for (const double s : shares) mean += s / kFingers;
    for (const double s : shares) squares += (s - mean) * (s - mean) / kFingers;
    std::ranges::sort(shares);
    std::printf("radius %4.0f mm: mean %.3f of the force, standard deviation %.1f %%, 90 %% within %.2f … %.2f\n",
                radius_mm, mean, 100.0 * std::sqrt(squares), shares[kFingers / 20], shares[kFingers - kFingers / 20]);
    EXPECT_NEAR(mean, 1.0, 0.03);
    EXPECT_LE(std::sqrt(squares), max_scatter);
  }
}

}  // namespace
}  // namespace triskin::skin
