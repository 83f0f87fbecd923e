// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "triskin/cli/command.hpp"

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

/// Measures one subject and returns an array of rows, one per measured point, with the subject's keys beside "seconds".
using BenchRows = std::function<nlohmann::json(const BenchOptions&, Output&)>;

/// Each subject's file holds one constant of this type at namespace scope; it becomes a subcommand of triskin-bench.
class BenchSubject {
 public:
  BenchSubject(const std::string& name, const std::string& summary, BenchRows rows);
};

}  // namespace triskin::cli
