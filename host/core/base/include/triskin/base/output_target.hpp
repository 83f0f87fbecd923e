// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace triskin {

/// A file under another name beside the one that it will replace.
struct TemporaryFile {
  int fd = -1;  ///< The file is open for reading and writing; -1 means that it could not be made, and errno tells why.
  std::string path;  ///< The path is in the folder of the target, with a short name of its own.
};

/// Creates the temporary file of `target` with the permissions of the target or, if there is none, with those that the
/// umask leaves of rw-rw-rw-.
[[nodiscard]] TemporaryFile create_beside(const std::filesystem::path& target);

/// Returns the file that a path finally names: symbolic links are followed, also one whose file does not exist yet.
[[nodiscard]] std::filesystem::path target_of(const std::filesystem::path& path);

/// Flushes the directory entry of a file to the disk, so that a rename survives a loss of power. Ignores a file system
/// that cannot do this. Cost: waits for the disk.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace triskin
