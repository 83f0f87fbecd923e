// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/bring_up.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "support/device_fixture.hpp"
#include "support/places.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"

namespace triskin::deploy {

using test::fault;

namespace {

BringUpOptions over(const hardware::Scene& scene) {
  BringUpOptions options;
  options.open = [scene] { return std::make_unique<hardware::SimLink>(scene); };
  options.stream_s = 0.5;
  return options;
}
hardware::Scene scene_of(int modules) {
  hardware::Scene scene;
  scene.design = test::strip(modules);
  return scene;
}
StepOutcome outcome(const std::vector<StepReport>& reports, int step) {
  return reports.at(static_cast<std::size_t>(step - 1)).outcome;
}

TEST(BringUp, FreshBoardsPassEveryStepThatALinkShows) {
  const hardware::Scene scene = scene_of(6);
  const auto reports = bring_up(scene.design, over(scene));
  ASSERT_EQ(reports.size(), 12U);
  for (int step = 1; step <= 6; ++step) EXPECT_EQ(outcome(reports, step), StepOutcome::kSkipped) << step;
  EXPECT_EQ(outcome(reports, 8), StepOutcome::kSkipped);
  for (const int step : {7, 9, 10, 11, 12})
    EXPECT_EQ(outcome(reports, step), StepOutcome::kPassed)
        << step << ": " << reports[static_cast<std::size_t>(step - 1)].found;
  EXPECT_NE(reports[11].found.find("6 of 6 modules stream"), std::string::npos) << reports[11].found;
}

TEST(BringUp, APersonIsAskedAboutWhatNoLinkShows) {
  const hardware::Scene scene = scene_of(2);
  BringUpOptions options = over(scene);
  std::vector<int> asked;
  options.ask = [&](const BringUpStep& step) -> StepAnswer {
    asked.push_back(step.number);
    if (step.number == 3) return {StepOutcome::kFailed, "RDP = BB"};
    return {StepOutcome::kPassed, "250 ns"};
  };
  const auto reports = bring_up(scene.design, options);
  EXPECT_EQ(asked, (std::vector<int>{1, 2, 3, 4, 5, 6, 9}));
  EXPECT_EQ(outcome(reports, 3), StepOutcome::kFailed);
  EXPECT_NE(reports[8].found.find("250 ns"), std::string::npos);
  const std::string text = to_markdown(reports, "sim");
  EXPECT_NE(text.find("| 3 | Read the option bytes (FLASH_OPTR, 0x40022020). | failed | RDP = BB |"),
            std::string::npos);
  EXPECT_NE(text.find("## Step 3"), std::string::npos);
  EXPECT_EQ(text.find("## Step 4"), std::string::npos);
}

TEST(BringUp, NamesTheStepThatAFaultStops) {
  hardware::Scene scene = scene_of(6);
  scene.faults = {fault(hardware::FaultKind::kRemovedChip, 4)};
  const auto reports = bring_up(scene.design, over(scene));
  EXPECT_EQ(outcome(reports, 9), StepOutcome::kPassed);
  EXPECT_EQ(outcome(reports, 10), StepOutcome::kFailed);
  EXPECT_NE(reports[9].found.find("5 converters answer"), std::string::npos) << reports[9].found;
  EXPECT_EQ(outcome(reports, 11), StepOutcome::kFailed);
  EXPECT_NE(reports[10].found.find("absent_module"), std::string::npos);
  EXPECT_EQ(outcome(reports, 12), StepOutcome::kFailed);
}

TEST(BringUp, ATaxelOutOfReachFailsTheLastStep) {
  hardware::Scene scene = scene_of(2);
  hardware::Fault shorted = fault(hardware::FaultKind::kSaturatedTaxel, 1);
  shorted.taxel = layout::TaxelIndex{5};
  scene.faults = {shorted};
  const auto reports = bring_up(scene.design, over(scene));
  EXPECT_EQ(outcome(reports, 12), StepOutcome::kFailed);
  EXPECT_NE(reports[11].found.find("module 1 taxel 5 rests outside"), std::string::npos) << reports[11].found;
}

TEST(BringUp, EachBoardIsProgrammedWithTheNamesOfItsChip) {
  ASSERT_EQ(bring_up_boards().size(), 3U);
  for (const BringUpBoard& board : bring_up_boards()) {
    const auto lines = programmer_lines(board);
    ASSERT_EQ(lines.size(), 5U);
    const std::vector<ProgrammerLine> commands = bring_up_steps(board)[4].commands;
    ASSERT_EQ(commands.size(), lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
      EXPECT_NE(lines[k].command.find(fmt::format("build/{}/bin/triskin_factory", board.build)), std::string::npos);
      EXPECT_EQ(commands[k].command, lines[k].command);
    }
  }
  const BringUpBoard& second = bring_up_board("nucleo_l452re");
  const auto lines = programmer_lines(second);
  EXPECT_NE(lines[0].command.find("firmware/board/stm32l452/openocd.cfg"), std::string::npos) << lines[0].command;
  EXPECT_NE(lines[1].command.find("--chip STM32L452RETx "), std::string::npos) << lines[1].command;
  EXPECT_NE(lines[2].command.find("--target stm32l452retx "), std::string::npos) << lines[2].command;
  for (const BringUpStep& step : bring_up_steps(second)) {
    for (const std::string* text : {&step.does, &step.measures, &step.expects, &step.otherwise}) {
      for (const char* other : {"g474", "G474", "0x469", "DBANK", "PB8", "data phase"})
        EXPECT_EQ(text->find(other), std::string::npos) << "step " << step.number << ": " << *text;
    }
  }
  try {
    (void)bring_up_board("nucleo_h7");
    FAIL() << "a board that has no image";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "no board is called 'nucleo_h7'; choose one of nucleo_g474re, icub_patch, nucleo_l452re");
  }
}

// The page is read beside the board, and its lines are copied into a terminal.
TEST(BringUp, LinesOfThePageAreThoseOfTheCommand) {
  const std::string page = read_file(std::filesystem::path(test::source_folder()) / "docs/program_board.md");
  for (const char* name : {"nucleo_g474re", "nucleo_l452re"}) {
    for (const ProgrammerLine& line : programmer_lines(bring_up_board(name)))
      EXPECT_NE(page.find(fmt::format("\n| {} | `{}` |\n", line.programmer, line.command)), std::string::npos)
          << name << ", " << line.programmer << ": " << line.command;
  }
  for (const BringUpBoard& board : bring_up_boards()) {
    const auto folder = std::filesystem::path(test::source_folder()) / "firmware/board" /
                        (board.chip == "STM32G474" ? "stm32g474" : "stm32l452");
    EXPECT_TRUE(std::filesystem::exists(folder / "boards" / board.name / "board.cmake")) << board.name;
    EXPECT_TRUE(std::filesystem::exists(folder / "openocd.cfg")) << board.name;
  }
}

TEST(BringUp, ABoardWithoutFdFramesIsNotAskedForTheFullStream) {
  const hardware::Scene scene = scene_of(2);
  BringUpOptions options = over(scene);
  options.board = &bring_up_board("nucleo_l452re");
  const auto reports = bring_up(scene.design, options);
  EXPECT_EQ(outcome(reports, 8), StepOutcome::kSkipped);
  EXPECT_EQ(reports[7].found, "the board has no USB");
  EXPECT_EQ(outcome(reports, 11), StepOutcome::kPassed) << reports[10].found;
  EXPECT_EQ(outcome(reports, 12), StepOutcome::kSkipped);
  EXPECT_NE(to_markdown(reports, "sim", *options.board).find("Board: nucleo_l452re. Link: sim"), std::string::npos);
}

TEST(BringUp, WithoutALinkTheStepsThatNeedItAreSkipped) {
  BringUpOptions options;
  options.open = []() -> std::unique_ptr<link::Link> { throw DeviceError("can0: no such interface"); };
  const auto reports = bring_up(test::strip(1), options);
  for (const int step : {7, 8}) EXPECT_EQ(outcome(reports, step), StepOutcome::kFailed) << step;
  for (int step = 9; step <= 12; ++step) EXPECT_EQ(outcome(reports, step), StepOutcome::kSkipped) << step;
  EXPECT_NE(reports[6].found.find("no such interface"), std::string::npos);
}

}  // namespace
}  // namespace triskin::deploy
