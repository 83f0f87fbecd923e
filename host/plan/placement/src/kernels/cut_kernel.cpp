// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/cut_kernel.hpp"

#include <cstring>

#include "kernels/vector_unit.hpp"

namespace triskin::placement {
namespace {

constexpr std::size_t kLanes = CutPairs::kLanes;
using Vector = double __attribute__((vector_size(8 * kLanes)));
using Bytes = std::int8_t __attribute__((vector_size(kLanes)));

[[gnu::always_inline]] inline void load(const double* lanes, Vector& to) {
  std::memcpy(&to, lanes, sizeof to);
}

[[gnu::always_inline]] inline void evaluate(const TileGrid& grid, double inset, const double* block,
                                            std::uint8_t* cut) {
  Vector ax, ay, bx, by, nx, ny, sign;
  load(block, ax);
  load(block + kLanes, ay);
  load(block + 2 * kLanes, bx);
  load(block + 3 * kLanes, by);
  load(block + 4 * kLanes, nx);
  load(block + 5 * kLanes, ny);
  load(block + 6 * kLanes, sign);
  const Vector zero = {};
  // Both ends lie beyond one side of the tile.
  const Vector sax = sign * ax, say = sign * ay, sbx = sign * bx, sby = sign * by;
  Vector beyond = zero - 1e300;
  for (int k = 0; k < grid.corners; ++k) {
    const double mx = grid.normal[static_cast<std::size_t>(k)].x(), my = grid.normal[static_cast<std::size_t>(k)].y();
    const Vector a = mx * sax + my * say, b = mx * sbx + my * sby, nearer = a < b ? a : b;
    const Vector room = nearer - grid.offset_mm[static_cast<std::size_t>(k)];
    beyond = room > beyond ? room : beyond;
  }
  // All corners lie on one side of the edge's line.
  const Vector level = nx * ax + ny * ay, snx = sign * nx, sny = sign * ny;
  Vector low = zero + 1e300, high = zero - 1e300;
  for (int k = 0; k < grid.corners; ++k) {
    const double cx = grid.corner[static_cast<std::size_t>(k)].x(), cy = grid.corner[static_cast<std::size_t>(k)].y();
    const Vector side = cx * snx + cy * sny - level;
    low = side < low ? side : low;
    high = side > high ? side : high;
  }
  Vector separation = low > beyond ? low : beyond;
  separation = -high > separation ? -high : separation;
  const auto truth = __builtin_convertvector(separation < zero + inset, Bytes);
  std::memcpy(cut, &truth, sizeof truth);
}

using Kernel = void (*)(const TileGrid&, double, const double*, std::size_t, std::uint8_t*);

#define TRISKIN_CUTS(unit, target)                                                                                  \
  target void cuts_##unit(const TileGrid& grid, double inset, const double* lanes, std::size_t blocks,              \
                          std::uint8_t* cut) {                                                                      \
    for (std::size_t k = 0; k < blocks; ++k) evaluate(grid, inset, lanes + CutPairs::kBlock * k, cut + kLanes * k); \
  }
TRISKIN_FOR_VECTOR_UNITS(TRISKIN_CUTS)
#undef TRISKIN_CUTS

}  // namespace

void CutPairs::grow() {
  room_ = 2 * room_ + 64 * kLanes;
  lanes_.resize(room_ * kFields);
}

const std::vector<std::uint8_t>& CutPairs::cuts(const TileGrid& grid, double inset_mm) {
  static const Kernel kKernel = fastest(cuts_plain, cuts_avx2, cuts_avx512);
  const std::size_t blocks = (count_ + kLanes - 1) / kLanes;
  cut_.resize(blocks * kLanes);
  kKernel(grid, inset_mm, lanes_.data(), blocks, cut_.data());
  return cut_;
}

}  // namespace triskin::placement
