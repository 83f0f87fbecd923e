// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// One 32-bit register at a fixed address. The section numbers in this folder are those of RM0440 (STM32G4 reference
/// manual). Each constant of this folder has its fact in tests/silicon/facts.txt; a test compares them.
class Register {
 public:
  /// `address` of the register; a multiple of 4. Touches nothing.
  constexpr explicit Register(std::uint32_t address) : address_(address) {}
  /// Address of the register; does not access it.
  [[nodiscard]] constexpr std::uint32_t address() const { return address_; }
  /// Value of the register, with the side effects that reading has there.
  [[nodiscard]] std::uint32_t read() const { return *pointer(); }
  /// Writes the whole register.
  void write(std::uint32_t value) const { *pointer() = value; }
  /// Sets the bits of `mask`: reads, then writes. Not atomic.
  void set(std::uint32_t mask) const { write(read() | mask); }
  /// Clears the bits of `mask`: reads, then writes. Not atomic.
  void clear(std::uint32_t mask) const { write(read() & ~mask); }
  /// Clears bits, then sets bits, in one write. Not atomic.
  void modify(std::uint32_t clear_mask, std::uint32_t set_mask) const { write((read() & ~clear_mask) | set_mask); }
  /// True when a bit of `mask` is set.
  [[nodiscard]] bool any(std::uint32_t mask) const { return (read() & mask) != 0; }

 private:
  [[nodiscard]] volatile std::uint32_t* pointer() const { return reinterpret_cast<volatile std::uint32_t*>(address_); }
  std::uint32_t address_;
};

/// Mask with bit `n` set, n 0..31.
[[nodiscard]] constexpr std::uint32_t bit(unsigned n) {
  return std::uint32_t{1} << n;
}

}  // namespace triskin::board
