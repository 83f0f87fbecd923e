// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "drawing.hpp"
#include "module_geometry.hpp"
#include "triskin/design/fold.hpp"
#include "triskin/design/module_side.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::sheet {
namespace {

using design::Vec3;

// An orthographic view of the part; z of a flat point rises towards the viewer.
struct View {
  const char* name;
  Vec3 toward, up;
  Vec2 origin_mm{0, 0};
  double scale = 1.0;
  [[nodiscard]] Vec3 right() const { return up.cross(toward); }
  [[nodiscard]] Vec2 turned(const Vec3& p) const { return {right().dot(p), -up.dot(p)}; }
  [[nodiscard]] Vec2 flat(const Vec3& p) const { return origin_mm + scale * turned(p); }
};

const std::array<View, 6> kViews{{{"from +x (y to the right, z up)", {1, 0, 0}, {0, 0, 1}},
                                  {"from −x (y to the left, z up)", {-1, 0, 0}, {0, 0, 1}},
                                  {"from +y (x to the left, z up)", {0, 1, 0}, {0, 0, 1}},
                                  {"from −y (x to the right, z up)", {0, -1, 0}, {0, 0, 1}},
                                  {"from +z (x to the right, y up)", {0, 0, 1}, {0, 1, 0}},
                                  {"from −z (x to the left, y up)", {0, 0, -1}, {0, 1, 0}}}};

struct Shape {
  double height;
  std::vector<Vec2> points;
  Color color;
};

using design::normal_of;

// A mesh with more faces is drawn as a picture: the generated forearm, six times 3,840 faces, was 4.5 MB of SVG, 0.2 kB
// per face. At six dots per mm the eye sees no dots at arm's length.
constexpr std::size_t kMaxDrawnFaces = 1000;
constexpr double kDotsPerMm = 6.0;

void draw_surface(const Drawing& d, const View& view) {
  std::vector<Shape> shapes;
  for (const auto& f : d.design.surface.faces) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = d.design.surface.vertices.at(static_cast<std::size_t>(f[k]));
    const double facing = normal_of(p).dot(view.toward);
    const double grey = facing > 0 ? 0.72 + 0.2 * facing : 0.5;  // The inside of the surface is darker.
    shapes.push_back(
        {view.toward.dot(p[0] + p[1] + p[2]), {view.flat(p[0]), view.flat(p[1]), view.flat(p[2])}, {grey, grey, grey}});
  }
  std::ranges::stable_sort(shapes, {}, &Shape::height);
  const bool as_picture = shapes.size() > kMaxDrawnFaces;
  if (as_picture) {
    Eigen::AlignedBox2d box;
    for (const Shape& s : shapes) {
      for (const Vec2& p : s.points) box.extend(p);
    }
    d.canvas.begin_raster(box.min(), box.sizes(), kDotsPerMm);
  }
  for (const Shape& s : shapes) d.canvas.fill_tight(s.points, s.color);
  if (as_picture) d.canvas.end_raster();
}

// Draws modules that show their front; returns the centres of those of each island.
std::map<int, std::vector<Vec2>> draw_modules(const Drawing& d, const View& view) {
  std::vector<Shape> shapes;
  std::map<int, std::vector<Vec2>> islands;
  const auto& layout = d.design.layout;
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    const auto& m = layout.modules[k];
    const double facing = normal_of(m.corner_mm).dot(view.toward);
    if (facing < 0.05) continue;
    Shape shape{view.toward.dot(center_of(m)), {}, color_of(d.plan.wiring[k].patch, 0.55 + 0.2 * facing)};
    const design::Outline outline = design::outline_of(m.corner_mm, layout.corner_cut_mm);
    for (const Vec3& p : outline.points()) shape.points.push_back(view.flat(p));
    shapes.push_back(std::move(shape));
    islands[m.island].push_back(view.flat(center_of(m)));
  }
  std::ranges::stable_sort(shapes, {}, &Shape::height);
  for (const Shape& s : shapes) {
    d.canvas.fill(s.points, s.color);
    d.canvas.outline(s.points, {0.1, kWhite, 0.0});
  }
  return islands;
}

// Returns the point nearest to the mean, because the mean itself may lie beside the island.
Vec2 middle_of_points(const std::vector<Vec2>& points) {
  Vec2 mean(0, 0);
  for (const Vec2& p : points) mean += p / static_cast<double>(points.size());
  return *std::ranges::min_element(points, {}, [&](const Vec2& p) { return (p - mean).norm(); });
}

void draw_badge(Canvas& canvas, const Vec2& at, const std::string& text, const Color& color) {
  const double half_mm = 1.1 + 0.9 * static_cast<double>(text.size());
  canvas.fill_rectangle(at - Vec2(half_mm, 2.1), {2.0 * half_mm, 4.2}, kWhite);
  canvas.rectangle(at - Vec2(half_mm, 2.1), {2.0 * half_mm, 4.2}, {0.2, color, 0.0});
  canvas.text(at + Vec2(0, 1.1), text, {.size_mm = 3.0, .bold = true, .align = 0.5, .color = color});
}

// Returns how much of each island a view shows: the sum of its modules, each weighted by how far it faces the viewer.
std::map<int, double> shown_of(const design::Design& design, const Vec3& toward) {
  std::map<int, double> shown;
  for (const auto& m : design.layout.modules) shown[m.island] += std::max(0.0, normal_of(m.corner_mm).dot(toward));
  return shown;
}

// Returns for each island the most that any view shows of it.
std::map<int, double> best_shown(const design::Design& design) {
  std::map<int, double> best;
  for (const View& view : kViews) {
    for (const auto& [island, shown] : shown_of(design, view.toward)) best[island] = std::max(best[island], shown);
  }
  return best;
}

// An island seen from the side gets its number only in the views that show it better; otherwise the numbers of islands
// around a corner would overlap.
void draw_island_numbers(const Drawing& d, const View& view, const std::map<int, std::vector<Vec2>>& centers) {
  constexpr double kWellShown = 0.5;
  const auto best = best_shown(d.design);
  const auto shown = shown_of(d.design, view.toward);
  for (const auto& [island, points] : centers) {
    if (shown.at(island) >= kWellShown * best.at(island))
      draw_badge(d.canvas, middle_of_points(points), std::to_string(island), kBlack);
  }
}

// Each view that an entry faces names it; of six views along the axes at least one has a cosine of 1/√3 or more.
void draw_entries(const Drawing& d, const View& view) {
  constexpr double kFacing = 0.4;
  for (const layout::PatchIndex p : design::patches_of(d.design)) {
    const auto entry = static_cast<std::size_t>(d.design.patches[static_cast<std::size_t>(p)].entry);
    const auto& m = d.design.layout.modules.at(entry);
    if (normal_of(m.corner_mm).dot(view.toward) < kFacing) continue;
    const int rotation = d.plan.wiring[entry].routed.rotation;
    const Vec2 at = view.flat(design::middle_of_side(m, rotation));
    d.canvas.fill_circle(at, 0.9, kBlue);
    d.canvas.text(at + Vec2(1.1, -0.6), fmt::format("C{}", p), {.size_mm = 2.4, .bold = true, .color = kBlue});
  }
}

// A landmark is drawn in the views that show it best: those whose direction it is far along.
void draw_landmarks(const Drawing& d, const View& view, double middle_height) {
  for (const Landmark& l : d.plan.landmarks) {
    if (view.toward.dot(l.at_mm) < middle_height - 1e-6) continue;
    draw_landmark(d.canvas, view.flat(l.at_mm), l.name);
  }
}

std::vector<Vec3> points_of(const design::Design& design) {
  std::vector<Vec3> points = design.surface.vertices;
  for (const auto& m : design.layout.modules) points.insert(points.end(), m.corner_mm.begin(), m.corner_mm.end());
  return points;
}

// Returns 1:1, 1:1.25, 1:1.6, 1:2, 1:2.5, 1:4, 1:5, 1:6, 1:8 or these times ten: scales that are easy to calculate
// with.
double round_scale(double most) {
  for (double ten = 1.0; ten < 1e6; ten *= 10.0) {
    for (const double by : {1.0, 1.25, 1.6, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
      if (1.0 / (by * ten) <= most) return 1.0 / (by * ten);
    }
  }
  return most;
}

}  // namespace

void draw_overview(const Drawing& d) {
  const auto points = points_of(d.design);
  const Vec2 cell((d.page.size_mm.x() - 2.0 * kMargin_mm) / 2.0,
                  (d.page.size_mm.y() - 2.0 * kMargin_mm - kHead_mm - kFoot_mm) / 3.0);
  double most = 1.0;
  std::array<Eigen::AlignedBox2d, 6> boxes;
  for (std::size_t v = 0; v < kViews.size(); ++v) {
    for (const Vec3& p : points) boxes[v].extend(kViews[v].turned(p));
    const Vec2 room = cell - Vec2(12, 16);
    most = std::min(most, (room.cwiseQuotient(boxes[v].sizes().cwiseMax(1.0))).minCoeff());
  }
  const double scale = round_scale(most);
  const char landmark = d.plan.landmarks.empty() ? 'R' : d.plan.landmarks.front().name.front();
  d.canvas.text({kMargin_mm, kMargin_mm + 16.0},
                fmt::format("Scale 1:{:g}. Boxed numbers are islands, C0, C1, … entries of the controllers, red "
                            "crosses {}1, {}2, … landmarks.",
                            1.0 / scale, landmark, landmark),
                {.size_mm = 2.6});
  d.canvas.text({kMargin_mm, kMargin_mm + 20.0}, "A colour is a controller. x, y and z are the axes of the mesh.",
                {.size_mm = 2.6});
  for (std::size_t v = 0; v < kViews.size(); ++v) {
    View view = kViews[v];
    const Vec2 corner(kMargin_mm + cell.x() * static_cast<double>(v % 2),
                      kMargin_mm + kHead_mm + cell.y() * static_cast<double>(v / 2));
    view.scale = scale;
    view.origin_mm = corner + Vec2(cell.x() / 2.0, cell.y() / 2.0 + 3.0) - scale * boxes[v].center();
    d.canvas.text(corner + Vec2(2, 5), view.name, {.size_mm = 3.0, .bold = true});
    draw_surface(d, view);
    const auto islands = draw_modules(d, view);
    double low = 1e300, high = -1e300;
    for (const Vec3& p : points) {
      low = std::min(low, view.toward.dot(p));
      high = std::max(high, view.toward.dot(p));
    }
    draw_landmarks(d, view, (low + high) / 2.0);
    draw_entries(d, view);
    draw_island_numbers(d, view, islands);
  }
}

}  // namespace triskin::sheet
