// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "triskin/hardware/ad7147.hpp"

namespace triskin::hardware {

/// A property in which the converters of a series differ, with its ranges and their source.
struct ConverterProperty;

/// How the converters of a scene are made.
struct Converters {
  struct Given {
    const ConverterProperty* property;
    double value;  ///< of a flag: 0 or 1
  };
  /// Each chip is drawn by its serial number, so that no two of a simulation are alike. False: ideal chips, all as the
  /// data sheet says and without noise.
  bool drawn = true;
  std::vector<Given> given{};  ///< every chip has these

  /// Returns the properties of the chip with this serial number; equal numbers give equal chips.
  [[nodiscard]] Ad7147Behaviour of(std::uint64_t serial) const;
};

}  // namespace triskin::hardware
