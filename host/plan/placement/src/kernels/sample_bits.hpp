// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace triskin::placement {

/// A block is sixteen words as one vector. It is passed by reference, because passing vectors by value depends on the
/// processor.
using BlockWords = std::uint32_t __attribute__((vector_size(64)));
[[nodiscard]] inline bool any(const BlockWords& v) {
  using Half = std::uint64_t __attribute__((vector_size(16)));
  Half part[4];
  std::memcpy(part, &v, sizeof part);
  const Half all = (part[0] | part[1]) | (part[2] | part[3]);
  return (all[0] | all[1]) != 0;
}

/// Stores one bit for each sample of a grid, 32 samples of a row per word. Words of the same columns are adjacent, so
/// that sixteen rows are processed at once. The widest instruction set of the processor is chosen at the first call;
/// all give the same bits.
class SampleBits {
 public:
  static constexpr int kBlock = 16, kWord = 32;  // This many rows and columns are processed at once.

  /// Clears all bits. `rows` must be a multiple of kBlock.
  void clear(int rows, int words);
  [[nodiscard]] std::uint32_t* word(int row, int word) { return bits_.data() + index(row, word); }
  [[nodiscard]] const std::uint32_t* word(int row, int word) const { return bits_.data() + index(row, word); }
  void flip(int row, std::uint32_t column) { *word(row, static_cast<int>(column / kWord)) ^= 1U << (column % kWord); }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int words() const { return words_; }

  /// Replaces each bit by the parity of itself and all before it in its row.
  void accumulate_parity();

 private:
  [[nodiscard]] std::size_t index(int row, int word) const {
    return static_cast<std::size_t>(word) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(row);
  }
  int rows_ = 0, words_ = 0, stride_ = 0;
  std::vector<std::uint32_t> bits_;
};

/// Counts how often each bit of a block of words is set in many blocks, with binary digits in planes, so that all 16 ×
/// 32 counts grow at once.
class BitCounts {
 public:
  void clear() {
    most_ = 0;
    planes_.clear();
  }
  /// Adds inside & ~cut of every other block of kBlock rows, starting with block `first`.
  void add(const SampleBits& inside, const SampleBits& cut, int first);
  /// Adds the sum of bits k and k + 16 of the words to counts[(k + turn) % 16].
  using Counts = std::array<std::array<std::int32_t, SampleBits::kBlock>, SampleBits::kWord / 2>;
  void add_to(Counts& counts, int turn) const;

 private:
  int most_ = 0;  // No count is higher than this.
  std::vector<std::array<std::uint32_t, SampleBits::kBlock>> planes_;
};

}  // namespace triskin::placement
