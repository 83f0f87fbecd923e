// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/check/routing_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "routed_patch.hpp"

namespace triskin::check {
namespace {

class TreeRules {
 public:
  TreeRules(const ModuleMap& modules, const RoutePatch& patch, const std::string& name, const RoutingLimits& limits,
            RoutingFindings& f)
      : modules_(modules), p_(patch), name_(name), limits_(limits), f_(f) {}

  void run() {
    const int n = static_cast<int>(p_.rows.size());
    if (n < 1 || n > limits_.capacity)
      broken("patch-size", fmt::format("has {} modules, 1 … {} are possible", n, limits_.capacity));
    addresses();
    connected();
    for (const RouteRow& r : p_.rows) row(r);
    entry();
    joints();
    totals();
  }

 private:
  void broken(const char* rule, const std::string& text) { f_.broken(rule, name_, text); }
  [[nodiscard]] std::array<int, 3> beside(int id) const {
    const auto found = modules_.find(id);
    return found == modules_.end() ? std::array{-1, -1, -1} : found->second.beside;
  }
  [[nodiscard]] bool member(int id) const { return p_.find(id) != nullptr; }

  void addresses() {
    std::map<std::pair<int, int>, int> taken;
    std::map<int, int> load;
    for (const RouteRow& r : p_.rows) {
      if (r.line < 0 || r.line >= limits_.lines)
        broken("line-range", fmt::format("module {} on line {}", r.id, r.line));
      if (r.address < 0 || r.address >= limits_.addresses)
        broken("address-range", fmt::format("module {} at address {}", r.id, r.address));
      const auto [old, is_new] = taken.try_emplace({r.line, r.address}, r.id);
      if (!is_new)
        broken("address-unique",
               fmt::format("modules {} and {} share line {} address {}", old->second, r.id, r.line, r.address));
      if (++load[r.line] == limits_.addresses + 1)
        broken("line-load", fmt::format("line {} has more than {} modules", r.line, limits_.addresses));
    }
  }

  void connected() {
    if (p_.rows.empty()) return;
    std::set<int> seen{p_.rows.front().id};
    std::vector<int> queue{p_.rows.front().id};
    while (!queue.empty()) {
      const int v = queue.back();
      queue.pop_back();
      for (const int w : beside(v)) {
        if (w >= 0 && member(w) && seen.insert(w).second) queue.push_back(w);
      }
    }
    for (const RouteRow& r : p_.rows) {
      if (!seen.contains(r.id))
        broken("connected", fmt::format("module {} does not hang together with module {}", r.id, p_.rows.front().id));
    }
  }

  void row(const RouteRow& r) {
    if ((r.parent < 0) != (r.id == p_.entry))
      broken("one-entry", fmt::format("module {} has parent {}, the entry is {}", r.id, r.parent, p_.entry));
    if (r.rotation < 0 || r.rotation > 2)
      broken("rotation-range", fmt::format("module {} has rotation {}", r.id, r.rotation));
    int climbed = 0;
    for (int v = r.id; v != p_.entry && climbed <= static_cast<int>(p_.rows.size()); ++climbed) {
      const RouteRow* up = p_.find(v);
      if (up == nullptr || up->parent < 0) break;
      v = up->parent;
    }
    if (climbed > static_cast<int>(p_.rows.size()))
      return broken("acyclic", fmt::format("module {} never reaches the entry", r.id));
    if (climbed != r.depth) broken("depth", fmt::format("module {} states depth {}, is {}", r.id, r.depth, climbed));
    if (r.parent < 0) return;
    if (!member(r.parent))
      return broken("parent-member", fmt::format("module {} hangs on {}, which is not in the patch", r.id, r.parent));
    const auto sides = beside(r.id);
    const auto side = std::ranges::find(sides, r.parent) - sides.begin();
    if (side == 3) return broken("parent-joint", fmt::format("modules {} and {} share no side", r.id, r.parent));
    if (side != r.rotation)
      broken("rotation",
             fmt::format("module {}: input port at side {}, its parent at side {}", r.id, r.rotation, side));
  }

  void entry() {
    const RouteRow* e = p_.find(p_.entry);
    if (e == nullptr) return broken("entry", fmt::format("entry {} is not a member", p_.entry));
    std::map<int, int> children;
    for (const RouteRow& r : p_.rows) ++children[r.parent];
    for (const auto& [id, count] : children) {
      if (id == p_.entry && count > 2)
        broken("entry-degree", fmt::format("entry {} has tree degree {}, one port is the cable's", id, count));
      if (id >= 0 && id != p_.entry && count > 2)
        broken("tree-degree", fmt::format("module {} has {} children on two output ports", id, count));
    }
    if (e->rotation < 0 || e->rotation > 2) return;
    const int behind = beside(p_.entry)[static_cast<std::size_t>(e->rotation)];
    const RouteRow* hanging = behind < 0 ? nullptr : p_.find(behind);
    if (hanging != nullptr && hanging->parent == p_.entry)
      broken("entry-cable", fmt::format("cable and module {} share a port of entry {}", behind, p_.entry));
    const bool border = behind < 0 && modules_.contains(p_.entry) && modules_.at(p_.entry).border;
    if (border != p_.border_entry)
      broken("border-entry", fmt::format("entry {} is {}on the border", p_.entry, border ? "" : "not "));
  }

  void joints() {
    std::set<Edge> cut;
    for (const auto& [a, b] : p_.cut) cut.insert(edge(a, b));
    for (const RouteRow& r : p_.rows) {
      for (const int w : beside(r.id)) {
        const RouteRow* other = w < 0 ? nullptr : p_.find(w);
        if (other == nullptr || w < r.id) continue;
        const bool in_tree = r.parent == w || other->parent == r.id;
        if (in_tree == cut.contains(edge(r.id, w)))
          broken("joint-use", fmt::format("joint {}–{} is {}", r.id, w,
                                          in_tree ? "cut but carries the tree" : "neither kept nor cut"));
        cut.erase(edge(r.id, w));
      }
    }
    for (const auto& [a, b] : cut) broken("joint-use", fmt::format("cut joint {}–{} does not exist", a, b));
  }

  void totals() {
    int hops = 0, deepest = 0;
    std::map<int, std::set<int>> lines_at;  // These lines are used at or below a module.
    for (const RouteRow& r : p_.rows) {
      deepest = std::max(deepest, r.depth);
      int v = r.id;
      for (std::size_t guard = 0; v >= 0 && guard <= p_.rows.size(); ++guard) {
        lines_at[v].insert(r.line);
        const RouteRow* up = p_.find(v);
        v = up == nullptr ? -1 : up->parent;
      }
    }
    for (const RouteRow& r : p_.rows) hops += r.parent < 0 ? 0 : static_cast<int>(lines_at[r.id].size());
    if (hops != p_.line_hops) broken("line-hops", fmt::format("states {}, are {}", p_.line_hops, hops));
    if (deepest != p_.max_depth) broken("max-depth", fmt::format("states {}, is {}", p_.max_depth, deepest));
  }

  const ModuleMap& modules_;
  const RoutePatch& p_;
  const std::string& name_;
  const RoutingLimits& limits_;
  RoutingFindings& f_;
};

void check_members(const ModuleMap& modules, const RouteDocument& d, RoutingFindings& f) {
  std::map<int, int> owners;
  for (const RoutePatch& p : d.patches) {
    for (const RouteRow& r : p.rows) ++owners[r.id];
  }
  for (const auto& [id, count] : owners) {
    if (!modules.contains(id)) f.broken("known-module", fmt::format("module {}", id), "is not in the module list");
    if (count > 1)
      f.broken("one-patch", fmt::format("module {}", id), fmt::format("stands {} times in the patches", count));
  }
  for (const auto& [id, m] : modules) {
    if (!owners.contains(id)) f.broken("every-module-wired", fmt::format("module {}", id), "belongs to no patch");
  }
}

void check_report(const ModuleMap& modules, const RouteDocument& d, const RoutingLimits& limits, RoutingFindings& f) {
  const int k = static_cast<int>(d.patches.size()), n = static_cast<int>(modules.size());
  int hops = 0, depth = 0, failures = 0, lost = 0;
  for (const RoutePatch& p : d.patches) {
    hops += p.line_hops;
    depth = std::max(depth, p.max_depth);
    for (const FailureRow& x : p.failures) {
      ++failures;
      lost += x.backed_up - (x.other < 0 ? 1 : 0);
    }
  }
  const auto wrong = [&](const char* rule, const std::string& text) { f.broken(rule, "routes", text); };
  if (d.stated_patches != k) wrong("patch-count", fmt::format("states {} patches, holds {}", d.stated_patches, k));
  if (d.lower_bound > k)
    wrong("lower-bound", fmt::format("{} patches under the stated lower bound {}", k, d.lower_bound));
  if (d.lower_bound < (n + limits.capacity - 1) / limits.capacity)
    wrong("lower-bound", fmt::format("{} is under the size bound", d.lower_bound));
  if (d.proved != (d.lower_bound == k))
    wrong("proved", fmt::format("states {}, bound {} and {} patches", d.proved, d.lower_bound, k));
  if (hops != d.line_hops || depth != d.max_depth)
    wrong("report-totals", fmt::format("states {} hops, depth {}; are {}, {}", d.line_hops, d.max_depth, hops, depth));
  const double mean = failures == 0 ? 0.0 : static_cast<double>(lost) / failures;
  if (!(std::abs(mean - d.mean_loss) <= 1e-9))
    wrong("mean-loss", fmt::format("states {:.6f}, is {:.6f}", d.mean_loss, mean));
}

}  // namespace

void check_route_tree(const ModuleMap& modules, const RoutePatch& patch, const std::string& name,
                      const RoutingLimits& limits, RoutingFindings& f) {
  TreeRules(modules, patch, name, limits, f).run();
}

DesignReport check_routes(const nlohmann::json& modules, const nlohmann::json& routes, const RoutingLimits& limits) {
  const ModuleMap map = read_listed_modules(modules);
  const RouteDocument document = read_route_document(routes);
  RoutingFindings f;
  f.report.rules = {"known-module",   "one-patch",      "every-module-wired",
                    "patch-size",     "line-range",     "address-range",
                    "address-unique", "line-load",      "connected",
                    "one-entry",      "rotation-range", "acyclic",
                    "depth",          "parent-member",  "parent-joint",
                    "rotation",       "entry",          "entry-degree",
                    "tree-degree",    "entry-cable",    "border-entry",
                    "joint-use",      "line-hops",      "max-depth",
                    "patch-count",    "lower-bound",    "proved",
                    "report-totals",  "mean-loss",      "failure-rows",
                    "loss-strapped",  "loss-rerouted",  "loss-one-entry",
                    "loss-backed-up", "second-entry",   "backup-tree",
                    "adoption"};
  check_members(map, document, f);
  for (std::size_t p = 0; p < document.patches.size(); ++p) {
    check_route_tree(map, document.patches[p], fmt::format("patch {}", p), limits, f);
  }
  // Failures are only simulated on valid trees.
  if (f.report.violations.empty()) {
    for (std::size_t p = 0; p < document.patches.size(); ++p) check_route_failures(map, document, p, limits, f);
  }
  check_report(map, document, limits, f);
  return std::move(f.report);
}

}  // namespace triskin::check
