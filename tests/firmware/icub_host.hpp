// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "triskin/wire/can_frame.hpp"

namespace triskin::test {

/// Describes an iCub host and an MTB4 board as their sources do (docs/icub.md names these). Nothing here is shared with
/// our encoder: identifiers, masks and numbers are written down a second time on purpose.
namespace icub_host {

/// Holds what the skin driver stores for one triangle.
struct Triangle {
  std::array<int, 12> value{};
  int halves = 0;                 ///< Received frames of both kinds are counted.
  std::optional<int> error_code;  ///< The code is in bytes 6 and 7 of the second frame, high byte first.
  /// Returns the driver's reading of the code.
  [[nodiscard]] std::string error() const {
    const int kind = error_code.value_or(0) & 0xF;
    if (kind == 0) return "";
    if (kind == 1) return "no ack";
    return kind == 2 ? "not connected" : "unknown error";
  }
  [[nodiscard]] int out_of_range() const { return (error_code.value_or(0) & 0xFFF0) >> 4; }
};

/// Reads like the driver: takes every standard frame, and counts those that it does not know.
class Reader {
 public:
  void take(const wire::CanFrame& f) {
    if (f.extended) return;
    const unsigned identifier = f.id;
    if (((identifier & 0x0F00U) >> 8) != 4) {
      if (((identifier & 0x0F00U) >> 8) != 7 && ((identifier & 0x0F00U) >> 8) != 2) ++unknown;
      return;
    }
    Triangle& t = triangles[{static_cast<int>((identifier & 0xF0U) >> 4), static_cast<int>(identifier & 0xFU)}];
    ++t.halves;
    if (f.data[0] == 0x40) {
      for (std::size_t k = 0; k < 7; ++k) t.value[k] = f.data[k + 1];
    } else if (f.data[0] == 0xC0) {
      for (std::size_t k = 0; k < 5; ++k) t.value[k + 7] = f.data[k + 1];
      if (f.size == 8) t.error_code = f.data[6] << 8 | f.data[7];
    } else {
      ++unknown;
    }
  }
  std::map<std::pair<int, int>, Triangle> triangles;  ///< The key is board and triangle.
  int unknown = 0;                                    ///< The driver knows no class or half for these frames.
};

/// Computes what an MTB4 board makes of a taxel without temperature compensation: `rise` is the change of the
/// converter's result since the calibration, counted so that pressure makes it larger.
struct Mtb4 {
  int no_load = 245, shift = 2;
  [[nodiscard]] int value(int rise) const {
    const int top = (255 - no_load) << shift, bottom = no_load << shift;
    if (rise <= -top) return 255;
    if (rise >= bottom) return 0;
    return no_load - (rise >> shift);
  }
  [[nodiscard]] bool out_of_range(int rise) const {
    return rise <= -(((255 - no_load) << shift) << 1) || rise >= ((no_load << shift) << 1);
  }
};

}  // namespace icub_host
}  // namespace triskin::test
