// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "triskin/base/error.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/recording/byte_source.hpp"

namespace triskin::recording {

/// Thrown when the file of a recording accepts no more bytes, for example because the disk is full. Everything written
/// before remains.
class WriteFailed : public Error {
 public:
  using Error::Error;
};

/// The file grows while it is written. It is opened before there is any data, so that an unwritable file is noticed at
/// once. An existing recording is replaced in one step, once the first bytes of the new one are in a file and the disk
/// has room for its first megabyte; until then the old one is untouched. No other program may write it at the same time
/// (flock). Threads: one.
class OutputFile final : public ByteSource {
 public:
  /// Opens `path`: a symbolic link is followed, "-" is standard output, and a device or a pipe is written to. Throws
  /// InputError naming the file and the cause; if another program writes it, the message names that program.
  explicit OutputFile(const std::filesystem::path& path);
  /// Opens the recording `path` to append behind its first `keep_bytes` bytes; the rest is cut off. Throws InputError,
  /// also when another program still writes it.
  OutputFile(const std::filesystem::path& path, std::uint64_t keep_bytes);
  /// Removes the file if it is new and nothing was written to it.
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends bytes. Throws WriteFailed naming the file, the cause and how many bytes were written.
  void write(Bytes bytes);
  /// Reads `into.size()` bytes from `offset`; returns false if the file is shorter or cannot be read (a pipe).
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::uint8_t> into) const override;
  /// Flushes everything to the disk and closes the file. Throws WriteFailed.
  void close();

  /// Returns true for a regular file, whose contents can be read again.
  [[nodiscard]] bool can_read() const { return regular_; }
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  /// Returns the file name that the user gave.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[noreturn]] void fail(int cause) const;
  void start();
  void begin_replacement();
  void append(Bytes bytes);

  std::string name_;
  std::string temporary_;  // The new file has this name until it replaces the old one.
  int file_ = -1;
  int old_file_ = -1;  // The descriptor holds the lock of the file that was replaced.
  bool regular_ = false, created_ = false, started_ = false, replaces_ = false;
  std::uint64_t size_ = 0;
};

}  // namespace triskin::recording
