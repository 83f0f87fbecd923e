// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "triskin/recording/output_file.hpp"

namespace triskin::recording {

/// A recording that goes into a joint file.
struct JoinPart {
  std::string name;  ///< Its attachments and tables are named NAME/design.json, triskin/NAME and so on.
  std::filesystem::path path;
};

/// Writes the MCAP recordings of several covers into one file for viewers. Topics stay as they are, and those of one
/// name and type become one channel; chunks follow each other by the time of their first message, so messages of
/// different covers are out of order by the length of a chunk (0.5 s) at most. What is damaged in a part is left out.
/// Result: number of messages. Throws InputError for a part that is no MCAP file, WriteFailed when `file` takes no
/// more. Cost: linear. Memory: a chunk of each part.
std::uint64_t join(std::span<const JoinPart> parts, OutputFile& file);

}  // namespace triskin::recording
