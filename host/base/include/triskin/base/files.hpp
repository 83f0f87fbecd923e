// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace triskin {

/// Whole file as bytes; "-" is standard input. Throws InputError naming the file when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Writes `bytes` so that `path` appears whole or not at all (temporary file in the same folder, fsync,
/// rename). Throws InputError naming the file and the cause; then the old file, if any, is unchanged.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Writes what a user asked for with -o, as the tools of coreutils would: "-" is standard output; a symbolic link is
/// followed, also one whose file does not exist yet, and the file that it names appears whole or not at all, with the
/// permissions that it had; into a device or pipe the bytes are written.
/// Throws InputError naming the file and the cause, also for a folder.
void write_output(const std::filesystem::path& path, std::string_view bytes);

/// Throws InputError where write_output() could not write: before long work, not behind it. Leaves nothing behind.
void require_writable(const std::filesystem::path& path);

/// Folder for what the program keeps on this computer between two runs: $XDG_STATE_HOME/triskin, else
/// ~/.local/state/triskin, else triskin-<user number> in the temporary folder. The folder above it is made if it is not there.
[[nodiscard]] std::filesystem::path state_home();

}  // namespace triskin
