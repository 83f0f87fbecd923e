// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <string>

namespace triskin::geometry {

/// Object of a mesh file to be read, and the names that a reader met.
struct ObjectFilter {
  std::string wanted;           ///< empty: all
  std::set<std::string> names;  ///< names of objects, groups, solids or nodes with faces

  /// Notes a name; true when it is the wanted one.
  bool meets(const std::string& name) {
    if (!name.empty()) names.insert(name);
    return !wanted.empty() && name == wanted;
  }
};

}  // namespace triskin::geometry
