// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/base/counted.hpp"
#include "triskin/skin/calibrate.hpp"

namespace triskin::cli {

void add_calibration_options(CLI::App& app, CalibrationOptions& options) {
  app.add_option("--calibration", options.file,
                 "calibration file, for kPa and N (none: counts; default: the calibration in the controllers, else the "
                 "one on this computer)");
}

namespace {

// Describes the calibration: its revisions, and where it is stored.
std::string version_of(const skin::FoundCalibration& found, const std::string& file) {
  const auto& boards = found.skin.boards();
  const auto [least, most] = std::ranges::minmax(boards, {}, &design::BoardCalibration::revision);
  const std::string revision = least.revision == most.revision
                                   ? fmt::format("revision {}", most.revision)
                                   : fmt::format("revisions {} … {}", least.revision, most.revision);
  if (!file.empty()) return fmt::format("{} of {}", revision, file);
  if (found.in_controllers == 0) return revision + ", kept by this computer";
  if (found.in_controllers == boards.size()) return revision + ", kept in the controllers";
  return fmt::format("{}, kept in {} of {}, the others' by this computer", revision, found.in_controllers,
                     counted(boards.size(), "controller"));
}

}  // namespace

void calibrate_cover(const CalibrationOptions& options, skin::LiveBus& bus, skin::LiveCover& cover,
                     const Output& output) {
  if (options.file == "none") return;
  std::vector<design::BoardCalibration> boards;
  if (!options.file.empty()) boards = design::read_calibration(options.file);
  skin::FoundCalibration found = bus.find_calibration(cover, boards);
  const std::string prefix = prefix_of(cover.config());
  for (const design::BoardCalibration& b : found.of_others) output.say(prefix + note_of_other(b));
  design::SkinCalibration& calibration = found.skin;
  if (calibration.complete()) {
    const design::CalibrationQuality q = design::quality_of(calibration.boards());
    output.say(fmt::format("{}calibrated: {}, {}, up to {:g} kPa; {}", prefix, counted(q.taxels, "taxel"),
                           q.worst_percent < 0.01 ? std::string("pressure error below 0.01 % (median and worst)")
                                                  : fmt::format("pressure error {:.2g} % (median), {:.2g} % (worst)",
                                                                q.median_percent, q.worst_percent),
                           q.max_kpa, version_of(found, options.file)));
    cover.set_calibration(std::move(calibration));
    return;
  }
  if (calibration.missing() > 0) {
    output.say(fmt::format("{}{} {} no calibration, so numbers stay counts: run triskin calibrate", prefix,
                           counted(calibration.missing(), "module"), agreeing(calibration.missing(), "has", "have")));
  } else if (!options.file.empty()) {
    throw InputError(
        fmt::format("--calibration {}: no entry for any controller of {}; calibrate them with triskin "
                    "calibrate, or leave the option out",
                    options.file, cover.design().name));
  }
}

std::string note_of_other(const design::BoardCalibration& board) {
  return fmt::format(
      "controller {} holds a calibration for other modules (patch {} of design {:016x}), which is not used; run "
      "triskin calibrate",
      board.serial, board.patch, board.design_id);
}

nlohmann::json calibration_keys(const design::SkinCalibration& calibration) {
  if (!calibration.complete()) return nullptr;
  const design::CalibrationQuality q = design::quality_of(calibration.boards());
  nlohmann::json boards = nlohmann::json::array();
  for (const design::BoardCalibration& b : calibration.boards())
    boards.push_back({{"serial", b.serial}, {"revision", b.revision}, {"made", b.made}});
  return {{"boards", std::move(boards)},
          {"median_percent", q.median_percent},
          {"worst_percent", q.worst_percent},
          {"residual_kpa", q.residual_kpa},
          {"most_kpa", q.max_kpa}};
}

}  // namespace triskin::cli
