// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/check/placement_proof.hpp"

#include <fmt/format.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <set>

#include "joint_bound.hpp"
#include "motion_region.hpp"
#include "ring_rules.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::check {
namespace {

// Above this, building the list of modules would take longer than the work it saves.
constexpr double kListReach_mm = 40.0;
constexpr int kDeepest = 26;     // One cell of the log is halved at most this often.
constexpr int kJointEvery = 3;   // This many halvings separate two searches for contradictions.
constexpr int kJointCredit = 6;  // After a search that helped, this many regions are searched.
// The placement itself is rounded by this much beside its tolerance, or more if it is far away.
constexpr double kSpare_mm = 1e-9;
// The pitch of hexagons is an irrational number, so that a gap of 0 is known to this length only.
constexpr double kNoGap_mm = 1e-12;

struct Rejected {
  std::string reason;
};

bool contains(const ProofBox& outer, const ProofBox& inner) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (outer.low[k] > inner.low[k] || outer.high[k] < inner.high[k]) return false;
  }
  return true;
}
bool overlaps(const ProofBox& a, const ProofBox& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (a.low[k] >= b.high[k] || a.high[k] <= b.low[k]) return false;
  }
  return true;
}

class Checker {
 public:
  Checker(const ProofLog& log, const ProofPolygon& polygon, std::int64_t& regions, std::int64_t& pairs)
      : log_(log), polygon_(polygon), regions_(regions), pairs_(pairs) {
    limit_ = 200'000 + 100 * static_cast<std::int64_t>(log.cells.size());
  }

  // Where the bound is `proved` already, the cells only have to cover the period.
  void run(bool proved) {
    proved_ = proved;
    const ProofBox period{{0.0, 0.0, 0.0},
                          {polygon_.pitch_mm(), polygon_.pitch_mm() * polygon_.module().row_height.high,
                           polygon_.module().period_high_rad}};
    std::vector<std::uint32_t> cells(log_.cells.size());
    for (std::uint32_t k = 0; k < cells.size(); ++k) cells[k] = k;
    cover(period, cells, nullptr, 1e300);
  }

 private:
  // Splits the region along faces of cells until each part lies in one of them; `list` has the modules of a region
  // around it, or is null while it would be too long.
  void cover(const ProofBox& region, const std::vector<std::uint32_t>& cells, const CandidateList* list,
             double list_reach) {
    const double reach = MotionRegion(polygon_, region).reach_mm();
    const bool in_one = std::ranges::any_of(cells, [&](std::uint32_t c) { return contains(log_.cells[c], region); });
    CandidateList own;
    if (!proved_ && reach < kListReach_mm && (in_one || reach < 0.7 * list_reach)) {
      own = narrowed(region, list);
      list = &own;
      list_reach = reach;
    }
    const bool proves = !proved_ && list == &own && own.bound() <= log_.upper_bound;
    if (in_one) {
      if (!proved_ && !proves && !(list == &own && joint_credit_ > 0 && closed_jointly(region, own, kDeepest)))
        halve(region, list, kDeepest);
      return;
    }
    if (proves) proved_ = true;  // The parts must only be covered by cells.
    for (const auto& [part, inner] : divided(region, cells)) cover(part, inner, list, list_reach);
    if (proves) proved_ = false;
  }

  struct Part {
    ProofBox region;
    std::vector<std::uint32_t> cells;
  };
  [[nodiscard]] std::array<Part, 2> divided(const ProofBox& region, const std::vector<std::uint32_t>& cells) const {
    const auto [axis, at] = best_face(region, cells);
    std::array<Part, 2> parts{Part{region, {}}, Part{region, {}}};
    parts[0].region.high[axis] = at;
    parts[1].region.low[axis] = at;
    for (Part& part : parts) {
      std::ranges::copy_if(cells, std::back_inserter(part.cells),
                           [&](std::uint32_t c) { return overlaps(log_.cells[c], part.region); });
    }
    return parts;
  }

  // Picks, among some faces per axis, the one that leaves the fewest cells on its fuller side.
  [[nodiscard]] std::pair<std::size_t, double> best_face(const ProofBox& region,
                                                         const std::vector<std::uint32_t>& cells) const {
    std::size_t best_axis = 0, fewest = cells.size() * 2 + 2;
    double best = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<double> faces;
      for (const std::uint32_t c : cells) {
        for (const double f : {log_.cells[c].low[axis], log_.cells[c].high[axis]}) {
          if (f > region.low[axis] && f < region.high[axis]) faces.push_back(f);
        }
      }
      std::ranges::sort(faces);
      for (std::size_t q = 1; q < 8 && !faces.empty(); ++q) {
        const double f = faces[faces.size() * q / 8];
        std::size_t low = 0, high = 0;
        for (const std::uint32_t c : cells) {
          low += log_.cells[c].low[axis] < f ? 1 : 0;
          high += log_.cells[c].high[axis] > f ? 1 : 0;
        }
        if (std::max(low, high) >= fewest) continue;
        fewest = std::max(low, high);
        best_axis = axis;
        best = f;
      }
    }
    if (fewest > cells.size() * 2) {
      throw Rejected{fmt::format("no cell covers x {}, y {}, theta {}", region.low[0], region.low[1], region.low[2])};
    }
    return {best_axis, best};
  }

  CandidateList narrowed(const ProofBox& box, const CandidateList* list) {
    if (++regions_ > limit_) throw Rejected{"the cells are too coarse: their bound cannot be shown"};
    const MotionRegion region(polygon_, box);
    return list != nullptr ? region.filtered(*list) : region.all();
  }

  // Takes one cell of the log and halves it if a bound over the whole of it is too weak.
  void halve(const ProofBox& box, const CandidateList* list, int deepest) {
    if (deepest == 0) {
      throw Rejected{fmt::format("more than {} modules may lie inside near x {}, y {}, theta {}", log_.upper_bound,
                                 box.low[0], box.low[1], box.low[2])};
    }
    std::array<double, 3> width{};
    for (std::size_t k = 0; k < 3; ++k) width[k] = (box.high[k] - box.low[k]) * (k == 2 ? polygon_.radius_mm() : 1.0);
    const auto axis = static_cast<std::size_t>(std::ranges::max_element(width) - width.begin());
    const double middle = 0.5 * (box.low[axis] + box.high[axis]);
    for (const bool upper : {false, true}) {
      ProofBox part = box;
      (upper ? part.low : part.high)[axis] = middle;
      if (part.low[axis] > box.high[axis] || part.high[axis] < box.low[axis]) continue;
      CandidateList own = narrowed(part, list);
      if (own.bound() <= log_.upper_bound || closed_jointly(part, own, deepest)) continue;
      halve(part, &own, deepest - 1);
    }
  }

  // Looks for needs of modules that contradict each other if halving alone has not helped: first at once, rarely after
  // it failed, more often after it helped.
  bool closed_jointly(const ProofBox& box, CandidateList& list, int deepest) {
    if (joint_credit_ == 0 && (kDeepest - deepest) % kJointEvery != kJointEvery - 1) return false;
    const MotionRegion region(polygon_, box);
    JointBound joint(region, list);
    const bool closed = joint.holds(list, log_.upper_bound);
    pairs_ += joint.pairs_compared();
    joint_credit_ = closed ? kJointCredit : std::max(0, joint_credit_ - 1);
    return closed;
  }

  const ProofLog& log_;
  const ProofPolygon& polygon_;
  std::int64_t &regions_, &pairs_;
  std::int64_t limit_ = 0;
  int joint_credit_ = 0;
  bool proved_ = false;
};

ProofModule require_header(const ProofLog& log, const std::vector<std::array<PlanePoint, 2>>& edges) {
  if (edges.empty() || edges != edge_set(log.rings))
    throw Rejected{"the polygon of the log is not the polygon of the file"};
  if (!log.shape) throw Rejected{fmt::format("\"shape\" must be {}", kProofShapeNames.list())};
  const double max_cut_mm = *log.shape == ProofShape::kTriangle ? kMaxProofCut_mm : 0.0;
  if (!(log.corner_cut_mm >= 0.0 && log.corner_cut_mm <= max_cut_mm)) throw Rejected{"corner_cut_mm is out of range"};
  ProofModule module = proof_module(*log.shape, log.corner_cut_mm);
  if (!(log.pitch_mm >= module.min_pitch_mm && log.pitch_mm <= 1000.0)) throw Rejected{"pitch_mm is out of range"};
  if (!(log.tolerance_mm > 0.0 && log.tolerance_mm <= 1.0)) throw Rejected{"tolerance_mm is out of range"};
  if (log.upper_bound < log.modules)
    throw Rejected{fmt::format("the bound {} is below the {} modules that are claimed", log.upper_bound, log.modules)};
  for (const ProofBox& c : log.cells) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (c.low[k] > c.high[k] || std::abs(c.low[k]) > 1e6 || std::abs(c.high[k]) > 1e6)
        throw Rejected{"a cell is not a box"};
    }
  }
  return module;
}

// Returns the rounding of the motion, which grows with the distance.
double rounding_of(const ProofLog& log, const ProofPolygon& polygon) {
  const double far_mm = polygon.radius_mm() + std::hypot(log.pivot[0], log.pivot[1]);
  return std::max(kSpare_mm, 4.0 * 0x1p-52 * far_mm);
}

void require_placement(const ProofLog& log, const ProofPolygon& polygon, double rounding_mm) {
  if (static_cast<int>(log.tiles.size()) != log.modules)
    throw Rejected{"the placement does not list as many modules as it claims"};
  if (std::set<ProofTile>(log.tiles.begin(), log.tiles.end()).size() != log.tiles.size())
    throw Rejected{"the placement lists a module twice"};
  const MotionRegion here(polygon, {log.motion, log.motion});
  for (const ProofTile& t : log.tiles) {
    if (!t.up && !polygon.module().has_down) throw Rejected{"modules of this shape are never down"};
    if (!here.holds(t, log.tolerance_mm + rounding_mm))
      throw Rejected{fmt::format("module ({}, {}, {}) does not lie inside", t.i, t.j, t.up ? "up" : "down")};
  }
}

IntervalPoint difference(const PlanePoint& a, const PlanePoint& b) {
  return {Interval(a[0]) - Interval(b[0]), Interval(a[1]) - Interval(b[1])};
}

// Uses the shoelace formula about the first point; holes are the rings after the first.
Interval area_of(const std::vector<Ring>& rings) {
  Interval area;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    Interval twice;
    for (std::size_t k = 0; k < rings[r].size(); ++k) {
      const PlanePoint &o = rings[r][0], &a = rings[r][k], &b = rings[r][(k + 1) % rings[r].size()];
      const IntervalPoint u = difference(a, o), v = difference(b, o);
      twice = twice + (u.x * v.y - v.x * u.y);
    }
    const bool is_clockwise = middle(twice) < 0.0;
    const Interval size = Interval(0.5) * (is_clockwise ? -twice : twice);
    area = r == 0 ? size : area - size;
  }
  return area;
}

// Modules of one placement do not overlap, so their areas add up to no more than the outline's.
bool proved_by_area(const ProofLog& log, const std::vector<Ring>& rings, const ProofModule& module) {
  const Interval one_more = Interval(log.upper_bound + 1.0) * module.area_mm2();
  return one_more.low > area_of(rings).high;
}

std::string hash_of(const std::vector<std::array<PlanePoint, 2>>& edges) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const auto& edge : edges) {
    for (const PlanePoint& p : edge) {
      for (const double coordinate : p) {
        // Adding 0 turns −0 into 0, which must have the same hash.
        const auto bits = std::bit_cast<std::uint64_t>(coordinate + 0.0);
        for (int k = 0; k < 64; k += 8) hash = (hash ^ ((bits >> k) & 0xff)) * 0x100000001b3;
      }
    }
  }
  return fmt::format("{:016x}", hash);
}

ProofReport said_by(const ProofLog& log, const std::vector<Ring>& rings) {
  ProofReport report;
  report.modules = log.modules;
  report.upper_bound = log.upper_bound;
  report.cells = static_cast<std::int64_t>(log.cells.size());
  report.tolerance_mm = log.tolerance_mm;
  report.corner_cut_mm = log.corner_cut_mm;
  report.outline_area_mm2 = middle(area_of(rings));
  report.outline_hash = hash_of(edge_set(rings));
  if (!log.shape) return report;
  report.shape = kProofShapeNames.name(*log.shape);
  // Facing sides of triangles move apart by 1/√3 of the growth of the pitch.
  const double wider_mm = log.pitch_mm - proof_module(*log.shape, 0.0).min_pitch_mm;
  report.gap_mm = std::max(0.0, *log.shape == ProofShape::kTriangle ? wider_mm / std::sqrt(3.0) : wider_mm);
  if (report.gap_mm < kNoGap_mm) report.gap_mm = 0.0;
  return report;
}

void require_number(const char* what, const std::optional<double>& wanted, double is, double allowed) {
  if (wanted && !(std::abs(*wanted - is) <= allowed))
    throw Rejected{fmt::format("the proof is about {} {:g} mm, not {:g} mm", what, is, *wanted)};
}

void require_expected(const ProofReport& report, const ProofExpectation& expected) {
  require_number("a tolerance of", expected.tolerance_mm, report.tolerance_mm, 1e-12 * report.tolerance_mm);
  require_number("a gap of", expected.gap_mm, report.gap_mm, 1e-9);
  require_number("a corner cut of", expected.corner_cut_mm, report.corner_cut_mm, 1e-12 * report.corner_cut_mm);
  if (expected.shape && *expected.shape != report.shape)
    throw Rejected{fmt::format("the proof is about the shape {}, not {}", report.shape, *expected.shape)};
  if (expected.outline_hash && *expected.outline_hash != report.outline_hash)
    throw Rejected{
        fmt::format("the proof is about the outline {}, not {}", report.outline_hash, *expected.outline_hash)};
  if (expected.modules && (*expected.modules != report.modules || *expected.modules != report.upper_bound))
    throw Rejected{fmt::format("the proof is about {} modules and a bound of {}, not {}", report.modules,
                               report.upper_bound, *expected.modules)};
}

ProofReport evaluate(const ProofLog& log, const std::vector<Ring>& rings, const ProofExpectation& expected) {
  const auto start = std::chrono::steady_clock::now();
  ProofReport report = said_by(log, rings);
  try {
    const auto edges = edge_set(rings);
    const ProofModule module = require_header(log, edges);
    require_expected(report, expected);
    const ProofPolygon polygon(edges, log.pivot, module, log.pitch_mm);
    if (polygon.radius_mm() > 1e6) throw Rejected{"the pivot lies too far from the polygon"};
    report.rounding_mm = rounding_of(log, polygon);
    require_placement(log, polygon, report.rounding_mm);
    Checker(log, polygon, report.regions, report.pairs).run(proved_by_area(log, rings, module));
    report.accepted = true;
  } catch (const Rejected& r) {
    report.reason = r.reason;
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace

ProofReport check_placement_proof_text(const std::string& log, const std::string& polygon,
                                       const ProofExpectation& expected) {
  const std::vector<Ring> rings = read_rings(polygon, "polygon");
  require_valid_rings(rings, "polygon");
  return evaluate(read_proof_log(log, "proof"), rings, expected);
}

ProofReport check_placement_proof(const std::filesystem::path& log, const std::filesystem::path& polygon,
                                  const ProofExpectation& expected) {
  const std::vector<Ring> rings = read_rings(read_text(polygon), polygon.string());
  require_valid_rings(rings, polygon.string());
  return evaluate(read_proof_log(read_text(log), log.string()), rings, expected);
}

}  // namespace triskin::check
