// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace triskin::cad {

/// Limits of a reader process.
struct ProcessLimits {
  double wall_s = 60.0;
  double processor_s = 60.0;
  std::uint64_t memory_bytes = 0;  ///< It limits the reader's address space.
  std::uint64_t file_bytes = 0;    ///< largest file that it may write
};

/// How a process ended.
enum class ProcessEnd : std::uint8_t { kDone, kFailed, kCrashed, kOutOfTime };

/// Output of a process, and how it ended.
struct ProcessResult {
  ProcessEnd end = ProcessEnd::kDone;
  int signal = 0;  ///< It is the signal of kCrashed.
  std::string output;
};

/// The program that reads CAD files: the file in the variable TRISKIN_CAD_READER, else `triskin-cad` beside this
/// program or in ../libexec/triskin. Nothing where it is not.
[[nodiscard]] std::optional<std::filesystem::path> find_reader();

/// Runs `program` with `input` as its standard input (a file in memory, so that it can seek) and takes its standard
/// output; its messages are dropped. Errors: InputError when no process can be started. Threads: any.
[[nodiscard]] ProcessResult run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                                        std::string_view input, const ProcessLimits& limits);

}  // namespace triskin::cad
