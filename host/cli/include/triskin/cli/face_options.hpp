// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "triskin/cad/select_faces.hpp"

namespace triskin::cli {

/// Options that choose faces of a STEP or IGES file, the same for every command that reads one.
class FaceOptions {
 public:
  void add_to(CLI::App& app);
  /// Selection that the options describe. Errors: InputError naming the option for text that is not what it wants.
  [[nodiscard]] cad::FaceSelection selection() const;

 private:
  cad::FaceSelection chosen_;
  std::vector<std::string> kinds_;
  std::string point_;
  double min_area_cm2_ = 0.0, max_area_cm2_ = 0.0;
};

}  // namespace triskin::cli
