// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "triskin/recording/output_file.hpp"

namespace triskin::recording {

/// Each part is one recording that is copied into the joint file.
struct JoinPart {
  std::string name;  ///< The name prefixes attachments and tables: NAME/design.json, triskin/NAME.
  std::filesystem::path path;
};

/// Joins the MCAP recordings of several covers into one file for viewers. Topics keep their names, and topics of equal
/// name and type share a channel. Chunks are ordered by their first message, so messages of different covers can be out
/// of order by one chunk (0.5 s) at most. Damaged data is left out. Returns the number of messages. Throws InputError
/// for a part that is no MCAP file, WriteFailed if `file` cannot be written. Cost: linear. Memory: a chunk of each
/// part.
std::uint64_t join(std::span<const JoinPart> parts, OutputFile& file);

}  // namespace triskin::recording
