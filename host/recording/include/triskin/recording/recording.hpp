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
  std::uint64_t link_time_us = 0;  ///< Its first sample came at this time.
  int module = 0;                  ///< It is an id of the design.
  Reader reader;                   ///< This reader holds from this time on.
  bool own = false;                ///< The module's own controller reads it again.
};

/// What a recording says of itself, and where it ends.
struct Summary {
  std::map<std::string, std::string> facts;   ///< They are design id, link, clock, units and versions.
  std::map<std::string, std::string> result;  ///< It says how the recording went and is empty when it was cut.
  std::string design_text;                    ///< It is the text of the design file.
  std::string calibration_text;  ///< It is the text of the calibration file; if it is empty there are only counts.
  std::string rest_text;  ///< It is the text of the file of rest values; if it is empty those of the design hold.
  /// They stand in the order of the file; recordings before 0.2 have none.
  std::vector<ReaderChange> reader_changes;
  std::uint64_t samples = 0;                ///< It counts the samples of modules.
  std::uint64_t first_us = 0, last_us = 0;  ///< They are the link's time at the first and the last sample.
  mcap::ReadReport file;
};

/// Reads the recording `path` and passes every sample to `handler` (may be empty) in the order of the file, up to the
/// last whole chunk. Throws InputError when it is no MCAP file. Memory: one chunk.
Summary read_recording(const std::filesystem::path& path, const std::function<void(const ModuleSample&)>& handler);
/// The design and the facts, without the samples: reads up to the first sample. Throws InputError.
[[nodiscard]] Summary read_origin(const std::filesystem::path& path);

/// A place of a recording that is damaged.
struct Loss {
  std::uint64_t offset = 0, bytes = 0;  ///< They are the position in the damaged file.
  std::string what;                     ///< It is "a chunk", "the index of a chunk" and the like.
  bool is_mended = false;               ///< It could be rebuilt from intact data, so nothing is missing.
  /// Time of the last message before the damage and the first one after it, since the first message; `to_s` < 0: there
  /// is none after it.
  double from_s = 0.0, to_s = 0.0;
};

/// What `recover` did.
struct Recovery {
  bool was_complete = false;  ///< The file needed no repair.
  std::uint64_t messages = 0, kept_bytes = 0, dropped_bytes = 0;
  std::string problem;       ///< It is the place where the file was cut or damaged.
  std::vector<Loss> losses;  ///< They stand in the order of the file.
};
/// Makes a damaged recording whole: keeps every chunk whose CRC holds, before and behind the damage, and writes the
/// indexes and the summary again. A file that was only cut is completed in place when `output` is empty. Damage
/// elsewhere, and a file that was closed, need `output`, so that no byte of the original is lost. Definitions of types
/// and channels that are damaged come from the summary when its CRC holds; without them the messages of their channels
/// are left out and counted as losses. Throws InputError when `path` is no MCAP file, is compressed, holds no whole
/// message, or needs `output`; WriteFailed. Cost: linear; memory: one record. Threads: one.
Recovery recover(const std::filesystem::path& path, const std::filesystem::path& output);

}  // namespace triskin::recording
