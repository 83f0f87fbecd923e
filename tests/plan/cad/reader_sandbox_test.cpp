// SPDX-License-Identifier: GPL-3.0-or-later
// Each forbidden call is tried in a process that has entered the sandbox, and in one that has not, where it must work:
// else the refusal would say nothing.
#include "triskin/cad/reader_sandbox.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ipc.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "reader_process.hpp"
#include "support/temp_folder.hpp"

namespace triskin {
namespace {

constexpr int kNoSandbox = 200;

// Returns the exit status of a process that does `what`: 0, or the error that it met.
int status_of(bool in_sandbox, const std::function<int()>& what) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    if (in_sandbox && !cad::enter_reader_sandbox()) ::_exit(kNoSandbox);
    ::_exit(what());
  }
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

int error_unless(bool good) {
  return good ? 0 : errno;
}

int opened(const std::string& path, int flags) {
  return error_unless(::open(path.c_str(), flags, 0600) >= 0);
}

class ReaderSandbox : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << "before";
    if (status_of(true, [] { return 0; }) == kNoSandbox) GTEST_SKIP() << "this kernel has no seccomp filters";
  }
  void expect_refused(const std::function<int()>& what) {
    EXPECT_EQ(status_of(false, what), 0);
    EXPECT_EQ(status_of(true, what), EPERM);
  }

  test::TempFolder folder_;
  std::string file_ = (folder_.path() / "file").string();
};

TEST_F(ReaderSandbox, no_file_is_written_made_or_removed) {
  expect_refused([&] { return opened(file_, O_WRONLY); });
  expect_refused([&] { return opened(file_, O_RDWR); });
  expect_refused([&] { return opened(file_, O_RDONLY | O_TRUNC); });
  expect_refused([&] { return opened(file_ + ".made", O_RDONLY | O_CREAT); });
  expect_refused([&] { return opened(folder_.path().string(), O_WRONLY | O_TMPFILE); });
  expect_refused([&] { return error_unless(::chmod(file_.c_str(), 0644) == 0); });
  expect_refused([&] { return error_unless(::mkdir((file_ + ".folder").c_str(), 0700) == 0); });
  expect_refused([&] { return error_unless(::link(file_.c_str(), (file_ + ".link").c_str()) == 0); });
  expect_refused([&] { return error_unless(::rename((file_ + ".link").c_str(), (file_ + ".moved").c_str()) == 0); });
  expect_refused([&] { return error_unless(::unlink((file_ + ".moved").c_str()) == 0); });
  constexpr long kFchmodat2 = 452;  // Older kernels than 6.6 have no such call.
  EXPECT_EQ(status_of(true, [&] { return error_unless(::syscall(kFchmodat2, AT_FDCWD, file_.c_str(), 0644, 0) == 0); }),
            EPERM);
  EXPECT_EQ(status_of(true, [&] { return std::ofstream(file_).is_open() ? 0 : 1; }), 1);
}

TEST_F(ReaderSandbox, nothing_is_connected_started_or_signalled) {
  expect_refused([] { return error_unless(::socket(AF_UNIX, SOCK_STREAM, 0) >= 0); });
  expect_refused([] { return error_unless(::socket(AF_INET, SOCK_DGRAM, 0) >= 0); });
  expect_refused([] { return error_unless(::kill(::getppid(), 0) == 0); });
  expect_refused([] {
    const pid_t parent = ::getppid();
    return error_unless(::syscall(SYS_tgkill, parent, parent, 0) == 0);
  });
  expect_refused([] { return error_unless(::syscall(SYS_shmget, IPC_PRIVATE, 4096, IPC_CREAT | 0600) >= 0); });
  expect_refused([] {
    const pid_t pid = ::fork();
    if (pid == 0) ::_exit(0);
    return error_unless(pid > 0);
  });
  expect_refused([] {
    ::execl("/bin/true", "true", static_cast<char*>(nullptr));
    return errno;
  });
}

TEST_F(ReaderSandbox, reading_memory_threads_and_open_files_stay) {
  EXPECT_EQ(status_of(true, [&] { return opened(file_, O_RDONLY); }), 0);
  EXPECT_EQ(status_of(true,
                      [] {
                        int sum = 0;
                        std::thread([&] {
                          sum = static_cast<int>(std::vector<char>(100'000'000, 1).size() / 100'000'000);
                        }).join();
                        return sum - 1;
                      }),
            0);
  const int fd = ::open(file_.c_str(), O_WRONLY | O_TRUNC);
  EXPECT_EQ(status_of(true, [&] { return error_unless(::write(fd, "after", 5) == 5); }), 0);
  ::close(fd);
  std::string text;
  std::ifstream(file_) >> text;
  EXPECT_EQ(text, "after");
}

TEST_F(ReaderSandbox, a_crash_stays_a_crash) {
  EXPECT_EQ(status_of(true,
                      [] {
                        std::abort();
                        return 0;
                      }),
            -SIGABRT);
}

// The program says that it begins to read, and waits for its part, a pipe that nobody writes to.
TEST_F(ReaderSandbox, triskin_cad_is_in_it_before_it_reads) {
  const auto program = cad::find_reader();
  ASSERT_TRUE(program.has_value());
  std::array<int, 2> part{}, answer{};
  ASSERT_EQ(::pipe2(part.data(), O_CLOEXEC), 0);
  ASSERT_EQ(::pipe2(answer.data(), O_CLOEXEC), 0);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::dup2(part[0], STDIN_FILENO);
    ::dup2(answer[1], STDOUT_FILENO);
    ::execl(program->c_str(), program->c_str(), "step", "0.1", "0.5", static_cast<char*>(nullptr));
    ::_exit(EXIT_FAILURE);
  }
  char first = 0;
  ASSERT_EQ(::read(answer[0], &first, 1), 1);
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  std::string line;
  while (std::getline(status, line) && !line.starts_with("Seccomp:")) {
  }
  EXPECT_EQ(line, "Seccomp:\t2");  // SECCOMP_MODE_FILTER
  ::kill(pid, SIGKILL);
  ::waitpid(pid, nullptr, 0);
  for (const int end : {part[0], part[1], answer[0], answer[1]}) ::close(end);
}

}  // namespace
}  // namespace triskin
