// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin::test {

/// A new empty folder of the running test, removed with all it holds at the end.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "triskin_test_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Returns the path of a file in the folder, as text.
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// Returns the message of the exception that `call` throws; empty, with a failure of the test, if it throws none of
/// this kind.
template <class Kind, class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Kind& e) {
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace triskin::test

/// Expects an InputError whose message contains `words`.
#define EXPECT_INPUT_ERROR(call, words)                                                            \
  do {                                                                                             \
    const std::string message = ::triskin::test::message_of<::triskin::InputError>([&] { call; }); \
    EXPECT_NE(message.find(words), std::string::npos) << message;                                  \
  } while (false)
