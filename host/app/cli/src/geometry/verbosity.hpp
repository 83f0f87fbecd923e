// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "command.hpp"

namespace triskin::cli {

/// Sets how much a command prints: -v more, -q nothing but errors.
struct Verbosity {
  bool verbose = false, quiet = false;

  /// Adds both options, which exclude each other.
  void add_to(CLI::App& app) {
    auto* more = app.add_flag("-v,--verbose", verbose, "show how the result came about");
    app.add_flag("-q,--quiet", quiet, "print only errors, and no progress")->excludes(more);
  }
  void apply(Output& output) const {
    if (quiet) output.silence();
  }
};

}  // namespace triskin::cli
