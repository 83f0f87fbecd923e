// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "triskin/base/files.hpp"
#include "triskin/base/markup.hpp"

namespace triskin::view {
namespace {

std::filesystem::path private_folder() {
  std::error_code none;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && std::filesystem::is_directory(runtime, none)) return runtime;
  const std::filesystem::path folder = state_home();
  std::filesystem::create_directories(folder, none);
  return folder;
}

// Returns the text of a page that immediately redirects to `address`.
std::string redirect_text(const std::string& address) {
  return fmt::format(
      "<!doctype html>\n<meta charset=\"utf-8\">\n<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\">\n<title>Triskin</title>\n<a href=\"{0}\">the page</a>\n",
      escape_markup(address));
}

// Writes a new file that only its owner can read. Returns false if it could not be written.
bool write_private(const std::filesystem::path& file, const std::string& text) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (fd < 0) return false;
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::close(fd);
  return written;
}

// Starts `program FILE` in its own session, with /dev/null for the three standard streams and no other open files.
void start_detached(const char* program, const std::string& file) {
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_t actions;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_init(&actions);
  (void)::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  (void)::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  (void)::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  (void)::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  (void)::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  std::string name = program, argument = file;
  char* const arguments[] = {name.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program, &actions, &attributes, arguments, environ) == 0)
    std::thread([child] { (void)::waitpid(child, nullptr, 0); }).detach();
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
}

}  // namespace

BrowserStart::BrowserStart(const std::string& address) {
  const std::filesystem::path file = private_folder() / fmt::format("triskin-view-{}.html", ::getpid());
  std::error_code none;
  std::filesystem::remove(file, none);
  if (!write_private(file, redirect_text(address))) return;
  file_ = file;
  start_detached("xdg-open", file_.string());
}

BrowserStart::~BrowserStart() {
  std::error_code none;
  if (!file_.empty()) std::filesystem::remove(file_, none);
}

}  // namespace triskin::view
