// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_outlines.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace triskin::cli {
namespace {

using design::Polygon;

// The radius is 1 with a few waves.
class Waves {
 public:
  explicit Waves(std::mt19937_64& random) {
    const auto uniform = [&](double high) { return high * (static_cast<double>(random() >> 11) * 0x1p-53); };
    for (std::size_t k = 0; k < size_.size(); ++k) {
      size_[k] = uniform(0.3) / static_cast<double>(k + 1);
      phase_[k] = uniform(2.0 * M_PI);
    }
  }
  [[nodiscard]] double radius(double angle) const {
    double r = 1.0;
    for (std::size_t k = 0; k < size_.size(); ++k)
      r += size_[k] * std::cos(static_cast<double>(k + 1) * angle + phase_[k]);
    return r;
  }

 private:
  std::array<double, 6> size_{}, phase_{};
};

std::mt19937_64 seeded(int vertices, double area_cm2) {
  return std::mt19937_64(static_cast<std::uint64_t>(vertices) * 100003u + static_cast<std::uint64_t>(area_cm2));
}

Polygon scaled(Polygon p, double area_cm2) {
  const double scale = std::sqrt(area_cm2 * 100.0 / placement::polygon_area(p));
  for (auto& v : p.outer) v *= scale;
  return placement::normalize_polygon(std::move(p), "bench outline");
}

}  // namespace

Polygon bench_outline(bool rough, int vertices, double area_cm2) {
  std::mt19937_64 random = seeded(vertices, area_cm2);
  const Waves waves(random);
  Polygon p;
  for (int k = 0; k < vertices; ++k) {
    const double angle = 2.0 * M_PI * k / vertices;
    const double r =
        rough ? 0.75 + (1.25 - 0.75) * (static_cast<double>(random() >> 11) * 0x1p-53) : waves.radius(angle);
    p.outer.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return scaled(std::move(p), area_cm2);
}

// A crack takes three vertices, its two lips and its end; the other vertices are spread over the arcs between cracks.
Polygon cracked_outline(int vertices, double area_cm2, int cracks, double depth) {
  constexpr double kHalfWidth_rad = 0.01;
  std::mt19937_64 random = seeded(vertices, area_cm2);
  const Waves waves(random);
  Polygon p;
  const auto add = [&](double angle, double part) {
    const double r = part * waves.radius(angle);
    p.outer.emplace_back(r * std::cos(angle), r * std::sin(angle));
  };
  const int arcs = std::max(1, cracks), plain = vertices - 3 * cracks;
  for (int a = 0; a < arcs; ++a) {
    const double from = 2.0 * M_PI * a / arcs, width = 2.0 * M_PI / arcs;
    if (cracks > 0) {
      add(from - kHalfWidth_rad, 1.0);
      add(from, 1.0 - depth);
      add(from + kHalfWidth_rad, 1.0);
    }
    const int here = plain * (a + 1) / arcs - plain * a / arcs;
    for (int k = 1; k <= here; ++k) add(from + width * k / (here + 1), 1.0);
  }
  return scaled(std::move(p), area_cm2);
}

}  // namespace triskin::cli
