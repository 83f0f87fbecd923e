// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>

namespace triskin::recording {

/// Bytes that can be read at any position.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Reads `into.size()` bytes from `offset`; returns false if there are fewer bytes or they cannot be read.
  [[nodiscard]] virtual bool read(std::uint64_t offset, std::span<std::uint8_t> into) const = 0;
};

/// Only one thread may use an input file.
class InputFile final : public ByteSource {
 public:
  /// Opens `path`. Throws InputError naming the file and the cause; a folder, device or pipe is refused.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile() override;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  [[nodiscard]] std::uint64_t size() const override;
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::uint8_t> into) const override;

 private:
  int file_ = -1;
};

}  // namespace triskin::recording
