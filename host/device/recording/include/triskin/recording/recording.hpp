// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/recording/mcap_file.hpp"
#include "triskin/recording/messages.hpp"
#include "triskin/recording/readers.hpp"

namespace triskin::recording {

/// The attachments with the calibration (design/calibration.hpp) and the rest values have these names.
inline constexpr const char *kCalibrationName = "calibration.json", *kRestName = "rest.json",
                            *kSettledName = "settled.json";

/// Returns the key of the fact that has the serial number of the controller with a node address.
[[nodiscard]] inline std::string serial_fact(layout::NodeAddress node) {
  return "serial_" + std::to_string(node.value());
}

/// Another controller began to read a module.
struct ReaderChange {
  std::uint64_t link_time_us = 0;  ///< The first sample of the new reader came at this time.
  layout::ModuleId module;
  Reader reader;     ///< This reader applies from that time on.
  bool own = false;  ///< True means that the module's own controller reads it again.
};

/// The summary has the facts that a recording contains about itself, and where it ends.
struct Summary {
  std::map<std::string, std::string> facts;  ///< The facts are design id, link, clock, units and versions.
  /// The recorder leaves this empty when the recording was cut; otherwise it describes how the recording went.
  std::map<std::string, std::string> result;
  std::string design_text;       ///< The text is a copy of the design file.
  std::string calibration_text;  ///< The text is that of the calibration file; if it is empty, there are only counts.
  std::string rest_text;  ///< The text is that of the file of rest values; if it is empty, the first values apply.
  /// The text is that of what the controllers said of the rest; if it is empty, they said nothing.
  std::string settled_text;
  std::vector<ReaderChange> reader_changes;  ///< in the order of the file
  /// Channels that look like samples of a skin but cannot be read, each with the reason.
  std::vector<std::string> not_understood;
  std::uint64_t samples = 0;                ///< Every sample of a module counts.
  std::uint64_t first_us = 0, last_us = 0;  ///< These are the link's times at the first and the last sample.
  mcap::ReadReport file;
};

/// Reads the recording `path` and passes every sample to `handler` (may be empty) in the order of the file, up to the
/// last whole chunk. Throws InputError when it is not an MCAP file. Memory: one chunk.
Summary read_recording(const std::filesystem::path& path, const std::function<void(const ModuleSample&)>& handler);
/// Reads only the design and the facts, up to the first sample. Throws InputError.
[[nodiscard]] Summary read_origin(const std::filesystem::path& path);

/// The file is damaged at this place.
struct Loss {
  std::uint64_t offset = 0, bytes = 0;  ///< The position refers to the damaged file.
  std::string what;        ///< The text names the damaged part: "a chunk", "the index of a chunk" and so on.
  bool is_mended = false;  ///< True means that the part was rebuilt from intact data, so nothing is missing.
  /// Times of the last message before the damage and the first one after it, counted from the first message; `to_s` < 0
  /// means that none follows.
  double from_s = 0.0, to_s = 0.0;
};

/// recover() returns what it found and repaired.
struct Recovery {
  bool was_complete = false;  ///< True means that the file needed no repair.
  std::uint64_t messages = 0, kept_bytes = 0, dropped_bytes = 0;
  std::string problem;       ///< The text says where the file was cut or damaged.
  std::vector<Loss> losses;  ///< Losses are in the order of the file.
};
/// Repairs a damaged recording: it keeps every chunk whose CRC is right, before and after the damage, and writes the
/// indexes and the summary again. A file that was only cut is completed in place when `output` is empty. Any other
/// damage, and a file that was closed, requires `output`, so that no byte of the original is lost. Damaged definitions
/// of types and channels are taken from the summary if its CRC is right; without them the messages of their channels
/// are left out and counted as losses. Throws InputError when `path` is not an MCAP file, is compressed, has no whole
/// message, or needs `output`; WriteFailed. Cost: linear; memory: one record. Threads: one.
Recovery recover(const std::filesystem::path& path, const std::filesystem::path& output);

}  // namespace triskin::recording
