// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/design/module_list.hpp"

namespace triskin::design {

/// Skin as drawn for skinGui: triangles on a plane, and, where the file tells, the board that reads each.
struct SkinGuiLayout {
  ModuleList list;         ///< Its islands are the drawing's connected groups, and center_mm is that of the drawing.
  std::vector<int> board;  ///< It is the board of node k, or −1 when unknown.
  int boards = 0;
  int boards_apart = 0;  ///< It counts boards whose triangles are not connected by joints.
};

/// Reads a skinGui configuration (`triangle_10pad id x y orientation gain mirror …` lines) or, with `part`, one part
/// of a JSON collection of them (`ini_2d` → part → `triangles`). Two triangles are joined when their centres lie
/// 15 … 22 mm apart and the directions of each one's joints are 120° apart; groups are laid on the lattice. Throws
/// InputError naming file and triangle: unknown part (with the parts there are), no triangle, ids that stand twice,
/// triangles that fit no lattice. Cost: O(n²).
[[nodiscard]] SkinGuiLayout read_skingui(const std::filesystem::path& path, const std::string& part = "");

/// The module list as JSON that read_module_list() reads. Cost: O(n).
[[nodiscard]] nlohmann::json module_list_json(const ModuleList& list);

}  // namespace triskin::design
