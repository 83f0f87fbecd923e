// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/base/bytes.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// Diagnostic trouble codes of the modules: 3 bytes, 0x9 then the module's state in the high byte's low nibble, 0, module row.
/// A fault that came and went stays confirmed until it is cleared. Kept in RAM.
class FaultMemory {
 public:
  static constexpr std::uint8_t kTestFailed = 0x01, kConfirmed = 0x08;
  static constexpr std::size_t kStates = 9;

  /// Notes the present state of a module; its earlier fault stays confirmed.
  void note(std::size_t module, wire::ModuleState state, std::uint64_t now_us) {
    for (std::size_t s = 2; s < kStates; ++s) {
      Entry& e = entries_[module][s];
      const bool now = static_cast<std::size_t>(state) == s;
      if (now && (e.status & kTestFailed) == 0) e.since_us = now_us;
      e.status = static_cast<std::uint8_t>(now ? (e.status | kTestFailed | kConfirmed) : (e.status & ~kTestFailed));
    }
  }
  void clear() { entries_ = {}; }

  /// DTC and status of every entry that has one of the bits of `mask`.
  void report(std::uint8_t mask, ByteWriter& out) const {
    for (std::size_t m = 0; m < entries_.size(); ++m) {
      for (std::size_t s = 2; s < kStates; ++s) {
        if ((entries_[m][s].status & mask) == 0) continue;
        out.u8(static_cast<std::uint8_t>(0x90 | s));
        out.u8(0);
        out.u8(static_cast<std::uint8_t>(m));
        out.u8(entries_[m][s].status);
      }
    }
  }

 private:
  struct Entry {
    std::uint8_t status = 0;
    std::uint64_t since_us = 0;
  };
  std::array<std::array<Entry, kStates>, layout::kMaxModules> entries_{};
};

}  // namespace triskin::fw
