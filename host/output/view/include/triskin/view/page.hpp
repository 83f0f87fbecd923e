// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <string_view>

#include "triskin/design/design.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {

/// The program has the files of the page embedded.
struct Asset {
  std::string_view type;  ///< The media type goes into the header Content-Type.
  std::string_view bytes;
};
/// Returns the files of the page that are embedded in the program, by name ("index.html", "main.js", "three.js", …).
[[nodiscard]] const std::map<std::string_view, Asset>& assets();
/// Returns false when the program was built on a machine without three.js; then there is no page.
[[nodiscard]] bool has_page();
/// Throws InputError with the remedy when the program has no page.
void require_page();

/// Returns the facts of a design that the page needs as JSON: surface, modules with corners and taxels (mm, mesh frame,
/// rounded to 10 µm), wiring, metrics with their limits, failures; page/model.js reads it. `recording` says that
/// the page has a recording to play. `notes` has covers of a robot and findings. Cost: O(faces + modules).
[[nodiscard]] std::string model_json(const design::Design& design, bool recording = false, const Notes& notes = {});

/// Makes the page of a design as one self-contained HTML file, which loads nothing and works from a disk or an e-mail.
/// `track` has frames of a recording (FrameTrack) that the page plays; empty means none. `notes` as for model_json().
/// Throws InputError when the
/// program has no page. Cost: O(faces + modules + track).
[[nodiscard]] std::string page_html(const design::Design& design, std::string_view track = {}, const Notes& notes = {});

}  // namespace triskin::view
