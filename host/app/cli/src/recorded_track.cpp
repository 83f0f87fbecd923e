// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorded_track.hpp"

#include <fmt/format.h>

#include <vector>

#include "shown_contact.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/skin/touch_map.hpp"
#include "triskin/view/frame_track.hpp"

namespace triskin::cli {

bool is_recording(const std::string& file) {
  return extension_of(file) == ".mcap";
}

RecordedTrack read_track(const std::string& file, std::size_t max_bytes) {
  RecordedTrack recorded{recorded_skin(file), {}, {}};
  const std::size_t modules = recorded.skin.design.layout.modules.size();
  skin::TouchMap touches(recorded.skin.design, recorded.skin.rest);
  const auto contacts = [&] {
    std::vector<view::LatestSamples::Contact> shown;
    for (const skin::SkinContact& c : skin::contacts_of(touches, recorded.skin.design, recorded.skin.calibration))
      shown.push_back(shown_contact(c, layout::SkinModule{0}));
    return shown;
  };
  view::FrameTrack track(modules, max_bytes, contacts);
  const recording::Summary summary = recording::read_recording(file, [&](const recording::ModuleSample& s) {
    if (static_cast<std::size_t>(s.module) >= modules) return;
    const auto time_us = static_cast<std::int64_t>(s.link_time_us);
    track.advance_to(time_us);
    touches.add({s.module, s.link_time_us, s.sample});
    track.add(layout::SkinModule{s.module.value()}, {s.sample.state, s.sample.valid, touches.change(s.module)},
              time_us);
  });
  recorded.frames = track.finish();
  if (recorded.frames.empty()) throw InputError(fmt::format("{}: holds no sample, so there is nothing to play", file));
  if (!summary.file.complete)
    recorded.remark = fmt::format("the recording {}; triskin recover makes it whole", summary.file.problem);
  if (track.is_cut())
    recorded.remark = fmt::format(
        "{}: the page holds only its first {} MB; record less, or play it with triskin replay", file, max_bytes >> 20U);
  return recorded;
}

}  // namespace triskin::cli
