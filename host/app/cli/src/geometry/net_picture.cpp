// SPDX-License-Identifier: GPL-3.0-or-later
#include "net_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "triskin/design/tile.hpp"

namespace triskin::cli {
namespace {

using design::Vec2;

constexpr double kGap_mm = 15.0, kRow_mm = 700.0;

double error_of(const mesh::Surface& surface, design::FaceIndex face, const std::array<Vec2, 3>& flat) {
  const auto& corners = surface.mesh().faces[static_cast<std::size_t>(face)];
  double worst = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &a = surface.mesh().vertices[static_cast<std::size_t>(corners[k])],
               &b = surface.mesh().vertices[static_cast<std::size_t>(corners[(k + 1) % 3])];
    const double length = (b - a).norm();
    worst = std::max(worst, std::abs((flat[(k + 1) % 3] - flat[k]).norm() - length) / length * design::kSide_mm);
  }
  return worst;
}

template <class Points>
std::string points_text(const Points& points, const Vec2& shift) {
  std::string text;
  for (const Vec2& p : points) text += fmt::format("{:.2f},{:.2f} ", p.x() + shift.x(), shift.y() - p.y());
  return text;
}

std::string piece_svg(const mesh::Surface& surface, const design::Piece& piece, const Vec2& shift, double limit_mm) {
  std::string out;
  for (std::size_t k = 0; k < piece.flat.size(); ++k) {
    const double share = std::min(1.0, error_of(surface, piece.faces[k], piece.flat[k]) / limit_mm);
    const int fade = static_cast<int>(std::lround(255 * (1 - 0.85 * share)));
    out += fmt::format("<polygon points='{0}' fill='rgb(255,{1},{1})' stroke='#999' stroke-width='0.2'/>\n",
                       points_text(piece.flat[k], shift), fade);
  }
  out += fmt::format("<polygon points='{}' fill='none' stroke='black' stroke-width='0.8'/>\n",
                     points_text(piece.outline.outer, shift));
  for (const auto& hole : piece.outline.holes) {
    out +=
        fmt::format("<polygon points='{}' fill='none' stroke='black' stroke-width='0.8'/>\n", points_text(hole, shift));
  }
  return out;
}

Eigen::AlignedBox2d box_of(const design::Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const Vec2& p : polygon.outer) box.extend(p);
  return box;
}

}  // namespace

std::string net_svg(const mesh::Surface& surface, const unfolding::Net& net, double limit_mm) {
  std::string body;
  double x = kGap_mm, y = kGap_mm, row = 0.0, width = 140.0;
  for (const design::Piece& piece : net.pieces) {
    const Eigen::AlignedBox2d box = box_of(piece.outline);
    const Vec2 &low = box.min(), &high = box.max();
    if (x > kGap_mm && x + high.x() - low.x() > kRow_mm) {
      x = kGap_mm;
      y += row + kGap_mm;
      row = 0.0;
    }
    body += piece_svg(surface, piece, {x - low.x(), y + high.y()}, limit_mm);
    x += high.x() - low.x() + kGap_mm;
    row = std::max(row, high.y() - low.y());
    width = std::max(width, x);
  }
  const double bar = y + row + kGap_mm, height = bar + kGap_mm;
  body += fmt::format(
      "<path d='M {0} {1} h 100' stroke='black' stroke-width='1.5'/><text x='{2}' y='{3}' font-family='sans-serif' "
      "font-size='9'>"
      "100 mm; red: edge error of {4} mm on 30 mm</text>\n",
      kGap_mm, bar, kGap_mm + 106, bar + 3, limit_mm);
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:.1f} {1:.1f}' width='{0:.1f}mm' height='{1:.1f}mm'>\n"
      "<rect width='100%' height='100%' fill='white'/>\n{2}</svg>\n",
      std::max(width, 340.0), height, body);
}

}  // namespace triskin::cli
