// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/deploy/flash.hpp"

namespace triskin::device {

/// Controller of each patch of a design, as `triskin identify` writes it (docs/which_board.md).
struct BoardFile {
  std::uint64_t design_id = 0;
  /// They are sorted by patch; each patch and each controller occurs once.
  std::vector<FlashOptions::Assignment> boards;
};

/// Reads such a file. Throws InputError naming file, place and remedy: no such file, another format or version, a patch
/// that the design lacks, a patch or controller that stands twice, a file of another design.
[[nodiscard]] BoardFile read_board_file(const std::filesystem::path& path, const design::Design& design);

/// Text of such a file.
[[nodiscard]] std::string board_file_text(const BoardFile& file);

/// Serial number in upper case; empty: it has not 24 hexadecimal digits.
[[nodiscard]] std::string normal_serial(std::string text);

}  // namespace triskin::device
