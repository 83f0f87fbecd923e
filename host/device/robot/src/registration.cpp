// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/registration.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ranges>
#include <string_view>

#include "triskin/base/error.hpp"

namespace triskin::robot {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::span<const Vector3d>;

constexpr double kBetter = 0.5;           // Another explanation must reduce the residual to at most this fraction.
constexpr double kExact_mm = 1.0;         // A touch is hardly more accurate than this.
constexpr double kMinWidth_mm = 1.0;      // The touches must spread this far across their longest line.
constexpr double kMinThickness_mm = 3.0;  // Touches are less accurate than this, so their mirror image looks the same.

Vector3d mean_of(Points points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// Returns the root mean square extents along the principal axes, largest first.
Vector3d extents_of(Points points) {
  const Vector3d mean = mean_of(points);
  Matrix3d spread = Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(spread / static_cast<double>(points.size()));
  return svd.singularValues().cwiseMax(0.0).cwiseSqrt();
}

void measure(Fit& fit, Points from, Points to) {
  double sum = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const double distance_mm = (fit.pose * from[k] - to[k]).norm();
    sum += distance_mm * distance_mm;
    if (distance_mm <= fit.max_mm) continue;
    fit.max_mm = distance_mm;
    fit.worst = static_cast<int>(k);
  }
  fit.rms_mm = std::sqrt(sum / static_cast<double>(from.size()));
}

// Returns nothing if the design lacks a module or taxel.
std::optional<std::vector<Vector3d>> places_of(const design::Design& design, std::span<const Touch> touches) {
  const auto wiring = design::wiring_of(design);
  std::vector<Vector3d> places;
  for (const Touch& t : touches) {
    const layout::ModuleId id = design::module_with(design, t.module);
    if (id < 0 || t.taxel < 0 || t.taxel >= layout::kTaxelsPerModule) return std::nullopt;
    const auto module = static_cast<std::size_t>(id);
    const auto taxels = design::taxels_of(design.layout.modules[module], wiring[module].routed.rotation);
    places.emplace_back(taxels[static_cast<std::size_t>(t.taxel)].position_mm);
  }
  return places;
}

void require_taxel(const NamedDesign& cover, const Touch& t) {
  if (design::module_with(*cover.design, t.module) < 0)
    throw InputError(fmt::format("{}: cover {} has no module {}; its modules are {}", t.place, cover.name, t.module,
                                 design::ranges_text(design::all_numbers(cover.design->layout))));
  if (t.taxel < 0 || t.taxel >= layout::kTaxelsPerModule)
    throw InputError(fmt::format("{}: module {} has no taxel {}; its taxels are 0 … {}", t.place, t.module, t.taxel,
                                 layout::kTaxelsPerModule - 1));
}

// Parses numbers such as "1.5,2"; returns false if their count is wrong or the text is not a number.
bool numbers_in(std::string_view line, std::array<double, 5>& numbers) {
  std::size_t n = 0;
  for (const auto part : std::views::split(line, ',')) {
    std::string_view field(part.begin(), part.end());
    while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
    while (!field.empty() && (field.back() == ' ' || field.back() == '\r')) field.remove_suffix(1);
    if (n == numbers.size()) return false;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), numbers[n]);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(numbers[n])) return false;
    ++n;
  }
  return n == numbers.size();
}

bool is_index(double x) {
  constexpr double kMaxNumber = 1e6;
  return x >= 0.0 && x <= kMaxNumber && x == std::floor(x);
}

}  // namespace

std::vector<Touch> read_touches(const std::string& text, const std::string& file) {
  std::vector<Touch> touches;
  int number = 0;
  for (const auto part : std::views::split(text, '\n')) {
    const std::string_view line(part.begin(), part.end());
    ++number;
    if (line.find_first_not_of(" \r") == std::string_view::npos || line.front() == '#') continue;
    if (touches.empty() && line.starts_with("module")) continue;
    std::array<double, 5> n{};
    if (!numbers_in(line, n) || !is_index(n[0]) || !is_index(n[1]))
      throw InputError(fmt::format("{}: line {}: must be module,taxel,x_mm,y_mm,z_mm", file, number));
    touches.push_back({design::ModuleNumber{static_cast<int>(n[0])},
                       layout::TaxelIndex{static_cast<int>(n[1])},
                       {n[2], n[3], n[4]},
                       fmt::format("{}: line {}", file, number)});
  }
  return touches;
}

Fit fit_pose(Points from, Points to, bool mirrored) {
  if (from.size() != to.size() || from.size() < 3) throw InputError("a pose needs three pairs of points or more");
  if (extents_of(from)[1] < kMinWidth_mm || extents_of(to)[1] < kMinWidth_mm)
    throw InputError("the touches lie on one line, which leaves the turn about it open; touch the cover all over");
  const Vector3d from_mean = mean_of(from), to_mean = mean_of(to);
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) covariance += (to[k] - to_mean) * (from[k] - from_mean).transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Vector3d diagonal(1.0, 1.0, mirrored ? -sign : sign);
  Fit fit;
  fit.pose.linear() = svd.matrixU() * diagonal.asDiagonal() * svd.matrixV().transpose();
  fit.pose.translation() = to_mean - fit.pose.linear() * from_mean;
  measure(fit, from, to);
  return fit;
}

Registration register_cover(const NamedDesign& cover, std::span<const NamedDesign> others,
                            std::span<const Touch> touches) {
  if (touches.size() < kMinTouches)
    throw InputError(fmt::format("cover {}: {} touches; {} or more are needed, spread over the cover", cover.name,
                                 touches.size(), kMinTouches));
  for (const Touch& t : touches) require_taxel(cover, t);
  const auto places = places_of(*cover.design, touches);
  std::vector<Vector3d> in_link;
  for (const Touch& t : touches) in_link.push_back(t.in_link_mm);
  Registration r;
  r.fit = fit_pose(*places, in_link);
  r.mirror_rms_mm = fit_pose(*places, in_link, true).rms_mm;
  r.thickness_mm = std::min(extents_of(*places)[2], extents_of(in_link)[2]);
  r.mirror_unknown = r.thickness_mm < kMinThickness_mm;
  if (r.fit.rms_mm < kExact_mm) return r;  // The fit is already so good that no other explanation is needed.
  double best_mm = kBetter * r.fit.rms_mm;
  r.mirrored = !r.mirror_unknown && r.mirror_rms_mm < best_mm;
  for (const NamedDesign& other : others) {
    const auto theirs = places_of(*other.design, touches);
    if (!theirs || extents_of(*theirs)[1] < kMinWidth_mm) continue;
    const double rms_mm = fit_pose(*theirs, in_link).rms_mm;
    if (rms_mm >= best_mm) continue;
    best_mm = rms_mm;
    r.exchanged_with = other.name;
    r.exchanged_rms_mm = rms_mm;
  }
  return r;
}

}  // namespace triskin::robot
