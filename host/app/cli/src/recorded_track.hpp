// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>

#include "triskin/recording/recorded_skin.hpp"

namespace triskin::cli {

using recording::recorded_skin;
using recording::RecordedSkin;

/// The page plays a recording in this form.
struct RecordedTrack {
  RecordedSkin skin;
  std::string frames;  ///< The frames have the format of view::FrameTrack.
  std::string remark;  ///< The remark says which parts of the recording are missing; it is empty if it is complete.
};

/// Returns true if the file name has the extension .mcap.
[[nodiscard]] bool is_recording(const std::string& file);

/// Reads a recording. `max_bytes` limits the frames; later ones are dropped. Throws InputError when it is not a
/// recording of triskin, or has no design or no sample. Cost: reads the file.
[[nodiscard]] RecordedTrack read_track(const std::string& file, std::size_t max_bytes);

}  // namespace triskin::cli
