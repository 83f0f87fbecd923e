// SPDX-License-Identifier: GPL-3.0-or-later
#include "reader_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>

#include "triskin/base/address_sanitizer.hpp"
#include "triskin/base/error.hpp"

namespace triskin::cad {
namespace {

// A sound file with deep trees needs some of it; deep brackets are refused earlier.
constexpr std::uint64_t kStack_bytes = 64ULL << 20U;

// Closes a file descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

int file_in_memory(std::string_view bytes) {
  const int fd = ::memfd_create("part", MFD_CLOEXEC);
  while (fd >= 0 && !bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n <= 0) throw InputError("there is no memory for a copy of the part; close other programs");
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  if (fd < 0 || ::lseek(fd, 0, SEEK_SET) != 0) throw InputError("no file in memory can be made; close other programs");
  return fd;
}

void set_limit(int resource, std::uint64_t soft, std::uint64_t hard) {
  const rlimit limit{soft, hard};
  (void)::setrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
}

// Between fork and exec, a program with threads may only use calls that are safe in a signal handler.
[[noreturn]] void become(const char* program, char* const* arguments, int in, int out, const ProcessLimits& limits,
                         pid_t parent) {
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(EXIT_FAILURE);
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  (void)::dup2(in, STDIN_FILENO);
  (void)::dup2(out, STDOUT_FILENO);
  (void)::dup2(nothing, STDERR_FILENO);
  const auto seconds = static_cast<std::uint64_t>(std::max(1.0, std::ceil(limits.processor_s)));
  set_limit(RLIMIT_CPU, seconds, seconds + 1);
  if (!kAddressSanitizer) set_limit(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes);
  set_limit(RLIMIT_STACK, kStack_bytes, kStack_bytes);
  set_limit(RLIMIT_CORE, 0, 0);
  set_limit(RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes);
  ::execv(program, arguments);
  ::_exit(EXIT_FAILURE);
}

// Reads until the other end is closed; returns false when the time is over.
bool read_until(int fd, std::chrono::steady_clock::time_point end, std::string& bytes) {
  std::array<char, 65536> buffer;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd ready{fd, POLLIN, 0};
    const int events = ::poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 1000)));
    if (events == 0 || (events < 0 && errno == EINTR)) continue;
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    bytes.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

ProcessResult result_of(pid_t pid, std::string output, bool is_late) {
  if (is_late) (void)::kill(pid, SIGKILL);
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  ProcessResult result{ProcessEnd::kDone, 0, std::move(output)};
  if (WIFSIGNALED(status)) {
    result.signal = WTERMSIG(status);
    const bool is_over = is_late || result.signal == SIGXCPU || result.signal == SIGKILL;
    result.end = is_over ? ProcessEnd::kOutOfTime : ProcessEnd::kCrashed;
  } else if (WEXITSTATUS(status) != 0) {
    result.end = ProcessEnd::kFailed;
  }
  return result;
}

}  // namespace

std::optional<std::filesystem::path> find_reader() {
  std::error_code error;
  if (const char* named = std::getenv("TRISKIN_CAD_READER"); named != nullptr) {
    if (::access(named, X_OK) == 0) return named;
    return std::nullopt;
  }
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return std::nullopt;
  for (const auto& place : {here / "triskin-cad", here / ".." / "libexec" / "triskin" / "triskin-cad"}) {
    if (::access(place.c_str(), X_OK) == 0) return place;
  }
  return std::nullopt;
}

ProcessResult run_limited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                          std::string_view input, const ProcessLimits& limits) {
  const Descriptor in(file_in_memory(input));
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw InputError("no pipe can be made; close other programs");
  const Descriptor out(ends[0]);
  Descriptor child_out(ends[1]);
  std::vector<std::string> copies{program.string()};
  copies.insert(copies.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& argument : copies) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                          std::chrono::duration<double>(limits.wall_s));
  const pid_t parent = ::getpid(), pid = ::fork();
  if (pid == 0) become(pointers.front(), pointers.data(), in.get(), child_out.get(), limits, parent);
  child_out.close();
  if (pid < 0) throw InputError("no process can be started for the CAD reader; close other programs");
  std::string output;
  const bool is_late = !read_until(out.get(), end, output);
  return result_of(pid, std::move(output), is_late);
}

}  // namespace triskin::cad
