// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

struct ReadOptions {
  double unit_mm = 0.0;  ///< One unit of the file's numbers has this length; 0 takes the unit of the file, or else 1.
  double max_deviation_mm = 0.05;  ///< The mesh is at most this far from the exact surface, 0.001 … 10.
  /// Limits processor time (> 0), with three times as much by the clock; at most 7 s and 6 s per MB of the file are
  /// used.
  double time_limit_s = 60.0;
  /// Limits the address space of the reader process; 0 takes 1,000, and more for files above 20 MB.
  std::uint64_t memory_mb = 0;
};

/// Returns true when the bytes are those of a STEP or IGES file, or the file's name says so.
[[nodiscard]] bool is_cad_file(const std::filesystem::path& path, std::string_view bytes);

/// Returns true when the program that reads CAD files is installed beside this one.
[[nodiscard]] bool can_read_parts();

/// Reads a STEP or IGES file and meshes it. The geometry kernel runs in its own process (`triskin-cad`) with limits of
/// time and memory, so that no file can stop this process. Errors: InputError naming the file, the place and the remedy
/// for files that cannot be read, for files without geometry, for limits that are reached, and if the reader is not
/// installed. A file that could be read only partly has Part::faults. Cost: 0.1 … 2 s for covers. Thread-safe.
[[nodiscard]] Part read_part(const std::filesystem::path& path, const ReadOptions& options = {});
/// Does the same for bytes in memory; messages call them `name`.
[[nodiscard]] Part read_part_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options = {});

}  // namespace triskin::cad
