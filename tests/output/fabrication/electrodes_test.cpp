// SPDX-License-Identifier: GPL-3.0-or-later
// What the electrodes of the module's board have, from its geometry, against the range that the simulation draws from
// (docs/silicon.md, "What electrodes have").
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

#include "field_solver.hpp"
#include "output/fabrication/src/kicad.hpp"
#include "output/fabrication/src/module_board.hpp"
#include "output/fabrication/src/module_tracks.hpp"
#include "output/fabrication/src/shield_plane.hpp"
#include "triskin/hardware/scene.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

constexpr double kEpsilon0_pf_per_mm = 8.854e-3;

// The distance from the touch side's copper to each layer below it, and the board's permittivity, as its file says.
struct Stack {
  std::array<double, 4> below_mm{};
  double permittivity = 0.0;
};

Stack stack_of(const std::string& board) {
  Stack stack;
  const std::regex item(R"re(\(layer "([^"]+)" \(type "[^"]+"\) \(thickness ([\d.]+)\)(.*?epsilon_r ([\d.]+))?)re");
  double at_mm = 0.0;
  std::size_t copper = 0;
  for (auto m = std::sregex_iterator(board.begin(), board.end(), item); m != std::sregex_iterator(); ++m) {
    const std::string name = (*m)[1];
    if (name.ends_with(".Mask")) continue;
    if (name.ends_with(".Cu")) {
      // From the lower side of the pad to the upper side of this copper.
      stack.below_mm.at(copper++) = at_mm;
      if (copper > 1) at_mm += std::stod((*m)[2]);
      continue;
    }
    at_mm += std::stod((*m)[2]);
    stack.permittivity = std::stod((*m)[4]);
  }
  EXPECT_EQ(copper, 4U);
  return stack;
}

// A straight piece of copper below the pads.
struct Piece {
  Vec2 from_mm, to_mm;
  double half_width_mm;
  std::size_t layer;
  std::string net;
};

double distance_mm(const Piece& piece, const Vec2& p) {
  const Vec2 along = piece.to_mm - piece.from_mm;
  const double length2 = along.squaredNorm();
  const double share = length2 == 0.0 ? 0.0 : std::clamp((p - piece.from_mm).dot(along) / length2, 0.0, 1.0);
  return (p - piece.from_mm - share * along).norm();
}

std::vector<Piece> copper_of_module() {
  std::vector<Piece> pieces;
  for (std::size_t net = 0; net < kBusNets; ++net) {
    const auto ring = ring_of(net, 0.0);
    for (std::size_t p = 0; p < ring.size(); ++p)
      pieces.push_back({ring[p], ring[(p + 1) % ring.size()], kTrack_mm / 2.0, 2, std::string(kBusNetNames[net])});
  }
  for (const ModuleTrack& t : module_routing().tracks)
    pieces.push_back({t.from_mm, t.to_mm, kNarrowTrack_mm / 2.0, static_cast<std::size_t>(t.layer), t.pad});
  for (const ModuleVia& via : module_routing().vias) {
    for (std::size_t layer = 1; layer < 4; ++layer)
      pieces.push_back({via.at_mm, via.at_mm, kContactPad_mm / 2.0, layer, via.pad});
  }
  for (const ModulePad& pad : module_pads()) {
    if (pad.layer == PadLayer::kTouch) continue;
    const double half_mm = pad.size_mm.mean() / 2.0;
    for (std::size_t layer = pad.layer == PadLayer::kThrough ? 1 : 3; layer < 4; ++layer)
      pieces.push_back({pad.at_mm, pad.at_mm, half_mm, layer, pad.name});
  }
  return pieces;
}

bool is_of_taxel(const std::string& pad, const std::string& taxel) {
  if (pad == taxel) return true;
  if (!pad.starts_with("U1.") || pad == "U1.25") return false;
  return chip_pins().at(std::stoul(pad.substr(3)) - 1) == "CIN" + taxel.substr(1);
}

// Capacitance of a pad to the copper below it: parallel plates, each point of the pad to the nearest layer that has
// copper under it. `fringe` widens the copper by its distance.
double plates_pf(const ModulePad& pad, const std::vector<Piece>& copper, const Stack& stack, double fringe,
                 const std::string& only = "") {
  constexpr double kGrid_mm = 0.05;
  const double radius_mm = pad.size_mm.x() / 2.0;
  const auto reach_mm = [&](const Piece& c) { return c.half_width_mm + fringe * stack.below_mm[c.layer]; };
  std::vector<Piece> near;
  for (const Piece& c : copper) {
    const bool other = c.layer > 0 && !is_of_taxel(c.net, pad.name) && (only.empty() || c.net.ends_with(only));
    if (other && distance_mm(c, pad.at_mm) <= radius_mm + reach_mm(c)) near.push_back(c);
  }
  double pf = 0.0;
  for (double x = -radius_mm + kGrid_mm / 2.0; x < radius_mm; x += kGrid_mm) {
    for (double y = -radius_mm + kGrid_mm / 2.0; y < radius_mm; y += kGrid_mm) {
      if (x * x + y * y > radius_mm * radius_mm) continue;
      const Vec2 p = pad.at_mm + Vec2(x, y);
      std::size_t nearest = 4;
      for (const Piece& c : near) {
        if (c.layer < nearest && distance_mm(c, p) <= reach_mm(c)) nearest = c.layer;
      }
      if (nearest < 4) pf += kEpsilon0_pf_per_mm * stack.permittivity * kGrid_mm * kGrid_mm / stack.below_mm[nearest];
    }
  }
  return pf;
}

double track_mm(const std::string& taxel) {
  double length_mm = 0.0;
  for (const ModuleTrack& t : module_routing().tracks)
    if (is_of_taxel(t.pad, taxel)) length_mm += (t.to_mm - t.from_mm).norm();
  return length_mm;
}

double area_mm2(const ModulePad& pad) {
  return std::numbers::pi * pad.size_mm.x() * pad.size_mm.x() / 4.0;
}

// Everything that the module's board leaves open, each from its least to its most.
struct Surroundings {
  double fabric_mm, fabric_permittivity;  // the layer over the pad, between air and foam
  double board;                           // plates on the board: permittivity and thickness of the maker's film
  double fringe;                          // share of its distance by which copper acts beyond its edge
  double track_pf_per_mm;                 // 0.1 mm wide, to the copper around it
  double pin_pf;                          // input of the converter: nobody knows
};
constexpr Surroundings kLeast{3.0, 1.0, 0.85, 0.0, 0.0, 0.0}, kMost{1.5, 3.0, 1.15, 1.0, 0.12, 3.0};

double electrode_pf(const ModulePad& pad, double plates_pf, const Surroundings& s) {
  const double fabric_pf = kEpsilon0_pf_per_mm * s.fabric_permittivity * area_mm2(pad) / s.fabric_mm;
  return fabric_pf + s.board * plates_pf + s.track_pf_per_mm * track_mm(pad.name) + s.pin_pf;
}

TEST(Electrodes, TheSimulationDrawsFromWhatBoardsCanHave) {
  const Stack stack = stack_of(module_alone());
  // Four layers of polyimide: 0.05 mm, 0.05 + 0.018 + 0.05 mm, and again 0.068 mm to the back.
  EXPECT_NEAR(stack.below_mm[1], 0.05, 1e-9);
  EXPECT_NEAR(stack.below_mm[2], 0.118, 1e-9);
  EXPECT_NEAR(stack.below_mm[3], 0.186, 1e-9);
  EXPECT_DOUBLE_EQ(stack.permittivity, 3.4);

  const std::vector<Piece> copper = copper_of_module();
  // Under every pad lies the plane that ACSHIELD drives. How much of its capacitance the driver leaves to the converter
  // nobody knows: a tenth, or all of it as if the plane were grounded. Without the plane the copper below counts.
  constexpr double kMinShare = 0.1;
  double least_pf = 100.0, most_pf = 0.0, shielded_pf = 0.0;
  for (const ModulePad& pad : module_pads()) {
    if (pad.layer != PadLayer::kTouch) continue;
    const double plane_pf = kEpsilon0_pf_per_mm * stack.permittivity * area_mm2(pad) / stack.below_mm[1];
    least_pf = std::min(least_pf, electrode_pf(pad, kMinShare * plane_pf, kLeast));
    most_pf = std::max(most_pf, electrode_pf(pad, plates_pf(pad, copper, stack, kMost.fringe), kMost));
    shielded_pf = std::max(shielded_pf, electrode_pf(pad, plane_pf, kMost));
  }
  std::printf("electrodes of the module: %.2f ... %.2f pF, with a grounded plane below %.2f\n", least_pf, most_pf,
              shielded_pf);
  // Installed boards cancel 34 steps (0x2200), and rest in the middle third of the range, which ends 10,922 counts from
  // its middle.
  const double installed_least_pf = (34 * 900 - 10'922) / 4096.0, installed_most_pf = (34 * 1400 + 10'922) / 4096.0;
  const hardware::Effects drawn;
  EXPECT_LE(drawn.electrode_least_pf, std::min(least_pf, installed_least_pf));
  EXPECT_GE(drawn.electrode_most_pf, std::max({most_pf, shielded_pf, installed_most_pf}));
  // Nor is the range wider than these by more than a fifth.
  EXPECT_GT(drawn.electrode_least_pf, 0.8 * std::min(least_pf, installed_least_pf));
  EXPECT_LT(drawn.electrode_most_pf, 1.2 * std::max({most_pf, shielded_pf, installed_most_pf}));
}

constexpr double kCountsPerPf = 4096.0;

// A track of width w and thickness t at distance h from a pad that is wide against it (van der Meijs and Fokkema,
// 1984).
double under_pad_pf_per_mm(double width_mm, double below_mm, double permittivity) {
  constexpr double kCopper_mm = 0.018;
  const double w = width_mm / below_mm, t = kCopper_mm / below_mm;
  return kEpsilon0_pf_per_mm * permittivity * (w + 0.77 + 1.06 * std::pow(w, 0.25) + 1.06 * std::sqrt(t));
}

// The board across a ring of In2 in the middle under a pad 2 mm wide; y from 0.2 mm of air above the pad.
CrossSection across_ring(bool has_plane) {
  CrossSection section(3.0, 0.7);
  section.add_dielectric(0.2, 0.27, 3.4);
  section.add_conductor(1, 0.5, 0.2, 2.0, 0.02);
  if (has_plane) section.add_conductor(3, 0.5, 0.27, 2.0, 0.02);
  section.add_conductor(2, 1.45, 0.34, 0.1, 0.02);
  return section;
}

// A field solver of another kind agrees with the formula for a line under a pad, and says what a plane between leaves.
TEST(Crosstalk, AFieldSolverAgreesWithTheFormula) {
  const double formula = under_pad_pf_per_mm(0.1, 0.12, 3.4), solved = across_ring(false).mutual_pf_per_mm(2, 1);
  const double shielded = across_ring(true).mutual_pf_per_mm(2, 1);
  std::printf("a track under a pad: formula %.4f, solver %.4f pF/mm; with the plane %.2e\n", formula, solved, shielded);
  EXPECT_NEAR(solved / formula, 1.0, 0.2);
  EXPECT_GT(shielded, 0.0);
  // What goes round the edges of a plane as wide as the pad: for 25 mm of track, more than any pad has, less than a
  // touch.
  EXPECT_LT(kCountsPerPf * shielded * 25.0, 20.0);
}

// The solver itself: two plates of a square section, 0.5 mm apart in 3.4, have the capacitance of plates plus little.
TEST(Crosstalk, TheSolverKnowsPlates) {
  CrossSection plates(1.0, 0.54);
  plates.add_dielectric(0.0, 0.54, 3.4);
  plates.add_conductor(1, 0.0, 0.0, 1.0, 0.02);
  plates.add_conductor(2, 0.0, 0.52, 1.0, 0.02);
  // Potentials live in the middles of cells, so the gap is one cell wider.
  EXPECT_NEAR(plates.mutual_pf_per_mm(1, 2), kEpsilon0_pf_per_mm * 3.4 * 1.0 / 0.51, 1e-4);
}

// True when a place lies on the plane that ACSHIELD drives.
bool is_shielded(const Vec2& p) {
  bool odd = false;
  static const std::vector<Ring> kPlane = shield_plane({0, 0}, 0.0);
  for (const Ring& ring : kPlane) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y()))
        odd = !odd;
    }
  }
  return odd;
}

// Length of the tracks of a line under a pad, all of it and what no plane covers.
struct UnderPad {
  double all_mm = 0.0, bare_mm = 0.0;
};
UnderPad under_pad(const ModulePad& pad, const std::vector<Piece>& copper, char line) {
  constexpr double kStep_mm = 0.02;
  UnderPad under;
  for (const Piece& c : copper) {
    const std::string data = std::string("SDA") + line, clock = std::string("SCL") + line;
    if (c.layer == 0 ||
        !(c.net.ends_with(data) || c.net.ends_with(clock) || c.net.starts_with(data) || c.net.starts_with(clock)))
      continue;
    const int steps = static_cast<int>((c.to_mm - c.from_mm).norm() / kStep_mm);
    for (int k = 0; k < steps; ++k) {
      const Vec2 p = c.from_mm + (k + 0.5) / steps * (c.to_mm - c.from_mm);
      if ((p - pad.at_mm).norm() > pad.size_mm.x() / 2.0) continue;
      under.all_mm += kStep_mm;
      if (c.layer <= 1 || !is_shielded(p)) under.bare_mm += kStep_mm;
    }
  }
  return under;
}

// Counts of a line to the pad that has most of it: without the plane, and what is left beside it. The second is what
// the board has; 20 counts is a touch.
TEST(Crosstalk, ThePlaneLeavesLessThanATouch) {
  const Stack stack = stack_of(module_alone());
  const std::vector<Piece> copper = copper_of_module();
  const double leak_pf_per_mm = across_ring(true).mutual_pf_per_mm(2, 1);
  double bare_counts = 0.0, open_counts = 0.0;
  int shielded = 0, sampled = 0;
  for (const ModulePad& pad : module_pads()) {
    if (pad.layer != PadLayer::kTouch) continue;
    for (const char line : {'0', '1', '2', '3'}) {
      const UnderPad under = under_pad(pad, copper, line);
      const double pf_per_mm = under_pad_pf_per_mm(kNarrowTrack_mm, stack.below_mm[2], stack.permittivity);
      open_counts = std::max(open_counts, kCountsPerPf * pf_per_mm * under.all_mm);
      bare_counts = std::max(
          bare_counts, kCountsPerPf * (pf_per_mm * under.bare_mm + leak_pf_per_mm * (under.all_mm - under.bare_mm)));
    }
    for (double x = -1.75; x <= 1.75; x += 0.05) {
      for (double y = -1.75; y <= 1.75; y += 0.05) {
        if (std::hypot(x, y) > pad.size_mm.x() / 2.0 - 0.01) continue;
        ++sampled;
        shielded += is_shielded(pad.at_mm + Vec2(x, y));
      }
    }
  }
  // Plated holes of the lines come through to the touch side beside pads: 0.4 mm wide, at least 0.2 mm from a pad, in
  // openings of the plane of 0.1 mm around them.
  double nearest_mm = 10.0;
  for (const ModulePad& hole : module_pads()) {
    if (hole.layer != PadLayer::kThrough) continue;
    for (const ModulePad& pad : module_pads()) {
      if (pad.layer == PadLayer::kTouch)
        nearest_mm = std::min(nearest_mm, (hole.at_mm - pad.at_mm).norm() - (hole.size_mm.x() + pad.size_mm.x()) / 2.0);
    }
  }
  CrossSection beside(3.0, 0.7);
  beside.add_dielectric(0.2, 0.27, 3.4);
  beside.add_conductor(1, 0.0, 0.2, 1.5, 0.02);
  beside.add_conductor(2, 1.5 + nearest_mm, 0.2, 0.4, 0.02);
  beside.add_conductor(3, 0.0, 0.27, 1.4 + nearest_mm, 0.02);
  beside.add_conductor(3, 2.0 + nearest_mm, 0.27, 0.8, 0.02);
  const double hole_counts = kCountsPerPf * beside.mutual_pf_per_mm(2, 1) * kContactPad_mm;
  std::printf(
      "a line under a pad: %.0f counts without the plane, %.1f with it; a hole %.2f mm beside a pad %.1f; "
      "%d of %d places of pads lie over the plane\n",
      open_counts, bare_counts, nearest_mm, hole_counts, shielded, sampled);
  EXPECT_GT(open_counts, 1000.0);  // what the plane is for
  EXPECT_EQ(shielded, sampled);
  constexpr double kTouch_counts = 20.0;
  constexpr int kHolesOfALine = 2;  // SDA and SCL at the nearest place
  EXPECT_LT(bare_counts + kHolesOfALine * hole_counts, kTouch_counts);
}

}  // namespace
}  // namespace triskin::fabrication
