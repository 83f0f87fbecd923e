// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace triskin::recording {

/// ROS 2 writes these versions of metadata.yaml: 5 is that of Humble and read by all that came later, 9 that of Jazzy.
inline constexpr int kMinRosbag2Version = 5, kMaxRosbag2Version = 9;

/// Describes recordings of this program as a bag of ROS 2 (rosbag2_storage/metadata_io.cpp): the text of the file
/// metadata.yaml beside them. `files` follow one another in time and were finished. `type_hash` gives the hash
/// ("RIHS01_…") of a message type by its name, for versions from 7 on; empty if it is not known. Throws InputError
/// naming a file that is no finished recording. Cost: reads the heads of all records.
[[nodiscard]] std::string rosbag2_metadata(std::span<const std::filesystem::path> files, int version,
                                           const std::function<std::string(std::string_view)>& type_hash);

}  // namespace triskin::recording
