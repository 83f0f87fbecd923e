// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "module_board.hpp"

namespace triskin::fabrication {

inline constexpr int kCopperLayers = 4;
inline constexpr int kShieldLayer = 1;  ///< CopperLayer::kInner1
/// Two tracks whose nodes are two steps apart keep the clearance, also where both run diagonally.
inline constexpr double kGridPitch_mm = 0.11;

/// A place of the grid on one copper layer (CopperLayer as a number).
struct GridNode {
  int layer = 0, x = 0, y = 0;
};

/// Fixed copper of the module, to which tracks of other nets keep their distance: a line with round ends, or a
/// rectangle.
struct FixedCopper {
  std::array<bool, kCopperLayers> on{};
  design::Vec2 from_mm, to_mm;      ///< Both ends of the line; equal for a disc or a rectangle.
  double radius_mm = 0.0;           ///< The half width of the line.
  design::Vec2 half_size_mm{0, 0};  ///< Half of the rectangle's sides; 0 for a line.
  double angle_rad = 0.0;
  int net = 0;
  [[nodiscard]] double distance_mm(const design::Vec2& p) const;
};

/// What a net carries decides on which layers it may run, so that a plane driven by ACSHIELD lies between every sensor
/// and everything digital.
enum class NetKind {
  kDigital,  ///< Bus, supply, straps: on the two lower layers, outside of the sensor windows.
  kSensor,   ///< CIN: on the touch side, and on the back inside the sensor windows.
  kShield,   ///< ACSHIELD: the first inner layer, and the way from there to its pin.
};

/// Returns true inside the two places beside the chip where sensor tracks come through to the back. Digital copper
/// keeps off them by kSensorGap_mm, from middle to border, on the lower layers.
[[nodiscard]] bool in_sensor_window(const design::Vec2& p, double margin_mm = 0.0);
inline constexpr double kSensorGap_mm = 0.3;

/// The grid of one module: which net may use which node.
class RouteGrid {
 public:
  /// Nets are numbered from 1; `kinds` has one entry for each number.
  RouteGrid(const std::vector<FixedCopper>& copper, const std::vector<NetKind>& kinds);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int nodes_per_layer() const { return width_ * height_; }
  [[nodiscard]] int index(const GridNode& n) const { return n.layer * nodes_per_layer() + n.y * width_ + n.x; }
  [[nodiscard]] design::Vec2 place_mm(int index) const;

  [[nodiscard]] bool may_track(int index, int net) const;
  /// `place` is an index on layer 0.
  [[nodiscard]] bool may_drill(int place, int net) const;
  /// Returns the nodes inside a piece of fixed copper, on all its layers.
  [[nodiscard]] std::vector<int> nodes_in(const FixedCopper& copper) const;

 private:
  static constexpr int kFree = 0, kNobody = -1;
  [[nodiscard]] static bool is_allowed(int owner, int net) { return owner == kFree || owner == net; }
  static void claim(int& owner, int net) { owner = owner == kFree || owner == net ? net : kNobody; }
  void block_edges();
  void block_copper(const FixedCopper& copper);
  template <typename Use>
  void for_nodes_near(const FixedCopper& copper, double reach_mm, Use use) const;

  int width_ = 0, height_ = 0;
  std::vector<int> track_, via_;      // Each node has the only net that may use it, kFree or kNobody.
  std::vector<std::uint8_t> window_;  // 2 inside a sensor window, 1 nearer to one than kSensorGap_mm
  std::vector<NetKind> kinds_;
};

}  // namespace triskin::fabrication
