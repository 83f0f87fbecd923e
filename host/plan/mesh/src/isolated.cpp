// SPDX-License-Identifier: GPL-3.0-or-later
#include "isolated.hpp"

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>

#include "triskin/base/address_sanitizer.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mesh {
namespace {

constexpr int kPoll_ms = 20;
// A waiting child uses no processor time, so wall-clock time limits it as well. A busy machine may give it a tenth of a
// processor.
constexpr unsigned kWallFactor = 10;

// The child inherits everything that the parent has mapped, so the limit is added to that.
void limit_memory(std::uint64_t bytes) {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  if (kAddressSanitizer || !(statm >> pages)) return;
  const rlim_t all = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit{all, all};
  setrlimit(RLIMIT_AS, &limit);
}

[[noreturn]] void child(const std::function<std::string()>& work, int pipe, const IsolatedLimits& limits) {
  const rlimit limit{limits.cpu_s, limits.cpu_s + 1}, none{0, 0};
  setrlimit(RLIMIT_CPU, &limit);
  if (limits.memory_bytes > 0) limit_memory(limits.memory_bytes);
  setrlimit(RLIMIT_CORE, &none);
  for (const int s : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS}) std::signal(s, SIG_DFL);
  if (std::freopen("/dev/null", "w", stderr) == nullptr) _exit(1);  // Suppresses the library's last messages.
  const std::string bytes = work();
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(pipe, bytes.data() + at, bytes.size() - at);
    if (n <= 0) _exit(1);
    at += static_cast<std::size_t>(n);
  }
  _exit(0);
}

}  // namespace

std::optional<std::string> run_isolated(const std::function<std::string()>& work, const IsolatedLimits& limits,
                                        const std::function<bool()>& is_late) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw InputError("no pipe to a child process can be made; close other programs");
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::close(ends[0]);
    child(work, ends[1], limits);
  }
  ::close(ends[1]);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kWallFactor * limits.cpu_s);
  const auto has_to_end = [&] { return (is_late && is_late()) || std::chrono::steady_clock::now() > end; };
  std::string bytes;
  std::array<char, 65536> buffer;
  bool is_ended = pid < 0;
  for (;;) {
    pollfd ready{ends[0], POLLIN, 0};
    if (!is_ended && has_to_end()) {
      ::kill(pid, SIGKILL);
      is_ended = true;  // The pipe has ended as well.
    } else if (!is_ended && ::poll(&ready, 1, kPoll_ms) <= 0) {
      continue;
    }
    const ssize_t n = ::read(ends[0], buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    bytes.append(buffer.data(), static_cast<std::size_t>(n));
  }
  ::close(ends[0]);
  if (pid < 0) throw InputError("no child process can be started; close other programs");
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return bytes;
}

}  // namespace triskin::mesh
