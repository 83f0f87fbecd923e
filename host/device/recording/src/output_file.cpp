// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "positioned_read.hpp"
#include "triskin/base/output_target.hpp"
#include "triskin/base/writer_lock.hpp"

namespace triskin::recording {
namespace {

void lock_or_close(int file, const std::string& name) {
  try {
    lock_for_writing(file, name);
  } catch (...) {
    ::close(file);
    throw;
  }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : name_(path.string()) {
  if (path == "-") {
    name_ = "standard output";
    file_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  } else {
    std::error_code none;
    created_ = !std::filesystem::exists(path, none);
    const bool special = !created_ && !std::filesystem::is_regular_file(path, none);
    file_ = ::open(path.c_str(), (special ? O_WRONLY : O_RDWR | O_CREAT) | O_CLOEXEC, 0644);
    struct stat status{};
    regular_ = file_ >= 0 && ::fstat(file_, &status) == 0 && S_ISREG(status.st_mode);
    replaces_ = regular_ && status.st_size > 0;
  }
  if (file_ < 0) {
    created_ = false;
    throw InputError(fmt::format("{}: cannot write ({}); nothing was recorded, check the folder and its permissions",
                                 name_, std::strerror(errno)));
  }
  if (regular_) lock_or_close(file_, name_);
}

OutputFile::OutputFile(const std::filesystem::path& path, std::uint64_t keep_bytes)
    : name_(path.string()), regular_(true), started_(true), size_(keep_bytes) {
  file_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file_ >= 0) lock_or_close(file_, name_);
  if (file_ < 0 || ::ftruncate(file_, static_cast<off_t>(keep_bytes)) != 0 ||
      ::lseek(file_, static_cast<off_t>(keep_bytes), SEEK_SET) < 0) {
    const int cause = errno;
    if (file_ >= 0) ::close(file_);
    throw InputError(fmt::format("{}: cannot write ({})", name_, std::strerror(cause)));
  }
}

OutputFile::~OutputFile() {
  if (created_ && !started_) ::unlink(name_.c_str());
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  for (const int file : {file_, old_file_})
    if (file >= 0) ::close(file);
}

void OutputFile::fail(int cause) const {
  throw WriteFailed(fmt::format("{}: cannot write ({}) after {} bytes, which are there; check the disk", name_,
                                std::strerror(cause), size_));
}

void OutputFile::start() {
  if (!started_ && replaces_) begin_replacement();
  started_ = true;
}

// The new recording starts under a temporary name beside the old one.
void OutputFile::begin_replacement() {
  const auto [file, temporary] = create_beside(target_of(name_));
  if (file < 0) fail(errno);
  old_file_ = std::exchange(file_, file);
  temporary_ = temporary;
  lock_for_writing(file_, name_);
  // Reserving this much detects a full disk while the old recording still exists.
  constexpr off_t kBeginning_bytes = off_t{1} << 20;
  if (::fallocate(file_, FALLOC_FL_KEEP_SIZE, 0, kBeginning_bytes) != 0 && (errno == ENOSPC || errno == EDQUOT))
    fail(errno);
}

void OutputFile::write(Bytes bytes) {
  start();
  append(bytes);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), target_of(name_).c_str()) != 0) fail(errno);
  temporary_.clear();
}

void OutputFile::append(Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file_, bytes.data(), bytes.size());
    if (n < 0) {
      if (errno == EINTR) continue;
      fail(errno);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    size_ += static_cast<std::uint64_t>(n);
  }
}

bool OutputFile::read(std::uint64_t offset, std::span<std::uint8_t> into) const {
  return regular_ && read_at(file_, offset, into);
}

void OutputFile::close() {
  const int file = file_;
  file_ = -1;
  const bool synced = !regular_ || ::fsync(file) == 0;
  const int cause = synced ? 0 : errno;
  if (regular_) sync_folder_of(target_of(name_));
  if (::close(file) != 0 || !synced) fail(cause != 0 ? cause : errno);
}

}  // namespace triskin::recording
