// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>

#include "triskin/recording/recorded_skin.hpp"

namespace triskin::cli {

using recording::recorded_skin;
using recording::RecordedSkin;

/// A recording as the page plays it.
struct RecordedTrack {
  RecordedSkin skin;
  std::string frames;  ///< They are those of view::FrameTrack.
  std::string remark;  ///< It says which parts of the recording are missing and is empty if it is complete.
};

/// True for the name of a recording: the extension is .mcap.
[[nodiscard]] bool is_recording(const std::string& file);

/// Reads a recording. `max_bytes`: of the frames; later ones are dropped. Throws InputError when it is no recording of
/// triskin, or holds no design or no sample. Cost: reads the file.
[[nodiscard]] RecordedTrack read_track(const std::string& file, std::size_t max_bytes);

}  // namespace triskin::cli
