// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cad/part.hpp"

namespace triskin::cad_reader {

/// Sets Face::side of every face: from places on it, rays along the normal measure how much is free, and rays against
/// it find the other sheet of a thin wall. Of two sheets with about the same view, the one that bulges is outward.
/// Cost: at most some 200,000 rays.
void decide_sides(cad::Part& part);

}  // namespace triskin::cad_reader
