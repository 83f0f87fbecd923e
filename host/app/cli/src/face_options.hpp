// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "triskin/cad/select_faces.hpp"

namespace triskin::cli {

/// These options choose faces of a STEP or IGES file; all commands that read such a file have the same ones.
class FaceOptions {
 public:
  void add_to(CLI::App& app);
  /// Returns the selection that the options describe. Errors: InputError naming the option for invalid text.
  [[nodiscard]] cad::FaceSelection selection() const;

 private:
  cad::FaceSelection chosen_;
  std::vector<int> faces_;
  std::vector<std::string> kinds_;
  std::string point_;
  double min_area_cm2_ = 0.0, max_area_cm2_ = 0.0;
};

}  // namespace triskin::cli
