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

/// The file of a recording took no more bytes, for example because the disk is full. What was written before is there.
class WriteFailed : public Error {
 public:
  using Error::Error;
};

/// A file that grows while it is written. It is opened before there is anything to write, so that one that cannot be
/// written is known at once. A recording that stood there is replaced in one step once the first bytes of the new one
/// are in a file and the disk has room for its first megabyte; before, the old one is whole. No other program may write
/// it meanwhile (flock). Threads: one.
class OutputFile final : public ByteSource {
 public:
  /// Opens `path`: a symbolic link is followed, "-" is standard output; a device or a pipe is written into. Throws
  /// InputError naming the file and the cause; when another program writes it, with that program.
  explicit OutputFile(const std::filesystem::path& path);
  /// Opens the recording `path` to be continued behind its first `keep_bytes` bytes; the rest is cut off. Throws
  /// InputError, also when another program still writes it.
  OutputFile(const std::filesystem::path& path, std::uint64_t keep_bytes);
  /// Removes a file that did not stand there before and into which nothing was written.
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends bytes. Throws WriteFailed naming the file, the cause and how many bytes are there.
  void write(Bytes bytes);
  /// Reads `into.size()` bytes from `offset`; false: the file has not so many, or it cannot be read (a pipe).
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::uint8_t> into) const override;
  /// Brings everything to the disk and closes the file. Throws WriteFailed.
  void close();

  /// True for a regular file: what was written can be read again.
  [[nodiscard]] bool can_read() const { return regular_; }
  /// Bytes of the file so far.
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  /// The file as the user named it.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[noreturn]] void fail(int cause) const;
  void start();
  void begin_replacement();
  void append(Bytes bytes);

  std::string name_;
  std::string temporary_;  // Name of the new file until it replaces the old one.
  int file_ = -1;
  int old_file_ = -1;  // Holds the lock of the file that was replaced.
  bool regular_ = false, created_ = false, started_ = false, replaces_ = false;
  std::uint64_t size_ = 0;
};

}  // namespace triskin::recording
