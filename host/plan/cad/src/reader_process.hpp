// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace triskin::cad {

struct ProcessLimits {
  double wall_s = 60.0;
  double processor_s = 60.0;
  std::uint64_t memory_bytes = 0;  ///< The reader's address space may not exceed this.
  std::uint64_t file_bytes = 0;    ///< No file that the reader writes may be larger.
};

enum class ProcessEnd : std::uint8_t { kDone, kFailed, kCrashed, kOutOfTime };

struct ProcessResult {
  ProcessEnd end = ProcessEnd::kDone;
  int signal = 0;  ///< Only a process that crashed has a signal number.
  std::string output;
};

/// Finds the program that reads CAD files: the file in the variable TRISKIN_CAD_READER, or else `triskin-cad` beside
/// this program or in ../libexec/triskin. Returns nothing if it is not there.
[[nodiscard]] std::optional<std::filesystem::path> find_reader();

/// Runs `program` with `input` as its standard input (a file in memory, so that it can seek) and returns its standard
/// output; its messages are dropped. Errors: InputError when no process can be started. Threads: any.
[[nodiscard]] ProcessResult run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                                        std::string_view input, const ProcessLimits& limits);

}  // namespace triskin::cad
