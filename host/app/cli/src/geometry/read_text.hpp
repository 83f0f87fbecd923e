// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

#include "command.hpp"
#include "triskin/mesh/open_side.hpp"

namespace triskin::cli {

/// Prints the notes of a mesh reader, one per line, and stores them in the result.
inline void say_notes(const std::string& file, const std::vector<std::string>& notes, Output& output) {
  for (const std::string& note : notes) output.say(fmt::format("{}: {}", file, note));
}

/// Names the side of an open part that gets the modules, and the reason; asks the user to check it if its faces look at
/// its own middle. Empty for a closed part, which has an outside.
[[nodiscard]] inline std::string side_text_of(const mesh::OpenSide& side) {
  constexpr double kNearlyAll = 0.95;
  if (!side.is_open) return {};
  std::string text = fmt::format(
      "Open surface: modules go on the side the face normals point to, on average ({:.2f}, {:.2f}, {:.2f}); --flip "
      "takes "
      "the other",
      side.normal.x(), side.normal.y(), side.normal.z());
  if (side.toward_middle > kNearlyAll)
    text += ". All faces point towards the middle of the part: is that the outside? If not, pass --flip";
  return text;
}

}  // namespace triskin::cli
