// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::exports {

/// The view is a parallel projection of a design, by default from the side that shows most of its modules.
class View {
 public:
  explicit View(const design::Design& design) {
    design::Vec3 normal(0, 0, 0);
    for (const auto& m : design.layout.modules)
      normal += (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
    toward_ = normal.norm() > 1e-6 ? design::Vec3(normal.normalized()) : design::Vec3(0, 0, 1);
    const design::Vec3 up = std::abs(toward_.z()) < 0.9 ? design::Vec3(0, 0, 1) : design::Vec3(0, 1, 0);
    right_ = up.cross(toward_).normalized();
    up_ = toward_.cross(right_);
    frame(design);
  }
  /// The six sides: this one, the three that follow when the part is turned about the upright, then from above and
  /// below.
  [[nodiscard]] std::vector<View> sides(const design::Design& design) const {
    return {*this,
            View(design, right_, up_),
            View(design, -toward_, up_),
            View(design, -right_, up_),
            View(design, up_, -toward_),
            View(design, -up_, toward_)};
  }
  [[nodiscard]] design::Vec2 flat(const design::Vec3& p) const { return {right_.dot(p), -up_.dot(p)}; }
  [[nodiscard]] double height(const design::Vec3& p) const { return toward_.dot(p); }
  [[nodiscard]] const design::Vec3& toward() const { return toward_; }
  [[nodiscard]] const Eigen::AlignedBox2d& box() const { return box_; }

 private:
  View(const design::Design& design, const design::Vec3& toward, const design::Vec3& up)
      : toward_(toward), right_(up.cross(toward)), up_(up) {
    frame(design);
  }
  void frame(const design::Design& design) {
    for (const design::Vec3& v : design.surface.vertices) box_.extend(flat(v));
  }

  design::Vec3 toward_, right_, up_;
  Eigen::AlignedBox2d box_;
};

/// The picture consists of such shapes; higher ones are drawn on top.
struct Shape {
  double height;
  std::string svg;
};

inline std::string polygon(const View& view, std::span<const design::Vec3> p, const std::string& style) {
  std::string points;
  for (const design::Vec3& v : p) {
    const design::Vec2 q = view.flat(v);
    points += fmt::format("{:.2f},{:.2f} ", q.x(), q.y());
  }
  return fmt::format("<polygon points=\"{}\" {}/>\n", points, style);
}

/// Adds the triangles of the surface, below everything else.
inline void add_surface(const design::Design& d, const View& view, std::vector<Shape>& shapes) {
  for (const auto& f : d.surface.faces) {
    const std::array p{d.surface.vertices[static_cast<std::size_t>(f[0])],
                       d.surface.vertices[static_cast<std::size_t>(f[1])],
                       d.surface.vertices[static_cast<std::size_t>(f[2])]};
    const double facing = (p[1] - p[0]).cross(p[2] - p[0]).normalized().dot(view.toward());
    const int grey = static_cast<int>(150 + 90 * std::abs(facing));
    shapes.push_back(
        {view.height((p[0] + p[1] + p[2]) / 3.0) - 1e6,  // The offset puts the whole surface below any module.
         polygon(view, p,
                 fmt::format("fill=\"rgb({0},{0},{0})\" stroke=\"rgb({0},{0},{0})\" stroke-width=\"0.4\"", grey))});
  }
}

/// Begins the picture with a white background.
inline std::string svg_head(const design::Vec2& low, const design::Vec2& size) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.1f} {:.1f} {:.1f} {:.1f}\" width=\"{:.0f}\">\n<rect "
      "x=\"{:.1f}\" y=\"{:.1f}\" "
      "width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      low.x(), low.y(), size.x(), size.y(), 3 * size.x(), low.x(), low.y());
}

}  // namespace triskin::exports
