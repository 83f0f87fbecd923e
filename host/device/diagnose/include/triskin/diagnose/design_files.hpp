// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "triskin/diagnose/verify.hpp"

namespace triskin::diagnose {

/// Returns the design files (*.json) of a folder that have the design id `id`, sorted by name. Unreadable files and
/// files of other formats are skipped; nothing is thrown. Cost: each file is read up to its id, at most 200 files.
[[nodiscard]] std::vector<std::filesystem::path> files_of_design(const std::filesystem::path& folder, std::uint64_t id);

/// Searches beside `design_file` for files of the designs that the controllers were found to have, and names them in
/// the findings (held_file and remedy). Throws nothing. Cost: files_of_design for each such finding.
void name_files(std::vector<Finding>& findings, const std::filesystem::path& design_file);

}  // namespace triskin::diagnose
