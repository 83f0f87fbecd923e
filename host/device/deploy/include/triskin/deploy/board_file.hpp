// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/deploy/flash.hpp"

namespace triskin::deploy {

/// `triskin identify` writes the controller of each patch of a design in this form (docs/deploy.md).
struct BoardFile {
  std::uint64_t design_id = 0;
  /// The list is sorted by patch; each patch and each controller occurs once.
  std::vector<FlashOptions::Assignment> boards;
};

/// Reads such a file. Throws InputError naming file, place and remedy: no such file, another format or version, a patch
/// that the design lacks, a patch or controller that occurs twice, a file of another design.
[[nodiscard]] BoardFile read_board_file(const std::filesystem::path& path, const design::Design& design);

/// Formats a board file that read_board_file() reads.
[[nodiscard]] std::string board_file_text(const BoardFile& file);

/// Converts a serial number to upper case; returns an empty text if it does not have 24 hexadecimal digits.
[[nodiscard]] std::string normal_serial(std::string text);

}  // namespace triskin::deploy
