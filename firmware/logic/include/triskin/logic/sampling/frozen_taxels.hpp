// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/patch_image.hpp"

namespace triskin::fw {

/// Tells frozen taxels of one chip from live ones. A live converter has noise: a taxel that keeps one value while the
/// others of its chip change and change is frozen. Noise (AD7147 data sheet, table 1: 12, 7, 3 counts peak to peak at
/// decimation 64, 128, 256) lets a live taxel repeat its value with a probability of 0.16, 0.27, 0.57 a reading, while
/// ten, eight, five others change. So kFrozenChanges of them are some 29, 36, 65 readings, in which a live taxel never
/// moves with a probability below 1e-15.
class FrozenTaxels {
 public:
  using Taxels = std::array<std::uint16_t, layout::kTaxelsPerModule>;
  static constexpr std::uint16_t kFrozenChanges = 288;  ///< changes of the other taxels
  static constexpr int kLively = 4;  ///< changed taxels below which a reading says nothing: a finger on a quiet skin

  /// The chip was configured anew.
  void restart() { still_ = {}; }
  /// One reading. Bit t of the result: taxel t is frozen. Cost: about 300 instructions.
  [[nodiscard]] std::uint16_t add(const Taxels& raw);

 private:
  Taxels last_{};
  std::array<std::uint16_t, layout::kTaxelsPerModule> still_{};  // Changes of the other taxels since this one changed.
};

}  // namespace triskin::fw
