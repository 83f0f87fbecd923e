// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/lattice/add_module.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "fold_limit.hpp"
#include "net.hpp"
#include "overlap.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::lattice {
namespace {

using lattice::Triangle;

constexpr double kFinalMargin = 0.98;  // The margin lets an independent measurement agree.
constexpr double kSnap_mm = 7.0;       // Neighbours in the lattice whose corners lie nearer pull the module to them.
constexpr double kOutward = 0.6;       // The growth uses the same cosine between module and surface.
constexpr double kMaxLift_mm = 1.5;
constexpr double kFirstStep = 1.0, kLastStep = 0.02;  // Both are in mm.
constexpr double kNear_mm = 45.0;                     // Modules whose centres are farther apart cannot overlap.
constexpr double kEnough = 0.9;                       // The search stops when all limits are kept with 10 % to spare.
// Further measurement of a bad place takes long, so one at 10 times a limit gets the cost kFar at once.
constexpr double kHopeless = 10.0, kFar = 1e4;

Vec3 center_of(const Triangle& t) {
  return (t[0] + t[1] + t[2]) / 3.0;
}
// A place for the module, and how it keeps the limits; 1 means exactly at a limit.
struct Judged {
  PlacedModule module;
  double worst = 0.0, sum = 0.0;
  std::vector<BrokenLimit> broken;

  void add(const char* limit, double measured, double allowed, int other = -1) {
    const double ratio = measured / allowed;
    worst = std::max(worst, ratio);
    sum += std::max(0.0, ratio - 0.5);
    if (ratio > 1.0) broken.push_back({limit, measured, allowed, other});
  }
  [[nodiscard]] double cost() const { return worst + 0.05 * sum; }
};

class ModulePlacer {
 public:
  ModulePlacer(const mesh::Surface& surface, const LayoutLimits& limits, const mesh::SurfaceRegions* regions,
               const ModuleLayout& layout, int id, int side)
      : surface_(surface), limits_(limits), regions_(regions), layout_(layout), beside_(id), side_(side) {
    const PlacedModule& m = layout.modules.at(at(id));
    if (m.neighbour.at(at(side)) >= 0) {
      throw InputError(fmt::format("module {} has no free side {}: module {} is joined there",
                                   design::number_of(layout, id), side,
                                   design::number_of(layout, m.neighbour[at(side)])));
    }
    const TileSide next = across(m.tile, side);
    tile_ = next.tile;
    its_side_ = next.side;
    require_free_tile();
    const Vec3 middle = (m.corner_mm[at(side)] + m.corner_mm[at((side + 1) % 3)]) / 2.0;
    for (int k = 0; k < static_cast<int>(layout.modules.size()); ++k) {
      if ((center_of(layout.modules[at(k)].corner_mm) - middle).norm() < kNear_mm + kHeight_mm) near_.push_back(k);
    }
  }

  // Returns a place that keeps the limits, or the one that the module would have without any slide, for the message.
  [[nodiscard]] Judged best() const {
    const Triangle beside = rolled(), between = pulled(beside);
    for (const Triangle& start : {beside, between}) {
      if (Judged found = improved(start); found.broken.empty()) return found;
    }
    Judged first = judged(beside, {}), second = judged(between, {});
    return first.cost() <= second.cost() ? first : second;
  }

  // Joins neighbours of the tile across its other sides if they keep the limits of a joint.
  void join(PlacedModule& m, ModuleLayout& layout) const {
    const int id = static_cast<int>(layout.modules.size());
    for (int s = 0; s < 3; ++s) {
      const TileSide next = across(tile_, s);
      for (const int k : near_) {
        PlacedModule& other = layout.modules[at(k)];
        if (other.island != m.island || other.tile != next.tile || other.neighbour[at(next.side)] >= 0) continue;
        Judged joint;
        judge_joint(m, s, k, joint);
        if (joint.worst > 1.0) continue;
        m.neighbour[at(s)] = k;
        other.neighbour[at(next.side)] = id;
      }
    }
  }

 private:
  void require_free_tile() const {
    const auto& modules = layout_.modules;
    const auto holder = std::ranges::find_if(
        modules, [&](const PlacedModule& m) { return m.island == modules[at(beside_)].island && m.tile == tile_; });
    if (holder == modules.end()) return;
    throw InputError(fmt::format("side {} of module {} lies at a slit: module {} has the tile across it", side_,
                                 design::number_of(layout_, beside_),
                                 design::number_of(layout_, static_cast<int>(holder - modules.begin()))));
  }

  // Finds the third corner by turning the height about the side until it meets the surface.
  [[nodiscard]] Triangle rolled() const {
    const auto& c = layout_.modules[at(beside_)].corner_mm;
    const Vec3 &a = c[at(side_)], &b = c[at((side_ + 1) % 3)];
    const Vec3 middle = (a + b) / 2.0, along = (b - a).normalized();
    Vec3 direction = middle - c[at((side_ + 2) % 3)];
    direction = (direction - direction.dot(along) * along).normalized();
    Vec3 apex = middle + kHeight_mm * direction;
    for (int k = 0; k < 5; ++k) {
      const Vec3 d = surface_.closest(apex).position_mm - middle;
      const Vec3 off = d - d.dot(along) * along;
      if (off.norm() < 1.0) break;
      apex = middle + kHeight_mm * off.normalized();
    }
    Triangle t;
    t[at(its_side_)] = b;
    t[at((its_side_ + 1) % 3)] = a;
    t[at((its_side_ + 2) % 3)] = apex;
    return t;
  }

  // Moves each corner to the middle of the corners that neighbours in the lattice have near it.
  [[nodiscard]] Triangle pulled(const Triangle& from) const {
    const int island = layout_.modules[at(beside_)].island;
    Triangle t = from;
    for (int c = 0; c < 3; ++c) {
      Vec3 sum = Vec3::Zero();
      int count = 0;
      for (const int k : near_) {
        const PlacedModule& m = layout_.modules[at(k)];
        for (int d = 0; m.island == island && d < 3; ++d) {
          if (tile_corner_index(m.tile, d) != tile_corner_index(tile_, c)) continue;
          if ((m.corner_mm[at(d)] - from[at(c)]).norm() > kSnap_mm) continue;
          sum += m.corner_mm[at(d)];
          ++count;
        }
      }
      if (count > 0) t[at(c)] = sum / count;
    }
    return t;
  }

  // Slides, turns and lifts the module while that helps: a compass search over two directions, a turn (as mm at the
  // corners) and the lift.
  [[nodiscard]] Judged improved(const Triangle& start) const {
    std::array<double, 4> x{};
    Judged best = judged(start, x);
    for (double step = kFirstStep; step > kLastStep && best.worst > kEnough;) {
      bool is_better = false;
      for (std::size_t k = 0; k < x.size(); ++k) {
        for (const double by : {step, -step}) {
          std::array<double, 4> y = x;
          y[k] += by;
          if (y[3] < 0.0 || y[3] > kMaxLift_mm) continue;
          Judged trial = judged(start, y);
          if (trial.cost() >= best.cost() - 1e-9) continue;
          best = std::move(trial);
          x = y;
          is_better = true;
          break;
        }
      }
      if (!is_better) step /= 2.0;
    }
    return best;
  }

  [[nodiscard]] Judged judged(const Triangle& start, const std::array<double, 4>& x) const {
    const Vec3 center = center_of(start), n = normal_of(start), u = (start[1] - start[0]).normalized(), v = n.cross(u);
    Triangle moved;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 d = start[c] - center;
      const Vec3 p = start[c] + x[0] * u + x[1] * v + x[2] / d.norm() * n.cross(d);
      moved[c] = x == std::array<double, 4>{} ? p : on_surface(p, n, x[3]);
    }
    Judged j;
    j.module.island = layout_.modules[at(beside_)].island;
    j.module.tile = tile_;
    j.module.corner_mm = lattice::fit_rigid(moved);
    judge(j);
    return j;
  }

  // A corner beyond the border lies on the continued plane.
  [[nodiscard]] Vec3 on_surface(const Vec3& p, const Vec3& normal, double lift_mm) const {
    const mesh::SurfacePoint foot = surface_.closest(p);
    const Vec3 off = p - foot.position_mm;
    return p - off.dot(normal) * normal + lift_mm * surface_.normal_at(foot);
  }

  void judge(Judged& j) const {
    PlacedModule& m = j.module;
    const auto allowed = [](double limit) { return kFinalMargin * limit; };
    judge_joint(m, its_side_, beside_, j);
    for (const int k : near_) judge_overlap(m, k, j);
    if (j.worst > kHopeless) {  // Further measurements would only take time.
      j.sum += kFar;
      return;
    }
    measure_on_surface(surface_, m, layout_.corner_cut_mm, regions_);
    j.add("center_gap_mm", m.center_gap_mm, allowed(limits_.center_gap_mm));
    j.add("overrun_mm", m.overrun_mm, allowed(limits_.overrun_mm));
    j.add("lift_mm", m.edge_lift_mm, allowed(limits_.lift_mm));
    j.add("depth_mm", m.edge_depth_mm, allowed(limits_.depth_mm));
    j.add("keep_out", m.keep_out_mm, allowed(limits_.overrun_mm));
    const Vec3 under = surface_.normal_at(surface_.closest(center_of(m.corner_mm)));
    if (const double cosine = under.dot(normal_of(m.corner_mm)); cosine < kOutward)
      j.add("outward", std::acos(std::clamp(cosine, -1.0, 1.0)), 0.5 * std::acos(kOutward));
  }

  void judge_joint(const PlacedModule& m, int s, int other, Judged& j) const {
    const PlacedModule& o = layout_.modules[at(other)];
    const int t = across(m.tile, s).side;
    const Vec3 &a = m.corner_mm[at(s)], &b = m.corner_mm[at((s + 1) % 3)], &c = o.corner_mm[at((t + 1) % 3)],
               &d = o.corner_mm[at(t)];
    const Vec3 n = normal_of(m.corner_mm), q = normal_of(o.corner_mm);
    j.add("hinge_gap_mm", std::max((a - c).norm(), (b - d).norm()), kFinalMargin * limits_.hinge_gap_mm, other);
    j.add("fold_rad", std::atan2(n.cross(q).norm(), n.dot(q)), kFinalMargin * fold_limit_between(limits_, n, q, b - a),
          other);
    j.add("edge_error_mm", std::abs((0.5 * (b + d) - 0.5 * (a + c)).norm() - kSide_mm),
          kFinalMargin * limits_.edge_error_mm, other);
  }

  void judge_overlap(const PlacedModule& m, int other, Judged& j) const {
    const PlacedModule& o = layout_.modules[at(other)];
    double depth_mm = penetration_depth(m.corner_mm, o.corner_mm, layout_.corner_cut_mm);
    const double allowed_mm = kFinalMargin * limits_.penetration_mm;
    if (depth_mm <= allowed_mm && lattice::pierced(m.corner_mm, o.corner_mm, layout_.corner_cut_mm, allowed_mm))
      depth_mm = 1.01 * allowed_mm;
    if (depth_mm > 0.0) j.add("penetration_mm", depth_mm, allowed_mm, other);
  }

  const mesh::Surface& surface_;
  const LayoutLimits& limits_;
  const mesh::SurfaceRegions* regions_;
  const ModuleLayout& layout_;
  int beside_, side_, its_side_ = 0;
  Tile tile_;
  std::vector<int> near_;
};

}  // namespace

std::vector<BrokenLimit> add_module(const mesh::Surface& surface, const LayoutLimits& limits,
                                    const mesh::SurfaceRegions* regions, ModuleLayout& layout, int id, int side) {
  const ModulePlacer placer(surface, limits, regions, layout, id, side);
  Judged best = placer.best();
  if (best.broken.empty()) {
    placer.join(best.module, layout);
    layout.modules.push_back(best.module);
  }
  std::ranges::stable_sort(best.broken, std::greater{}, [](const BrokenLimit& b) { return b.measured / b.allowed; });
  return std::move(best.broken);
}

}  // namespace triskin::lattice
