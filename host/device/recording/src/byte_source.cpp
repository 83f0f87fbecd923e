// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/byte_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "positioned_read.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/require_file.hpp"

namespace triskin::recording {

bool read_at(int file, std::uint64_t offset, std::span<std::uint8_t> into) {
  while (!into.empty()) {
    const ssize_t n = ::pread(file, into.data(), into.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    into = into.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return true;
}

InputFile::InputFile(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none))
    throw InputError(fmt::format("{}: is a folder; give a recording in it, as {}", path.string(),
                                 (path / (path.filename().string() + "_0.mcap")).string()));
  require_file(path, Pipes::kRefused);
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw InputError(fmt::format("{}: cannot read ({})", path.string(), std::strerror(errno)));
}

InputFile::~InputFile() {
  ::close(file_);
}

std::uint64_t InputFile::size() const {
  struct stat status{};
  return ::fstat(file_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

bool InputFile::read(std::uint64_t offset, std::span<std::uint8_t> into) const {
  return read_at(file_, offset, into);
}

}  // namespace triskin::recording
