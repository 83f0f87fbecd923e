// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/sample_bits.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kernels/vector_unit.hpp"

namespace triskin::placement {
namespace {

constexpr int kLanes = SampleBits::kBlock;
using Words = std::uint32_t __attribute__((vector_size(4 * kLanes)));

[[gnu::always_inline]] inline void parity(std::uint32_t* bits, int rows, int stride, int words) {
  for (int first = 0; first < rows; first += kLanes, bits += kLanes) {
    Words carry = {};
    for (int w = 0; w < words; ++w) {
      std::uint32_t* at = bits + static_cast<std::ptrdiff_t>(w) * stride;
      Words v;
      std::memcpy(&v, at, sizeof v);
      for (int shift = 1; shift < SampleBits::kWord; shift *= 2) v ^= v << shift;
      v ^= carry;
      carry = Words{} - (v >> 31);
      std::memcpy(at, &v, sizeof v);
    }
  }
}

// Sums a few blocks with the binary digits in registers.
struct FewBlocks {
  static constexpr int kPlanes = 8, kMaxBlocks = (1 << kPlanes) - 1;
  Words plane[kPlanes];
  int blocks;
};

[[gnu::always_inline]] inline void begin(FewBlocks& few) {
  for (Words& p : few.plane) p = Words{};
  few.blocks = 0;
}

[[gnu::always_inline]] inline void add(FewBlocks& few, Words& carry) {
  for (Words& p : few.plane) {
    const Words both = p & carry;
    p ^= carry;
    carry = both;
  }
  ++few.blocks;
}

[[gnu::always_inline]] inline void flush(FewBlocks& few, std::uint32_t* planes, std::size_t count) {
  Words carry = {};
  for (std::size_t p = 0; p < count; ++p, planes += kLanes) {
    const Words digit = p < FewBlocks::kPlanes ? few.plane[p] : Words{};
    Words plane;
    std::memcpy(&plane, planes, sizeof plane);
    const Words sum = plane ^ digit ^ carry;
    carry = (plane & digit) | (carry & (plane ^ digit));
    std::memcpy(planes, &sum, sizeof sum);
  }
  begin(few);
}

[[gnu::always_inline]] inline void add_blocks(const SampleBits& inside, const SampleBits& cut, int first,
                                              std::uint32_t* planes, std::size_t count) {
  FewBlocks few;
  begin(few);
  for (int w = 0; w < inside.words(); ++w) {
    for (int row = kLanes * first; row < inside.rows(); row += 2 * kLanes) {
      Words block, off;
      std::memcpy(&block, inside.word(row, w), sizeof block);
      std::memcpy(&off, cut.word(row, w), sizeof off);
      block &= ~off;
      add(few, block);
      if (few.blocks == FewBlocks::kMaxBlocks) flush(few, planes, count);
    }
  }
  flush(few, planes, count);
}

[[gnu::always_inline]] inline void sum(const std::uint32_t* planes, std::size_t count, int bit, std::int32_t* to) {
  Words total;
  std::memcpy(&total, to, sizeof total);
  for (std::size_t p = 0; p < count; ++p, planes += kLanes) {
    Words plane;
    std::memcpy(&plane, planes, sizeof plane);
    plane >>= bit;
    total += ((plane & 1U) + ((plane >> (SampleBits::kWord / 2)) & 1U)) << p;
  }
  std::memcpy(to, &total, sizeof total);
}

using Parity = void (*)(std::uint32_t*, int, int, int);
using AddBlocks = void (*)(const SampleBits&, const SampleBits&, int, std::uint32_t*, std::size_t);
using Sum = void (*)(const std::uint32_t*, std::size_t, int, std::int32_t*);

#define TRISKIN_SAMPLE_BITS(unit, target)                                                                          \
  target void parity_##unit(std::uint32_t* bits, int rows, int stride, int words) {                                \
    parity(bits, rows, stride, words);                                                                             \
  }                                                                                                                \
  target void add_blocks_##unit(const SampleBits& inside, const SampleBits& cut, int first, std::uint32_t* planes, \
                                std::size_t count) {                                                               \
    add_blocks(inside, cut, first, planes, count);                                                                 \
  }                                                                                                                \
  target void sum_##unit(const std::uint32_t* planes, std::size_t count, int bit, std::int32_t* to) {              \
    sum(planes, count, bit, to);                                                                                   \
  }
TRISKIN_FOR_VECTOR_UNITS(TRISKIN_SAMPLE_BITS)
#undef TRISKIN_SAMPLE_BITS

}  // namespace

// One more block of rows is needed, because a fill that ends between two blocks reads and writes a whole one.
void SampleBits::clear(int rows, int words) {
  rows_ = rows;
  words_ = words;
  stride_ = rows + kBlock;
  bits_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(words), 0);
}

void SampleBits::accumulate_parity() {
  static const Parity kParity = fastest(parity_plain, parity_avx2, parity_avx512);
  kParity(bits_.data(), rows_, stride_, words_);
}

void BitCounts::add(const SampleBits& inside, const SampleBits& cut, int first) {
  static const AddBlocks kAdd = fastest(add_blocks_plain, add_blocks_avx2, add_blocks_avx512);
  most_ += (inside.rows() / SampleBits::kBlock + 1 - first) / 2 * inside.words();
  planes_.resize(static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(most_))));
  kAdd(inside, cut, first, planes_.front().data(), planes_.size());
}

void BitCounts::add_to(Counts& counts, int turn) const {
  static const Sum kSum = fastest(sum_plain, sum_avx2, sum_avx512);
  for (std::size_t k = 0; k < counts.size(); ++k)
    kSum(planes_.front().data(), planes_.size(), static_cast<int>(k),
         counts[(k + static_cast<std::size_t>(turn)) % counts.size()].data());
}

}  // namespace triskin::placement
