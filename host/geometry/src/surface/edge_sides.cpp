// SPDX-License-Identifier: GPL-3.0-or-later
#include "edge_sides.hpp"

#include <algorithm>
#include <tuple>

#include "index.hpp"

namespace triskin::geometry {

EdgeSides::EdgeSides(const Mesh& mesh) : sides_(3 * mesh.faces.size()) {
  std::vector<std::size_t> begin(mesh.vertices.size() + 1, 0);  // of the sides of each low vertex
  const auto low_of = [&](const std::array<int, 3>& f, std::size_t s) { return std::min(f[s], f[(s + 1) % 3]); };
  for (const auto& f : mesh.faces) {
    for (std::size_t s = 0; s < 3; ++s) ++begin[at(low_of(f, s)) + 1];
  }
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<std::size_t> next = begin;
  for (std::size_t k = 0; k < mesh.faces.size(); ++k) {
    const auto& f = mesh.faces[k];
    for (std::size_t s = 0; s < 3; ++s) {
      const int low = low_of(f, s);
      sides_[next[at(low)]++] = {low, std::max(f[s], f[(s + 1) % 3]), static_cast<int>(k), static_cast<int>(s)};
    }
  }
  for (std::size_t v = 0; v + 1 < begin.size(); ++v) {
    std::sort(sides_.begin() + static_cast<std::ptrdiff_t>(begin[v]),
              sides_.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]), [](const EdgeSide& a, const EdgeSide& b) {
                return std::tie(a.high, a.face, a.side) < std::tie(b.high, b.face, b.side);
              });
  }
}

}  // namespace triskin::geometry
