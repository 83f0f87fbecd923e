// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion_region.hpp"

#include <limits>

namespace triskin::check {
namespace {

constexpr double kFacing = 0.05;         // An edge faces a side when the cosine between their normals is at least this.
constexpr double kSlack_mm = 1e-6;       // This is far above the rounding of plain doubles at 1e6 mm.
constexpr double kFootRounding = 1e-13;  // The foot of a point on an edge is rounded by less than this share.
constexpr int kMaxHalvingsOfAngles = 8;

IntervalPoint scaled(const IntervalPoint& p, double sign) {
  return sign > 0.0 ? p : IntervalPoint{-p.x, -p.y};
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

MotionRegion::MotionRegion(const ProofPolygon& polygon, const ProofBox& box)
    : polygon_(polygon),
      x_(0.5 * (box.low[0] + box.high[0])),
      y_(0.5 * (box.low[1] + box.high[1])),
      theta_(0.5 * (box.low[2] + box.high[2])) {
  const auto half = [&](std::size_t k, double center) {
    const double h = std::max(box.high[k] - center, center - box.low[k]);
    return h > 0.0 ? h * (1.0 + 1e-15) + std::abs(center) * 0x1p-52 : 0.0;
  };
  const double theta = theta_;
  half_x_ = half(0, x_);
  half_y_ = half(1, y_);
  half_theta_ = half(2, theta);
  cosine_ = cosine(Interval(theta));
  sine_ = sine(Interval(theta));
  plain_cosine_ = std::cos(theta);
  plain_sine_ = std::sin(theta);
  sampled_ = {{{std::cos(theta - half_theta_), std::sin(theta - half_theta_)},
               {plain_cosine_, plain_sine_},
               {std::cos(theta + half_theta_), std::sin(theta + half_theta_)}}};
  const Interval angles(theta - half_theta_ - 1e-15, theta + half_theta_ + 1e-15);
  cosine_range_ = cosine(angles);
  sine_range_ = sine(angles);
  reach_ = (std::hypot(half_x_, half_y_) + polygon.radius_mm() * half_theta_) * (1.0 + 1e-14);
}

const MotionRegion::Moved& MotionRegion::moved(std::uint32_t index) const {
  if (place_of_.empty()) place_of_.assign(polygon_.edges().size(), kNotMoved);
  if (place_of_[index] == kNotMoved) {
    place_of_[index] = static_cast<std::uint32_t>(moved_.size());
    moved_.push_back(newly_moved(polygon_.edges()[index]));
  }
  return moved_[place_of_[index]];
}

MotionRegion::Moved MotionRegion::newly_moved(const ProofEdge& edge) const {
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

MotionRegion::Verdict MotionRegion::one_side_frees(std::size_t side, const IntervalPoint& center, double sign,
                                                   const Moved& m, double allowance_mm) const {
  const ProofModule& module = polygon_.module();
  const IntervalPoint n = scaled(module.normal[side], sign);
  bool certain = true;
  for (std::size_t e = 0; e < 2; ++e) {
    const Interval value = dot(n, m.end[e] - center) - module.offset[side] + Interval(allowance_mm);
    const double spread =
        (n.x.magnitude() * half_x_ + n.y.magnitude() * half_y_ + dot(n, m.end_turn[e]).magnitude() * half_theta_) *
        (1.0 + 1e-14);
    if (value.high + spread < 0.0) return Verdict::kNever;
    certain = certain && value.low - spread >= 0.0;
  }
  return certain ? Verdict::kAlways : Verdict::kMay;
}

// Tells whether one of the module's sides separates it from the edge: always, for some motions, or never.
MotionRegion::Verdict MotionRegion::side_frees(const IntervalPoint& center, double sign, const Moved& m,
                                               double allowance_mm) const {
  Verdict best = Verdict::kNever;
  for (std::size_t k = 0; k < polygon_.module().normal.size(); ++k) {
    const Verdict here = one_side_frees(k, center, sign, m, allowance_mm);
    if (here == Verdict::kAlways) return Verdict::kAlways;
    if (here == Verdict::kMay) best = Verdict::kMay;
  }
  return best;
}

// Tests the edge's own line: the whole module left of it, or the whole module right of it.
MotionRegion::Ways MotionRegion::line_ways(const IntervalPoint& center, double sign, const ProofEdge& edge,
                                           const Moved& m, double allowance_mm) const {
  Ways ways;
  bool always_left = true, always_right = true;
  const Interval allowance = Interval(allowance_mm) * Interval(edge.length_mm);
  for (const IntervalPoint& up_corner : polygon_.module().corner) {
    const IntervalPoint arm = center + scaled(up_corner, sign) - IntervalPoint{x_, y_};
    const IntervalPoint wide_arm = arm + IntervalPoint{Interval(-half_x_, half_x_), Interval(-half_y_, half_y_)};
    const Interval value = dot(m.normal, arm) - edge.offset;
    const double spread = (m.normal_range.x.magnitude() * half_x_ + m.normal_range.y.magnitude() * half_y_ +
                           dot(m.normal_turn, wide_arm).magnitude() * half_theta_) *
                          (1.0 + 1e-14);
    ways.left = ways.left && value.high + spread + allowance.high >= 0.0;
    ways.right = ways.right && value.low - spread - allowance.high <= 0.0;
    always_left = always_left && value.low - spread + allowance.low >= 0.0;
    always_right = always_right && value.high + spread - allowance.low <= 0.0;
  }
  ways.always = edge.length_mm > 0.0 && (always_left || always_right);
  return ways;
}

Need MotionRegion::line_need(std::uint32_t edge, double turn, const IntervalPoint& point) const {
  const ProofEdge& e = polygon_.edges()[edge];
  const Interval scale(turn / e.length_mm);
  const IntervalPoint normal = quarter_turn(e.end[1] - e.end[0]);
  const IntervalPoint from = point - IntervalPoint{x_, y_};
  return {false,
          edge,
          {scale * normal.x, scale * normal.y},
          point,
          scale * e.offset,
          length_of(from.x.magnitude() + half_x_, from.y.magnitude() + half_y_)};
}

void MotionRegion::add_side_needs(const Candidate& module, std::uint32_t edge, std::size_t side,
                                  std::vector<Need>& needs) const {
  const IntervalPoint normal = scaled(polygon_.module().normal[side], module.tile.up ? 1.0 : -1.0);
  const double shift = length_of(std::abs(x_) + half_x_, std::abs(y_) + half_y_);
  for (const IntervalPoint& end : polygon_.edges()[edge].end) {
    needs.push_back({true, edge, normal, end, dot(normal, module.center) + polygon_.module().offset[side],
                     shift + length_of(end.x.magnitude(), end.y.magnitude())});
  }
}

// The edge may also lie beyond a side of the module that faces it. A point of the module whose foot is on the edge then
// still lies on the same side of the edge's line (left for turn 1): the foot is beyond the side, the point is not, and
// the side faces the line.
void MotionRegion::add_needs_over(const Candidate& module, std::uint32_t edge, double turn,
                                  std::vector<Need>& needs) const {
  const ProofEdge& e = polygon_.edges()[edge];
  const double dx = middle(e.end[1].x) - middle(e.end[0].x), dy = middle(e.end[1].y) - middle(e.end[0].y),
               length = std::hypot(dx, dy);
  const auto foot = [&](const IntervalPoint& p) {
    const double gx = middle(p.x) - x_, gy = middle(p.y) - y_;
    const double px = plain_cosine_ * gx + plain_sine_ * gy, py = -plain_sine_ * gx + plain_cosine_ * gy;
    return ((px - middle(e.end[0].x)) * dx + (py - middle(e.end[0].y)) * dy) / length;
  };
  const double arm =
      std::hypot(middle(module.center.x) - x_, middle(module.center.y) - y_) + polygon_.module().circumradius_high_mm;
  const double spread = std::hypot(half_x_, half_y_) + arm * half_theta_ +
                        kFootRounding * (1.0 + arm + length + polygon_.radius_mm() + std::hypot(x_, y_));
  const auto& corners = polygon_.module().corner;
  const double sign = module.tile.up ? 1.0 : -1.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const IntervalPoint a = module.center + scaled(corners[k], sign),
                        b = module.center + scaled(corners[(k + 1) % corners.size()], sign);
    const double at_a = foot(a), at_b = foot(b);
    for (const double wanted : {std::clamp(at_a, spread, length - spread), std::clamp(at_b, spread, length - spread)}) {
      if (!(spread <= length - spread) || (wanted - at_a) * (wanted - at_b) > 0.0) continue;
      const double share = at_a == at_b ? 0.0 : std::clamp((wanted - at_a) / (at_b - at_a), 0.0, 1.0);
      const Interval part(share);
      needs.push_back(line_need(edge, turn, {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)}));
      if (wanted == at_a && at_a == at_b) break;
    }
  }
}

void MotionRegion::add_needs(const Candidate& module, std::uint32_t edge, std::vector<Need>& needs) const {
  const ProofEdge& e = polygon_.edges()[edge];
  if (!(e.length_mm > 0.0)) return;
  const Moved& m = moved(edge);
  const double sign = module.tile.up ? 1.0 : -1.0;
  Ways ways = line_ways(module.center, sign, e, m, 0.0);
  Interval against(-1.0, -1.0);  // The least and largest component of the sides' normals along that of the edge.
  bool first = true;
  for (std::size_t k = 0; k < polygon_.module().normal.size(); ++k) {
    if (one_side_frees(k, module.center, sign, m, 0.0) == Verdict::kNever) continue;
    ways.sides.push_back(k);
    const Interval along = dot(scaled(polygon_.module().normal[k], sign), m.normal_range);
    against = first ? along : Interval(std::min(against.low, along.low), std::max(against.high, along.high));
    first = false;
  }
  const double facing = kFacing * e.length_mm;
  if (ways.sides.empty()) {
    if (ways.left == ways.right) return;
    for (const IntervalPoint& corner : polygon_.module().corner)
      needs.push_back(line_need(edge, ways.left ? 1.0 : -1.0, module.center + scaled(corner, sign)));
    return;
  }
  if (ways.sides.size() == 1 && !ways.left && !ways.right) add_side_needs(module, edge, ways.sides.front(), needs);
  if (!ways.right && against.high < -facing) add_needs_over(module, edge, 1.0, needs);
  if (!ways.left && against.low > facing) add_needs_over(module, edge, -1.0, needs);
}

bool MotionRegion::never_met(const Need& need) const {
  const IntervalPoint shift{Interval(-half_x_, half_x_), Interval(-half_y_, half_y_)};
  Interval value, turn;
  IntervalPoint normal = need.normal;
  if (need.by_side) {
    value = dot(normal, turned(need.point, cosine_, sine_) + IntervalPoint{x_, y_});
    turn = dot(normal, quarter_turn(turned(need.point, cosine_range_, sine_range_)));
  } else {
    const IntervalPoint arm = need.point - IntervalPoint{x_, y_};
    value = dot(turned(normal, cosine_, sine_), arm);
    normal = turned(normal, cosine_range_, sine_range_);
    turn = dot(quarter_turn(normal), arm + shift);
  }
  const double spread =
      (normal.x.magnitude() * half_x_ + normal.y.magnitude() * half_y_ + turn.magnitude() * half_theta_) *
      (1.0 + 1e-14);
  return (value - need.constant).high + spread < 0.0;
}

NeedSamples MotionRegion::samples(const Need& need) const {
  const double nx = middle(need.normal.x), ny = middle(need.normal.y), px = middle(need.point.x),
               py = middle(need.point.y), constant = middle(need.constant);
  NeedSamples samples{nx, ny, {}};
  if (!need.by_side) {
    samples.normal_x = plain_cosine_ * nx - plain_sine_ * ny;
    samples.normal_y = plain_sine_ * nx + plain_cosine_ * ny;
  }
  for (std::size_t k = 0; k < kSampledAngles; ++k) {
    const auto& [c, s] = sampled_[k];
    if (need.by_side)
      samples.excess_mm[k] = nx * (c * px - s * py + x_) + ny * (s * px + c * py + y_) - constant;
    else
      samples.excess_mm[k] = (c * nx - s * ny) * (px - x_) + (s * nx + c * ny) * (py - y_) - constant;
  }
  return samples;
}

NeedChange MotionRegion::change(const Need& need) const {
  const double nx = middle(need.normal.x), ny = middle(need.normal.y), px = middle(need.point.x),
               py = middle(need.point.y), c = plain_cosine_, s = plain_sine_;
  if (need.by_side) {
    const double x = c * px - s * py, y = s * px + c * py;
    return {nx * (x + x_) + ny * (y + y_) - middle(need.constant),
            {nx * half_x_, ny * half_y_, (ny * x - nx * y) * half_theta_}};
  }
  const double x = c * nx - s * ny, y = s * nx + c * ny;
  return {x * (px - x_) + y * (py - y_) - middle(need.constant),
          {-x * half_x_, -y * half_y_, (x * (py - y_) - y * (px - x_)) * half_theta_}};
}

bool MotionRegion::never_met_together(const std::vector<WeightedNeed>& needs) const {
  NeedSum sum{};
  for (const auto& [need, weight] : needs) {
    const Interval w(weight);
    const IntervalPoint normal{w * need->normal.x, w * need->normal.y};
    const IntervalPoint arm = need->by_side ? need->point : need->point - IntervalPoint{x_, y_};
    const Interval across = normal.x * arm.y - normal.y * arm.x;
    sum.cosine = sum.cosine + dot(normal, arm);
    sum.constant = sum.constant + w * need->constant;
    if (need->by_side) {
      sum.sine = sum.sine - across;
      sum.constant = sum.constant - dot(normal, IntervalPoint{x_, y_});
      sum.side_normal = sum.side_normal + normal;
    } else {
      sum.sine = sum.sine + across;
      sum.line_normal = sum.line_normal + normal;
    }
  }
  return !needs.empty() && negative(sum, theta_ - half_theta_, theta_ + half_theta_, kMaxHalvingsOfAngles);
}

// Uses the mean value form over the angles, and if the sum is negative in the middle only, tries either half.
bool MotionRegion::negative(const NeedSum& sum, double low, double high, int halvings) const {
  const double at = 0.5 * (low + high), half = std::max(high - at, at - low) * (1.0 + 1e-12) + 1e-16;
  const auto highest = [&](double reach) {
    const Interval angles(at - reach, at + reach), c = cosine(angles), s = sine(angles);
    const IntervalPoint rest = sum.side_normal - turned(sum.line_normal, c, s);
    const Interval value = sum.cosine * cosine(Interval(at)) + sum.sine * sine(Interval(at)) - sum.constant;
    const double slope = (sum.sine * c - sum.cosine * s).magnitude();
    return value.high + (slope * reach + rest.x.magnitude() * half_x_ + rest.y.magnitude() * half_y_) * (1.0 + 1e-12);
  };
  if (highest(half) < 0.0) return true;
  if (halvings == 0 || !(highest(0.0) < 0.0)) return false;
  return negative(sum, low, at, halvings - 1) && negative(sum, at, high, halvings - 1);
}

MotionRegion::Verdict MotionRegion::cuts(const IntervalPoint& center, bool up, std::uint32_t edge,
                                         double allowance_mm) const {
  const Moved& m = moved(edge);
  const double sign = up ? 1.0 : -1.0;
  const Verdict side = side_frees(center, sign, m, allowance_mm);
  if (side == Verdict::kAlways) return Verdict::kNever;
  const Ways line = line_ways(center, sign, polygon_.edges()[edge], m, allowance_mm);
  if (line.always) return Verdict::kNever;
  return side == Verdict::kNever && !line.left && !line.right ? Verdict::kAlways : Verdict::kMay;
}

double MotionRegion::distance_mm(const IntervalPoint& center, const ProofEdge& edge) const {
  const double cx = middle(center.x) - x_, cy = middle(center.y) - y_;
  const double px = plain_cosine_ * cx + plain_sine_ * cy, py = -plain_sine_ * cx + plain_cosine_ * cy;
  const double ax = middle(edge.end[0].x), ay = middle(edge.end[0].y);
  const double dx = middle(edge.end[1].x) - ax, dy = middle(edge.end[1].y) - ay;
  const double square = dx * dx + dy * dy;
  const double t = square > 0.0 ? std::clamp(((px - ax) * dx + (py - ay) * dy) / square, 0.0, 1.0) : 0.0;
  const double x = px - ax - t * dx, y = py - ay - t * dy;
  return std::sqrt(x * x + y * y);
}

bool MotionRegion::center_inside(const IntervalPoint& center) const {
  const double cx = middle(center.x) - x_, cy = middle(center.y) - y_;
  return polygon_.contains(plain_cosine_ * cx + plain_sine_ * cy, -plain_sine_ * cx + plain_cosine_ * cy);
}

// Returns the part of each grid row that the outline can reach, where the centre of a module inside must lie.
std::vector<MotionRegion::Span> MotionRegion::row_spans(double first_y, double row_height, std::size_t rows) const {
  std::vector<Span> spans(rows);
  const double wider = reach_ + kSlack_mm;
  const auto row = [&](double y) {
    return static_cast<std::size_t>(std::clamp((y - first_y) / row_height, 0.0, static_cast<double>(rows) - 1.0));
  };
  const auto placed = [&](const IntervalPoint& p) {
    const double px = middle(p.x), py = middle(p.y);
    return std::array{plain_cosine_ * px - plain_sine_ * py + x_, plain_sine_ * px + plain_cosine_ * py + y_};
  };
  for (const ProofEdge& edge : polygon_.edges()) {
    auto a = placed(edge.end[0]), b = placed(edge.end[1]);
    if (a[1] > b[1]) std::swap(a, b);
    const double slope = b[1] > a[1] ? (b[0] - a[0]) / (b[1] - a[1]) : 0.0;
    for (std::size_t r = row(a[1] - wider); r <= row(b[1] + wider); ++r) {
      // Takes the part of the edge beside the row; the first and the last row also take everything beyond them.
      const double low = r == 0 ? a[1] : std::clamp(first_y + row_height * static_cast<double>(r) - wider, a[1], b[1]);
      const double high =
          r + 1 == rows ? b[1] : std::clamp(first_y + row_height * static_cast<double>(r + 1) + wider, a[1], b[1]);
      for (const double x : {a[0] + (low - a[1]) * slope, a[1] < b[1] ? a[0] + (high - a[1]) * slope : b[0]}) {
        spans[r].low = std::min(spans[r].low, x - wider);
        spans[r].high = std::max(spans[r].high, x + wider);
      }
    }
  }
  return spans;
}

CandidateList MotionRegion::all() const {
  CandidateList list;
  for (std::uint32_t k = 0; k < polygon_.edges().size(); ++k) list.edges.push_back(k);
  double low = 1e300, high = -1e300;
  for (const ProofEdge& edge : polygon_.edges()) {
    for (const IntervalPoint& end : edge.end) {
      const double y = plain_sine_ * middle(end.x) + plain_cosine_ * middle(end.y) + y_;
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
  const double pitch = polygon_.pitch_mm(), height = pitch * polygon_.module().row_height.low,
               shift = polygon_.module().row_shift;
  const int first_row = static_cast<int>(std::floor((low - reach_) / height)) - 2,
            last_row = static_cast<int>(std::ceil((high + reach_) / height)) + 2;
  const std::vector<Span> spans =
      row_spans(first_row * height, height, static_cast<std::size_t>(last_row - first_row + 1));
  for (int j = first_row; j <= last_row; ++j) {
    const Span& span = spans[static_cast<std::size_t>(j - first_row)];
    if (span.low > span.high) continue;
    const int first = static_cast<int>(std::floor(span.low / pitch - shift * j)) - 2;
    for (int i = first; pitch * (i + shift * j) <= span.high; ++i) {
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
      const Verdict verdict = distance < inner ? Verdict::kAlways : cuts(tile.center, tile.tile.up, list.edges[k], 0.0);
      if (verdict == Verdict::kMay) kept.edges.push_back(list.edges[k]);
      possible = verdict != Verdict::kAlways;
    }
    // If no edge passes the centre, inside and outside are the same for the whole region.
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
  for (std::uint32_t edge = 0; edge < polygon_.edges().size(); ++edge) {
    const double distance = distance_mm(center, polygon_.edges()[edge]);
    if (distance > polygon_.module().circumradius_high_mm + kSlack_mm) continue;
    if (distance < polygon_.module().inradius_low_mm - tolerance_mm - 0.01 ||
        cuts(center, tile.up, edge, tolerance_mm) != Verdict::kNever)
      return false;
  }
  return center_inside(center);
}

}  // namespace triskin::check
