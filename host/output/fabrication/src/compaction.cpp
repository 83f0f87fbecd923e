// SPDX-License-Identifier: GPL-3.0-or-later
#include "compaction.hpp"

#include <algorithm>
#include <cmath>

#include "triskin/geometry/segment.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

// Corners and sides that are this much farther from each other than the gap are watched while bodies move.
constexpr double kWatched_mm = 4.0;
// A corner may have got this deep behind a side of another body; deeper ones belong to the side's far neighbours.
constexpr double kMaxDepth_mm = 0.75;
// Corners are pushed this much farther than needed, so that the pushing ends after finitely many sweeps.
constexpr double kMargin_mm = 2e-3;
constexpr double kTolerance_mm = 1e-6;
constexpr int kMaxSweeps = 1500;
constexpr double kFirstStep_mm = 1.0, kLastStep_mm = 0.05;

struct Box {
  Vec2 low{1e9, 1e9}, high{-1e9, -1e9};
  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  [[nodiscard]] bool is_within(const Box& other, double reach) const {
    return (low.array() <= other.high.array() + reach).all() && (other.low.array() <= high.array() + reach).all();
  }
};

Box box_of_side(const Vec2& a, const Vec2& b) {
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

Box box_of(const Body& body) {
  Box box;
  for (const Ring& ring : body.rings_mm) {
    for (const Vec2& p : ring) box.add(p + body.shift_mm);
  }
  return box;
}

// A corner of one body near the side a … b of another, both as they are before the bodies' shifts.
struct Touch {
  std::size_t corner_body, side_body;
  Vec2 corner, a, b;
};

// Returns the direction that leads the corner away from the side and, by `distance`, how far away it is.
Vec2 away_from_side(const Vec2& p, const Vec2& a, const Vec2& b, double& distance) {
  const Vec2 along = b - a;
  const double t = (p - a).dot(along) / std::max(along.squaredNorm(), 1e-12);
  const Vec2 normal = Vec2(along.y(), -along.x()) / std::max(along.norm(), 1e-6);  // Bodies lie to the left of sides.
  distance = (p - a).dot(normal);
  if (t >= 0.0 && t <= 1.0) return normal;
  const Vec2 from_end = p - (t < 0.0 ? a : b);
  distance = from_end.norm();
  return distance > 1e-9 ? Vec2(from_end / distance) : normal;
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool sides_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (cross(b - a, c - a) > 0.0) != (cross(b - a, d - a) > 0.0) &&
         (cross(d - c, a - c) > 0.0) != (cross(d - c, b - c) > 0.0);
}

class Compaction {
 public:
  Compaction(std::vector<Body> bodies, const CompactionRoom& room) : bodies_(std::move(bodies)), room_(room) {
    for (const Body& body : bodies_) {
      Box& box = boxes_.emplace_back(box_of(body));
      box.low -= body.shift_mm;
      box.high -= body.shift_mm;
      last_sheet_ = std::max(last_sheet_, body.sheet);
    }
  }

  std::optional<std::vector<Vec2>> run() {
    std::vector<Vec2> best = shifts();
    double length = length_of_last();
    // The layout comes from pixels; where they hide a gap that is too small, it may need a little more room.
    double longer = 0.0;
    while (!settles(best, std::min(room_.length_mm, length + longer))) {
      if (length + longer >= room_.length_mm || longer > 2.0) return std::nullopt;
      longer += 0.25;
    }
    best = shifts();
    for (double step = kFirstStep_mm; step >= kLastStep_mm;) {
      if (settles(best, length_of_last() - step))
        best = shifts();
      else
        step /= 2.0;
      set_shifts(best);
    }
    return best;
  }

 private:
  [[nodiscard]] std::vector<Vec2> shifts() const {
    std::vector<Vec2> all;
    for (const Body& body : bodies_) all.push_back(body.shift_mm);
    return all;
  }
  void set_shifts(const std::vector<Vec2>& shifts) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_[k].shift_mm = shifts[k];
  }

  // Returns the length used of the last sheet, with the gap at its end.
  [[nodiscard]] double length_of_last() const {
    double length = 0.0;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (bodies_[k].sheet == last_sheet_)
        length = std::max(length, bodies_[k].shift_mm.y() + boxes_[k].high.y() + room_.gap_mm);
    }
    return length;
  }

  // Starts from these shifts and pushes until all gaps are kept with the last sheet at most this long.
  bool settles(const std::vector<Vec2>& from, double length_mm) {
    set_shifts(from);
    watch();
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      bool is_inside = true;
      for (std::size_t k = 0; k < bodies_.size(); ++k) is_inside = push_inside(k, length_mm) && is_inside;
      if (!is_inside) return false;
      double worst = 0.0;
      for (const Touch& touch : touches_) worst = std::max(worst, push_apart(touch, length_mm));
      if (worst < 0.5 * kMargin_mm) return keeps_gaps();
    }
    return false;
  }

  // Returns whether the body fits at all.
  bool push_inside(std::size_t k, double length_mm) {
    const Body& body = bodies_[k];
    const Vec2 end(room_.width_mm, body.sheet == last_sheet_ ? length_mm : room_.length_mm);
    const Vec2 low = Vec2::Constant(room_.gap_mm) - boxes_[k].low,
               high = end - Vec2::Constant(room_.gap_mm) - boxes_[k].high;
    if ((high.array() < low.array()).any()) return false;
    bodies_[k].shift_mm = body.shift_mm.cwiseMax(low).cwiseMin(high);
    return true;
  }

  // Lists all corners near sides of other bodies.
  void watch() {
    touches_.clear();
    for (std::size_t a = 0; a < bodies_.size(); ++a) {
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (a != b && bodies_[a].sheet == bodies_[b].sheet &&
            box_of(bodies_[a]).is_within(box_of(bodies_[b]), room_.gap_mm + kWatched_mm))
          watch(a, b);
      }
    }
  }

  void watch(std::size_t a, std::size_t b) {
    const double reach = room_.gap_mm + kWatched_mm;
    const Box box = box_of(bodies_[b]);
    const Vec2 offset = bodies_[a].shift_mm - bodies_[b].shift_mm;
    for_each_corner(bodies_[a], [&](const Vec2& corner, const Vec2&) {
      const Vec2 at = corner + bodies_[a].shift_mm;
      if (!box_of_side(at, at).is_within(box, reach)) return;
      for_each_corner(bodies_[b], [&](const Vec2& from, const Vec2& to) {
        if (geometry::distance_to_segment(Vec2(corner + offset), from, to) < reach)
          touches_.push_back({a, b, corner, from, to});
      });
    });
  }

  // Calls what(corner, next corner) for every corner of the body's rings.
  template <typename What>
  static void for_each_corner(const Body& body, const What& what) {
    for (const Ring& ring : body.rings_mm) {
      for (std::size_t k = 0; k < ring.size(); ++k) what(ring[k], ring[(k + 1) % ring.size()]);
    }
  }

  // Moves each of the two bodies by half of what is missing. Returns what was missing.
  double push_apart(const Touch& touch, double length_mm) {
    Vec2 &corner_shift = bodies_[touch.corner_body].shift_mm, &side_shift = bodies_[touch.side_body].shift_mm;
    double distance = 0.0;
    const Vec2 direction = away_from_side(touch.corner + corner_shift - side_shift, touch.a, touch.b, distance);
    const double missing = room_.gap_mm + kMargin_mm - distance;
    if (missing <= 0.0 || distance < -kMaxDepth_mm) return 0.0;
    corner_shift += 0.5 * missing * direction;
    side_shift -= 0.5 * missing * direction;
    push_inside(touch.corner_body, length_mm);
    push_inside(touch.side_body, length_mm);
    return missing;
  }

  [[nodiscard]] bool keeps_gaps() const {
    for (std::size_t a = 0; a < bodies_.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (bodies_[a].sheet == bodies_[b].sheet && !keeps_gap(bodies_[a], bodies_[b])) return false;
      }
    }
    return true;
  }

  [[nodiscard]] bool keeps_gap(const Body& one, const Body& other) const {
    const double gap = room_.gap_mm + kTolerance_mm;
    const Box box = box_of(other);
    if (!box_of(one).is_within(box, gap)) return true;
    bool is_kept = !contains(one, other) && !contains(other, one);
    for_each_corner(one, [&](const Vec2& a, const Vec2& b) {
      const Vec2 p = a + one.shift_mm, q = b + one.shift_mm;
      const Box side = box_of_side(p, q);
      if (!is_kept || !side.is_within(box, gap)) return;
      for_each_corner(other, [&](const Vec2& c, const Vec2& d) {
        const Vec2 r = c + other.shift_mm, s = d + other.shift_mm;
        if (!is_kept || !side.is_within(box_of_side(r, s), gap)) return;
        is_kept = !sides_cross(p, q, r, s) && geometry::distance_to_segment(p, r, s) >= gap &&
                  geometry::distance_to_segment(r, p, q) >= gap && geometry::distance_to_segment(q, r, s) >= gap &&
                  geometry::distance_to_segment(s, p, q) >= gap;
      });
    });
    return is_kept;
  }

  // Returns whether the first corner of `inner` lies on `outer`; if no sides cross, all of them do then.
  static bool contains(const Body& outer, const Body& inner) {
    const Vec2 p = inner.rings_mm[0][0] + inner.shift_mm - outer.shift_mm;
    bool inside = false;
    for_each_corner(outer, [&](const Vec2& a, const Vec2& b) {
      if (geometry::ray_crosses(p, a, b)) inside = !inside;
    });
    return inside;
  }

  std::vector<Body> bodies_;
  std::vector<Box> boxes_;  // The boxes are those without the shifts.
  CompactionRoom room_;
  int last_sheet_ = 0;
  std::vector<Touch> touches_;
};

}  // namespace

std::optional<std::vector<Vec2>> compacted(std::vector<Body> bodies, const CompactionRoom& room) {
  return Compaction(std::move(bodies), room).run();
}

}  // namespace triskin::fabrication
