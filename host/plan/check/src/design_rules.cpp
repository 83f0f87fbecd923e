// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/check/design_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "checked_design.hpp"
#include "module_outline.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::check {
namespace {

void stated(Findings& f, const char* rule, double says, double is, double tolerance) {
  if (!(std::abs(says - is) <= tolerance)) f.broken(rule, "design", fmt::format("states {:.6g}, is {:.6g}", says, is));
}

// Limits are the user's choice and define what the design is measured against; one that is no length or angle makes
// every comparison void.
void check_limits(const CheckedDesign::Limits& l, bool with_jumpers, DesignReport& report, Findings& f) {
  f.rule("limits");
  std::vector<std::pair<const char*, double>> limits{{"edge_error_mm", l.edge_error},   {"hinge_gap_mm", l.hinge_gap},
                                                     {"center_gap_mm", l.center_gap},   {"fold_rad", l.fold},
                                                     {"penetration_mm", l.penetration}, {"overrun_mm", l.overrun}};
  if (l.fold_away != std::numeric_limits<double>::infinity()) limits.emplace_back("fold_away_rad", l.fold_away);
  if (l.fold_towards != std::numeric_limits<double>::infinity())
    limits.emplace_back("fold_towards_rad", l.fold_towards);
  if (with_jumpers) limits.emplace_back("jumper_mm", l.jumper);
  if (l.lift != std::numeric_limits<double>::infinity()) {
    limits.emplace_back("lift_mm", l.lift);
    limits.emplace_back("depth_mm", l.depth);
  }
  for (const auto& [name, value] : limits) {
    report.limits.emplace_back(name, value);
    constexpr double kMaxLimit = 1000.0;  // A limit of a metre does not restrict modules of 30 mm.
    if (!(value >= 0.0 && value <= kMaxLimit))
      f.broken("limits", "design", fmt::format("{} is {:.6g}, not a limit", name, value));
  }
}

// Computes FNV-1a of 64 bits over little-endian words, as docs/design_file.md defines the id.
class Fnv {
 public:
  void add(std::int64_t word) {
    for (int k = 0; k < 8; ++k)
      value_ = (value_ ^ (static_cast<std::uint64_t>(word) >> (8 * k) & 0xFF)) * 0x100000001B3U;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

// Tables store a kind as a number of three bits above an id of thirteen.
void check_kinds(const CheckedDesign& d, Findings& f) {
  f.rule("kinds");
  constexpr std::size_t kMaxKinds = 7;
  if (d.kinds.size() > kMaxKinds)
    f.broken("kinds", "design", fmt::format("{} kinds; a table holds {}", d.kinds.size(), kMaxKinds));
  for (std::size_t k = 0; k < d.kinds.size(); ++k) {
    const auto& kind = d.kinds[k];
    const std::string where = fmt::format("kind \"{}\"", kind.name);
    if (kind.name.empty() || kind_number(d, kind.name) != static_cast<int>(k) + 1)
      f.broken("kinds", where, "its name is empty, taken or that of the standard kind");
    if (kind.taxels < 1 || kind.taxels > 12)
      f.broken("kinds", where, fmt::format("{} taxels; a converter has 1 … 12", kind.taxels));
    if (!(std::isfinite(kind.sensitivity) && kind.sensitivity >= 0.0))
      f.broken("kinds", where, fmt::format("a sensitivity of {:.6g} counts per kPa", kind.sensitivity));
  }
  for (std::size_t m = 0; m < d.modules.size(); ++m) {
    if (kind_number(d, d.modules[m].kind) < 0)
      f.broken("kinds", d.name(m), fmt::format("\"{}\" is no kind of this design", d.modules[m].kind));
  }
}

// Labels and tables name a module by its number: 16 bits, or 13 beside kinds. A number must not be given to a second
// module, neither now nor later.
void check_numbers(const CheckedDesign& d, Findings& f) {
  f.rule("module-number");
  const int end = d.kinds.empty() ? 65'536 : 8'192;
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const int number = d.modules[k].number;
    if (number < 0 || number >= end)
      f.broken("module-number", d.name(k), fmt::format("a table holds numbers of 0 … {}", end - 1));
    if (k > 0 && number <= d.modules[k - 1].number)
      f.broken("module-number", d.name(k), fmt::format("stands after {}; numbers ascend", d.name(k - 1)));
  }
  if (d.next_module >= 0 && !d.modules.empty() && d.next_module <= d.modules.back().number) {
    f.broken("module-number", "design",
             fmt::format("next_module is {}, the last module has {}; the next number lies above all that were given",
                         d.next_module, d.modules.back().number));
  }
}

// A controller whose id matches is not flashed again, so an id that belongs to other modules would leave it unchanged.
void check_id(const CheckedDesign& d, Findings& f) {
  f.rule("design-id");
  Fnv fnv;
  for (const auto& m : d.modules) {
    for (const int word : {m.island, m.i, m.j, m.up ? 1 : 0}) fnv.add(word);
    for (const P3& c : m.corner) {
      for (int axis = 0; axis < 3; ++axis) fnv.add(std::llround(c[axis] * 1000.0));
    }
    for (const int n : m.neighbour) fnv.add(n);
  }
  for (const auto& j : d.jumpers) {
    for (const int word : {j.module[0], j.side[0], j.module[1], j.side[1]}) fnv.add(word);
  }
  for (const auto& p : d.patches) {
    fnv.add(p.entry);
    fnv.add(p.second_entry);
    fnv.add(p.second_entry_side);
    for (const int k : p.modules) {
      const auto& m = d.modules[static_cast<std::size_t>(k)];
      for (const int word : {k, m.parent, m.rotation, m.line, m.address}) fnv.add(word);
    }
  }
  if (d.corner_cut > 0.0) fnv.add(std::llround(d.corner_cut * 1000.0));
  for (const auto& k : d.kinds) {
    for (const std::string& text : {k.name, k.dielectric}) {
      fnv.add(static_cast<std::int64_t>(text.size()));
      for (const char c : text) fnv.add(static_cast<unsigned char>(c));
    }
    fnv.add(k.taxels);
    fnv.add(std::llround(k.sensitivity * 1000.0));
  }
  for (std::size_t m = 0; !d.kinds.empty() && m < d.modules.size(); ++m) fnv.add(kind_number(d, d.modules[m].kind));
  const bool has_gaps = !d.modules.empty() && d.modules.back().number != static_cast<int>(d.modules.size()) - 1;
  for (std::size_t m = 0; has_gaps && m < d.modules.size(); ++m) fnv.add(d.modules[m].number);
  if (!d.modules.empty() && d.next_module > d.modules.back().number + 1) fnv.add(d.next_module);
  if (fnv.value() != d.design_id) {
    f.broken("design-id", "design",
             fmt::format("states {:016x}, its modules, their numbers and wiring have {:016x}: the file was changed",
                         d.design_id, fnv.value()));
  }
}

}  // namespace

int kind_number(const CheckedDesign& d, const std::string& name) {
  if (name == "standard") return 0;
  const auto found = std::ranges::find(d.kinds, name, &CheckedDesign::Kind::name);
  return found == d.kinds.end() ? -1 : static_cast<int>(found - d.kinds.begin()) + 1;
}

void check_report(const CheckedDesign& d, Findings& f) {
  check_id(d, f);
  for (const char* rule : {"report-area", "report-coverage", "report-maxima", "report-bound"}) f.rule(rule);
  double area = 0.0;
  for (const auto& face : d.faces) {
    const P3 &a = d.vertices[static_cast<std::size_t>(face[0])], &b = d.vertices[static_cast<std::size_t>(face[1])],
             &c = d.vertices[static_cast<std::size_t>(face[2])];
    area += (b - a).cross(c - a).norm() / 2;
  }
  const double covered = static_cast<double>(d.modules.size()) * kModule_mm2;
  stated(f, "report-area", d.area_cm2, area / 100, 1e-6 * area);
  stated(f, "report-coverage", d.coverage, covered / area, 1e-9);
  const double left = static_cast<double>(d.modules.size()) * area_left(d.corner_cut);
  if (d.corner_cut > 0.0) stated(f, "report-coverage", d.coverage_cut, left / area, 1e-9);
  double edge = 0.0, hinge = 0.0, center = 0.0, lift = 0.0, depth = 0.0;
  for (const auto& m : d.modules) {
    edge = std::max(edge, m.edge_error);
    center = std::max(center, m.center_gap);
    lift = std::max(lift, m.edge_lift);
    depth = std::max(depth, m.edge_depth);
    for (const double g : m.hinge_gap) hinge = std::max(hinge, g);
  }
  stated(f, "report-maxima", d.max_edge_error, edge, 1e-9);
  stated(f, "report-maxima", d.max_hinge_gap, hinge, 1e-9);
  stated(f, "report-maxima", d.max_center_gap, center, 1e-9);
  if (std::isfinite(d.limits.lift)) {
    stated(f, "report-maxima", d.max_edge_lift, lift, 1e-9);
    stated(f, "report-maxima", d.max_edge_depth, depth, 1e-9);
  }
  if (static_cast<int>(d.modules.size()) > d.upper_bound) {
    f.broken("report-bound", "design",
             fmt::format("{} modules above the stated upper bound {}", d.modules.size(), d.upper_bound));
  }
}

DesignReport check_design(const std::filesystem::path& path) {
  return check_design_text(read_text(path), path.string());
}

DesignReport check_design_text(const std::string& text, const std::string& name) {
  const CheckedDesign design = read_checked_design(text, name);
  DesignReport report;
  report.corner_cut_mm = design.corner_cut;
  report.modules = design.modules.size();
  Findings findings(report);
  check_limits(design.limits, !design.jumpers.empty(), report, findings);
  check_numbers(design, findings);  // A wrong number makes other rules fail.
  check_modules(design, findings);
  check_surface(design, findings);
  check_side(design, findings);
  check_pieces(design, findings);
  check_jumpers(design, findings);
  check_regions(design, findings);
  check_patches(design, findings);
  if (!design.kinds.empty()) check_kinds(design, findings);
  check_report(design, findings);
  report.sharp_joints = sharp_joints_of(design);
  return report;
}

}  // namespace triskin::check
