// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace triskin::geometry {

/// A block of sixteen words as one vector; by reference, for vectors passed by value would depend on the processor.
using BlockWords = std::uint32_t __attribute__((vector_size(64)));
[[nodiscard]] inline bool any(const BlockWords& v) {
  using Half = std::uint64_t __attribute__((vector_size(16)));
  Half part[4];
  std::memcpy(part, &v, sizeof part);
  const Half all = (part[0] | part[1]) | (part[2] | part[3]);
  return (all[0] | all[1]) != 0;
}

/// One bit for each sample of a grid, 32 samples of a row in a word. Words of the same columns stand together, so that
/// sixteen rows are done at once. The widest instruction set of the processor is chosen at the first call; all give the
/// same bits.
class SampleBits {
 public:
  static constexpr int kBlock = 16, kWord = 32;  // Rows and columns that are processed at once.

  /// All bits off. `rows` is a multiple of kBlock.
  void clear(int rows, int words);
  [[nodiscard]] std::uint32_t* word(int row, int word) { return bits_.data() + index(row, word); }
  [[nodiscard]] const std::uint32_t* word(int row, int word) const { return bits_.data() + index(row, word); }
  void flip(int row, std::uint32_t column) { *word(row, static_cast<int>(column / kWord)) ^= 1U << (column % kWord); }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int words() const { return words_; }

  /// Each bit becomes the parity of itself and all before it in its row.
  void accumulate_parity();

 private:
  [[nodiscard]] std::size_t index(int row, int word) const {
    return static_cast<std::size_t>(word) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(row);
  }
  int rows_ = 0, words_ = 0, stride_ = 0;
  std::vector<std::uint32_t> bits_;
};

/// How often each bit of a block of words is set in many blocks: binary digits in planes, all 16 × 32 at once.
class BitCounts {
 public:
  void clear() {
    most_ = 0;
    planes_.clear();
  }
  /// Adds inside & ~cut of every other block of kBlock rows, block `first` being the first.
  void add(const SampleBits& inside, const SampleBits& cut, int first);
  /// Adds to counts[k] the sum of bits k and k + 16 of the words, turned by `turn`: to counts[(k + turn) % 16].
  using Counts = std::array<std::array<std::int32_t, SampleBits::kBlock>, SampleBits::kWord / 2>;
  void add_to(Counts& counts, int turn) const;

 private:
  int most_ = 0;  // No count is higher than this.
  std::vector<std::array<std::uint32_t, SampleBits::kBlock>> planes_;
};

}  // namespace triskin::geometry
