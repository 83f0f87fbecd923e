// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/host/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "triskin/host/error.hpp"

namespace triskin {
namespace {

[[noreturn]] void fail_write(const std::filesystem::path& path, const char* step, int cause) {
  throw InputError(fmt::format("{}: cannot write ({}: {}); nothing was changed, check the folder and its permissions",
                               path.string(), step, std::strerror(cause)));
}

// Returns 0 or the errno of the first failure.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0) {
      if (errno == EINTR) continue;
      return errno;
    }
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return ::fsync(fd) == 0 ? 0 : errno;
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code ec;
  if (std::filesystem::is_directory(path, ec)) {
    throw InputError(fmt::format("{}: is a folder; give a file", path.string()));
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot read ({})", path.string(), std::strerror(errno)));
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  std::string temporary = path.string() + ".XXXXXX";
  const int fd = ::mkstemp(temporary.data());
  if (fd < 0) fail_write(path, "create", errno);
  ::fchmod(fd, 0644);
  const int cause = write_all(fd, bytes);
  ::close(fd);
  if (cause != 0) {
    ::unlink(temporary.c_str());
    fail_write(path, "write", cause);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const int why = errno;
    ::unlink(temporary.c_str());
    fail_write(path, "rename", why);
  }
}

}  // namespace triskin
