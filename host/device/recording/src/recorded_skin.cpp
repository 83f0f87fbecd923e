// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/recorded_skin.hpp"

#include <fmt/format.h>

#include "triskin/base/error.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::recording {

namespace {

std::string serial_of(const mcap::TextMap& facts, layout::NodeAddress node) {
  const auto serial = facts.find(serial_fact(node));
  return serial == facts.end() ? "" : serial->second;
}

}  // namespace

RecordedSkin recorded_skin(const std::string& file) {
  const Summary origin = read_origin(file);
  if (origin.design_text.empty())
    throw InputError(fmt::format("{}: holds no design: is it a recording of triskin?", file));
  RecordedSkin skin{design::parse_design(origin.design_text, file + ": design.json"), {}, {}, {}, origin.facts};
  for (layout::PatchIndex patch; patch < static_cast<int>(skin.design.patches.size()); ++patch)
    skin.serials.push_back(serial_of(origin.facts, design::node_address_of(skin.design, patch)));
  if (!origin.rest_text.empty())
    skin.rest.kept = design::parse_rest(origin.rest_text, file + ": " + kRestName, skin.design.layout.modules.size());
  if (!origin.settled_text.empty())
    skin.rest.settled =
        design::parse_settled(origin.settled_text, file + ": " + kSettledName, skin.design.layout.modules.size());
  if (origin.calibration_text.empty()) return skin;
  const auto boards = design::parse_calibration(origin.calibration_text, file + ": " + kCalibrationName);
  const auto serial_of = [&](layout::PatchIndex patch) { return skin.serials[static_cast<std::size_t>(patch)]; };
  skin.calibration = design::SkinCalibration(skin.design, boards, serial_of);
  return skin;
}

}  // namespace triskin::recording
