// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// Every register has 32 bits and a fixed address. The section numbers in this folder are those of RM0440 (STM32G4
/// reference manual). tests/firmware/silicon/facts.txt has the fact behind each constant of this folder, and a test
/// compares them.
class Register {
 public:
  /// `address` must be a multiple of 4. The constructor touches nothing.
  constexpr explicit Register(std::uint32_t address) : address_(address) {}
  /// Returns the address of the register without accessing it.
  [[nodiscard]] constexpr std::uint32_t address() const { return address_; }
  /// Reads the register, with the side effects that reading it has.
  [[nodiscard]] std::uint32_t read() const { return *pointer(); }
  void write(std::uint32_t value) const { *pointer() = value; }
  /// Sets the bits of `mask` by reading and writing. Not atomic.
  void set(std::uint32_t mask) const { write(read() | mask); }
  /// Clears the bits of `mask` by reading and writing. Not atomic.
  void clear(std::uint32_t mask) const { write(read() & ~mask); }
  /// Clears bits and sets bits in one write. Not atomic.
  void modify(std::uint32_t clear_mask, std::uint32_t set_mask) const { write((read() & ~clear_mask) | set_mask); }
  /// Returns true when a bit of `mask` is set.
  [[nodiscard]] bool any(std::uint32_t mask) const { return (read() & mask) != 0; }

 private:
  [[nodiscard]] volatile std::uint32_t* pointer() const { return reinterpret_cast<volatile std::uint32_t*>(address_); }
  std::uint32_t address_;
};

/// Returns a mask with bit `n` set, n 0..31.
[[nodiscard]] constexpr std::uint32_t bit(unsigned n) {
  return std::uint32_t{1} << n;
}

}  // namespace triskin::board
