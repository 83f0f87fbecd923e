// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

/// Laplace's equation on a cross section by finite differences, as a witness of formulas: cells of 0.01 mm, successive
/// over-relaxation, no field through the border.
namespace triskin::fabrication {

class CrossSection {
 public:
  static constexpr double kCell_mm = 0.01;

  CrossSection(double width_mm, double height_mm)
      : width_(cells(width_mm)), height_(cells(height_mm)), permittivity_(size(), 1.0), conductor_(size(), 0) {}

  /// Rectangles from (x, y), y downwards; conductors count from 1.
  void add_dielectric(double y_mm, double height_mm, double relative_permittivity) {
    each(0.0, y_mm, width_ * kCell_mm, height_mm, [&](std::size_t k) { permittivity_[k] = relative_permittivity; });
  }
  void add_conductor(int number, double x_mm, double y_mm, double width_mm, double height_mm) {
    each(x_mm, y_mm, width_mm, height_mm, [&](std::size_t k) { conductor_[k] = number; });
  }

  /// Returns the capacitance between two conductors per length, pF/mm, all other conductors being at 0 V.
  [[nodiscard]] double mutual_pf_per_mm(int driven, int sensed) const {
    std::vector<double> volt(size(), 0.0);
    for (std::size_t k = 0; k < size(); ++k) volt[k] = conductor_[k] == driven ? 1.0 : 0.0;
    const double omega = 2.0 / (1.0 + std::sin(3.14159265358979 / std::max(width_, height_)));
    for (int round = 0; round < 20'000; ++round) {
      double change = 0.0;
      for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
          if (conductor_[at(x, y)] != 0) continue;
          double sum = 0.0, weights = 0.0;
          for_neighbours(x, y, [&](std::size_t other, double weight) {
            sum += weight * volt[other];
            weights += weight;
          });
          const double step = omega * (sum / weights - volt[at(x, y)]);
          volt[at(x, y)] += step;
          change = std::max(change, std::abs(step));
        }
      }
      if (change < 1e-9) break;
    }
    double charge = 0.0;
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (conductor_[at(x, y)] != sensed) continue;
        for_neighbours(x, y, [&](std::size_t other, double weight) {
          if (conductor_[other] != sensed) charge += weight * volt[other];
        });
      }
    }
    return 8.854e-3 * charge;
  }

 private:
  static int cells(double mm) { return static_cast<int>(std::lround(mm / kCell_mm)); }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  [[nodiscard]] std::size_t at(int x, int y) const { return static_cast<std::size_t>(y * width_ + x); }
  template <typename Use>
  void each(double x_mm, double y_mm, double w_mm, double h_mm, Use use) {
    for (int y = std::max(0, cells(y_mm)); y < std::min(height_, cells(y_mm + h_mm)); ++y) {
      for (int x = std::max(0, cells(x_mm)); x < std::min(width_, cells(x_mm + w_mm)); ++x) use(at(x, y));
    }
  }
  // Between a conductor and a dielectric the cell of the dielectric counts; between two dielectrics their series.
  template <typename Use>
  void for_neighbours(int x, int y, Use use) const {
    constexpr int kStep[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const auto& [dx, dy] : kStep) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
      const std::size_t here = at(x, y), other = at(x + dx, y + dy);
      const double a = conductor_[here] != 0 ? permittivity_[other] : permittivity_[here];
      const double b = conductor_[other] != 0 ? a : permittivity_[other];
      use(other, 2.0 * a * b / (a + b));
    }
  }

  int width_, height_;
  std::vector<double> permittivity_;
  std::vector<int> conductor_;
};

}  // namespace triskin::fabrication
