// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "routed_patch.hpp"

namespace triskin::check {
namespace {

class FailureRules {
 public:
  FailureRules(const ModuleMap& modules, const RouteDocument& routes, std::size_t patch, const RoutingLimits& limits,
               RoutingFindings& f)
      : modules_(modules), routes_(routes), p_(routes.patches[patch]), index_(patch), limits_(limits), f_(f) {
    for (std::size_t q = 0; q < routes.patches.size(); ++q) {
      const RoutePatch& other = routes.patches[q];
      for (const RouteRow& r : other.rows) owner_[r.id] = q;
      // No signal passes where an entry cable is plugged.
      const int behind = modules_.at(other.entry).beside[static_cast<std::size_t>(other.find(other.entry)->rotation)];
      if (behind >= 0) plugged_.insert(edge(other.entry, behind));
      const int second = other.second_entry, side = other.second_side;
      if (second < 0 || side < 0 || side > 2 || !modules_.contains(second)) continue;
      const int beyond = modules_.at(second).beside[static_cast<std::size_t>(side)];
      if (beyond >= 0) plugged_.insert(edge(second, beyond));
    }
  }

  void run() {
    second_entry();
    std::set<std::pair<int, int>> rows;
    for (const FailureRow& x : p_.failures) {
      if (!rows.insert({x.module, x.other}).second) broken("failure-rows", x, "stands twice");
      if (!known(x)) continue;
      losses(x);
      backup(x);
    }
    for (const RouteRow& r : p_.rows) {
      if (!rows.contains({r.id, -1}))
        f_.broken("failure-rows", name(), fmt::format("no row for a failure of module {}", r.id));
      if (r.parent >= 0 && !rows.contains({r.id, r.parent}))
        f_.broken("failure-rows", name(), fmt::format("no row for joint {}–{}", r.id, r.parent));
    }
  }

 private:
  [[nodiscard]] std::string name() const { return fmt::format("patch {}", index_); }
  void broken(const char* rule, const FailureRow& x, const std::string& text) {
    f_.broken(rule, name(),
              x.other < 0 ? fmt::format("failure of module {}: {}", x.module, text)
                          : fmt::format("failure of joint {}–{}: {}", x.module, x.other, text));
  }

  void second_entry() {
    const int e = p_.second_entry, s = p_.second_side;
    if (e < 0) return;
    bool fits = e != p_.entry && p_.find(e) != nullptr && s >= 0 && s <= 2;
    if (fits) {
      const int beyond = modules_.at(e).beside[static_cast<std::size_t>(s)];
      fits = beyond < 0 ? modules_.at(e).border : p_.find(beyond) == nullptr;
      const bool border = beyond < 0;
      if (fits && border != p_.second_border)
        f_.broken("second-entry", name(), fmt::format("module {} is {}on the border", e, border ? "" : "not "));
    }
    if (!fits) f_.broken("second-entry", name(), fmt::format("module {} side {} has no place for a connector", e, s));
  }

  bool known(const FailureRow& x) {
    const RouteRow* r = p_.find(x.module);
    const bool is_joint = x.other >= 0;
    if (r != nullptr && (!is_joint || r->parent == x.other)) return true;
    broken("failure-rows", x, "is no module or tree joint of the patch");
    return false;
  }

  [[nodiscard]] bool dead(const FailureRow& x, int id) const { return x.other < 0 && id == x.module; }
  [[nodiscard]] bool joined(const FailureRow& x, int a, int b) const {
    if (a < 0 || b < 0 || dead(x, a) || dead(x, b) || plugged_.contains(edge(a, b))) return false;
    if (x.other >= 0 && edge(a, b) == edge(x.module, x.other)) return false;
    const auto& sides = modules_.at(a).beside;
    return std::ranges::find(sides, b) != sides.end();
  }

  [[nodiscard]] std::set<int> reached(const FailureRow& x, const std::vector<int>& from) const {
    std::set<int> seen;
    std::vector<int> queue;
    for (const int v : from) {
      if (v >= 0 && !dead(x, v) && seen.insert(v).second) queue.push_back(v);
    }
    while (!queue.empty()) {
      const int v = queue.back();
      queue.pop_back();
      for (const int w : modules_.at(v).beside) {
        if (w >= 0 && p_.find(w) != nullptr && joined(x, v, w) && seen.insert(w).second) queue.push_back(w);
      }
    }
    return seen;
  }

  [[nodiscard]] int below(int id) const {
    int count = 0;
    for (const RouteRow& r : p_.rows) {
      for (const RouteRow* v = &r; v != nullptr; v = v->parent < 0 ? nullptr : p_.find(v->parent))
        count += v->id == id ? 1 : 0;
    }
    return count;
  }

  void losses(const FailureRow& x) {
    const int n = static_cast<int>(p_.rows.size());
    const std::set<int> alive = reached(x, {p_.entry, p_.second_entry});
    const int strapped = below(x.module), rerouted = n - static_cast<int>(alive.size());
    const int one_entry = n - static_cast<int>(reached(x, {p_.entry}).size());
    if (x.strapped != strapped) broken("loss-strapped", x, fmt::format("states {}, is {}", x.strapped, strapped));
    if (x.rerouted != rerouted) broken("loss-rerouted", x, fmt::format("states {}, is {}", x.rerouted, rerouted));
    if (x.one_entry != one_entry) broken("loss-one-entry", x, fmt::format("states {}, is {}", x.one_entry, one_entry));
    const int backed_up = n - static_cast<int>(alive.size() + x.adopted.size());
    if (x.backed_up != backed_up) broken("loss-backed-up", x, fmt::format("states {}, is {}", x.backed_up, backed_up));
    adoption(x, alive);
  }

  void adoption(const FailureRow& x, const std::set<int>& alive) {
    std::map<int, std::size_t> adopter;
    std::map<std::size_t, int> taken;
    for (const auto& [child, parent] : x.adopted) {
      const bool unreachable_module =
          p_.find(child) != nullptr && !alive.contains(child) && !dead(x, child) && !adopter.contains(child);
      if (!unreachable_module || !modules_.contains(parent) || !joined(x, child, parent)) {
        broken("adoption", x, fmt::format("module {} cannot be read over module {}", child, parent));
        continue;
      }
      const bool inside = owner_.at(parent) == index_;
      if (inside && !adopter.contains(parent)) {
        broken("adoption", x, fmt::format("module {} hangs on {}, which nobody adopted before it", child, parent));
        continue;
      }
      adopter[child] = inside ? adopter[parent] : owner_.at(parent);
      ++taken[adopter[child]];
    }
    for (const auto& [patch, count] : taken) {
      const int places = limits_.lines * limits_.addresses - static_cast<int>(routes_.patches[patch].rows.size());
      if (count > places)
        broken("adoption", x, fmt::format("patch {} takes {} modules, has {} free addresses", patch, count, places));
    }
  }

  // Checks that the normal tree with the listed changes reaches every living module over living joints, from an entry.
  void backup(const FailureRow& x) {
    std::map<int, int> parent;
    for (const RouteRow& r : p_.rows) parent[r.id] = r.parent;
    for (const auto& [child, up] : x.backup) {
      if (!parent.contains(child)) broken("backup-tree", x, fmt::format("names module {} of another patch", child));
      parent[child] = up;
    }
    std::map<int, int> children;
    for (const int v : reached(x, {p_.entry, p_.second_entry})) {
      int u = v;
      for (std::size_t guard = 0; u >= 0 && parent.contains(u) && parent[u] >= 0 && guard <= p_.rows.size(); ++guard) {
        if (!joined(x, u, parent[u])) break;
        u = parent[u];
      }
      const bool at_entry = u == p_.entry || u == p_.second_entry;
      if (!at_entry || parent[u] >= 0) broken("backup-tree", x, fmt::format("module {} does not reach an entry", v));
      if (parent[v] >= 0) ++children[parent[v]];
    }
    for (const auto& [id, count] : children) {
      if (count > 2) broken("backup-tree", x, fmt::format("module {} has {} children on two ports", id, count));
    }
  }

  const ModuleMap& modules_;
  const RouteDocument& routes_;
  const RoutePatch& p_;
  std::size_t index_;
  const RoutingLimits& limits_;
  RoutingFindings& f_;
  std::map<int, std::size_t> owner_;
  std::set<Edge> plugged_;
};

}  // namespace

void check_route_failures(const ModuleMap& modules, const RouteDocument& routes, std::size_t patch,
                          const RoutingLimits& limits, RoutingFindings& f) {
  FailureRules(modules, routes, patch, limits, f).run();
}

}  // namespace triskin::check
