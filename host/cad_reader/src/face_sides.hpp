// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cad/part.hpp"

namespace triskin::cad_reader {

/// Sets Face::side of every face: places on it look along their normal (how much is free) and against it (is there
/// another sheet of a thin wall). Of two sheets that see alike, the one that bulges is outward. Cost: at most some
/// 200,000 rays.
void decide_sides(cad::Part& part);

}  // namespace triskin::cad_reader
