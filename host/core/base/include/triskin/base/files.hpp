// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace triskin {

/// Reads a whole file as bytes; "-" is standard input. Throws InputError naming the file when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Writes `bytes` so that `path` appears whole or not at all (temporary file in the same folder, fsync,
/// rename). Throws InputError naming the file and the cause; then the old file, if any, is unchanged.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Writes an output that a user asked for with -o, as the tools of coreutils would: "-" is standard output; a symbolic
/// link is followed, also one whose file does not exist yet, and the file that it names appears whole or not at all,
/// with its old permissions; into a device or pipe the bytes are written. Throws InputError naming the file and the
/// cause, also for a folder.
void write_output(const std::filesystem::path& path, std::string_view bytes);

/// Does the same for text that is made part by part. Without commit() a file stays as it was before, but output to
/// standard output, a device or a pipe cannot be undone. One thread.
class OutputFile {
 public:
  /// Throws as write_output() does.
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws InputError naming the file and the cause.
  void write(std::string_view bytes);
  /// Completes the file. Throws the same as write().
  void commit();

 private:
  std::filesystem::path path_, target_;
  std::string temporary_;  // Empty if the file is written in place.
  int fd_ = -1;
};

/// Throws InputError if write_output() could not write, so that a command fails before its long work and not after.
/// Leaves no file behind.
void require_writable(const std::filesystem::path& path);

/// Returns the folder for data that the program keeps on this computer between two runs: $XDG_STATE_HOME/triskin, else
/// ~/.local/state/triskin, else triskin-<user number> in the temporary folder. Creates the folder above it if missing.
[[nodiscard]] std::filesystem::path state_home();

}  // namespace triskin
