// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/part.hpp"

namespace triskin::cad {

design::Vec3 size_of(const Part& part) {
  if (part.mesh.vertices.empty()) return design::Vec3::Zero();
  design::Vec3 low = part.mesh.vertices.front(), high = low;
  for (const design::Vec3& v : part.mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return high - low;
}

}  // namespace triskin::cad
