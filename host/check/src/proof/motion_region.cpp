// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion_region.hpp"

#include <limits>

namespace triskin::check {
namespace {

constexpr double kSlack_mm = 1e-6;  // far above the rounding of plain doubles at 1e6 mm

IntervalPoint scaled(const IntervalPoint& p, double sign) {
  return sign > 0.0 ? p : IntervalPoint{-p.x, -p.y};
}
double middle(const Interval& i) {
  return 0.5 * (i.low + i.high);
}

}  // namespace

ProofPolygon::ProofPolygon(const std::vector<std::array<PlanePoint, 2>>& edges, const PlanePoint& pivot,
                           const ProofModule& module, double pitch_mm)
    : module_(module), pitch_(pitch_mm) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& [a, b] : edges) {
    ProofEdge e;
    e.end[0] = {Interval(a[0]) - Interval(pivot[0]), Interval(a[1]) - Interval(pivot[1])};
    e.end[1] = {Interval(b[0]) - Interval(pivot[0]), Interval(b[1]) - Interval(pivot[1])};
    const IntervalPoint along = e.end[1] - e.end[0];
    e.offset = dot(quarter_turn(along), e.end[0]);
    e.length_mm = std::hypot(along.x.magnitude(), along.y.magnitude()) * (1.0 + 1e-15);
    for (const auto& p : e.end) {
      radius_ = std::max(radius_, std::hypot(p.x.magnitude(), p.y.magnitude()) * (1.0 + 1e-15));
      low = std::min(low, p.y.low);
      high = std::max(high, p.y.high);
    }
    edges_.push_back(e);
  }
  const std::size_t n = std::clamp<std::size_t>(edges_.size(), 1, 4096);
  slab_low_ = low;
  slab_height_ = std::max((high - low) / static_cast<double>(n), 1e-9);
  slabs_.resize(n);
  const auto slab = [&](double y) {
    return static_cast<std::size_t>(std::clamp((y - low) / slab_height_, 0.0, static_cast<double>(n - 1)));
  };
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const auto [y0, y1] = std::minmax({middle(edges_[k].end[0].y), middle(edges_[k].end[1].y)});
    for (std::size_t s = slab(y0); s <= slab(y1); ++s) slabs_[s].push_back(static_cast<std::uint32_t>(k));
  }
}

bool ProofPolygon::contains(double x, double y) const {
  const double position = (y - slab_low_) / slab_height_;
  if (position < 0.0 || position > static_cast<double>(slabs_.size())) return false;
  bool inside = false;
  for (const std::uint32_t k : slabs_[std::min(static_cast<std::size_t>(position), slabs_.size() - 1)]) {
    const double ax = middle(edges_[k].end[0].x), ay = middle(edges_[k].end[0].y);
    const double bx = middle(edges_[k].end[1].x), by = middle(edges_[k].end[1].y);
    if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) inside = !inside;
  }
  return inside;
}

struct MotionRegion::Moved {
  std::array<IntervalPoint, 2> end, end_turn;  // at the middle; derivative by the angle over the region
  IntervalPoint normal, normal_range, normal_turn;
};

MotionRegion::MotionRegion(const ProofPolygon& polygon, const ProofBox& box)
    : polygon_(polygon), x_(0.5 * (box.low[0] + box.high[0])), y_(0.5 * (box.low[1] + box.high[1])) {
  const auto half = [&](std::size_t k, double center) {
    const double h = std::max(box.high[k] - center, center - box.low[k]);
    return h > 0.0 ? h * (1.0 + 1e-15) + std::abs(center) * 0x1p-52 : 0.0;
  };
  const double theta = 0.5 * (box.low[2] + box.high[2]);
  half_x_ = half(0, x_);
  half_y_ = half(1, y_);
  half_theta_ = half(2, theta);
  cosine_ = cosine(Interval(theta));
  sine_ = sine(Interval(theta));
  plain_cosine_ = std::cos(theta);
  plain_sine_ = std::sin(theta);
  const Interval angles(theta - half_theta_ - 1e-15, theta + half_theta_ + 1e-15);
  cosine_range_ = cosine(angles);
  sine_range_ = sine(angles);
  reach_ = (std::hypot(half_x_, half_y_) + polygon.radius_mm() * half_theta_) * (1.0 + 1e-14);
}

MotionRegion::Moved MotionRegion::moved(const ProofEdge& edge) const {
  Moved m;
  for (std::size_t e = 0; e < 2; ++e) {
    m.end[e] = turned(edge.end[e], cosine_, sine_) + IntervalPoint{x_, y_};
    m.end_turn[e] = quarter_turn(turned(edge.end[e], cosine_range_, sine_range_));
  }
  const IntervalPoint normal = quarter_turn(edge.end[1] - edge.end[0]);
  m.normal = turned(normal, cosine_, sine_);
  m.normal_range = turned(normal, cosine_range_, sine_range_);
  m.normal_turn = quarter_turn(m.normal_range);
  return m;
}

// Does one of the module's sides separate it from the edge: always, for some motions, never?
MotionRegion::Verdict MotionRegion::side_frees(const IntervalPoint& center, double sign, const Moved& m,
                                               double allowance_mm) const {
  Verdict best = Verdict::kNever;
  const ProofModule& module = polygon_.module();
  for (std::size_t k = 0; k < module.normal.size(); ++k) {
    const IntervalPoint n = scaled(module.normal[k], sign);
    bool possible = true, certain = true;
    for (std::size_t e = 0; e < 2 && possible; ++e) {
      const Interval value = dot(n, m.end[e] - center) - module.offset[k] + Interval(allowance_mm);
      const double spread =
          (n.x.magnitude() * half_x_ + n.y.magnitude() * half_y_ + dot(n, m.end_turn[e]).magnitude() * half_theta_) *
          (1.0 + 1e-14);
      possible = value.high + spread >= 0.0;
      certain = certain && value.low - spread >= 0.0;
    }
    if (possible && certain) return Verdict::kAlways;
    if (possible) best = Verdict::kMay;
  }
  return best;
}

// The edge's own line: the whole module left of it, or the whole module right of it.
MotionRegion::Verdict MotionRegion::line_frees(const IntervalPoint& center, double sign, const ProofEdge& edge,
                                               const Moved& m, double allowance_mm) const {
  bool left = true, right = true, always_left = true, always_right = true;
  const Interval allowance = Interval(allowance_mm) * Interval(edge.length_mm);
  for (const IntervalPoint& up_corner : polygon_.module().corner) {
    const IntervalPoint arm = center + scaled(up_corner, sign) - IntervalPoint{x_, y_};
    const IntervalPoint wide_arm = arm + IntervalPoint{Interval(-half_x_, half_x_), Interval(-half_y_, half_y_)};
    const Interval value = dot(m.normal, arm) - edge.offset;
    const double spread = (m.normal_range.x.magnitude() * half_x_ + m.normal_range.y.magnitude() * half_y_ +
                           dot(m.normal_turn, wide_arm).magnitude() * half_theta_) *
                          (1.0 + 1e-14);
    left = left && value.high + spread + allowance.high >= 0.0;
    right = right && value.low - spread - allowance.high <= 0.0;
    always_left = always_left && value.low - spread + allowance.low >= 0.0;
    always_right = always_right && value.high + spread - allowance.low <= 0.0;
  }
  if (edge.length_mm > 0.0 && (always_left || always_right)) return Verdict::kAlways;
  return left || right ? Verdict::kMay : Verdict::kNever;
}

MotionRegion::Verdict MotionRegion::cuts(const IntervalPoint& center, bool up, const ProofEdge& edge,
                                         double allowance_mm) const {
  const Moved m = moved(edge);
  const double sign = up ? 1.0 : -1.0;
  const Verdict side = side_frees(center, sign, m, allowance_mm);
  if (side == Verdict::kAlways) return Verdict::kNever;
  const Verdict line = line_frees(center, sign, edge, m, allowance_mm);
  if (line == Verdict::kAlways) return Verdict::kNever;
  return side == Verdict::kNever && line == Verdict::kNever ? Verdict::kAlways : Verdict::kMay;
}

double MotionRegion::distance_mm(const IntervalPoint& center, const ProofEdge& edge) const {
  const double cx = middle(center.x) - x_, cy = middle(center.y) - y_;
  const double px = plain_cosine_ * cx + plain_sine_ * cy, py = -plain_sine_ * cx + plain_cosine_ * cy;
  const double ax = middle(edge.end[0].x), ay = middle(edge.end[0].y);
  const double dx = middle(edge.end[1].x) - ax, dy = middle(edge.end[1].y) - ay;
  const double square = dx * dx + dy * dy;
  const double t = square > 0.0 ? std::clamp(((px - ax) * dx + (py - ay) * dy) / square, 0.0, 1.0) : 0.0;
  return std::hypot(px - ax - t * dx, py - ay - t * dy);
}

bool MotionRegion::center_inside(const IntervalPoint& center) const {
  const double cx = middle(center.x) - x_, cy = middle(center.y) - y_;
  return polygon_.contains(plain_cosine_ * cx + plain_sine_ * cy, -plain_sine_ * cx + plain_cosine_ * cy);
}

CandidateList MotionRegion::all() const {
  CandidateList list;
  for (std::uint32_t k = 0; k < polygon_.edges().size(); ++k) list.edges.push_back(k);
  const double span = polygon_.radius_mm() + reach_ + polygon_.module().circumradius_high_mm + 1.0;
  const double pitch = polygon_.pitch_mm(), height = pitch * polygon_.module().row_height.low,
               shift = polygon_.module().row_shift;
  for (int j = static_cast<int>(std::floor((y_ - span) / height)) - 1; j * height <= y_ + span; ++j) {
    const int first = static_cast<int>(std::floor((x_ - span) / pitch - shift * j)) - 2;
    for (int i = first; pitch * (i + shift * j) <= x_ + span; ++i) {
      for (int down = 0; down <= (polygon_.module().has_down ? 1 : 0); ++down) {
        const ProofTile tile{i, j, down == 0};
        list.tiles.push_back({tile, polygon_.center_of(tile), 0, static_cast<std::uint32_t>(list.edges.size()), false});
      }
    }
  }
  return filtered(list);
}

CandidateList MotionRegion::filtered(const CandidateList& list) const {
  CandidateList kept;
  kept.certain = list.certain;
  const double inner = polygon_.module().inradius_low_mm - reach_ - kSlack_mm,
               outer = polygon_.module().circumradius_high_mm + reach_ + kSlack_mm;
  for (Candidate tile : list.tiles) {
    const auto first = static_cast<std::uint32_t>(kept.edges.size());
    double nearest = std::numeric_limits<double>::infinity();
    bool possible = true;
    for (std::uint32_t k = tile.first; k < tile.first + tile.count && possible; ++k) {
      const ProofEdge& edge = polygon_.edges()[list.edges[k]];
      const double distance = distance_mm(tile.center, edge);
      nearest = std::min(nearest, distance);
      if (distance > outer) continue;
      const Verdict verdict = distance < inner ? Verdict::kAlways : cuts(tile.center, tile.tile.up, edge, 0.0);
      if (verdict == Verdict::kMay) kept.edges.push_back(list.edges[k]);
      possible = verdict != Verdict::kAlways;
    }
    // Where no edge passes the centre, inside and outside are the same for the whole region.
    if (possible && !tile.inside && nearest > reach_ + kSlack_mm) {
      tile.inside = center_inside(tile.center);
      possible = tile.inside;
    }
    tile.first = first;
    tile.count = static_cast<std::uint32_t>(kept.edges.size()) - first;
    if (!possible)
      kept.edges.resize(first);
    else if (tile.count == 0 && tile.inside)
      ++kept.certain;
    else
      kept.tiles.push_back(tile);
  }
  return kept;
}

bool MotionRegion::holds(const ProofTile& tile, double tolerance_mm) const {
  const IntervalPoint center = polygon_.center_of(tile);
  for (const ProofEdge& edge : polygon_.edges()) {
    const double distance = distance_mm(center, edge);
    if (distance > polygon_.module().circumradius_high_mm + kSlack_mm) continue;
    if (distance < polygon_.module().inradius_low_mm - tolerance_mm - 0.01 ||
        cuts(center, tile.up, edge, tolerance_mm) != Verdict::kNever)
      return false;
  }
  return center_inside(center);
}

}  // namespace triskin::check
