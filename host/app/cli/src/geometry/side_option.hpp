// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "command.hpp"
#include "triskin/mesh/bridge_holes.hpp"
#include "triskin/mesh/side.hpp"

namespace triskin::cli {

/// Every command that uses a surface of a part has the options --side, --from and --bridge-mm.
class SideOption {
 public:
  void add_to(CLI::App& app);

  /// Returns the values. Errors: InputError naming the option and its valid values.
  [[nodiscard]] mesh::SideOptions options() const;
  [[nodiscard]] double bridge_mm() const { return bridge_mm_; }

 private:
  std::string side_ = "auto", from_;
  double bridge_mm_ = 0.0;
};

/// Describes the chosen side of the part in one line; empty if there is no wall.
[[nodiscard]] std::string side_text(const mesh::TakenSide& taken);
/// Describes the result of closing holes in one line; empty if it was not requested.
[[nodiscard]] std::string bridge_text(const mesh::BridgeReport& report);

/// Says that both sides look alike, draws them into `picture`, and adds the keys of the result. Returns the exit
/// status.
int report_undecided(const design::Mesh& part, const mesh::TakenSide& taken, const std::string& picture,
                     Output& output);

/// Adds `side`, `side_certain` and `wall_mm` (0 without a wall) to the result.
void add_side_keys(const mesh::TakenSide& taken, Output& output);

}  // namespace triskin::cli
