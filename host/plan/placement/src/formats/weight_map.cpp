// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/placement/weight_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/base/json_cause.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/json_value.hpp"
#include "triskin/geometry/segment.hpp"
#include "weight_regions.hpp"

namespace triskin::placement {
namespace {

// The map is constant in squares farther outside the raster than these.
constexpr int kFirstSquare = -3, kLastSquare = 2;

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
      low = low.cwiseMin(triangle[k].at_mm);
      high = high.cwiseMax(triangle[k].at_mm);
    }
    triangles.push_back(triangle);
  }
  const Vec2 count = ((high - low) / step_mm).array().ceil() + 1.0;
  if (count.prod() > kMaxPoints)
    throw InputError(fmt::format("weights: a step of {} mm gives {:.0f} points, more than {:.0g}; take a longer step",
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
      if (!(values[r][c] >= 0.0 && values[r][c] <= 1e12))
        throw InputError(fmt::format("weights: row {}, column {}: {} must be in 0 … 1e12", r, c, values[r][c]));
    }
  }
  stride_ = columns_ + 2 * kRim + 1;
  for (int r = -kRim; r <= rows_ + kRim; ++r) {
    const auto& row = values[static_cast<std::size_t>(std::clamp(r, 0, rows_ - 1))];
    for (int c = -kRim; c <= columns_ + kRim; ++c)
      control_.push_back(row[static_cast<std::size_t>(std::clamp(c, 0, columns_ - 1))]);
  }
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

WeightRegions regions_of(const nlohmann::json& json) {
  WeightRegions wanted;
  wanted.elsewhere = json.at("elsewhere").get<double>();
  wanted.module_weight = json.value("module_weight", 0.0);
  wanted.step_mm = json.at("step_mm").get<double>();
  for (const auto& region : json.at("regions")) {
    WeightRegions::Region r;
    r.weight = region.at("weight").get<double>();
    for (const auto& p : region.at("outline_mm").get<std::vector<std::array<double, 2>>>())
      r.outline_mm.emplace_back(p[0], p[1]);
    wanted.regions.push_back(std::move(r));
  }
  return wanted;
}

}  // namespace

WeightMap read_weight_map(const std::filesystem::path& file) {
  const auto json = design::parse_json(read_text(file), file.string());
  try {
    if (json.contains("regions")) return weight_map_of(regions_of(json));
    if (json.contains("vertices")) {
      std::vector<WeightMap::Vertex> vertices;
      for (const auto& v : json["vertices"].get<std::vector<std::array<double, 3>>>())
        vertices.push_back({{v[0], v[1]}, v[2]});
      return WeightMap::of_mesh(vertices, json.at("faces").get<std::vector<std::array<int, 3>>>(),
                                json.at("step_mm").get<double>());
    }
    const auto origin = json.at("origin_mm").get<std::array<double, 2>>();
    return {Vec2(origin[0], origin[1]), json.at("step_mm").get<double>(),
            json.at("rows").get<std::vector<std::vector<double>>>()};
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format(
        "{}: not a map of weights ({}); it needs \"step_mm\" and \"origin_mm\": [x, y], \"rows\": [[…], "
        "…], or \"vertices\": [[x, y, weight], …], \"faces\": [[a, b, c], …], or \"regions\": [{{\"weight\": w, "
        "\"outline_mm\": [[x, y], …]}}, …], \"elsewhere\": w",
        file.string(), json_cause(e.what())));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", file.string(), e.what()));
  }
}

}  // namespace triskin::placement
