// SPDX-License-Identifier: GPL-3.0-or-later
#include "side_decision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

constexpr double kDecided = 0.15;  // |outwardness| from which a region is decided; see docs/mesh.md
constexpr double kWeak = 0.3, kBeyondDoubt = 0.5;
constexpr double kPocket = -0.3;  // The floor of a thick body below this outwardness is a pocket.
constexpr double kHiddenVisibility = 0.2;
constexpr double kWalledRegion = 0.5;  // A region counts as walled when this share of its area has a wall.
// An edge weighs as much as a strip of this width. It weighs more if the sheets across the wall meet behind it too,
// because then the wall as a whole turns there; at the foot of a rib it does not.
constexpr double kBesideWidth_mm = 12.0, kBendWidth_mm = 100.0;
constexpr double kAcrossWeight = 1.0;
constexpr double kRibFoot = 0.2;         // This share of a rib's border is its foot.
constexpr double kMaxRibFraction = 0.3;  // A larger share of the outer area is no rib.
// A region has this share of another outer region right behind it when the two lie back to back.
constexpr double kBackToBack = 0.3;
constexpr double kRecessBorder = 0.85;    // This share of a recess's border lies on outer regions; holes take the rest.
constexpr double kRimSurroundings = 0.9;  // This share of a rim strip's border lies on outer regions.
constexpr double kMinUndecided_mm2 = 400.0, kMaxUndecidedFraction = 0.15, kLargeRegion = 0.05;
constexpr double kMinWalledFraction = 0.25, kMinInnerFraction = 0.05;
constexpr double kJoinedFraction = 0.1;  // The lesser side of a component must have this fraction of its walled area.
constexpr int kPasses = 400;
constexpr double kSettled = 1e-5;

class Decision {
 public:
  Decision(const SideEvidence& evidence, const SideOptions& options) : evidence_(evidence), options_(options) {}

  SideDecision run() {
    const std::size_t n = evidence_.regions.size();
    out_.side.assign(n, FaceSide::kOuter);
    out_.choice.assign(n, 0);
    out_.outwardness.assign(n, 0.0);
    if (!has_enough_wall()) return std::move(out_);
    gather_bonds();
    std::vector<double> wanted, weight;
    for (const RegionEvidence& e : evidence_.regions) {
      wanted.push_back(e.outwardness);
      weight.push_back(e.outwardness_mm2 + 1e-6);
    }
    out_.outwardness = relaxed(wanted, weight);
    out_.enclosed = static_cast<int>(std::ranges::count(evidence_.is_component_enclosed, true));
    label_regions();
    label_strips();
    label_ribs();
    doubt();
    drop_lone_strips();
    judge();
    return std::move(out_);
  }

 private:
  struct Bond {
    int other;
    double weight, sign;  // A sign of −1 says that the two regions should differ.
  };

  [[nodiscard]] const RegionEvidence& region(int r) const { return evidence_.regions[at(r)]; }
  [[nodiscard]] bool has_wall(int r) const {
    const RegionEvidence& e = region(r);
    return e.walled_mm2 - e.self_mm2 >= kWalledRegion * e.area_mm2;
  }
  // A strip is as narrow as the wall is thick.
  [[nodiscard]] bool is_strip(int r) const {
    return !has_wall(r) && 2.0 * region(r).area_mm2 < options_.max_wall_mm * region(r).border_mm;
  }
  [[nodiscard]] bool is_too_narrow(int r) const { return is_narrow(region(r).area_mm2, region(r).border_mm); }
  [[nodiscard]] bool is_enclosed(int r) const { return evidence_.is_component_enclosed[at(region(r).component)]; }
  [[nodiscard]] int count() const { return static_cast<int>(evidence_.regions.size()); }

  [[nodiscard]] bool has_enough_wall() const {
    double walled = 0.0, all = 0.0;
    for (int r = 0; r < count(); ++r) {
      all += region(r).area_mm2;
      if (has_wall(r)) walled += region(r).area_mm2;
    }
    if (options_.is_asked()) return walled > 0.0;
    const bool is_closed = std::ranges::all_of(evidence_.is_component_closed, [](bool c) { return c; });
    return walled >= (is_closed ? kMinInnerFraction : kMinWalledFraction) * all;
  }

  void gather_bonds() {
    bonds_.resize(evidence_.regions.size());
    partner_ = partners();
    const auto bond = [&](const RegionPair& p, double weight, double sign) {
      bonds_[at(p.first)].push_back({p.second, weight, sign});
      bonds_[at(p.second)].push_back({p.first, weight, sign});
    };
    for (const auto& [pair, area] : evidence_.across_mm2) bond(pair, kAcrossWeight * area, -1.0);
    for (const auto& [pair, length] : evidence_.beside_mm) {
      if (!has_wall(pair.first) || !has_wall(pair.second)) continue;
      bond(pair, (is_bend(pair) ? kBendWidth_mm : kBesideWidth_mm) * length, 1.0);
    }
  }

  // Finds for each region the one across the wall of most of its area; −1 if there is none.
  [[nodiscard]] std::vector<int> partners() const {
    std::vector<int> partner(evidence_.regions.size(), -1);
    std::vector<double> most(partner.size(), 0.0);
    const auto take = [&](int r, int other, double area) {
      if (area <= most[at(r)]) return;
      most[at(r)] = area;
      partner[at(r)] = other;
    };
    for (const auto& [pair, area] : evidence_.across_mm2) {
      take(pair.first, pair.second, area);
      take(pair.second, pair.first, area);
    }
    return partner;
  }
  [[nodiscard]] bool is_bend(const RegionPair& pair) const {
    const int a = partner_[at(pair.first)], b = partner_[at(pair.second)];
    return a >= 0 && b >= 0 && a != pair.second && a != b && evidence_.beside_mm.contains(std::minmax(a, b));
  }

  // Gauss-Seidel converges because the matrix is dominated by its diagonal.
  [[nodiscard]] std::vector<double> relaxed(const std::vector<double>& wanted,
                                            const std::vector<double>& weight) const {
    std::vector<double> x = wanted;
    for (int pass = 0; pass < kPasses; ++pass) {
      double change = 0.0;
      for (std::size_t r = 0; r < x.size(); ++r) {
        double sum = weight[r] * wanted[r], total = weight[r];
        for (const Bond& b : bonds_[r]) {
          sum += b.weight * b.sign * x[at(b.other)];
          total += b.weight;
        }
        const double next = sum / total;
        change = std::max(change, std::abs(next - x[r]));
        x[r] = next;
      }
      if (change < kSettled) break;
    }
    return x;
  }

  void label_regions() {
    for (int r = 0; r < count(); ++r) {
      const double x = out_.outwardness[at(r)];
      FaceSide& side = out_.side[at(r)];
      if (!options_.from_mm && (region(r).visibility < kHiddenVisibility || is_enclosed(r))) {
        side = FaceSide::kInner;
      } else if (has_wall(r)) {
        side = x >= kDecided ? FaceSide::kOuter : x <= -kDecided ? FaceSide::kInner : FaceSide::kUndecided;
      } else if (is_strip(r)) {
        side = FaceSide::kRim;
      } else {
        side = x <= kPocket ? FaceSide::kInner : FaceSide::kOuter;
      }
    }
  }

  // A chamfer between two outer faces is no rim, and a strip beside anything else is one.
  void label_strips() {
    const std::vector<double> outer_mm = outer_borders_mm();
    for (int r = 0; r < count(); ++r) {
      FaceSide& side = out_.side[at(r)];
      if (!is_strip(r) || (side != FaceSide::kRim && side != FaceSide::kOuter)) continue;
      side = outer_mm[at(r)] >= kRimSurroundings * region(r).border_mm ? FaceSide::kOuter : FaceSide::kRim;
    }
  }

  // Regions that stand on the inner side alone are inside: a rib looks alike on both sides, and the last one of a row
  // even looks outer.
  void label_ribs() {
    std::vector<double> inner_mm(evidence_.regions.size(), 0.0), outer_mm = inner_mm;
    const auto count_border = [&](int r, int other, double length) {
      if (partner_[at(r)] == other || !has_wall(other)) return;
      if (out_.side[at(other)] == FaceSide::kInner) inner_mm[at(r)] += length;
      if (out_.side[at(other)] == FaceSide::kOuter) outer_mm[at(r)] += length;
    };
    for (const auto& [pair, length] : evidence_.beside_mm) {
      count_border(pair.first, pair.second, length);
      count_border(pair.second, pair.first, length);
    }
    const double most = kMaxRibFraction * area_of(FaceSide::kOuter);
    for (int r = 0; r < count(); ++r) {
      const bool stands = inner_mm[at(r)] >= kRibFoot * region(r).border_mm && outer_mm[at(r)] < inner_mm[at(r)];
      FaceSide& side = out_.side[at(r)];
      if (side == FaceSide::kUndecided && is_too_narrow(r)) side = FaceSide::kRim;
      const bool may_be_rib = has_wall(r) || outer_mm[at(r)] == 0.0;  // The walls of a honeycomb's cell have no wall.
      if (side == FaceSide::kUndecided || (side == FaceSide::kOuter && may_be_rib && region(r).area_mm2 < most))
        side = stands ? FaceSide::kInner : side;
    }
  }

  // Returns the length of each region's border that lies on outer regions.
  [[nodiscard]] std::vector<double> outer_borders_mm() const {
    std::vector<double> outer_mm(evidence_.regions.size(), 0.0);
    for (const auto& [pair, length] : evidence_.beside_mm) {
      if (out_.side[at(pair.first)] == FaceSide::kOuter) outer_mm[at(pair.second)] += length;
      if (out_.side[at(pair.second)] == FaceSide::kOuter) outer_mm[at(pair.first)] += length;
    }
    return outer_mm;
  }

  // Doubts regions that are outer only through their neighbours, against their own evidence, and pairs of which both
  // are outer. The floor of a recess in the outer side sees less than its back, but all around it the outer side goes
  // on; the brim of a hat ends at a rim.
  void doubt() {
    const std::vector<double> outer_mm = outer_borders_mm();
    for (int r = 0; r < count(); ++r) {
      if (out_.side[at(r)] != FaceSide::kOuter || !has_wall(r) || region(r).outwardness > -kDecided) continue;
      if (out_.outwardness[at(r)] >= kWeak && outer_mm[at(r)] >= kRecessBorder * region(r).border_mm) continue;
      out_.side[at(r)] = is_too_narrow(r) ? FaceSide::kRim : FaceSide::kUndecided;
      const int partner = partner_[at(r)];
      if (partner >= 0 && partner_[at(partner)] == r && out_.side[at(r)] == FaceSide::kUndecided)
        out_.side[at(partner)] = FaceSide::kUndecided;
    }
    for (const auto& [pair, area] : evidence_.across_mm2) {
      auto [less, more] = pair;
      if (out_.outwardness[at(less)] > out_.outwardness[at(more)]) std::swap(less, more);
      const bool both = out_.side[at(less)] == FaceSide::kOuter && out_.side[at(more)] == FaceSide::kOuter;
      if (both && area > kBackToBack * region(less).area_mm2) out_.side[at(less)] = FaceSide::kRim;
    }
  }

  // The last rib of a row may see as much as the outer side does. No module fits on it, and none reaches it without
  // crossing a rim from outer regions on which one fits, so it is left out.
  void drop_lone_strips() {
    const auto is_outer = [&](int r) { return out_.side[at(r)] == FaceSide::kOuter; };
    std::vector<std::vector<int>> beside(evidence_.regions.size());
    for (const auto& [pair, length] : evidence_.beside_mm) {
      beside[at(pair.first)].push_back(pair.second);
      beside[at(pair.second)].push_back(pair.first);
    }
    std::vector<int> reached;
    std::vector<bool> is_reached(evidence_.regions.size(), false);
    for (int r = 0; r < count(); ++r) {
      if (is_outer(r) && !is_too_narrow(r)) reached.push_back(r);
    }
    if (reached.empty()) return;
    for (const int r : reached) is_reached[at(r)] = true;
    for (std::size_t k = 0; k < reached.size(); ++k) {
      for (const int next : beside[at(reached[k])]) {
        if (!is_outer(next) || is_strip(next) || is_reached[at(next)]) continue;
        is_reached[at(next)] = true;
        reached.push_back(next);
      }
    }
    for (int r = 0; r < count(); ++r) {
      if (is_outer(r) && has_wall(r) && !is_reached[at(r)]) out_.side[at(r)] = FaceSide::kRim;
    }
    label_strips();
  }

  [[nodiscard]] double area_of(FaceSide side) const {
    double area = 0.0;
    for (int r = 0; r < count(); ++r) area += out_.side[at(r)] == side ? region(r).area_mm2 : 0.0;
    return area;
  }

  void judge() {
    const double outer = area_of(FaceSide::kOuter), inner = area_of(FaceSide::kInner),
                 undecided = area_of(FaceSide::kUndecided), all = outer + inner + undecided + area_of(FaceSide::kRim);
    out_.has_wall =
        inner + undecided >= (options_.is_asked() ? 0.0 : kMinInnerFraction) * all && inner + undecided > 0.0;
    out_.has_loose_sheets =
        out_.has_wall && options_.wanted == SideWanted::kAuto && options_.choice == 0 && !is_joined();
    if (out_.has_loose_sheets) out_.has_wall = false;
    if (!out_.has_wall) {
      out_.side.assign(out_.side.size(), FaceSide::kOuter);
      return;
    }
    for (int r = 0; r < count(); ++r) {
      const bool counts = out_.side[at(r)] == FaceSide::kOuter || out_.side[at(r)] == FaceSide::kUndecided;
      if (counts && has_wall(r) && region(r).area_mm2 > kLargeRegion * outer)
        out_.margin = std::min(out_.margin, std::abs(out_.outwardness[at(r)]));
    }
    out_.is_certain = 0.5 * undecided < std::max(kMinUndecided_mm2, undecided_fraction() * (outer + 0.5 * undecided));
    if (!out_.is_certain) open_weak_regions();
    number_choices();
  }

  // Beside a clear outer side, a large part may stay undecided; beside a doubtful one only little may, as on a flat
  // panel whose rim and bulge contradict each other.
  [[nodiscard]] double undecided_fraction() const {
    double sum = 0.0, area = 0.0;
    for (int r = 0; r < count(); ++r) {
      if (out_.side[at(r)] != FaceSide::kOuter || !has_wall(r)) continue;
      sum += out_.outwardness[at(r)] * region(r).area_mm2;
      area += region(r).area_mm2;
    }
    const double mean = area > 0.0 ? sum / area : 1.0;
    return kMaxUndecidedFraction * std::clamp((mean - kDecided) / (kBeyondDoubt - kDecided), 0.0, 1.0);
  }

  // If the user is asked anyway, the question includes the weakly decided regions.
  void open_weak_regions() {
    for (int r = 0; r < count(); ++r) {
      FaceSide& side = out_.side[at(r)];
      const bool is_decided = side == FaceSide::kOuter || side == FaceSide::kInner;
      if (is_decided && has_wall(r) && !is_enclosed(r) && std::abs(out_.outwardness[at(r)]) < kWeak)
        side = FaceSide::kUndecided;
    }
  }

  // Tells whether most of the wall has both its sides in one component, as a solid has. Two sheets that no rim joins
  // may be two separate surfaces, and the inner one would disappear without a question.
  [[nodiscard]] bool is_joined() const {
    std::map<int, std::array<double, 2>> sides;  // For each component, the areas of outer and other regions.
    for (int r = 0; r < count(); ++r) {
      const FaceSide side = out_.side[at(r)];
      if (has_wall(r) && side != FaceSide::kRim)
        sides[region(r).component][side == FaceSide::kOuter ? 0 : 1] += region(r).area_mm2;
    }
    double joined = 0.0, all = 0.0;
    for (const auto& [component, area] : sides) {
      all += area[0] + area[1];
      const bool is_solid = evidence_.is_component_closed[at(component)];
      if (is_solid || std::min(area[0], area[1]) > kJoinedFraction * (area[0] + area[1])) joined += area[0] + area[1];
    }
    return joined >= 0.5 * all;
  }

  // Numbers the undecided regions that belong together: the largest one counts as the outer side, and the others follow
  // it.
  void number_choices() {
    const auto is_open = [&](std::size_t r) { return out_.side[r] == FaceSide::kUndecided && out_.choice[r] == 0; };
    for (;;) {
      int seed = -1;
      for (int r = 0; r < count(); ++r) {
        if (is_open(at(r)) && (seed < 0 || region(r).area_mm2 > region(seed).area_mm2)) seed = r;
      }
      if (seed < 0) return;
      std::vector<double> wanted(evidence_.regions.size(), 0.0), weight(evidence_.regions.size(), 1e-3);
      wanted[at(seed)] = 1.0;
      weight[at(seed)] = 1e12;
      const std::vector<double> x = relaxed(wanted, weight);
      double sum = 0.0;
      for (std::size_t r = 0; r < x.size(); ++r) {
        if (is_open(r)) sum += x[r] * evidence_.regions[r].area_mm2 * out_.outwardness[r];
      }
      const double sign = sum < 0.0 ? -1.0 : 1.0;
      for (std::size_t r = 0; r < x.size(); ++r) {
        if (is_open(r) && (std::abs(x[r]) > 1e-3 || static_cast<int>(r) == seed))
          out_.choice[r] = sign * x[r] > 0.0 ? 1 : 2;
      }
    }
  }

  const SideEvidence& evidence_;
  const SideOptions& options_;
  std::vector<std::vector<Bond>> bonds_;
  std::vector<int> partner_;
  SideDecision out_;
};

}  // namespace

SideDecision decide_sides(const SideEvidence& evidence, const SideOptions& options) {
  return Decision(evidence, options).run();
}

}  // namespace triskin::mesh
