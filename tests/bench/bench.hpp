// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "triskin/cli/command.hpp"

namespace triskin::cli {

struct BenchOptions {
  bool quick = false;  ///< The whole subject ends within 50 s.
  std::string data;    ///< folder with parts/ and blender/: real covers and nets; empty: what is generated
};

/// Processor time of the program so far, s: for work of one thread on a machine that does other work too.
[[nodiscard]] inline double processor_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Measures one subject: an array of rows, one per measured point, with the subject's keys beside "seconds".
using BenchRows = std::function<nlohmann::json(const BenchOptions&, Output&)>;

/// Each subject's file holds one constant of this type at namespace scope; it becomes a subcommand of triskin-bench.
class BenchSubject {
 public:
  BenchSubject(const std::string& name, const std::string& summary, BenchRows rows);
};

}  // namespace triskin::cli
