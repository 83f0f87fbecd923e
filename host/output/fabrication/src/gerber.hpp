// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "ring.hpp"

namespace triskin::fabrication {

/// One layer as a Gerber file: format X2 with file, aperture and net attributes, mm with six decimals. Source: Ucamco,
/// The Gerber Layer Format Specification, revision 2022.02. Coordinates are seen from the touch side, y up, also those
/// of the back.
class Gerber {
 public:
  /// `function` is the value of .FileFunction, such as "Copper,L1,Top". Solder masks are negative: what is drawn is
  /// open.
  explicit Gerber(std::string_view function);

  /// `use` is the value of .AperFunction, such as "ViaPad"; `net` may be empty.
  void flash(const design::Vec2& at_mm, double diameter_mm, std::string_view use, std::string_view net);
  /// The rectangle is turned counter-clockwise.
  void flash_rectangle(const design::Vec2& at_mm, const design::Vec2& size_mm, double angle_rad, std::string_view use,
                       std::string_view net);
  void line(const design::Vec2& from_mm, const design::Vec2& to_mm, double width_mm, std::string_view use,
            std::string_view net);
  void region(const Ring& ring_mm, std::string_view net);
  [[nodiscard]] std::string text() const;

 private:
  void select(const std::string& shape, std::string_view use);
  void carry(std::string_view net);

  std::string function_, apertures_, body_, net_;
  std::map<std::string, int> codes_;  // of aperture definitions, with their use
  int code_ = 0;
};

/// Holes of one diameter as an Excellon file in mm, decimal coordinates. `function` is such as "Plated,1,4,PTH".
[[nodiscard]] std::string excellon(std::string_view function, double diameter_mm, std::span<const design::Vec2> at_mm);

}  // namespace triskin::fabrication
