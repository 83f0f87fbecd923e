// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper/grid_frame.hpp"

#include <cmath>
#include <stdexcept>

namespace triskin::placement::paper {
namespace {

// Returns the nearest whole number; |x| must be far below 2^51.
double nearest(double x) {
  constexpr double kShift = 0x1.8p52;
  return (x + kShift) - kShift;
}

double to_v(const Vec2& p) {
  return p.y() / kHeight_mm;
}
double to_u(const Vec2& p) {
  return p.x() / kSide_mm - 0.5 * to_v(p);
}

}  // namespace

Placement without_pivot(const Polygon& polygon, const PivotedPlacement& at) {
  if (at.vertex < 0) return {at.x_mm, at.y_mm, at.theta_rad};
  const Vec2& pivot = polygon.outer.at(static_cast<std::size_t>(at.vertex));
  const Vec2 turned = Eigen::Rotation2Dd(at.theta_rad) * pivot;
  return {at.x_mm + pivot.x() - turned.x(), at.y_mm + pivot.y() - turned.y(), at.theta_rad};
}

GridFrame::GridFrame(const Polygon& polygon, double touch_mm) : first_(polygon.outer.front()), touch_mm_(touch_mm) {
  const auto add = [&](const std::vector<Vec2>& ring) {
    begin_.push_back(vertices_.size());
    for (const Vec2& p : ring) vertices_.emplace_back(p - first_);
  };
  add(polygon.outer);
  for (const auto& hole : polygon.holes) add(hole);
  begin_.push_back(vertices_.size());
  const std::size_t n = vertices_.size();
  for (auto* values : {&turned_u_, &turned_v_, &u_, &v_}) values->resize(n);
  for (std::size_t d = 0; d < kDirections; ++d) {
    across_[d].resize(n);
    along_[d].resize(n);
  }
}

void GridFrame::turn(double theta) {
  if (turned_ && theta == theta_) return;
  const double c = std::cos(theta), s = std::sin(theta);
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const Vec2& p = vertices_[k];
    const Vec2 q(c * p.x() - s * p.y(), s * p.x() + c * p.y());
    turned_u_[k] = to_u(q);
    turned_v_[k] = to_v(q);
  }
  turned_ = true;
  theta_ = theta;
}

void GridFrame::move(const PivotedPlacement& at) {
  turn(at.theta_rad);
  double shift_u = 0.0, shift_v = 0.0;
  if (at.vertex < 0) {
    const Vec2 origin = Vec2(at.x_mm, at.y_mm) + Eigen::Rotation2Dd(at.theta_rad) * first_;
    shift_u = to_u(origin);
    shift_v = to_v(origin);
  } else {
    const auto pivot = static_cast<std::size_t>(at.vertex);
    if (pivot >= begin_[1]) throw std::out_of_range("placement: its pivot is no vertex of the outer ring");
    const Vec2 target = first_ + vertices_[pivot] + Vec2(at.x_mm, at.y_mm);
    shift_u = to_u(target) - turned_u_[pivot];
    shift_v = to_v(target) - turned_v_[pivot];
  }
  const double touch = touch_across();
  const auto laid = [touch](double x) {
    const double line = nearest(x);
    return std::abs(x - line) <= touch ? line : x;
  };
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const double u = turned_u_[k] + shift_u, v = turned_v_[k] + shift_v;
    u_[k] = u;
    v_[k] = v;
    across_[0][k] = along_[1][k] = along_[2][k] = laid(v);
    across_[1][k] = along_[0][k] = laid(u);
    across_[2][k] = laid(u + v);
  }
}

}  // namespace triskin::placement::paper
