// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/placement/weight_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/json_value.hpp"
#include "triskin/geometry/segment.hpp"
#include "weight_regions.hpp"

namespace triskin::placement {
namespace {

// The map is constant in squares farther outside the raster than these.
constexpr int kFirstSquare = -3, kLastSquare = 2;
// The search compares sums to 1e-5 of their bound. Of smaller weights that would be a denormal number, which has hardly
// a digit.
constexpr double kMinWeight = 1e-300;

bool is_weight(double w) {
  return w >= 0.0 && w <= 1e12;
}

// Evaluates the four cubic B-splines over one interval, 0 ≤ t < 1, and their slopes.
std::array<double, 4> splines(double t) {
  const double u = 1.0 - t;
  return {u * u * u / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
          t * t * t / 6.0};
}
std::array<double, 4> slopes(double t) {
  const double u = 1.0 - t;
  return {-0.5 * u * u, 1.5 * t * t - 2.0 * t, -1.5 * u * u + 2.0 * u, 0.5 * t * t};
}

// Returns the weight at the point of the face that is nearest to p, and its squared distance.
std::pair<double, double> nearest_on_face(const Vec2& p, const std::array<WeightMap::Vertex, 3>& face) {
  const auto& [a, b, c] = face;
  const Vec2 u = b.at_mm - a.at_mm, v = c.at_mm - a.at_mm, w = p - a.at_mm;
  const double twice_area = u.x() * v.y() - u.y() * v.x();
  if (twice_area != 0.0) {
    const double s = (w.x() * v.y() - w.y() * v.x()) / twice_area, t = (u.x() * w.y() - u.y() * w.x()) / twice_area;
    if (s >= 0.0 && t >= 0.0 && s + t <= 1.0)
      return {a.weight + s * (b.weight - a.weight) + t * (c.weight - a.weight), 0.0};
  }
  std::pair<double, double> best{0.0, 1e300};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &from = face[k], &to = face[(k + 1) % 3];
    const double t = geometry::part_of_segment(p, from.at_mm, to.at_mm);
    const double far = (p - from.at_mm - t * (to.at_mm - from.at_mm)).squaredNorm();
    if (far < best.second) best = {from.weight + t * (to.weight - from.weight), far};
  }
  return best;
}

}  // namespace

WeightMap WeightMap::of_mesh(const std::vector<Vertex>& vertices, const std::vector<std::array<int, 3>>& faces,
                             double step_mm) {
  constexpr double kMaxPoints = 1e6;
  if (!(step_mm > 0.0)) throw InputError(fmt::format("weights: step {} mm must be positive", step_mm));
  if (faces.empty()) throw InputError("weights: the mesh has no faces");
  std::vector<std::array<Vertex, 3>> triangles;
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::array<Vertex, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const int v = faces[f][k];
      if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
        throw InputError(fmt::format("weights: face {}: there is no vertex {}", f, v));
      triangle[k] = vertices[static_cast<std::size_t>(v)];
      if (!triangle[k].at_mm.allFinite()) throw InputError(fmt::format("weights: vertex {} is not finite", v));
      if (!is_weight(triangle[k].weight))
        throw InputError(fmt::format("weights: vertex {}: {} must be in 0 … 1e12", v, triangle[k].weight));
      low = low.cwiseMin(triangle[k].at_mm);
      high = high.cwiseMax(triangle[k].at_mm);
    }
    triangles.push_back(triangle);
  }
  const Vec2 count = ((high - low) / step_mm).array().ceil() + 1.0;
  if (!(count.prod() <= kMaxPoints))
    throw InputError(fmt::format("weights: a step of {} mm gives {:.2g} points, more than {:.0g}; take a longer step",
                                 step_mm, count.prod(), kMaxPoints));
  std::vector<std::vector<double>> values(static_cast<std::size_t>(count.y()),
                                          std::vector<double>(static_cast<std::size_t>(count.x())));
  for (std::size_t r = 0; r < values.size(); ++r) {
    for (std::size_t c = 0; c < values[r].size(); ++c) {
      const Vec2 p = low + step_mm * Vec2(static_cast<double>(c), static_cast<double>(r));
      double nearest = 1e300;
      for (const auto& t : triangles) {
        const auto [weight, far] = nearest_on_face(p, t);
        if (far >= nearest) continue;
        nearest = far;
        values[r][c] = weight;
        if (far == 0.0) break;
      }
    }
  }
  return {low, step_mm, values};
}

WeightMap::WeightMap(const Vec2& origin_mm, double step_mm, const std::vector<std::vector<double>>& values)
    : origin_(origin_mm), step_(step_mm) {
  if (!(step_mm > 0.0 && std::isfinite(step_mm)) || !origin_mm.allFinite())
    throw InputError(fmt::format("weights: step {} mm must be positive, and the origin finite", step_mm));
  rows_ = static_cast<int>(values.size());
  columns_ = values.empty() ? 0 : static_cast<int>(values[0].size());
  if (columns_ == 0) throw InputError("weights: there are none; give at least one row with one value");
  for (std::size_t r = 0; r < values.size(); ++r) {
    if (values[r].size() != values[0].size())
      throw InputError(
          fmt::format("weights: row {} has {} values, row 0 has {}", r, values[r].size(), values[0].size()));
    for (std::size_t c = 0; c < values[r].size(); ++c) {
      if (!is_weight(values[r][c]))
        throw InputError(fmt::format("weights: row {}, column {}: {} must be in 0 … 1e12", r, c, values[r][c]));
    }
  }
  stride_ = columns_ + 2 * kRim + 1;
  for (int r = -kRim; r <= rows_ + kRim; ++r) {
    const auto& row = values[static_cast<std::size_t>(std::clamp(r, 0, rows_ - 1))];
    for (int c = -kRim; c <= columns_ + kRim; ++c)
      control_.push_back(row[static_cast<std::size_t>(std::clamp(c, 0, columns_ - 1))]);
  }
  for (double& w : control_) w = w < kMinWeight ? 0.0 : w;
  most_ = std::ranges::max(control_);
  // A spline's slopes are averages of first differences of its control values.
  double dx = 0.0, dy = 0.0;
  for (int r = -1; r <= rows_; ++r) {
    for (int c = -1; c <= columns_; ++c) {
      dx = std::max(dx, std::abs(*control(c + 1, r) - *control(c, r)));
      dy = std::max(dy, std::abs(*control(c, r + 1) - *control(c, r)));
    }
  }
  max_slope_ = std::hypot(dx, dy) / step_;
  near_curvature_.assign(control_.size(), 0.0);
  for (int r = kFirstSquare; r <= rows_ + kLastSquare; ++r) {
    for (int c = kFirstSquare; c <= columns_ + kLastSquare; ++c) near_curvature_[index(c, r)] = curvature_around(c, r);
  }
  max_curvature_ = std::ranges::max(near_curvature_);
}

// A spline's curvatures are averages of second differences of its control values; those that have a part in the nine
// squares around a square of the raster count.
double WeightMap::curvature_around(int column, int row) const {
  double dxx = 0.0, dxy = 0.0, dyy = 0.0;
  for (int r = row - 2; r <= row + 3; ++r) {
    for (int c = column - 2; c <= column + 3; ++c) {
      const double *above = control(c, r + 1), *here = control(c, r), *below = control(c, r - 1);
      if (c > column - 2 && c < column + 3) dxx = std::max(dxx, std::abs(here[-1] - 2.0 * here[0] + here[1]));
      if (r > row - 2 && r < row + 3) dyy = std::max(dyy, std::abs(below[0] - 2.0 * here[0] + above[0]));
      if (c < column + 3 && r < row + 3) dxy = std::max(dxy, std::abs(above[1] - here[1] - above[0] + here[0]));
    }
  }
  return std::sqrt(dxx * dxx + 2.0 * dxy * dxy + dyy * dyy) / (step_ * step_);
}

WeightMap::Jet WeightMap::at(const Vec2& p_mm) const {
  // Beyond the rim the map is constant; the limits keep the indices small.
  const double x = std::clamp((p_mm.x() - origin_.x()) / step_, 1.0 * kFirstSquare, 1.0 * (columns_ + kLastSquare)),
               y = std::clamp((p_mm.y() - origin_.y()) / step_, 1.0 * kFirstSquare, 1.0 * (rows_ + kLastSquare));
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const auto bx = splines(x - column), by = splines(y - row), sx = slopes(x - column), sy = slopes(y - row);
  Jet jet;
  for (std::size_t r = 0; r < 4; ++r) {
    const double* const v = control(column - 1, row - 1 + static_cast<int>(r));
    double value = 0.0, slope = 0.0;
    for (std::size_t c = 0; c < 4; ++c) {
      value += v[c] * bx[c];
      slope += v[c] * sx[c];
    }
    jet.value += value * by[r];
    jet.slope_per_mm += Vec2(slope * by[r], value * sy[r]);
  }
  jet.slope_per_mm /= step_;
  jet.near_curvature_per_mm2 = near_curvature_[index(column, row)];
  return jet;
}

namespace {

// An unknown key would leave a weight as if it had not been written.
void require_keys(const design::JsonValue& object, const std::vector<std::string_view>& known) {
  for (const auto& [key, value] : object.raw().items()) {
    if (std::ranges::find(known, key) == known.end())
      object.fail_at_key(key, fmt::format("unknown key; there can be {}", fmt::join(known, ", ")));
  }
}

// The errors of the maps know no file.
WeightMap made(const std::filesystem::path& file, const auto& make) {
  try {
    return make();
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", file.string(), e.what()));
  }
}

Vec2 point_of(const design::JsonValue& point) {
  point.require_size(2);
  return {point.at(0).number(), point.at(1).number()};
}

WeightMap map_of_regions(const design::JsonValue& json, const std::filesystem::path& file) {
  require_keys(json, {"step_mm", "elsewhere", "module_weight", "regions"});
  WeightRegions wanted;
  wanted.elsewhere = json["elsewhere"].number();
  if (has(json, "module_weight")) wanted.module_weight = json["module_weight"].number();
  wanted.step_mm = json["step_mm"].number();
  const design::JsonValue regions = json["regions"];
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const design::JsonValue region = regions.at(k);
    const design::JsonValue outline = region["outline_mm"];
    WeightRegions::Region& r = wanted.regions.emplace_back();
    r.weight = region["weight"].number();
    require_keys(region, {"weight", "outline_mm"});
    for (std::size_t p = 0; p < outline.size(); ++p) r.outline_mm.push_back(point_of(outline.at(p)));
  }
  return made(file, [&] { return weight_map_of(wanted); });
}

WeightMap map_of_mesh(const design::JsonValue& json, const std::filesystem::path& file) {
  require_keys(json, {"step_mm", "vertices", "faces"});
  const design::JsonValue vertices = json["vertices"], faces = json["faces"];
  std::vector<WeightMap::Vertex> points;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const design::JsonValue v = vertices.at(k);
    v.require_size(3);
    points.push_back({{v.at(0).number(), v.at(1).number()}, v.at(2).number()});
  }
  std::vector<std::array<int, 3>> corners;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const design::JsonValue f = faces.at(k);
    f.require_size(3);
    const int last = static_cast<int>(points.size()) - 1;
    corners.push_back({f.at(0).integer(0, last), f.at(1).integer(0, last), f.at(2).integer(0, last)});
  }
  const double step_mm = json["step_mm"].number();
  return made(file, [&] { return WeightMap::of_mesh(points, corners, step_mm); });
}

WeightMap map_of_raster(const design::JsonValue& json, const std::filesystem::path& file) {
  require_keys(json, {"step_mm", "origin_mm", "rows"});
  const design::JsonValue rows = json["rows"];
  std::vector<std::vector<double>> values(rows.size());
  for (std::size_t r = 0; r < values.size(); ++r) {
    const design::JsonValue row = rows.at(r);
    for (std::size_t c = 0; c < row.size(); ++c) values[r].push_back(row.at(c).number());
  }
  const Vec2 origin_mm = point_of(json["origin_mm"]);
  const double step_mm = json["step_mm"].number();
  return made(file, [&] { return WeightMap(origin_mm, step_mm, values); });
}

}  // namespace

WeightMap read_weight_map(const std::filesystem::path& file) {
  const auto text = design::parse_json(read_text(file), file.string());
  const design::JsonValue json(text, file.string());
  const bool is_regions = has(json, "regions"), is_mesh = has(json, "vertices");
  if (!is_regions && !is_mesh && !has(json, "rows"))
    json.fail(
        "not a map of weights, which has \"rows\", or \"vertices\" and \"faces\", or \"regions\" (docs/placement.md)");
  return is_regions ? map_of_regions(json, file) : is_mesh ? map_of_mesh(json, file) : map_of_raster(json, file);
}

}  // namespace triskin::placement
