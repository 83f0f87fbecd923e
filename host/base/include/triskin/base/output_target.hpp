// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace triskin {

/// A file under another name beside the one that it will replace.
struct TemporaryFile {
  int fd = -1;       ///< open for reading and writing; -1: it could not be made, and errno says why
  std::string path;  ///< path in the folder of the target, with a short name of its own
};

/// Creates the temporary file of `target` with the permissions that the target has, or, where there is none, with those
/// that the umask leaves of rw-rw-rw-.
[[nodiscard]] TemporaryFile create_beside(const std::filesystem::path& target);

/// The file that a path names in the end: symbolic links are followed, also one whose file does not exist yet.
[[nodiscard]] std::filesystem::path target_of(const std::filesystem::path& path);

/// Brings the entry of a file in its folder to the disk, so that a rename outlives a loss of power. A file system that
/// cannot is taken as it is. Cost: waits for the disk.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace triskin
