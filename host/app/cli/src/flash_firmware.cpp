// SPDX-License-Identifier: GPL-3.0-or-later
#include "flash_firmware.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "triskin/session/controller.hpp"

namespace triskin::cli {
namespace {

using deploy::UpdateOutcome;

std::string runs(std::size_t bytes, int slot) {
  return fmt::format("{} bytes written, slot {} runs", bytes, slot == 0 ? 'A' : 'B');
}

void add_row(FirmwareReport& report, const std::string& serial, UpdateOutcome outcome, int slot, std::size_t bytes,
             const std::string& why) {
  report.rows.push_back({{"serial", serial},
                         {"equal", outcome == UpdateOutcome::kEqual},
                         {"slot", slot},
                         {"bytes", bytes},
                         {"outcome", deploy::outcome_name(outcome)}});
  if (!why.empty()) report.rows.back()["why"] = why;
}

// Updates through the loader, during which the controller does not sample.
void update_one(session::Bus& bus, const wire::NodeClaim& claim, const deploy::FirmwarePackage& package,
                const deploy::UpdateOptions& options, FirmwareReport& report, Output& output) {
  const ProgressSink bars = output.progress();
  const int part = static_cast<int>(report.rows.size());
  const ProgressSink bar = [&](const Progress& p) { triskin::report(bars, p.stage, p.fraction, p.detail, part); };
  const deploy::FirmwareResult r = deploy::update_firmware(bus, claim, package, options, bar);
  const auto outcome = r.bytes != 0 ? UpdateOutcome::kUpdated : r.equal ? UpdateOutcome::kEqual : UpdateOutcome::kWould;
  add_row(report, r.serial, outcome, r.slot, r.bytes, "");
  output.say(fmt::format("controller {}  firmware {}", r.serial,
                         r.bytes != 0 ? runs(r.bytes, r.slot) + ", by its loader"
                         : r.equal    ? std::string("equal, skipped")
                                      : std::string("would be written by its loader")));
}

// Updates a controller that a broadcast has left out. An error concerns only this board, because the others have their
// image.
void update_left_out(session::Bus& bus, const deploy::BoardUpdate& board, const deploy::FirmwarePackage& package,
                     const deploy::UpdateOptions& options, FirmwareReport& report, Output& output) {
  try {
    update_one(bus, board.claim, package, options, report, output);
  } catch (const link::Unreachable&) {
    throw;  // The link has failed, so the remaining boards cannot be reached either.
  } catch (const DeviceError& e) {
    add_row(report, board.serial, UpdateOutcome::kGivenUp, board.slot, 0, e.what());
    output.say(fmt::format("controller {}  firmware given up: {}", board.serial, e.what()));
    report.complete = false;
  }
}

void print_report(const deploy::BoardUpdate& b, FirmwareReport& report, Output& output) {
  add_row(report, b.serial, b.outcome, b.slot, b.bytes, b.why);
  std::string text(deploy::outcome_name(b.outcome));
  if (b.outcome == UpdateOutcome::kUpdated) text = runs(b.bytes, b.slot);
  if (b.outcome == UpdateOutcome::kEqual) text = "equal, skipped";
  if (b.outcome == UpdateOutcome::kWould) text = "would be written";
  output.say(fmt::format("controller {}  firmware {}{}", b.serial, text, b.why.empty() ? "" : ": " + b.why));
  const bool well =
      b.outcome == UpdateOutcome::kUpdated || b.outcome == UpdateOutcome::kEqual || b.outcome == UpdateOutcome::kWould;
  report.complete = report.complete && well;
}

}  // namespace

void add_firmware_options(CLI::App& app, FirmwareOptions& options) {
  app.add_option("--firmware", options.file,
                 "firmware package for every controller on the link, over CAN, to all of a bus at once")
      ->check(CLI::ExistingFile);
  app.add_flag("--each", options.update.each,
               "with --firmware: start it on the controllers that are ready, even if others refuse it");
  app.add_flag("--allow-older", options.update.allow_older, "with --firmware: also over a newer version");
  app.add_flag("--one-by-one", options.one_by_one,
               "with --firmware: through the loaders, one controller after the other, without sampling");
  app.add_option_function<std::string>(
         "--board", [&options](const std::string& name) { std::ranges::copy(name, options.update.hardware.begin()); },
         "with --firmware: part number of the boards that the package is for")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return name.size() == wire::kPartNumber.size()
                       ? std::string()
                       : std::string("a part number has eight characters, such as TRISKIN1");
          },
          "PART"));
}

FirmwareReport flash_firmware(std::span<link::Link* const> links, const std::set<wire::UniqueId>& expected,
                              const deploy::FirmwarePackage& package, const FirmwareOptions& options,
                              const deploy::FlashOptions& flash, Output& output) {
  FirmwareReport report;
  deploy::UpdateOptions update = options.update;
  update.dry_run = flash.dry_run;
  update.force = flash.force;
  const deploy::BoardsOnWires found = deploy::find_boards(links, expected);
  if (options.one_by_one) {
    for (const deploy::UpdateBus& b : found.boards) {
      for (const wire::NodeClaim& claim : b.boards) update_one(*b.bus, claim, package, update, report, output);
    }
  } else {
    const deploy::BroadcastResult r = deploy::broadcast_firmware(found.boards, package, update, output.progress());
    std::size_t row = 0;
    for (const deploy::UpdateBus& b : found.boards) {
      for (std::size_t k = 0; k < b.boards.size(); ++k, ++row) {
        const deploy::BoardUpdate& board = r.boards[row];
        if (board.outcome == UpdateOutcome::kByLoader)
          update_left_out(*b.bus, board, package, update, report, output);
        else
          print_report(board, report, output);
      }
    }
    if (r.frames > 0)
      output.say(fmt::format("{} data frames, {} of them again, {:.2f} s", r.frames, r.again, r.link_s));
  }
  for (const wire::UniqueId& id : found.silent) {
    deploy::BoardUpdate board{.claim = {.unique_id = id},
                              .serial = session::to_text(id),
                              .why = "no longer answers; check its power and cable, then run the command again"};
    print_report(board, report, output);
  }
  return report;
}

}  // namespace triskin::cli
