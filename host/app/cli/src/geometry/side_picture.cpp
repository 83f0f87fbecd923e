// SPDX-License-Identifier: GPL-3.0-or-later
#include "side_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace triskin::cli {
namespace {

using design::FaceIndex;
using design::Mesh;
using design::Vec3;
using mesh::FaceSide;
using mesh::SideChoice;

constexpr int kView_px = 420;
constexpr double kFill = 0.47;     // The part's farthest corner lies at this fraction of a view from its middle.
constexpr double kTilt_rad = 0.6;  // A view along the normal would hide the side walls.

struct Colour {
  int red, green, blue;
};

Colour colour_of(const SideChoice& choice, FaceIndex face) {
  switch (choice.side_of(face)) {
    case FaceSide::kOuter:
      return {70, 185, 90};
    case FaceSide::kInner:
      return {210, 80, 75};
    case FaceSide::kRim:
      return {165, 165, 165};
    case FaceSide::kUndecided:
      break;
  }
  return choice.choice_of_face[static_cast<std::size_t>(face)] == 2 ? Colour{70, 120, 225} : Colour{240, 165, 40};
}

std::array<const Vec3*, 3> corners_of(const Mesh& mesh, std::size_t face) {
  const auto& f = mesh.faces[face];
  const auto corner = [&](std::size_t k) { return &mesh.vertices[static_cast<std::size_t>(f[k])]; };
  return {corner(0), corner(1), corner(2)};
}

Vec3 cross_of(const Mesh& mesh, std::size_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  return (*b - *a).cross(*c - *a);
}

/// A view has screen coordinates in pixels and a depth towards the viewer.
class View {
 public:
  View(const Mesh& mesh, const Vec3& toward_viewer)
      : mesh_(mesh), z_(toward_viewer.normalized()), x_(z_.unitOrthogonal()), y_(z_.cross(x_)) {
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    middle_ = 0.5 * (low + high);
    scale_ = kFill * kView_px / std::max(1e-9, 0.5 * (high - low).norm());
  }

  [[nodiscard]] Vec3 on_screen(const Vec3& p) const {
    const Vec3 d = scale_ * (p - middle_);
    return {0.5 * kView_px + d.dot(x_), 0.5 * kView_px - d.dot(y_), d.dot(z_)};
  }
  [[nodiscard]] double facing(std::size_t face) const { return cross_of(mesh_, face).normalized().dot(z_); }

  /// Returns the front face at each pixel, or −1.
  [[nodiscard]] std::vector<FaceIndex> front_faces() const {
    std::vector<FaceIndex> front(kView_px * kView_px, FaceIndex::none());
    std::vector<double> depth(front.size(), -1e300);
    for (std::size_t f = 0; f < mesh_.faces.size(); ++f) draw(f, front, depth);
    return front;
  }

 private:
  void draw(std::size_t face, std::vector<FaceIndex>& front, std::vector<double>& depth) const {
    const auto c = corners_of(mesh_, face);
    const Vec3 a = on_screen(*c[0]), u = on_screen(*c[1]) - a, v = on_screen(*c[2]) - a;
    const double det = u.x() * v.y() - u.y() * v.x();
    if (std::abs(det) < 1e-9) return;
    const auto range = [&](int axis) {
      const double low = a[axis] + std::min({0.0, u[axis], v[axis]}),
                   high = a[axis] + std::max({0.0, u[axis], v[axis]});
      return std::array{std::max(0, static_cast<int>(std::floor(low))),
                        std::min(kView_px - 1, static_cast<int>(std::ceil(high)))};
    };
    const auto columns = range(0), rows = range(1);
    for (int row = rows[0]; row <= rows[1]; ++row) {
      for (int column = columns[0]; column <= columns[1]; ++column) {
        const double px = column - a.x(), py = row - a.y();
        const double s = (px * v.y() - py * v.x()) / det, t = (u.x() * py - u.y() * px) / det;
        if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
        const double z = a.z() + s * u.z() + t * v.z();
        const auto pixel = static_cast<std::size_t>(row * kView_px + column);
        if (z <= depth[pixel]) continue;
        depth[pixel] = z;
        front[pixel] = FaceIndex(face);
      }
    }
  }

  const Mesh& mesh_;
  Vec3 z_, x_, y_, middle_;
  double scale_ = 1.0;
};

std::string face_svg(const Mesh& part, const View& view, FaceIndex face, const Colour& c) {
  const double light = 0.35 + 0.65 * std::abs(view.facing(static_cast<std::size_t>(face)));
  const auto shade = [&](int value) { return static_cast<int>(light * value); };
  std::string points;
  for (const Vec3* p : corners_of(part, static_cast<std::size_t>(face))) {
    const Vec3 s = view.on_screen(*p);
    points += fmt::format("{:.1f},{:.1f} ", s.x(), s.y());
  }
  const std::string fill = fmt::format("#{:02x}{:02x}{:02x}", shade(c.red), shade(c.green), shade(c.blue));
  return fmt::format("<polygon points='{0}' fill='{1}' stroke='{1}' stroke-width='0.4'/>\n", points, fill);
}

// Draws the faces that nothing hides, far ones first.
std::string faces_svg(const Mesh& part, const SideChoice& choice, const View& view, std::vector<FaceIndex> shown) {
  std::ranges::sort(shown);
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  std::erase(shown, FaceIndex::none());
  const auto depth = [&](FaceIndex f) {
    const auto c = corners_of(part, static_cast<std::size_t>(f));
    return view.on_screen((*c[0] + *c[1] + *c[2]) / 3.0).z();
  };
  std::ranges::sort(shown, {}, depth);
  std::string out;
  for (const FaceIndex f : shown) out += face_svg(part, view, f, colour_of(choice, f));
  return out;
}

// Puts each number at the pixel of the choice that is nearest to the middle of its pixels.
// Returns column and row of each pixel that shows a face of choice `number`.
std::vector<std::array<int, 2>> pixels_of(int number, const SideChoice& choice, const std::vector<FaceIndex>& front) {
  std::vector<std::array<int, 2>> pixels;
  for (std::size_t k = 0; k < front.size(); ++k) {
    if (front[k] >= 0 && choice.choice_of_face[static_cast<std::size_t>(front[k])] == number)
      pixels.push_back({static_cast<int>(k) % kView_px, static_cast<int>(k) / kView_px});
  }
  return pixels;
}

std::string numbers_svg(const SideChoice& choice, const std::vector<FaceIndex>& front) {
  std::string out;
  for (const int number : {1, 2}) {
    const std::vector<std::array<int, 2>> pixels = pixels_of(number, choice, front);
    if (pixels.size() < 400) continue;  // A number would hide such a small area.
    double x = 0.0, y = 0.0;
    for (const auto& p : pixels) {
      x += p[0] / static_cast<double>(pixels.size());
      y += p[1] / static_cast<double>(pixels.size());
    }
    const auto at =
        *std::ranges::min_element(pixels, {}, [&](const auto& p) { return std::hypot(p[0] - x, p[1] - y); });
    out += fmt::format(
        "<text x='{}' y='{}' font-family='sans-serif' font-size='44' font-weight='bold' text-anchor='middle' "
        "stroke='white' stroke-width='6' paint-order='stroke'>{}</text>\n",
        at[0], at[1] + 15, number);
  }
  return out;
}

// Returns the direction of the chosen side, or of choice 1.
Vec3 outward_of(const Mesh& part, const SideChoice& choice) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const FaceSide side = choice.side_of(FaceIndex(f));
    if (side == FaceSide::kOuter || (side == FaceSide::kUndecided && choice.choice_of_face[f] == 1))
      sum += cross_of(part, f);
  }
  return sum.norm() > 1e-6 ? Vec3(sum.normalized()) : Vec3(0.0, 0.0, 1.0);
}

}  // namespace

std::string side_svg(const design::Mesh& part, const mesh::SideChoice& choice) {
  const Vec3 out = outward_of(part, choice), across = out.unitOrthogonal();
  const Vec3 tilt = std::tan(kTilt_rad) * across, turn = std::tan(kTilt_rad) * out.cross(across);
  const std::array<Vec3, 4> from{out + tilt + turn, out - tilt - turn, -out + tilt + turn, -out - tilt - turn};
  std::string body;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const View view(part, from[k]);
    const std::vector<FaceIndex> front = view.front_faces();
    body += fmt::format("<g transform='translate({} {})'>\n{}{}</g>\n", k % 2 * kView_px, k / 2 * kView_px,
                        faces_svg(part, choice, view, front), numbers_svg(choice, front));
  }
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}'>\n"
      "<rect width='100%' height='100%' fill='white'/>\n{2}"
      "<text x='10' y='{3}' font-family='sans-serif' font-size='15'>green: outer side; red: inner side; grey: rims; "
      "orange 1, blue 2: undecided (--side 1 or --side 2)</text>\n</svg>\n",
      2 * kView_px, 2 * kView_px + 30, body, 2 * kView_px + 18);
}

}  // namespace triskin::cli
