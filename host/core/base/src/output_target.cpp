// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/output_target.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>

namespace triskin {

TemporaryFile create_beside(const std::filesystem::path& target) {
  std::random_device random;
  constexpr int kTries = 20;
  for (int k = 0; k < kTries; ++k) {
    const std::string name = fmt::format(".triskin-{:08x}", random());
    TemporaryFile file{-1, (target.parent_path() / name).string()};
    file.fd = ::open(file.path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file.fd < 0 && errno == EEXIST) continue;
    struct stat old{};
    if (file.fd >= 0 && ::stat(target.c_str(), &old) == 0) ::fchmod(file.fd, old.st_mode & 07777);
    return file;
  }
  return {};
}

std::filesystem::path target_of(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  constexpr int kMaxLinks = 40;  // The kernel has the same limit.
  fs::path target = path;
  std::error_code error;
  for (int k = 0; k < kMaxLinks && fs::is_symlink(target, error); ++k) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target;
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path parent = path.parent_path();
  const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  (void)::fsync(folder);
  ::close(folder);
}

}  // namespace triskin
