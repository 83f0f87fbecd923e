// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "triskin/design/module.hpp"

namespace triskin::pipeline {

/// Numbers the modules of an edited layout so that labels and printed sheets hold: a module that stays keeps its number
/// if the layout is still long enough for it. The numbers that became free go to the added modules and then to those
/// that had the highest numbers. `new_id` has the present id by old id (−1: gone) and `added` the present ids of the
/// new modules; both are brought up to date. The layout must have no jumpers yet. Cost: O(n).
void keep_numbers(design::ModuleLayout& layout, std::vector<int>& new_id, std::span<int> added = {});

}  // namespace triskin::pipeline
