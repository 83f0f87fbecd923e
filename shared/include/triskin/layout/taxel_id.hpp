// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace triskin::layout {

/// Names a taxel of a skin. Module and taxel travel together, so that nobody exchanges two plain numbers.
struct TaxelId {
  int module = 0;  ///< An id of the design.
  int taxel = 0;   ///< 0 … kTaxelsPerModule − 1.
  bool operator==(const TaxelId&) const = default;
};

}  // namespace triskin::layout
