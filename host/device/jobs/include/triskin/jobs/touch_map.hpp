// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::device {

/// A taxel under pressure, in the mesh frame.
struct PressedTaxel {
  int module = 0, taxel = 0;                           ///< id in the design, 0..11
  double change_counts = 0.0;                          ///< against the rest value, ≥ kPressed_counts
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};  ///< centre, outward unit normal
};

/// Keeps the rest value of every taxel and lists the taxels under pressure. The rest value is the median of the first
/// three valid samples of the taxel: nothing should touch the skin then; the median tolerates one sample of a finger
/// that was lifted just before. Not thread-safe.
class TouchMap {
 public:
  static constexpr double kPressed_counts = 200.0;
  static constexpr std::size_t kRestSamples = 3;
  /// `design` outlives the map.
  explicit TouchMap(const design::Design& design)
      : design_(design), wiring_(design::wiring_of(design)), modules_(design.layout.modules.size()) {}
  /// Takes a sample; invalid values are ignored.
  void add(const ModuleFrame& frame);
  /// Taxels whose latest value differs from rest by kPressed_counts or more, strongest first.
  [[nodiscard]] std::vector<PressedTaxel> pressed() const;

 private:
  struct Module {
    std::array<std::uint8_t, layout::kTaxelsPerModule> seen{};  // valid samples, up to kRestSamples
    std::array<std::array<double, kRestSamples>, layout::kTaxelsPerModule> first{};
    std::array<double, layout::kTaxelsPerModule> rest{}, now{};
  };
  const design::Design& design_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<Module> modules_;
};

}  // namespace triskin::device
