// SPDX-License-Identifier: GPL-3.0-or-later
// A test loads this library before the program (LD_PRELOAD). It shifts the wall clock while the program runs, as a
// person or NTP does, by the seconds in the file TRISKIN_TEST_WALL, and makes the TRISKIN_TEST_FAIL_AT-th change of a
// regular file, and all later ones, fail with the error TRISKIN_TEST_FAIL_ERRNO: a full or broken disk. A disk of
// TRISKIN_TEST_DISK_BYTES has that much less what the program wrote, and is full after it.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>

namespace {

const std::atomic<std::int64_t>* shift_s() {
  static const std::atomic<std::int64_t>* const kShift = []() -> const std::atomic<std::int64_t>* {
    const char* file = std::getenv("TRISKIN_TEST_WALL");
    const int fd = file == nullptr ? -1 : static_cast<int>(::syscall(SYS_openat, AT_FDCWD, file, O_RDONLY, 0));
    if (fd < 0) return nullptr;
    void* memory = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, fd, 0);
    return memory == MAP_FAILED ? nullptr : static_cast<const std::atomic<std::int64_t>*>(memory);
  }();
  return kShift;
}

std::atomic<long> changes = 0;

// Returns true when this change of a file has to fail; errno is set then.
bool fails() {
  static const long kFirst = [] {
    const char* text = std::getenv("TRISKIN_TEST_FAIL_AT");
    return text == nullptr ? 0L : std::strtol(text, nullptr, 10);
  }();
  static const int kErrno = [] {
    const char* text = std::getenv("TRISKIN_TEST_FAIL_ERRNO");
    return text == nullptr ? ENOSPC : static_cast<int>(std::strtol(text, nullptr, 10));
  }();
  if (kFirst == 0 || ++changes < kFirst) return false;
  errno = kErrno;
  return true;
}

std::atomic<std::int64_t> written_bytes = 0;

// No disk has this size, unless the test says one.
std::int64_t disk_bytes() {
  static const std::int64_t kSize = [] {
    const char* text = std::getenv("TRISKIN_TEST_DISK_BYTES");
    return text == nullptr ? std::int64_t{-1} : std::strtoll(text, nullptr, 10);
  }();
  return kSize;
}

// Returns true when these bytes do not fit on the disk; errno is set then.
bool overflows(size_t size) {
  if (disk_bytes() < 0) return false;
  if ((written_bytes += static_cast<std::int64_t>(size)) <= disk_bytes()) return false;
  errno = ENOSPC;
  return true;
}

bool is_regular(int fd) {
  struct stat status{};
  return ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const long result = ::syscall(SYS_clock_gettime, clock, time);
  if (result == 0 && clock == CLOCK_REALTIME && shift_s() != nullptr) time->tv_sec += shift_s()->load();
  return static_cast<int>(result);
}

int gettimeofday(timeval* time, void* /*zone*/) noexcept {
  timespec now{};
  const int result = clock_gettime(CLOCK_REALTIME, &now);
  *time = {now.tv_sec, now.tv_nsec / 1000};
  return result;
}

time_t time(time_t* out) noexcept {
  timespec now{};
  (void)clock_gettime(CLOCK_REALTIME, &now);
  if (out != nullptr) *out = now.tv_sec;
  return now.tv_sec;
}

ssize_t write(int fd, const void* bytes, size_t size) {
  if (size > 0 && is_regular(fd) && (fails() || overflows(size))) return -1;
  return ::syscall(SYS_write, fd, bytes, size);
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t offset) {
  if (is_regular(fd) && (fails() || overflows(size))) return -1;
  return ::syscall(SYS_pwrite64, fd, bytes, size, offset);
}
ssize_t pwrite(int fd, const void* bytes, size_t size, off_t offset) {
  return pwrite64(fd, bytes, size, offset);
}

int ftruncate64(int fd, off64_t size) noexcept {
  if (is_regular(fd) && fails()) return -1;
  return static_cast<int>(::syscall(SYS_ftruncate, fd, size));
}
int ftruncate(int fd, off_t size) noexcept {
  return ftruncate64(fd, size);
}

int fsync(int fd) {
  if (is_regular(fd) && fails()) return -1;
  return static_cast<int>(::syscall(SYS_fsync, fd));
}

int rename(const char* from, const char* to) noexcept {
  if (fails()) return -1;
  return static_cast<int>(::syscall(SYS_rename, from, to));
}

int statvfs(const char* path, struct statvfs* status) noexcept {
  struct statvfs64 whole{};
  const int result = statvfs64(path, &whole);
  if (result != 0) return result;
  *status = {};
  status->f_bsize = status->f_frsize = 1;
  status->f_blocks = status->f_bfree = status->f_bavail = static_cast<fsblkcnt_t>(whole.f_bavail * whole.f_frsize);
  if (disk_bytes() >= 0) {
    const std::int64_t left = disk_bytes() - written_bytes;
    status->f_bfree = status->f_bavail = static_cast<fsblkcnt_t>(left < 0 ? 0 : left);
  }
  return 0;
}

}  // extern "C"
