// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/patch_image.hpp"

namespace triskin::fw {

/// Detects frozen taxels of one chip. A working converter has noise, so a taxel that keeps one value while the others
/// of its chip keep changing is frozen. By its noise (AD7147 data sheet, table 1: 12, 7, 3 counts peak to peak at
/// decimation 64, 128, 256) a working taxel repeats its value with a probability of 0.16, 0.27, 0.57 per reading, while
/// ten, eight, five others change. So kFrozenChanges of them take about 29, 36, 65 readings, in which a working taxel
/// stays unchanged with a probability below 1e-15. On a quieter chip a taxel in the middle of a count repeats its value
/// with up to 0.95, while others at the edge of a count change as often as ever, but hardly by two counts: without
/// kFrozenJumps such changes, kQuietChanges are required, some 750 readings.
class FrozenTaxels {
 public:
  using Taxels = std::array<std::uint16_t, layout::kTaxelsPerModule>;
  static constexpr std::uint16_t kFrozenChanges = 288;  ///< So many changes of the other taxels are required.
  /// A reading with fewer changed taxels says nothing, as with a finger on a quiet skin.
  static constexpr int kLively = 4;
  static constexpr std::uint16_t kFrozenJumps = 12;      ///< So many of the changes must be of two counts or more, ...
  static constexpr std::uint16_t kQuietChanges = 1'000;  ///< ... or so many changes are required.

  /// Resets the counts because the chip was configured again.
  void restart() { still_ = {}; }
  /// Adds one reading. Bit t of the result says that taxel t is frozen. Cost: about 300 instructions.
  [[nodiscard]] std::uint16_t add(const Taxels& raw);

 private:
  Taxels last_{};
  // Changes of the other taxels since the last change of this one.
  struct Evidence {
    std::uint16_t changes = 0, jumps = 0;
    [[nodiscard]] bool enough() const {
      return changes >= kQuietChanges || (changes >= kFrozenChanges && jumps >= kFrozenJumps);
    }
  };
  std::array<Evidence, layout::kTaxelsPerModule> still_{};
};

}  // namespace triskin::fw
