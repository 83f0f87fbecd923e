// SPDX-License-Identifier: GPL-3.0-or-later
// A program in place of the browser checks how a browser is started.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "triskin/base/files.hpp"
#include "triskin/view/browser.hpp"

namespace triskin::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kAddress = "http://127.0.0.1:7777/0123456789abcdef0123456789abcdef/#module-3";

class BrowserStarts : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("browser.{}", ::getpid());
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "xdg-open") << "#!/bin/sh\n"
                                           "{ tr '\\0' ' ' < /proc/$$/cmdline; echo; ls /proc/$$/fd; echo session "
                                           "$(cut -d' ' -f6 /proc/$$/stat) process $$; cat \"$1\"; } > '"
                                        << (folder_ / "seen.part").string() << "'\nmv '"
                                        << (folder_ / "seen.part").string() << "' '" << (folder_ / "seen").string()
                                        << "'\n";
    std::filesystem::permissions(folder_ / "xdg-open", std::filesystem::perms::owner_all);
    path_ = std::getenv("PATH");
    ::setenv("PATH", (folder_.string() + ":" + path_).c_str(), 1);
    ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }
  void TearDown() override {
    ::setenv("PATH", path_.c_str(), 1);
    std::filesystem::remove_all(folder_);
  }
  std::string seen() const {
    for (int k = 0; k < 3000 && !std::filesystem::exists(folder_ / "seen"); ++k) ::usleep(10'000);
    return std::filesystem::exists(folder_ / "seen") ? read_file(folder_ / "seen") : "";
  }

  std::filesystem::path folder_;
  std::string path_;
};

TEST_F(BrowserStarts, without_the_token_in_the_list_of_processes) {
  const view::BrowserStart start(kAddress);
  const std::string text = seen();
  const std::string command = text.substr(0, text.find('\n'));
  EXPECT_THAT(command, HasSubstr(start.file().string()));
  EXPECT_THAT(command, Not(HasSubstr("0123456789abcdef")));
  EXPECT_THAT(text, HasSubstr(fmt::format("0; url={}", kAddress))) << "the file leads to the page";
}

TEST_F(BrowserStarts, with_a_file_that_nobody_else_can_read_and_that_goes_with_the_program) {
  std::filesystem::path file;
  {
    const view::BrowserStart start(kAddress);
    file = start.file();
    struct stat status{};
    ASSERT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600U);
    EXPECT_FALSE(seen().empty());
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(BrowserStarts, in_a_session_of_its_own_without_our_descriptors) {
  const int ours = ::dup(0);  // This descriptor is not closed on exec.
  const view::BrowserStart start(kAddress);
  const std::string text = seen();
  ::close(ours);
  const std::size_t at = text.find("session ");
  ASSERT_NE(at, std::string::npos) << text;
  const std::string line = text.substr(at, text.find('\n', at) - at);
  const std::string session = line.substr(8, line.find(" process") - 8);
  EXPECT_EQ(line, fmt::format("session {0} process {0}", session)) << "a session of its own";
  EXPECT_NE(session, std::to_string(::getsid(0)));
  EXPECT_THAT(text, Not(HasSubstr(fmt::format("\n{}\n", ours))));
}

}  // namespace
}  // namespace triskin::test
