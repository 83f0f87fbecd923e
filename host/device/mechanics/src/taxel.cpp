// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/taxel.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "quadrature.hpp"

namespace triskin::mechanics {
namespace {

constexpr int kNodesPerInterval = 24;

using Profile = std::function<double(double)>;

// Integrates `integrand` from `from` to `to`, which may bend like a square root at each of `bends`.
double integral(double from, double to, std::vector<double> bends, const Profile& integrand) {
  std::erase_if(bends, [&](double b) { return b <= from || b >= to; });
  bends.push_back(from);
  bends.push_back(to);
  std::sort(bends.begin(), bends.end());
  double sum = 0.0;
  for (std::size_t k = 1; k < bends.size(); ++k) {
    const Quadrature rule = square_root_rule(kNodesPerInterval, bends[k - 1], bends[k]);
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) sum += rule.weights[i] * integrand(rule.nodes[i]);
  }
  return sum;
}

// Returns half of the angle over which the circle of radius r about the axis lies in the disc.
double half_angle(double r, double distance, double disc_radius) {
  if (r <= disc_radius - distance) return std::numbers::pi;
  const double cosine = (r * r + distance * distance - disc_radius * disc_radius) / (2.0 * r * distance);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

double disc_mean(const Contact& contact, double distance, double disc_radius, const Profile& value) {
  const double area = std::numbers::pi * disc_radius * disc_radius;
  if (contact.is_line) {
    const auto integrand = [&](double x) {
      const double s = x - distance;
      return 2.0 * std::sqrt(std::max(0.0, disc_radius * disc_radius - s * s)) * value(std::abs(x));
    };
    const double edge = contact.contact_radius_mm;
    return integral(distance - disc_radius, distance + disc_radius, {-edge, edge}, integrand) / area;
  }
  const auto integrand = [&](double r) { return 2.0 * r * half_angle(r, distance, disc_radius) * value(r); };
  const double inner = distance < disc_radius ? 0.0 : distance - disc_radius;
  return integral(inner, distance + disc_radius, {disc_radius - distance, contact.contact_radius_mm}, integrand) / area;
}

}  // namespace

double taxel_dc_over_c(const Layer& layer, const Contact& contact, double distance_mm, double disc_diameter_mm) {
  const double h = layer.thickness_mm;
  return disc_mean(contact, distance_mm, disc_diameter_mm / 2.0, [&](double r) {
    const double u = contact.field->displacement_mm(r);
    return u / (h - u);
  });
}

double taxel_displacement_mm(const Contact& contact, double distance_mm, double disc_diameter_mm) {
  return disc_mean(contact, distance_mm, disc_diameter_mm / 2.0,
                   [&](double r) { return contact.field->displacement_mm(r); });
}

}  // namespace triskin::mechanics
