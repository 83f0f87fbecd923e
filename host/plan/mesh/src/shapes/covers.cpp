// SPDX-License-Identifier: GPL-3.0-or-later
#include "covers.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace triskin::mesh {
namespace {

double square(double x) {
  return x * x;
}

struct Ball {
  Vec3 center_mm;
  double radius_mm;
};

// Returns the distance to the nearest of these balls; the inside of each ball is cut away.
double outside_of(std::initializer_list<Ball> balls, const Vec3& p) {
  double least = 1e9;
  for (const Ball& b : balls) least = std::min(least, (p - b.center_mm).norm() - b.radius_mm);
  return least;
}

}  // namespace

Mesh forearm(int faces) {
  constexpr double kLength_mm = 300.0, kBend_rad = 0.35, kHalfTurn_rad = 1.75;
  const int along = std::max(2, static_cast<int>(std::lround(std::sqrt(0.5 * faces * 60.0 / 32.0))));
  const int around = std::max(2, static_cast<int>(std::lround(0.5 * faces / along)));
  Mesh mesh;
  for (int a = 0; a <= along; ++a) {
    const double t = static_cast<double>(a) / along;
    const double bend = kBend_rad * t, radius = 62.0 - 20.0 * t, arc = kLength_mm / kBend_rad;
    const Vec3 axis(0.0, arc * (1.0 - std::cos(bend)), arc * std::sin(bend));
    const Vec3 side(1, 0, 0), up(0, std::cos(bend), -std::sin(bend));
    for (int r = 0; r <= around; ++r) {
      const double angle = kHalfTurn_rad * (2.0 * r / around - 1.0);
      mesh.vertices.push_back(axis + radius * (std::sin(angle) * side + std::cos(angle) * up));
    }
  }
  for (int a = 0; a < along; ++a) {
    for (int r = 0; r < around; ++r) {
      const int v = a * (around + 1) + r;
      mesh.faces.push_back({v, v + around + 1, v + 1});
      mesh.faces.push_back({v + 1, v + around + 1, v + around + 2});
    }
  }
  return mesh;
}

Sheet torso() {
  Sheet sheet;
  sheet.aspect = 1.9;
  sheet.place = [](double u, double v) {
    const double turn = 2.3 * (2.0 * u - 1.0), height = -0.55 + 1.75 * v;
    const double section = std::cos(height) * (1.0 - 0.03 * std::cos(4.0 * turn));
    Vec3 p(97.0 * section * std::sin(turn), -78.0 * section * std::cos(turn), 112.0 * std::sin(height));
    for (const double side : {-1.0, 1.0})
      p.y() -= 19.0 * std::exp(-(square(p.x() - side * 40.0) + square(p.z() - 38.0)) / (2.0 * square(17.0)));
    return p;
  };
  sheet.keep = [](const Vec3& p) {
    return outside_of({{Vec3(92, -4, 38), 28.0}, {Vec3(-92, -4, 38), 28.0}, {Vec3(0, -75, -25), 13.0}}, p);
  };
  return sheet;
}

Sheet hip() {
  Sheet sheet;
  sheet.aspect = 1.1;
  sheet.place = [](double u, double v) {
    const double x = 220.0 * (u - 0.5), turn = -1.5 + 3.1 * v;
    const double radius = 50.0 + 24.0 * square(std::sin(M_PI * x / 200.0));
    return Vec3(x, -1.1 * radius * std::cos(turn), radius * std::sin(turn) - 0.0008 * x * x);
  };
  sheet.keep = [](const Vec3& p) {
    return outside_of({{Vec3(82, -38, -82), 40.0}, {Vec3(-82, -38, -82), 40.0}, {Vec3(18, -52, 12), 9.0}}, p);
  };
  return sheet;
}

Sheet thigh() {
  constexpr double kLength_mm = 170.0, kBend_rad = 0.55;
  Sheet sheet;
  sheet.aspect = 1.7;
  sheet.closed = true;
  sheet.place = [](double u, double v) {
    const double turn = 2.0 * M_PI * u, bend = kBend_rad * v, arc = kLength_mm / kBend_rad;
    const double crest = 7.0 * std::exp((std::cos(turn) - 1.0) / square(0.2)) * std::sin(M_PI * std::min(1.0, 0.2 + v));
    const double profile =
        50.0 - 12.0 * v + 8.0 * std::sin(M_PI * v) + 11.0 * std::pow(v, 6.0) - 560.0 * std::max(0.0, v - 0.955);
    const double radius = profile * (1.0 + 0.08 * std::cos(2.0 * turn)) + crest;
    const Vec3 axis(0.0, arc * (1.0 - std::cos(bend)), arc * std::sin(bend));
    const Vec3 side(1, 0, 0), up(0, std::cos(bend), -std::sin(bend));
    return Vec3(axis + radius * (std::sin(turn) * side - std::cos(turn) * up));
  };
  sheet.keep = [](const Vec3& p) { return outside_of({{Vec3(48, 12, 95), 17.0}}, p); };
  return sheet;
}

}  // namespace triskin::mesh
