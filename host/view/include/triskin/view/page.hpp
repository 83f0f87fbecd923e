// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <string_view>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {

/// One file of the page.
struct Asset {
  std::string_view type;  ///< It is the media type for the header Content-Type.
  std::string_view bytes;
};
/// The files of the page that were embedded in the program, by name ("index.html", "main.js", "three.js", …).
[[nodiscard]] const std::map<std::string_view, Asset>& assets();
/// False when the program was built on a machine without three.js; then there is no page.
[[nodiscard]] bool has_page();
/// Throws InputError with the remedy when the program has no page.
void require_page();

/// What the page needs to know of a design, as JSON: surface, modules with corners and taxels (mm, mesh frame, rounded
/// to 10 µm), wiring, metrics with their limits, failures. docs/view.md has the keys. `recording`: the page has a
/// recording to play. `calibration`: for forces in N; where it is not complete the page shows counts. `notes`: covers
/// of a robot and findings. Cost: O(faces + modules).
[[nodiscard]] std::string model_json(const design::Design& design, bool recording = false,
                                     const design::SkinCalibration& calibration = {}, const Notes& notes = {});

/// The page of a design as one HTML file with everything inside: it asks for nothing and works from a disk or a mail.
/// `track`: frames of a recording (FrameTrack) that the page plays, empty: none. `calibration` and `notes` as
/// model_json. Throws InputError when the program has no page. Cost: O(faces + modules + track).
[[nodiscard]] std::string page_html(const design::Design& design, std::string_view track = {},
                                    const design::SkinCalibration& calibration = {}, const Notes& notes = {});

}  // namespace triskin::view
