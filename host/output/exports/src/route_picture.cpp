// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/exports/route_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <map>

namespace triskin::exports {
namespace {

constexpr double kSide = 30.0;
constexpr std::array kLineColor{"#8ecae6", "#ffd166", "#95d5b2", "#f4a6b8"};

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// Computes the position of each node in the drawing: its lattice place, islands side by side, y downwards.
class Sheet {
 public:
  explicit Sheet(const design::ModuleList& list) {
    std::map<int, Eigen::AlignedBox2d> boxes;
    for (std::size_t k = 0; k < list.tiles.size(); ++k) {
      for (int c = 0; c < 3; ++c) boxes[list.graph.nodes[k].island].extend(lattice_corner(list.tiles[k], c));
    }
    std::map<int, design::Vec2> shift;
    double x = kSide;
    for (const auto& [island, box] : boxes) {
      shift[island] = design::Vec2(x, kSide) - box.min();
      x += box.sizes().x() + kSide;
      size_ = {x, std::max(size_.y(), box.sizes().y() + 2 * kSide)};
    }
    for (std::size_t k = 0; k < list.tiles.size(); ++k) {
      corners_.emplace_back();
      for (int c = 0; c < 3; ++c)
        corners_.back()[at(c)] = lattice_corner(list.tiles[k], c) + shift[list.graph.nodes[k].island];
    }
  }
  [[nodiscard]] const std::array<design::Vec2, 3>& corners(int node) const { return corners_[at(node)]; }
  [[nodiscard]] design::Vec2 center(int node) const {
    return (corners(node)[0] + corners(node)[1] + corners(node)[2]) / 3.0;
  }
  [[nodiscard]] design::Vec2 side_middle(int node, int side) const {
    return (corners(node)[at(side)] + corners(node)[at((side + 1) % 3)]) / 2.0;
  }
  [[nodiscard]] const design::Vec2& size() const { return size_; }

 private:
  static design::Vec2 lattice_corner(const design::Tile& t, int c) {
    const auto v = design::tile_corner_index(t, c);
    const design::Vec2 p = design::grid_point(v[0], v[1], kSide);
    return {p.x(), -p.y()};
  }
  std::vector<std::array<design::Vec2, 3>> corners_;
  design::Vec2 size_{0, 0};
};

std::string triangle(const std::array<design::Vec2, 3>& c, const char* fill) {
  return fmt::format(
      "<polygon points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\" fill=\"{}\" stroke=\"#fff\" "
      "stroke-width=\"0.5\"/>\n",
      c[0].x(), c[0].y(), c[1].x(), c[1].y(), c[2].x(), c[2].y(), fill);
}

std::string segment(const design::Vec2& a, const design::Vec2& b, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", a.x(), a.y(), b.x(), b.y(),
                     style);
}

std::string draw_patch(const design::Patch& patch, const design::ModuleGraph& graph, const std::vector<int>& patch_of,
                       const Sheet& sheet) {
  std::string below, above;
  for (const design::RoutedModule& m : patch.modules) {
    below += triangle(sheet.corners(m.node), kLineColor[at(m.line)]);
    const design::Vec2 center = sheet.center(m.node);
    for (int s = 0; s < 3; ++s) {
      const int next = graph.nodes[at(m.node)].neighbour[at(s)];
      if (next >= 0 && patch_of[at(next)] == patch_of[at(m.node)]) continue;
      above += segment(sheet.corners(m.node)[at(s)], sheet.corners(m.node)[at((s + 1) % 3)],
                       "stroke=\"#333\" stroke-width=\"1.8\" stroke-linecap=\"round\"");
    }
    if (m.parent >= 0) {
      const design::Vec2 from = sheet.center(m.parent), step = (center - from) * 0.2;
      above += segment(from + step, center - step, "stroke=\"#333\" stroke-width=\"1\" marker-end=\"url(#arrow)\"");
    } else {
      const design::Vec2 cable = sheet.side_middle(m.node, m.rotation);
      above += segment(cable + (cable - center), cable,
                       "stroke=\"#c1121f\" stroke-width=\"2.2\" marker-end=\"url(#cable)\"");
      above += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#c1121f\"/>\n", center.x(), center.y());
    }
    above += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-family=\"sans-serif\" font-size=\"5.5\" text-anchor=\"middle\" "
        "fill=\"#333\">{}</text>\n",
        center.x() + 5.0, center.y() - 2.5, m.address);
  }
  if (patch.second_entry >= 0) {
    const design::Vec2 c = sheet.center(patch.second_entry);
    above += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"none\" stroke=\"#c1121f\" stroke-width=\"1.2\"/>\n", c.x(),
        c.y());
  }
  return below + above;
}

}  // namespace

std::string route_svg(const design::ModuleList& list, std::span<const design::Patch> patches) {
  const Sheet sheet(list);
  std::vector<int> patch_of(list.tiles.size(), -1);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    for (const auto& m : patches[p].modules) patch_of[at(m.node)] = static_cast<int>(p);
  }
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{2:.0f}\">\n<defs>"
      "<marker id=\"arrow\" orient=\"auto\" markerWidth=\"4\" markerHeight=\"4\" refX=\"3\" refY=\"2\"><path d=\"M0,0 "
      "L4,2 L0,4 z\" fill=\"#333\"/></marker>"
      "<marker id=\"cable\" orient=\"auto\" markerWidth=\"4\" markerHeight=\"4\" refX=\"3\" refY=\"2\"><path d=\"M0,0 "
      "L4,2 L0,4 z\" fill=\"#c1121f\"/></marker></defs>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      sheet.size().x(), sheet.size().y() + 20, std::min(1600.0, 2.0 * sheet.size().x()));
  for (const design::Patch& patch : patches) svg += draw_patch(patch, list.graph, patch_of, sheet);
  for (std::size_t l = 0; l < kLineColor.size(); ++l) {
    svg += fmt::format(
        "<rect x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"12\" height=\"12\" fill=\"{2}\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "font-family=\"sans-serif\" "
        "font-size=\"10\">L{5}</text>\n",
        10.0 + 60.0 * static_cast<double>(l), sheet.size().y(), kLineColor[l], 25.0 + 60.0 * static_cast<double>(l),
        sheet.size().y() + 10, l);
  }
  return svg + "</svg>\n";
}

}  // namespace triskin::exports
