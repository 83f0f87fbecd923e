// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::design {

/// Taxels are off rest if they read something that no touch explains.
struct OffRest {
  int taxels = 0;
  std::vector<layout::ModuleId> modules;  ///< The modules with such taxels are in ascending order.
};

/// Returns "n taxels do not rest: tare; their modules: …" with at most twelve modules, or nothing if all rest.
[[nodiscard]] std::string sentence(const OffRest& off);

}  // namespace triskin::design
