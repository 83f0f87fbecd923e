// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <utility>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/base/nearest_name.hpp"
#include "triskin/base/output_target.hpp"
#include "triskin/base/require_file.hpp"

namespace triskin {
namespace {

// Throws what was refused with this errno. The remedy of a limit is to raise it.
[[noreturn]] void refuse(const std::string& what, int cause, const std::string& remedy) {
  if (cause == EMFILE || cause == ENFILE)
    throw ResourceError(what + "; end other programs, or allow more open files (ulimit -n)");
  if (cause == EFBIG) throw InputError(what + "; allow larger files (ulimit -f)");
  throw InputError(what + remedy);
}

[[noreturn]] void fail_write(const std::filesystem::path& path, const char* step, int cause) {
  refuse(fmt::format("{}: cannot write ({}: {}); nothing was changed", path.string(), step, std::strerror(cause)),
         cause, ", check the folder and its permissions");
}

// Returns 0 or the errno of the first failure.
int write_bytes(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0) {
      if (errno == EINTR) continue;
      return errno;
    }
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return 0;
}

// Does the same and waits until the data is on the disk.
int write_all(int fd, std::string_view bytes) {
  const int cause = write_bytes(fd, bytes);
  return cause != 0 || ::fsync(fd) == 0 ? cause : errno;
}

void rename_or_remove(const std::string& temporary, const std::filesystem::path& path) {
  if (::rename(temporary.c_str(), path.c_str()) == 0) return sync_folder_of(path);
  const int why = errno;
  ::unlink(temporary.c_str());
  fail_write(path, "rename", why);
}

void write_into(int fd, const std::filesystem::path& path, std::string_view bytes) {
  const int cause = write_bytes(fd, bytes);
  if (cause != 0)
    throw InputError(
        fmt::format("{}: cannot write ({}); not all of it has arrived there", path.string(), std::strerror(cause)));
}

// Returns what to say beside the cause: a file of the folder with nearly this name was probably meant.
std::string similar_file(const std::filesystem::path& path) {
  constexpr std::size_t kMaxFiles = 2'000;  // A larger folder would cost a person more time than the hint saves.
  const std::string name = path.filename().string();
  std::vector<std::string> names;
  std::error_code none;
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (std::filesystem::directory_iterator at(folder, none), end; !none && at != end && names.size() < kMaxFiles;
       at.increment(none))
    names.push_back(at->path().filename().string());
  const std::string nearest = nearest_name(name, names, path.stem().string().size());
  return nearest.empty() ? "" : fmt::format("; did you mean {}?", (path.parent_path() / nearest).string());
}

// Reads to the end, but not for ever: a pipe may have none.
std::string bytes_of(std::istream& in, std::string bytes, const std::string& name) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::string block(kBlock, '\0');
  while (in.read(block.data(), kBlock) || in.gcount() > 0) {
    bytes.append(block, 0, static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > kMaxInput_bytes)
      throw InputError(fmt::format("{}: does not end within {} GiB; give a smaller file", name, kMaxInput_bytes >> 30));
  }
  return bytes;
}

}  // namespace

void require_file(const std::filesystem::path& path, Pipes pipes) {
  namespace fs = std::filesystem;
  std::error_code none;
  const fs::file_status status = fs::status(path, none);
  if (!fs::exists(status) || fs::is_regular_file(status)) return;
  if (fs::is_directory(status)) throw InputError(fmt::format("{}: is a folder; give a file", path.string()));
  if (!fs::is_fifo(status)) throw InputError(fmt::format("{}: is a device or socket; give a file", path.string()));
  if (pipes == Pipes::kRefused) throw InputError(fmt::format("{}: is a pipe; give a file", path.string()));
}

std::string read_file(const std::filesystem::path& path) {
  if (path == "-") return bytes_of(std::cin, {}, "standard input");
  require_file(path, Pipes::kAllowed);
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    const int cause = errno;
    refuse(fmt::format("{}: cannot read ({})", path.string(), std::strerror(cause)), cause,
           cause == ENOENT ? similar_file(path) : "");
  }
  std::string bytes;  // The size is known except for a pipe; the buffer is then filled in one piece.
  std::error_code ec;
  if (const auto size = std::filesystem::file_size(path, ec); !ec) {
    if (size > kMaxInput_bytes)
      throw InputError(fmt::format("{}: has {:.1f} GiB, and at most {} are read; give a smaller file", path.string(),
                                   static_cast<double>(size) / (1 << 30), kMaxInput_bytes >> 30));
    bytes.resize(static_cast<std::size_t>(size));
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
  }
  // The file may have grown since its size was read.
  return in ? bytes_of(in, std::move(bytes), path.string()) : bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  const auto [fd, temporary] = create_beside(path);
  if (fd < 0) fail_write(path, "create", errno);
  const int cause = write_all(fd, bytes);
  const int close_cause = ::close(fd) == 0 ? 0 : errno;  // A network file system may report a full disk only here.
  if (cause != 0 || close_cause != 0) {
    ::unlink(temporary.c_str());
    fail_write(path, "write", cause != 0 ? cause : close_cause);
  }
  rename_or_remove(temporary, path);
}

void write_output(const std::filesystem::path& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  namespace fs = std::filesystem;
  if (path == "-") {
    path_ = "standard output";
    fd_ = STDOUT_FILENO;
    return;
  }
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) throw InputError(fmt::format("{}: is a folder; give a file", path.string()));
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    fd_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd_ < 0) fail_write(path, "open", errno);
    return;
  }
  target_ = target_of(path);
  const auto [fd, temporary] = create_beside(target_);
  if (fd < 0) fail_write(target_, "create", errno);
  fd_ = fd;
  temporary_ = temporary;
}

OutputFile::~OutputFile() {
  if (fd_ >= 0 && fd_ != STDOUT_FILENO) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  if (temporary_.empty()) return write_into(fd_, path_, bytes);
  if (const int cause = write_bytes(fd_, bytes); cause != 0) fail_write(target_, "write", cause);
}

void OutputFile::commit() {
  if (temporary_.empty()) return;
  if (::fsync(fd_) != 0) fail_write(target_, "write", errno);
  if (::close(std::exchange(fd_, -1)) != 0) fail_write(target_, "write", errno);
  rename_or_remove(std::exchange(temporary_, {}), target_);
}

void require_writable(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  if (path == "-") return;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) throw InputError(fmt::format("{}: is a folder; give a file", path.string()));
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    if (::access(path.c_str(), W_OK) != 0) fail_write(path, "open", errno);
    return;
  }
  const fs::path target = target_of(path);
  if (target.filename().string().size() > NAME_MAX) fail_write(path, "create", ENAMETOOLONG);
  const auto [fd, temporary] = create_beside(target);
  if (fd < 0) fail_write(path, "create", errno);
  ::close(fd);
  ::unlink(temporary.c_str());
}

std::filesystem::path state_home() {
  std::filesystem::path base;
  if (const char* xdg = std::getenv("XDG_STATE_HOME"); xdg != nullptr && *xdg != '\0') {
    base = xdg;
  } else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    base = std::filesystem::path(home) / ".local" / "state";
  }
  std::error_code error;
  if (!base.empty()) std::filesystem::create_directories(base, error);
  if (!base.empty() && !error) return base / "triskin";
  // All users of the computer share this folder, so each has a subfolder of his own there.
  base = std::filesystem::temp_directory_path(error);
  if (error) base = "/tmp";
  return base / fmt::format("triskin-{}", ::getuid());
}

}  // namespace triskin
