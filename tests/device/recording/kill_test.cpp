// SPDX-License-Identifier: GPL-3.0-or-later
// A recording whose process is killed at a random moment must hold everything up to one second before.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <random>

#include "recorded.hpp"

namespace triskin::recording {
namespace {

constexpr int kModules = 20;
constexpr std::uint64_t kSecond_us = 1'000'000;

// Counts samples in memory that both processes share.
class Progress {
 public:
  Progress()
      : count_(static_cast<std::atomic<std::uint64_t>*>(::mmap(
            nullptr, sizeof(std::atomic<std::uint64_t>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {
    new (count_) std::atomic<std::uint64_t>(0);
  }
  ~Progress() { ::munmap(count_, sizeof *count_); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  std::atomic<std::uint64_t>& operator*() { return *count_; }

 private:
  std::atomic<std::uint64_t>* count_;
};

// Records until it is killed.
[[noreturn]] void record_forever(const std::filesystem::path& path, const design::Design& design,
                                 std::atomic<std::uint64_t>& count) {
  OutputFile file(path);
  const auto recorder = make_recorder(Format::kMcap, file, design, origin());
  for (std::uint64_t k = 0; k < 4'000'000; ++k) {
    recorder->add(sample_of(k, kModules));
    count = k + 1;
  }
  std::_Exit(1);
}

// Returns the samples of the recording at the moment of the kill.
std::uint64_t kill_after(const std::filesystem::path& path, const design::Design& design, std::uint64_t samples) {
  Progress progress;
  const pid_t child = ::fork();
  if (child == 0) record_forever(path, design, *progress);
  while (*progress < samples) ::usleep(50);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  return *progress;
}

void kill_and_read(int times, std::uint64_t seed) {
  const Folder folder("kill");
  const design::Design design = test::strip(kModules);
  std::mt19937_64 random(seed);
  for (int k = 0; k < times; ++k) {
    const std::filesystem::path path = folder / "r.mcap";
    const std::uint64_t count = kill_after(path, design, 2'000 + random() % 40'000);
    const std::uint64_t killed_us = sample_of(count - 1, kModules).link_time_us;
    Summary summary;
    const auto read = samples_of(path, &summary);
    std::array<std::uint64_t, 3> next{0, 0, 16};  // The index is the node, the value the number of its next sample.
    for (const ModuleSample& s : read) {
      std::uint64_t& expected = next.at(s.sample.node_address);
      ASSERT_EQ(s, sample_of(expected, kModules)) << "seed " << seed << ", kill " << k;
      ++expected;
      if (expected % kModules == 0 || expected % kModules == 16) expected += s.sample.node_address == 1 ? 4 : 16;
    }
    for (const int node : {1, 2}) {
      const ModuleSample missing = sample_of(next.at(static_cast<std::size_t>(node)), kModules);
      ASSERT_GT(missing.link_time_us + kSecond_us, killed_us) << "seed " << seed << ", kill " << k << ", node " << node;
    }
    (void)recover(path, {});
    Summary recovered;
    ASSERT_EQ(samples_of(path, &recovered), read) << "seed " << seed << ", kill " << k;
    ASSERT_TRUE(recovered.file.complete);
    std::filesystem::remove(path);
  }
}

TEST(Kill, everything_up_to_one_second_before_is_read_at_twenty_moments) {
  kill_and_read(20, 1);
}

TEST(Kill, everything_up_to_one_second_before_is_read_at_two_hundred_moments) {
  kill_and_read(200, 2);
}

}  // namespace
}  // namespace triskin::recording
