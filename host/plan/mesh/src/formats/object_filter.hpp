// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <string>

namespace triskin::mesh {

/// Selects the object of a mesh file and collects the names that a reader met.
struct ObjectFilter {
  std::string wanted;           ///< An empty name selects all objects.
  std::set<std::string> names;  ///< All objects, groups, solids or nodes that have faces are listed.

  /// Notes a name and returns true when it is the wanted one.
  bool meets(const std::string& name) {
    if (!name.empty()) names.insert(name);
    return !wanted.empty() && name == wanted;
  }
};

}  // namespace triskin::mesh
