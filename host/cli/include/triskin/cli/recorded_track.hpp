// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"

namespace triskin::cli {

/// A recording as the page plays it.
struct RecordedTrack {
  design::Design design;  ///< the one in the recording
  std::string frames;     ///< view::FrameTrack
  std::string remark;     ///< for a person: what of the recording is not there; empty: it is all there
};

/// True for the name of a recording: the extension is .mcap.
[[nodiscard]] bool is_recording(const std::string& file);

/// The design in a recording. Throws InputError when it is no recording of triskin, or holds no design. Cost: reads the
/// first part of the file.
[[nodiscard]] design::Design recorded_design(const std::string& file);

/// The calibration in a recording of `design`; none: counts alone. Throws InputError when it is damaged. Cost: as
/// recorded_design.
[[nodiscard]] design::SkinCalibration recorded_calibration(const std::string& file, const design::Design& design);

/// Reads a recording. `most_bytes`: of the frames; later ones are dropped. Throws InputError when it is no recording of
/// triskin, or holds no design or no sample. Cost: reads the file.
[[nodiscard]] RecordedTrack read_track(const std::string& file, std::size_t most_bytes);

}  // namespace triskin::cli
