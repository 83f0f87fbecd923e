// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/design/side_by_side.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::cli {

/// The page shows a design unchanged, or the covers of a robot in the frame of its base.
struct ShownDesign {
  design::Design design;
  std::vector<design::CoverOffset> offsets;
  view::Notes notes{};  ///< names and coverage of the covers of a robot
};
/// Reads a design file or a robot file. `is_deployed`: the design must be intact. Throws InputError as the readers do.
[[nodiscard]] ShownDesign read_shown_design(const std::string& file, bool is_deployed);

/// Reads the covers of a robot file, each with its own numbers, its name, and the node addresses of the robot. Throws
/// InputError as read_assembly does.
[[nodiscard]] std::vector<design::Design> read_covers(const std::string& robot_file);

}  // namespace triskin::cli
