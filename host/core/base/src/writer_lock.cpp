// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/writer_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/pace.hpp"

namespace triskin {
namespace {

// FNV-1a may give two paths the same lock; they would then only wait for each other.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return hash;
}

bool is_taken(int error) {
  return error == EWOULDBLOCK || error == EINTR;
}

[[noreturn]] void refuse_second_writer(int fd, const std::string& name) {
  throw InputError(fmt::format("{}: {} is writing it; end that first, or give another file", name, lock_holder(fd)));
}

std::string name_of_process(const std::string& pid) {
  if (pid == std::to_string(::getpid())) return "this process";
  std::ifstream in("/proc/" + pid + "/comm");
  std::string name;
  std::getline(in, name);
  return name.empty() ? "process " + pid : fmt::format("process {} ({})", pid, name);
}

}  // namespace

// Parses a line of /proc/locks: "3: FLOCK  ADVISORY  WRITE 4711 08:01:1234567 0 EOF".
std::string lock_holder(int fd) {
  struct stat status{};
  if (::fstat(fd, &status) != 0) return "another program";
  const std::string file = fmt::format("{:02x}:{:02x}:{}", major(status.st_dev), minor(status.st_dev), status.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, advice, access, pid, inode;
    words >> number >> kind >> advice >> access >> pid >> inode;
    if (kind == "FLOCK" && inode == file) return name_of_process(pid);
  }
  return "another program";
}

void lock_for_writing(int fd, const std::string& name) {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && is_taken(errno)) refuse_second_writer(fd, name);
}

WriterLock::WriterLock(const std::filesystem::path& path, std::chrono::milliseconds patience) {
  std::error_code none;
  const std::filesystem::path folder = state_home() / "locks";
  std::filesystem::create_directories(folder, none);
  const std::string whole = std::filesystem::weakly_canonical(path, none).string();
  const std::string lock = (folder / fmt::format("{:016x}", hash_of(whole.empty() ? path.string() : whole))).string();
  fd_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0) throw InputError(fmt::format("{}: cannot lock it ({}: {})", path.string(), lock, std::strerror(errno)));
  constexpr std::chrono::milliseconds kLook{20};
  const auto end = std::chrono::steady_clock::now() + patience;
  while (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && is_taken(errno)) {
    if (std::chrono::steady_clock::now() < end && sleep_until(std::chrono::steady_clock::now() + kLook)) continue;
    try {
      refuse_second_writer(fd_, path.string());
    } catch (...) {
      ::close(fd_);
      throw;
    }
  }
}

WriterLock::~WriterLock() {
  ::close(fd_);
}

}  // namespace triskin
