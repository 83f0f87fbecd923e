// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <string>

namespace triskin::geometry {

/// Object of a mesh file to be read, and the names that a reader met.
struct ObjectFilter {
  std::string wanted;           ///< An empty name wants all objects.
  std::set<std::string> names;  ///< They are the names of all objects, groups, solids or nodes that have faces.

  /// Notes a name; true when it is the wanted one.
  bool meets(const std::string& name) {
    if (!name.empty()) names.insert(name);
    return !wanted.empty() && name == wanted;
  }
};

}  // namespace triskin::geometry
