// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cli/recorded_track.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "triskin/design/design_text.hpp"
#include "triskin/host/error.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/view/frame_track.hpp"

namespace triskin::cli {

bool is_recording(const std::string& file) {
  return std::filesystem::path(file).extension() == ".mcap";
}

design::Design recorded_design(const std::string& file) {
  const recording::Summary origin = recording::read_origin(file);
  if (origin.design_text.empty())
    throw InputError(fmt::format("{}: holds no design: is it a recording of triskin?", file));
  return design::parse_design(origin.design_text, file + ": design.json");
}

design::SkinCalibration recorded_calibration(const std::string& file, const design::Design& design) {
  const recording::Summary origin = recording::read_origin(file);
  if (origin.calibration_text.empty()) return {};
  const auto boards = design::parse_calibration(origin.calibration_text, file + ": " + recording::kCalibrationName);
  return design::SkinCalibration(design, boards, [&](int patch) -> std::string {
    const auto serial = origin.facts.find(recording::serial_fact(design::node_address_of(design, patch)));
    return serial == origin.facts.end() ? "" : serial->second;
  });
}

RecordedTrack read_track(const std::string& file, std::size_t most_bytes) {
  RecordedTrack recorded{recorded_design(file), {}, {}};
  view::FrameTrack track(recorded.design.layout.modules.size(), most_bytes);
  const recording::Summary summary = recording::read_recording(file, [&](const recording::ModuleSample& s) {
    track.add(s.module, s.sample, static_cast<std::int64_t>(s.link_time_us));
  });
  recorded.frames = track.finish();
  if (recorded.frames.empty()) throw InputError(fmt::format("{}: holds no sample, so there is nothing to play", file));
  if (!summary.file.complete)
    recorded.remark = fmt::format("the recording {}; triskin recover makes it whole", summary.file.problem);
  if (track.is_cut())
    recorded.remark =
        fmt::format("{}: the page holds only its first {} MB; record less, or play it with triskin replay", file,
                    most_bytes >> 20U);
  return recorded;
}

}  // namespace triskin::cli
