// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "triskin/base/text_file.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"

namespace triskin::design {
namespace {

constexpr const char* kCalibrationFormat = "triskin-calibration";
constexpr int kCalibrationVersion = 1;
constexpr const char* kCalibrationPage = "docs/calibration.md";
constexpr double kMaxCountsPerKpa = 65'535.0;
constexpr double kMaxPressure_kpa = 1e4;

nlohmann::ordered_json place_json(const PlaceCalibration& place) {
  nlohmann::ordered_json counts = nlohmann::ordered_json::array(), error = counts, residual = counts;
  for (const TaxelSensitivity& t : place.taxels) {
    counts.push_back(t.counts_per_kpa);
    error.push_back(t.error_percent);
    residual.push_back(t.residual_kpa);
  }
  return {{"line", place.line},
          {"address", place.address},
          {"counts_per_kpa", std::move(counts)},
          {"error_percent", std::move(error)},
          {"residual_kpa", std::move(residual)}};
}

nlohmann::ordered_json board_json(const BoardCalibration& b) {
  nlohmann::ordered_json places = nlohmann::ordered_json::array();
  for (const PlaceCalibration& place : b.places) places.push_back(place_json(place));
  return {{"serial", b.serial},
          {"design_id", fmt::format("{:016x}", b.design_id)},
          {"patch", b.patch},
          {"revision", b.revision},
          {"made", b.made},
          {"method", kCalibrationMethodNames.name(b.method)},
          {"most_kpa", b.max_kpa},
          {"taxel_area_mm2", b.taxel_area_mm2},
          {"places", std::move(places)}};
}

PlaceCalibration place_in(const JsonValue& v) {
  only_keys(v, {"line", "address", "counts_per_kpa", "error_percent", "residual_kpa"}, kCalibrationPage);
  PlaceCalibration place;
  place.line = v["line"].integer(0, layout::kLines - 1);
  place.address = v["address"].integer(0, layout::kAddressesPerLine - 1);
  for (const char* key : {"counts_per_kpa", "error_percent", "residual_kpa"}) v[key].require_size(place.taxels.size());
  for (std::size_t t = 0; t < place.taxels.size(); ++t) {
    place.taxels[t].counts_per_kpa = number_in(v["counts_per_kpa"].at(t), 0.0, kMaxCountsPerKpa);
    place.taxels[t].error_percent = number_in(v["error_percent"].at(t), 0.0, 1e6);
    place.taxels[t].residual_kpa = number_in(v["residual_kpa"].at(t), 0.0, kMaxPressure_kpa);
  }
  return place;
}

std::string serial_in(const JsonValue& v) {
  std::string serial = v.text();
  if (serial.size() != 24 || serial.find_first_not_of("0123456789ABCDEF") != std::string::npos)
    v.fail("must have 24 hexadecimal digits, upper case, as triskin discover shows serial numbers");
  return serial;
}

void read_places(const JsonValue& places, BoardCalibration& board) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const PlaceCalibration place = place_in(places.at(k));
    if (board.at(place.line, place.address) != nullptr)
      places.at(k).fail(fmt::format("line {}, address {} appears twice", place.line, place.address));
    board.places.push_back(place);
  }
}

BoardCalibration board_in(const JsonValue& v) {
  only_keys(v, {"serial", "design_id", "patch", "revision", "made", "method", "most_kpa", "taxel_area_mm2", "places"},
            kCalibrationPage);
  const auto method = kCalibrationMethodNames.value(v["method"].text());
  if (!method) v["method"].fail("must be " + kCalibrationMethodNames.list());
  BoardCalibration board{.serial = serial_in(v["serial"]),
                         .design_id = hex64(v["design_id"]),
                         .patch = layout::PatchIndex{v["patch"].integer(0, kMaxCount)},
                         .revision = v["revision"].integer(1, kMaxCount),
                         .made = v["made"].text(),
                         .method = *method,
                         .max_kpa = number_in(v["most_kpa"], 0.0, kMaxPressure_kpa),
                         .taxel_area_mm2 = number_in(v["taxel_area_mm2"], 1e-3, 1e6),
                         .places = {}};
  read_places(v["places"], board);
  return board;
}

// Counts the pressure taxels of a place that have no sensitivity, and collects the errors of the others.
void add_taxels(const PlaceCalibration& place, CalibrationQuality& q, std::vector<double>& errors_percent) {
  for (std::size_t t = 0; t < place.taxels.size(); ++t) {
    const TaxelSensitivity& taxel = place.taxels[t];
    if (taxel.counts_per_kpa > 0.0) {
      errors_percent.push_back(taxel.error_percent);
      q.residual_kpa = std::max(q.residual_kpa, taxel.residual_kpa);
    } else if (layout::measures_pressure(t)) {
      ++q.missing;
    }
  }
}

}  // namespace

const PlaceCalibration* BoardCalibration::at(int line, int address) const {
  const auto place =
      std::ranges::find_if(places, [&](const PlaceCalibration& p) { return p.line == line && p.address == address; });
  return place == places.end() ? nullptr : &*place;
}

std::string calibration_text(std::span<const BoardCalibration> boards) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BoardCalibration& b : boards) list.push_back(board_json(b));
  const nlohmann::ordered_json document = {
      {"format", kCalibrationFormat}, {"version", kCalibrationVersion}, {"boards", std::move(list)}};
  return document.dump() + "\n";
}

std::vector<BoardCalibration> parse_calibration(const std::string& text, const std::string& name) {
  const nlohmann::json document = parse_json(text, name);
  const JsonValue v(document, name);
  require_head(v, kCalibrationFormat, kCalibrationVersion, "calibrate again, or use the release that wrote it");
  only_keys(v, {"format", "version", "boards"}, kCalibrationPage);
  std::vector<BoardCalibration> boards;
  const JsonValue list = v["boards"];
  for (std::size_t k = 0; k < list.size(); ++k) {
    BoardCalibration board = board_in(list.at(k));
    if (std::ranges::find(boards, board.serial, &BoardCalibration::serial) != boards.end())
      list.at(k)["serial"].fail("the controller appears twice");
    boards.push_back(std::move(board));
  }
  return boards;
}

std::vector<BoardCalibration> read_calibration(const std::filesystem::path& path) {
  return parse_calibration(read_text(path), path.string());
}

CalibrationQuality quality_of(std::span<const BoardCalibration> boards) {
  CalibrationQuality q;
  std::vector<double> errors;
  for (const BoardCalibration& b : boards) {
    q.max_kpa = &b == boards.data() ? b.max_kpa : std::min(q.max_kpa, b.max_kpa);
    for (const PlaceCalibration& place : b.places) add_taxels(place, q, errors);
  }
  q.taxels = errors.size();
  if (errors.empty()) return q;
  std::ranges::sort(errors);
  q.median_percent = errors[errors.size() / 2];
  q.worst_percent = errors.back();
  return q;
}

SkinCalibration::SkinCalibration(const Design& design, std::span<const BoardCalibration> boards,
                                 const std::function<std::string(layout::PatchIndex)>& serial_of_patch)
    : modules_(design.layout.modules.size()) {
  for (const layout::PatchIndex patch : patches_here(design)) {
    const std::string serial = serial_of_patch(patch);
    const auto board = std::ranges::find(boards, serial, &BoardCalibration::serial);
    const bool known = !serial.empty() && board != boards.end();
    if (known) boards_.push_back(*board);
    for (const RoutedModule& routed : design.patches[static_cast<std::size_t>(patch)].modules) {
      const PlaceCalibration* const place = known ? board->at(routed.line, routed.address) : nullptr;
      if (place == nullptr) {
        ++missing_;
        continue;
      }
      Module& module = modules_.at(static_cast<std::size_t>(routed.node));
      module.area_mm2 = board->taxel_area_mm2;
      module.max_kpa = board->max_kpa;
      for (std::size_t t = 0; t < place->taxels.size(); ++t) module.counts_per_kpa[t] = place->taxels[t].counts_per_kpa;
    }
  }
}

double SkinCalibration::counts_per_kpa(layout::TaxelId taxel) const {
  return modules_.at(static_cast<std::size_t>(taxel.module)).counts_per_kpa.at(static_cast<std::size_t>(taxel.taxel));
}

double SkinCalibration::pressure_kpa(layout::TaxelId taxel, double change_counts) const {
  const double sensitivity = counts_per_kpa(taxel);
  return sensitivity > 0.0 ? change_counts / sensitivity : 0.0;
}

double SkinCalibration::force_n(layout::TaxelId taxel, double change_counts) const {
  return kNewtonPerKpaMm2 * pressure_kpa(taxel, change_counts) * taxel_area_mm2(taxel.module);
}

bool SkinCalibration::is_above_range(layout::TaxelId taxel, double change_counts) const {
  constexpr double kMargin = 0.02;  // A pressure that is exactly that of the last step reads a little more or less.
  return pressure_kpa(taxel, change_counts) >
         (1.0 + kMargin) * modules_.at(static_cast<std::size_t>(taxel.module)).max_kpa;
}

}  // namespace triskin::design
