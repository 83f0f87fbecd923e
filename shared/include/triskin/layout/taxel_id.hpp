// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/layout/index.hpp"

namespace triskin::layout {

/// Names a taxel of a skin. Module and taxel travel together.
struct TaxelId {
  ModuleId module;
  TaxelIndex taxel;
  bool operator==(const TaxelId&) const = default;
};

}  // namespace triskin::layout
