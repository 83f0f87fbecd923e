// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/base/writer_lock.hpp"

namespace triskin {
namespace {

using testing::HasSubstr;

class Locks : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("locks.{}", ::getpid());
    std::filesystem::create_directories(folder_);
    ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(Locks, the_second_writer_is_told_the_process_of_the_first) {
  const WriterLock first(folder_ / "rest.json");
  try {
    const WriterLock second(folder_ / "rest.json");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("rest.json"));
    EXPECT_THAT(e.what(), HasSubstr("this process is writing it"));
  }
  EXPECT_NO_THROW(WriterLock(folder_ / "other.json"));
}

TEST_F(Locks, ends_with_its_program_however_that_ends) {
  std::array<int, 2> ready{};
  ASSERT_EQ(::pipe(ready.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const WriterLock lock(folder_ / "rest.json");
    (void)!::write(ready[1], "x", 1);
    ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THROW(WriterLock(folder_ / "rest.json"), InputError);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(WriterLock(folder_ / "rest.json"));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(Locks, patience_waits_for_a_writer_that_is_done_soon) {
  std::array<int, 2> ready{};
  ASSERT_EQ(::pipe(ready.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const WriterLock lock(folder_ / "rest.json");
    (void)!::write(ready[1], "x", 1);
    ::usleep(100'000);
    std::_Exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_NO_THROW(WriterLock(folder_ / "rest.json", std::chrono::seconds(30)));
  ::waitpid(child, nullptr, 0);
  ::close(ready[0]);
  ::close(ready[1]);
}

// The kernel names the holder by device and inode of the file, so two names of one file have one holder.
TEST_F(Locks, a_hard_link_has_the_holder_of_its_file) {
  const std::string file = (folder_ / "r.mcap").string();
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  lock_for_writing(fd, file);
  std::filesystem::create_hard_link(file, folder_ / "again.mcap");
  const int again = ::open((folder_ / "again.mcap").c_str(), O_RDWR | O_CLOEXEC);
  EXPECT_THROW(lock_for_writing(again, "again.mcap"), InputError);
  EXPECT_EQ(lock_holder(again), "this process");
  ::close(again);
  ::close(fd);
}

TEST(Sleep, ends_when_the_process_is_asked_to_end) {
  interrupt_request() = true;
  const auto far = std::chrono::steady_clock::now() + std::chrono::hours(24);
  EXPECT_FALSE(sleep_until(far));
  Pace pace(0);
  pace.hold(86'400'000'000);  // The link is a day ahead.
  interrupt_request() = false;
  EXPECT_LT(std::chrono::steady_clock::now(), far);
  EXPECT_TRUE(sleep_until(std::chrono::steady_clock::now()));
}

TEST(Pace, labels_follow_the_link_and_a_link_that_was_behind_is_not_hurried) {
  Pace pace(1'000'000);
  EXPECT_EQ(pace.unix_us(1'500'000) - pace.unix_us(1'000'000), 500'000);
  const auto start = std::chrono::steady_clock::now();
  pace.hold(1'050'000);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(50));
}

}  // namespace
}  // namespace triskin
