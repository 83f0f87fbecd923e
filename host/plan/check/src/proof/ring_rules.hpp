// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "proof_log.hpp"

namespace triskin::check {

/// Throws InputError naming `name` and a ring unless the closed rings (first the outer one, then holes) are a valid
/// polygon as OGC 06-103r4, 6.1.11.1 defines it. Written independently of the rules of `place`, on exact constructions.
/// Cost: O(n²).
void require_valid_rings(const std::vector<Ring>& rings, const std::string& name);

}  // namespace triskin::check
