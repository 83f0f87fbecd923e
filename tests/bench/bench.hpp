// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <sys/resource.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "app/cli/src/command.hpp"

namespace triskin::cli {

struct BenchOptions {
  bool quick = false;  ///< True keeps the whole subject below 50 s.
  /// The folder has parts/ and blender/ with real covers and nets; if it is empty, generated ones are used.
  std::string data;
};

/// Returns the processor time of the program so far, s, for work of one thread on a machine that does other work too.
[[nodiscard]] inline double processor_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// As processor_s(), with the child processes that have ended: repair searches for crossings in one of its own.
[[nodiscard]] inline double processor_s_with_children() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return processor_s() + seconds(children.ru_utime) + seconds(children.ru_stime);
}

/// A temporary folder, deleted with its content at the end.
class Scratch {
 public:
  Scratch() : path_(std::filesystem::temp_directory_path() / ("triskin_bench_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Measures one subject and returns an array of rows, one per measured point, with the subject's keys beside "seconds".
using BenchRows = std::function<nlohmann::json(const BenchOptions&, Output&)>;

/// Each subject's file holds one constant of this type at namespace scope; it becomes a subcommand of triskin-bench.
class BenchSubject {
 public:
  BenchSubject(const std::string& name, const std::string& summary, BenchRows rows);
};

}  // namespace triskin::cli
