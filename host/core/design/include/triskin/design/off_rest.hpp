// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/module_number.hpp"

namespace triskin::design {

/// Taxels are off rest if they read something that no touch explains.
struct OffRest {
  int taxels = 0;
  std::vector<ModuleNumber> modules;  ///< The modules with such taxels are in ascending order.
};

/// Returns "n taxels do not rest: tare; their modules: …" with at most twelve modules, or nothing if all rest.
[[nodiscard]] std::string sentence(const OffRest& off);

}  // namespace triskin::design
