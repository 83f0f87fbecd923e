// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/design/module_list.hpp"

namespace triskin::exports {

/// skinGui draws a skin as triangles on a plane; some files also name the board that reads each.
struct SkinGuiLayout {
  design::ModuleList
      list;  ///< Islands are the connected groups of the drawing, and center_mm is measured in the drawing.
  std::vector<int> board;  ///< Entry k is the board of node k, or −1 when unknown.
  int boards = 0;
  int boards_apart = 0;  ///< The triangles of this many boards are not connected by joints.
};

/// Reads a skinGui configuration (`triangle_10pad id x y orientation gain mirror …` lines) or, with `part`, one part
/// of a JSON collection of them (`ini_2d` → part → `triangles`). Two triangles are joined when their centres are 15
/// … 22 mm apart and the directions of each one's joints are 120° apart; groups are placed on the lattice. Throws
/// InputError naming file and triangle: unknown part (with a list of the parts), no triangle, repeated ids, triangles
/// that fit no lattice. Cost: O(n²).
[[nodiscard]] SkinGuiLayout read_skingui(const std::filesystem::path& path, const std::string& part = "");

/// Writes the module list as JSON that read_module_list() reads. Cost: O(n).
[[nodiscard]] nlohmann::json module_list_json(const design::ModuleList& list);

}  // namespace triskin::exports
