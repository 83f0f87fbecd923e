// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "triskin/recording/mcap_file.hpp"
#include "triskin/recording/messages.hpp"
#include "triskin/recording/readers.hpp"

namespace triskin::recording {

/// Name of the attachment that holds the calibration (design/calibration.hpp).
inline constexpr const char *kCalibrationName = "calibration.json", *kRestName = "rest.json";

/// Fact that holds the serial number of the controller with a node address.
[[nodiscard]] inline std::string serial_fact(int node) {
  return "serial_" + std::to_string(node);
}

/// Another controller began to read a module.
struct ReaderChange {
  std::uint64_t link_time_us = 0;  ///< when its first sample came
  int module = 0;                  ///< id in the design
  Reader reader;                   ///< from then on
  bool own = false;                ///< it is the module's own controller again
};

/// What a recording says of itself, and where it ends.
struct Summary {
  std::map<std::string, std::string> facts;   ///< design id, link, clock, units, versions
  std::map<std::string, std::string> result;  ///< how it went; empty when it was cut
  std::string design_text;                    ///< the design file
  std::string calibration_text;               ///< the calibration file; empty: counts alone
  std::string rest_text;                      ///< the file of the rest values; empty: those by design
  std::vector<ReaderChange> reader_changes;   ///< in the order of the file; none in recordings before 0.2
  std::uint64_t samples = 0;                  ///< of modules
  std::uint64_t first_us = 0, last_us = 0;    ///< link time of the first and the last sample
  mcap::ReadReport file;
};

/// Reads the recording `path` and passes every sample to `handler` (may be empty) in the order of the file, up to the
/// last whole chunk. Throws InputError when it is no MCAP file. Memory: one chunk.
Summary read_recording(const std::filesystem::path& path, const std::function<void(const ModuleSample&)>& handler);
/// The design and the facts, without the samples: reads up to the first sample. Throws InputError.
[[nodiscard]] Summary read_origin(const std::filesystem::path& path);

/// What `recover` did.
struct Recovery {
  bool was_complete = false;  ///< nothing had to be done
  std::uint64_t messages = 0, kept_bytes = 0, dropped_bytes = 0;
  std::string problem;  ///< where the file was cut
};
/// Makes a recording that was cut whole: keeps everything up to its last whole chunk and writes the index. With an
/// empty `output` in the file itself, which then ends at the cut; else into a new file. Throws InputError when `path`
/// is no MCAP file, when there is no whole chunk, or when more is damaged than the end (then it demands `output`);
/// WriteFailed.
Recovery recover(const std::filesystem::path& path, const std::filesystem::path& output);

}  // namespace triskin::recording
