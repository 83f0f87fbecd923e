// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/part_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "triskin/base/markup.hpp"

namespace triskin::cad {
namespace {

using design::BrepFaceIndex;
using design::Vec2;
using design::Vec3;

constexpr double kWidth = 600.0, kGap = 20.0, kText = 16.0;
// Multiples of the golden angle keep the colours of faces far apart on the colour wheel.
constexpr double kGolden_deg = 137.508;

struct View {
  Vec3 right, up, toward;
};

View isometric(double side) {
  const Vec3 toward = side * Vec3(1.0, -1.0, 1.0).normalized();
  const Vec3 right = Vec3::UnitZ().cross(toward).normalized();
  return {right, toward.cross(right), toward};
}

std::string fill(BrepFaceIndex face, bool is_selected, double light) {
  const double hue = std::fmod(face * kGolden_deg, 360.0);
  const double brightness = 35.0 + 35.0 * light;
  return is_selected ? fmt::format("hsl({:.0f},65%,{:.0f}%)", hue, brightness)
                     : fmt::format("hsl(0,0%,{:.0f}%)", 45.0 + 40.0 * light);
}

class Drawing {
 public:
  Drawing(const Part& part, const std::vector<BrepFaceIndex>& selected)
      : part_(part), is_selected_(part.faces.size(), selected.empty()) {
    for (const BrepFaceIndex f : selected) is_selected_.at(static_cast<std::size_t>(f)) = true;
    Vec3 low = part.mesh.vertices.front(), high = low;
    for (const Vec3& v : part.mesh.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    middle_ = 0.5 * (low + high);
    scale_ = kWidth / std::max(1e-9, (high - low).norm());
  }

  std::string view(const View& v, double left) {
    view_ = v;
    left_ = left;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t t = 0; t < part_.mesh.faces.size(); ++t) {
      if (normal(t).dot(v.toward) > 0.0) order.emplace_back(centre(t).dot(v.toward), t);
    }
    std::ranges::sort(order);
    std::string out;
    for (const auto& [depth, t] : order) out += triangle(t);
    for (std::size_t f = 0; f < part_.faces.size(); ++f) out += label(f);
    return out;
  }

 private:
  [[nodiscard]] const Vec3& at(std::size_t t, std::size_t k) const {
    return part_.mesh.vertices[static_cast<std::size_t>(part_.mesh.faces[t][k])];
  }
  [[nodiscard]] Vec3 centre(std::size_t t) const { return (at(t, 0) + at(t, 1) + at(t, 2)) / 3.0; }
  [[nodiscard]] Vec3 normal(std::size_t t) const {
    return (at(t, 1) - at(t, 0)).cross(at(t, 2) - at(t, 0)).normalized();
  }
  [[nodiscard]] Vec2 flat(const Vec3& p) const {
    const Vec3 d = scale_ * (p - middle_);
    return {left_ + 0.5 * kWidth + d.dot(view_.right), kGap + 0.5 * kWidth - d.dot(view_.up)};
  }
  [[nodiscard]] std::string triangle(std::size_t t) const {
    const BrepFaceIndex face = part_.face_of_triangle[t];
    const Vec2 a = flat(at(t, 0)), b = flat(at(t, 1)), c = flat(at(t, 2));
    const std::string colour = fill(face, is_selected_[static_cast<std::size_t>(face)], normal(t).dot(view_.toward));
    // A thin line of the same colour closes the seams that renderers leave between triangles.
    return fmt::format(
        "<path d='M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z' fill='{}' stroke='{}' stroke-width='.4'/>\n", a.x(),
        a.y(), b.x(), b.y(), c.x(), c.y(), colour, colour);
  }
  [[nodiscard]] std::string label(std::size_t f) const {
    const Face& face = part_.faces[f];
    if (!is_selected_[f] || face.normal.dot(view_.toward) <= 0.1) return {};
    const Vec2 p = flat(face.place_mm);
    return fmt::format("<text x='{:.1f}' y='{:.1f}' font-size='10' text-anchor='middle'>{}</text>\n", p.x(), p.y(), f);
  }

  const Part& part_;
  std::vector<bool> is_selected_;
  Vec3 middle_ = Vec3::Zero();
  double scale_ = 1.0, left_ = 0.0;
  View view_{};
};

}  // namespace

std::string part_svg(const Part& part, const std::vector<BrepFaceIndex>& selected) {
  const double width = 2.0 * kWidth + 3.0 * kGap, height = kWidth + 2.0 * kGap + 2.0 * kText;
  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' "
      "font-family='sans-serif'>\n<rect width='100%' height='100%' fill='white'/>\n",
      width, height);
  if (!part.mesh.vertices.empty()) {
    Drawing drawing(part, selected);
    out += drawing.view(isometric(1.0), kGap) + drawing.view(isometric(-1.0), 2.0 * kGap + kWidth);
  }
  const Vec3 size = size_of(part);
  out += fmt::format(
      "<text x='{}' y='{}' font-size='13'>{}: {} faces, {:.1f} × {:.1f} × {:.1f} mm; "
      "numbers: index of the face; left "
      "from (1, −1, 1), right from (−1, 1, −1)</text>\n</svg>\n",
      kGap, height - kText, part.bodies.empty() ? std::string() : escape_markup(part.bodies.front().name),
      part.faces.size(), size.x(), size.y(), size.z());
  return out;
}

}  // namespace triskin::cad
