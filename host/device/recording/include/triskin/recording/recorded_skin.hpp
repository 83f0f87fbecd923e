// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"

namespace triskin::recording {

struct RecordedSkin {
  design::Design design;
  design::SkinCalibration calibration;  ///< If the calibration is empty, the recording has only counts.
  /// Serial numbers of the controllers are indexed by patch; an empty text means unknown.
  std::vector<std::string> serials;
  design::KnownRest rest;                    ///< Where nothing is known, the first values say where the taxels rest.
  std::map<std::string, std::string> facts;  ///< The facts describe the recording (docs/recording.md).
};

/// Reads which skin a recording is of. Throws InputError when the file is not a recording of triskin, has no design, or
/// has a damaged calibration or damaged rest values. Cost: reads the first part of the file.
[[nodiscard]] RecordedSkin recorded_skin(const std::string& file);

}  // namespace triskin::recording
