// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "triskin/diagnose/verify.hpp"

namespace triskin::device {

/// The design files (*.json) of a folder that say they are design `id`, by name. Files that cannot be read, and those
/// of other formats, are passed over; nothing is thrown. Cost: each file is read until its id, at most 200 files.
[[nodiscard]] std::vector<std::filesystem::path> files_of_design(const std::filesystem::path& folder, std::uint64_t id);

/// Looks beside `design_file` for files of the designs that the controllers were found to hold, and names them in the
/// findings (held_file and remedy). Throws nothing. Cost: files_of_design for each such finding.
void name_files(std::vector<Finding>& findings, const std::filesystem::path& design_file);

}  // namespace triskin::device
