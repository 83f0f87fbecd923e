// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace triskin::machine {

struct ElfImage;

/// Counts the instructions that the core executes, by address, so that a test can tell which function of the image
/// needs them. Cost: one search of a hash table per block of code.
class Profile {
 public:
  struct Function {
    std::string name;  ///< As a C++ programmer writes it; code without a symbol before it has the name "?".
    std::uint64_t instructions = 0;
  };

  /// Adds the instructions of the block of code at `address`.
  void add(std::uint32_t address, std::uint32_t instructions) { by_block_[address] += instructions; }
  void clear() { by_block_.clear(); }
  /// Returns the functions of `image` that have run, those with most instructions first. Functions that the compiler
  /// has inlined count for their caller.
  [[nodiscard]] std::vector<Function> by_function(const ElfImage& image) const;

 private:
  std::unordered_map<std::uint32_t, std::uint64_t> by_block_;
};

}  // namespace triskin::machine
