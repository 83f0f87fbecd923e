// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "checked_design.hpp"

namespace triskin::check {
namespace {

std::string patch_name(std::size_t p) {
  return "patch " + std::to_string(p);
}

class PatchChecker {
 public:
  PatchChecker(const CheckedDesign& d, std::size_t patch, Findings& f)
      : d_(d), p_(d.patches[patch]), index_(patch), f_(f) {
    for (const int m : p_.modules) members_.insert(m);
  }

  void run() {
    sizes();
    addresses();
    tree();
    joints();
    second_entry();
    totals();
    supply();
    pull_ups();
  }

 private:
  [[nodiscard]] const CheckedDesign::Module& module(int k) const { return d_.modules[static_cast<std::size_t>(k)]; }
  [[nodiscard]] int number(int k) const { return d_.number(k); }
  void broken(const char* rule, const std::string& text) { f_.broken(rule, patch_name(index_), text); }

  void sizes() {
    if (p_.modules.empty() || p_.modules.size() > 16)
      broken("patch-size", fmt::format("has {} modules, 1 … 16 are possible", p_.modules.size()));
    if (members_.size() != p_.modules.size()) broken("patch-members", "lists a module twice");
    if (p_.node_address != static_cast<int>(index_) + 1)
      broken("patch-node", fmt::format("has node address {}, must be {}", p_.node_address, index_ + 1));
    for (const int m : members_) {
      if (module(m).patch != static_cast<int>(index_))
        broken("patch-members",
               fmt::format("lists module {}, which says it belongs to patch {}", number(m), module(m).patch));
    }
    islands();
  }

  // Islands are connected by jumpers only; the tree rules tell whether they are.
  void islands() {
    std::set<int> islands;
    for (const int m : members_) islands.insert(module(m).island);
    const auto jumpers = std::ranges::count_if(d_.jumpers, [&](const CheckedDesign::Jumper& j) {
      return members_.contains(j.module[0]) && members_.contains(j.module[1]);
    });
    if (static_cast<int>(islands.size()) > 1 + static_cast<int>(jumpers))
      broken("patch-island", fmt::format("spans {} islands, {} jumpers join them", islands.size(), jumpers));
  }

  void addresses() {
    std::map<std::pair<int, int>, int> taken;
    std::map<int, int> on_line;
    for (const int m : p_.modules) {
      const auto& x = module(m);
      if (x.line < 0 || x.line > 3 || x.address < 0 || x.address > 3)
        broken("address-range", fmt::format("module {}: line {} address {}", number(m), x.line, x.address));
      const auto [at, is_new] = taken.try_emplace({x.line, x.address}, m);
      if (!is_new)
        broken("address-unique", fmt::format("modules {} and {} share line {} address {}", number(at->second),
                                             number(m), x.line, x.address));
      if (++on_line[x.line] == 5) broken("line-load", fmt::format("line {} has more than 4 modules", x.line));
    }
  }

  void tree() {
    std::map<int, std::size_t> rank;
    for (std::size_t k = 0; k < p_.modules.size(); ++k) rank[p_.modules[k]] = k;
    if (!members_.contains(p_.entry))
      return broken("entry", fmt::format("its entry {} is not a member", number(p_.entry)));
    std::map<int, int> children;
    for (std::size_t k = 0; k < p_.modules.size(); ++k) {
      const int m = p_.modules[k];
      const auto& x = module(m);
      if ((x.parent < 0) != (m == p_.entry))
        broken("one-entry",
               fmt::format("module {} has parent {}, the entry is {}", number(m), number(x.parent), number(p_.entry)));
      if (x.parent < 0) {
        if (x.depth != 0) broken("depth", fmt::format("entry {} states depth {}", number(m), x.depth));
        continue;
      }
      if (!members_.contains(x.parent)) {
        broken("parent", fmt::format("module {} hangs on {}, which is not in the patch", number(m), number(x.parent)));
        continue;
      }
      ++children[x.parent];
      if (rank[x.parent] >= k)
        broken("parent-first", fmt::format("module {} is listed before its parent {}", number(m), number(x.parent)));
      else if (x.depth != module(x.parent).depth + 1)
        broken("depth",
               fmt::format("module {} states depth {}, its parent {}", number(m), x.depth, module(x.parent).depth));
      check_input_side(m, x);
    }
    if (children[p_.entry] > 2)
      broken("entry-degree", fmt::format("entry {} has {} children, two ports are left beside the cable",
                                         number(p_.entry), children[p_.entry]));
    for (const auto& [m, n] : children) {
      if (m != p_.entry && n > 2)
        broken("tree-degree", fmt::format("module {} has {} children on two output ports", number(m), n));
    }
  }

  // Port A lies at side `rotation` and must face the parent.
  void check_input_side(int m, const CheckedDesign::Module& x) {
    if (x.rotation < 0 || x.rotation > 2)
      return broken("rotation", fmt::format("module {} has rotation {}", number(m), x.rotation));
    if (x.beside[static_cast<std::size_t>(x.rotation)] != x.parent) {
      broken("rotation", fmt::format("module {}: its input port lies at side {}, its parent {} does not", number(m),
                                     x.rotation, number(x.parent)));
    }
  }

  // Every joint inside the patch carries the tree or is cut, not both.
  void joints() {
    std::set<std::pair<int, int>> cut;
    for (const auto& c : p_.cut_joints) cut.insert(std::minmax(c[0], c[1]));
    for (const int m : p_.modules) {
      for (const int n : module(m).beside) {
        if (n < m || !members_.contains(n)) continue;
        const bool in_tree = module(m).parent == n || module(n).parent == m;
        if (in_tree == cut.contains({m, n})) {
          const char* const fault = in_tree ? "cut but carries the tree" : "neither cut nor used";
          broken("joint-use", fmt::format("joint {}–{} is {}", number(m), number(n), fault));
        }
        cut.erase({m, n});
      }
    }
    for (const auto& [a, b] : cut)
      broken("joint-use", fmt::format("cut joint {}–{} does not exist", number(a), number(b)));
    const auto& e = module(p_.entry);
    if (e.rotation < 0 || e.rotation > 2)
      return broken("rotation", fmt::format("entry {} has rotation {}", number(p_.entry), e.rotation));
    const int behind_cable = e.beside[static_cast<std::size_t>(e.rotation)];
    if (behind_cable >= 0 && members_.contains(behind_cable) && module(behind_cable).parent == p_.entry) {
      broken("entry-cable",
             fmt::format("the cable enters module {} where module {} hangs", number(p_.entry), number(behind_cable)));
    }
  }

  // The second cable must be at a side without a joint of the patch, and not at the side of the first cable.
  void second_entry() {
    if (p_.second_entry < 0) return;
    if (!members_.contains(p_.second_entry))
      return broken("second-entry", fmt::format("second entry {} is not in the patch", number(p_.second_entry)));
    const int beyond = module(p_.second_entry).beside[static_cast<std::size_t>(p_.second_entry_side)];
    if (beyond >= 0 && members_.contains(beyond)) {
      broken("second-entry", fmt::format("the second cable enters module {} where module {} is joined",
                                         number(p_.second_entry), number(beyond)));
    }
    if (p_.second_entry == p_.entry && p_.second_entry_side == module(p_.entry).rotation) {
      broken("second-entry",
             fmt::format("both cables enter module {} at side {}", number(p_.entry), p_.second_entry_side));
    }
  }

  void totals() {
    int deepest = 0, hops = 0;
    for (const int m : p_.modules) {
      deepest = std::max(deepest, module(m).depth);
      std::set<int> lines;  // These lines are used at or below m.
      for (const int v : p_.modules) {
        int u = v;
        for (std::size_t guard = 0; u >= 0 && u != m && guard < p_.modules.size(); ++guard) u = module(u).parent;
        if (u == m) lines.insert(module(v).line);
      }
      if (m != p_.entry) hops += static_cast<int>(lines.size());
    }
    if (deepest != p_.max_depth) broken("max-depth", fmt::format("states {}, is {}", p_.max_depth, deepest));
    if (hops != p_.line_hops) broken("line-hops", fmt::format("states {}, are {}", p_.line_hops, hops));
  }

  // Every converter needs 2.6 V, and 0.15 V more for what the figures leave out: the pull-ups' current through ground,
  // the converter's maximal current, heat. The currents are summed from the ends of the tree to its entry, the voltages
  // from there to the ends. docs/routing.md has the sources.
  void supply() {
    constexpr double kNeeded_v = 2.6 + 0.15, kController_v = 3.3 * 0.97, kModule_a = 1e-3;
    constexpr double kCable_ohm_per_mm = 0.98e-3, kPlugs_ohm = 0.12, kCable_mm = 500.0, kJoint_ohm = 0.23;
    std::map<int, double> behind_a, volts;
    for (auto m = p_.modules.rbegin(); m != p_.modules.rend(); ++m) {
      behind_a[*m] += kModule_a;
      if (module(*m).parent >= 0) behind_a[module(*m).parent] += behind_a[*m];
    }
    for (const int m : p_.modules) {
      const int parent = module(m).parent;
      double ohm = parent < 0 ? kCable_mm * kCable_ohm_per_mm + kPlugs_ohm : kJoint_ohm;
      for (const CheckedDesign::Jumper& j : d_.jumpers) {
        if (parent >= 0 && std::minmax(j.module[0], j.module[1]) == std::minmax(m, parent))
          ohm += kPlugs_ohm + j.length * kCable_ohm_per_mm;
      }
      volts[m] = (parent < 0 ? kController_v : volts[parent]) - ohm * behind_a[m];
      if (volts[m] < kNeeded_v)
        broken("supply", fmt::format("module {} has {:.2f} V, needs {:.2f}; feed the patch at both ends", number(m),
                                     volts[m], kNeeded_v));
    }
  }

  // A pull-up must be weak enough for a chip to hold the line low (3 mA at 0.4 V, UM10204, table 10), and strong enough
  // to charge what hangs on the line from 30 to 70 % in 300 ns. docs/routing.md has the capacitances.
  void pull_ups() {
    constexpr double kMin_ohm = (3.3 - 0.4) / 3e-3, kRise_ns = 300.0, kCable_pf_per_mm = 0.06, kCable_mm = 500.0;
    constexpr double kJoint_pf = 2.0, kPlugs_pf = 2.0, kChip_pf = 10.0, kSwitch_pf = 6.0;
    double common_pf = kCable_mm * kCable_pf_per_mm;
    std::map<int, int> on_line;
    for (const int m : p_.modules) {
      ++on_line[module(m).line];
      const int parent = module(m).parent;
      if (parent < 0) continue;
      common_pf += kJoint_pf;
      for (const CheckedDesign::Jumper& j : d_.jumpers) {
        if (std::minmax(j.module[0], j.module[1]) == std::minmax(m, parent))
          common_pf += kPlugs_pf + j.length * kCable_pf_per_mm;
      }
    }
    for (const auto& [line, chips] : on_line) {
      const double pf = common_pf + kChip_pf * chips + kSwitch_pf * (static_cast<double>(p_.modules.size()) - chips);
      const double most_ohm = kRise_ns * 1e3 / (std::log(0.7 / 0.3) * pf);
      if (most_ohm < kMin_ohm)
        broken(
            "pull-up",
            fmt::format("line {} has {:.0f} pF and would need a pull-up of {:.0f} Ω or less; a chip sinks the current "
                        "of {:.0f} Ω and more; use fewer modules or less cable",
                        line, pf, most_ohm, kMin_ohm));
    }
  }

  const CheckedDesign& d_;
  const CheckedDesign::Patch& p_;
  std::size_t index_;
  Findings& f_;
  std::set<int> members_;
};

}  // namespace

void check_patches(const CheckedDesign& design, Findings& findings) {
  for (const char* rule : {"patch-size",     "patch-members", "patch-node",   "patch-island", "address-range",
                           "address-unique", "line-load",     "entry",        "one-entry",    "parent",
                           "parent-first",   "depth",         "entry-degree", "tree-degree",  "rotation",
                           "joint-use",      "entry-cable",   "max-depth",    "line-hops",    "every-module-wired",
                           "patches-bound",  "supply",        "pull-up"}) {
    findings.rule(rule);
  }
  std::vector<int> owners(design.modules.size(), 0);
  int controllers = 0;
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    if (design.patches[p].modules.empty()) continue;
    ++controllers;
    PatchChecker(design, p, findings).run();
    for (const int m : design.patches[p].modules) ++owners[static_cast<std::size_t>(m)];
  }
  for (std::size_t k = 0; k < owners.size(); ++k) {
    if (owners[k] != 1)
      findings.broken("every-module-wired", design.name(k), fmt::format("belongs to {} patches", owners[k]));
  }
  if (controllers < design.patches_lower_bound) {
    findings.broken("patches-bound", "design",
                    fmt::format("{} patches under the stated lower bound {}", controllers, design.patches_lower_bound));
  }
}

}  // namespace triskin::check
