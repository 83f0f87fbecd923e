// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"

namespace triskin::cli {

/// The skin that a recording is of.
struct RecordedSkin {
  design::Design design;
  design::SkinCalibration calibration;  ///< none: counts alone
  std::vector<std::string> serials;     ///< indexed by patch: serial of the controller; empty text: not known
  design::RestValues rest;              ///< empty: the design's rest values
};

/// A recording as the page plays it.
struct RecordedTrack {
  RecordedSkin skin;
  std::string frames;  ///< view::FrameTrack
  std::string remark;  ///< message about missing parts of the recording; empty: it is complete
};

/// True for the name of a recording: the extension is .mcap.
[[nodiscard]] bool is_recording(const std::string& file);

/// The skin that a recording is of. Throws InputError when it is no recording of triskin, holds no design, or a damaged
/// calibration or rest values. Cost: reads the first part of the file.
[[nodiscard]] RecordedSkin recorded_skin(const std::string& file);

/// Reads a recording. `max_bytes`: of the frames; later ones are dropped. Throws InputError when it is no recording of
/// triskin, or holds no design or no sample. Cost: reads the file.
[[nodiscard]] RecordedTrack read_track(const std::string& file, std::size_t max_bytes);

}  // namespace triskin::cli
