// SPDX-License-Identifier: GPL-3.0-or-later
// A computer that has no more to give (open files, memory, file size) and giant input: each command ends by itself,
// with a sentence that a person can read.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include "app/cli/shell_case.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"

namespace triskin::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class Want : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    design::write_design(folder_ / "strip.json", strip(2, 2));
    ASSERT_EQ(run("generate near-degenerate -o part.stl").status, 0);
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  }
  struct Ended {
    bool by_signal = false;
    int status = 0;
    std::string messages;
  };
  [[nodiscard]] Ended run_within(const std::string& limit, const std::string& arguments) const {
    const std::string command = fmt::format("cd '{}' && exec >out 2>messages && ulimit {} && exec {} {}",
                                            folder_.string(), limit, program_file(), arguments);
    const int status = std::system(command.c_str());
    return {WIFSIGNALED(status) || WEXITSTATUS(status) > 128, WEXITSTATUS(status), read_file(folder_ / "messages")};
  }
};

TEST_F(Want, every_command_ends_by_itself_under_every_limit) {
  int refused = 0;
  for (const char* limit : {"-n 8", "-n 5", "-v 120000", "-f 1", "-f 16"}) {
    for (const char* arguments :
         {"design part.stl --time-limit-s 0.5 -o d.json", "check strip.json", "extract part.stl -o x.stl",
          "export strip.json -o x.svg", "export strip.json -o x.html", "flash strip.json --link sim --force",
          "verify strip.json --link sim", "record strip.json --link sim --seconds 0.5 -o r.mcap"}) {
      const Ended ended = run_within(limit, arguments);
      SCOPED_TRACE(fmt::format("ulimit {}, {}: status {}: {}", limit, arguments, ended.status, ended.messages));
      EXPECT_FALSE(ended.by_signal);
      EXPECT_LE(ended.status, 3);
      if (ended.status < 2) continue;
      ++refused;
      EXPECT_THAT(ended.messages, HasSubstr("triskin: "));
      EXPECT_THAT(ended.messages, testing::Not(HasSubstr("internal error")));
    }
  }
  EXPECT_GT(refused, 0) << "some of them must not fit";
}

TEST_F(Want, without_descriptors_the_limit_is_named) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int first_free = ::open("/dev/null", O_RDONLY);
  ASSERT_GE(first_free, 0);
  ::close(first_free);
  const rlimit none{static_cast<rlim_t>(first_free), before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  std::vector<std::pair<int, std::string>> said;
  for (const bool writes : {false, true}) {
    try {
      if (writes)
        write_output(folder_ / "new", "text");
      else
        (void)read_file(folder_ / "strip.json");
    } catch (const Error& e) {
      said.emplace_back(e.exit_status(), e.what());
    }
  }
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_EQ(said.size(), 2U);
  for (const auto& [status, text] : said) {
    EXPECT_EQ(status, 3);
    EXPECT_THAT(text, AllOf(HasSubstr("Too many open files"), HasSubstr("allow more open files (ulimit -n)")));
  }
}

TEST_F(Want, a_file_larger_than_allowed_names_the_limit) {
  const Ended ended = run_within("-f 1", "export strip.json -o x.html");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.messages, AllOf(StartsWith("triskin: x.html: cannot write (write: File too large)"),
                                    HasSubstr("allow larger files (ulimit -f)")));
}

// Three megabytes of one word, of many words, and of characters that take three bytes each.
TEST_F(Want, giant_strings_are_shortened_in_messages) {
  const auto repeated = [](std::string_view word, std::size_t times) {
    std::string text;
    for (std::size_t k = 0; k < times; ++k) text += word;
    return text;
  };
  const std::string letters(3'000'000, 'y');
  for (const std::string& giant : {letters, repeated("ab ", 1'000'000), repeated("€", 1'000'000)}) {
    write_output(folder_ / "giant.json", "{\"" + giant + "\":1," + read_file(folder_ / "strip.json").substr(1));
    for (const char* command : {"check giant.json", "verify giant.json --link sim", "export giant.json -o x.svg"}) {
      const Outcome ended = run(command);
      EXPECT_EQ(ended.status, 2);
      EXPECT_LT(ended.messages.size(), 4'500U) << command;
      EXPECT_THAT(ended.messages, AllOf(StartsWith("triskin: giant.json: "), HasSubstr("…")));
    }
  }
}

}  // namespace
}  // namespace triskin::test
