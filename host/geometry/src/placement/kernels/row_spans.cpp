// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/kernels/row_spans.hpp"

#include <cstring>

#include "placement/kernels/vector_unit.hpp"

namespace triskin::geometry {
namespace {

constexpr int kLanes = 16;
using Reals = float __attribute__((vector_size(4 * kLanes)));
using Whole = std::int32_t __attribute__((vector_size(4 * kLanes)));

[[gnu::always_inline]] inline void spans(const BoundLines& lines, int rows, int room, std::int32_t* begin,
                                         std::int32_t* end) {
  const Reals zero = {}, lane = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  for (int first = 0; first < rows; first += kLanes) {
    const Reals row = lane + static_cast<float>(first);
    Reals low = zero, high = zero + 1e9F;
    for (const BoundLines::Line& l : lines.lower) {
      const Reals v = l.at + l.slope * row;
      low = v > low ? v : low;
    }
    for (const BoundLines::Line& l : lines.upper) {
      const Reals v = l.at + l.slope * row;
      high = v < high ? v : high;
    }
    high = high < low ? low - 3.0F : high;  // none
    low = low < 1e9F ? low : zero + 1e9F;
    const Whole from = __builtin_convertvector(low, Whole) + (1 - room);
    const Whole to = __builtin_convertvector(high + 4.0F, Whole) - (3 - room);
    std::memcpy(begin + first, &from, sizeof from);
    std::memcpy(end + first, &to, sizeof to);
  }
}

using Spans = void (*)(const BoundLines&, int, int, std::int32_t*, std::int32_t*);

#define TRISKIN_SPANS(unit, target)                                                                           \
  target void spans_##unit(const BoundLines& l, int rows, int room, std::int32_t* begin, std::int32_t* end) { \
    spans(l, rows, room, begin, end);                                                                         \
  }
TRISKIN_FOR_VECTOR_UNITS(TRISKIN_SPANS)
#undef TRISKIN_SPANS

}  // namespace

void row_spans(const BoundLines& lines, int rows, int room, std::vector<std::int32_t>& begin,
               std::vector<std::int32_t>& end) {
  const auto size = static_cast<std::size_t>((rows + kLanes - 1) / kLanes * kLanes);
  begin.resize(size);
  end.resize(size);
  static const Spans kSpans = fastest(spans_plain, spans_avx2, spans_avx512);
  kSpans(lines, rows, room, begin.data(), end.data());
}

}  // namespace triskin::geometry
