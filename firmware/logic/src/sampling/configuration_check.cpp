// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/configuration_check.hpp"

#include <algorithm>
#include <utility>

namespace triskin::fw {

bool ConfigurationCheck::needed_for(const ad7147::Results& results) {
  return std::exchange(required_, false) || !std::ranges::all_of(results, ad7147::in_range);
}

}  // namespace triskin::fw
