// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"

namespace triskin::recording {

/// The skin that a recording is of.
struct RecordedSkin {
  design::Design design;
  design::SkinCalibration calibration;       ///< none: counts alone
  std::vector<std::string> serials;          ///< indexed by patch: serial of the controller; empty text: not known
  design::RestValues rest;                   ///< empty: the design's rest values
  std::map<std::string, std::string> facts;  ///< what the recording says of itself (docs/recording.md)
};

/// The skin that a recording is of. Throws InputError when it is no recording of triskin, holds no design, or a damaged
/// calibration or rest values. Cost: reads the first part of the file.
[[nodiscard]] RecordedSkin recorded_skin(const std::string& file);

}  // namespace triskin::recording
