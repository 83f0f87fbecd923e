// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// Limits and wishes for reading a part.
struct ReadOptions {
  double unit_mm = 0.0;  ///< It is the length of one unit of the file's numbers; 0 takes what the file says, else 1.
  double max_deviation_mm = 0.05;  ///< The mesh is at most so far from the exact surface, 0.001 … 10.
  /// > 0, of the processor, three times as much by the clock; at most 7 s and 6 s per MB of the file.
  double time_limit_s = 60.0;
  /// It limits the address space of the reader process; 0 takes 1,000, and more for files above 20 MB.
  std::uint64_t memory_mb = 0;
};

/// True when the bytes are those of a STEP or IGES file, or the file's name says so.
[[nodiscard]] bool is_cad_file(const std::filesystem::path& path, std::string_view bytes);

/// True when the program that reads CAD files is installed beside this one.
[[nodiscard]] bool can_read_parts();

/// Reads a STEP or IGES file and meshes it. The geometry kernel runs in a process of its own (`triskin-cad`) with
/// limits of time and memory: whatever the file holds, this process goes on. Errors: InputError naming the file, the
/// place and the remedy for what cannot be read, for files without geometry, for limits that are reached, and where the
/// reader is not installed. What could be read in part has Part::faults. Cost: 0.1 … 2 s for covers. Thread-safe.
[[nodiscard]] Part read_part(const std::filesystem::path& path, const ReadOptions& options = {});
/// The same for bytes in memory; `name` stands in messages.
[[nodiscard]] Part read_part_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options = {});

}  // namespace triskin::cad
