// SPDX-License-Identifier: GPL-3.0-or-later
// The routing rules use their own structures, which are filled from the two documents.
#pragma once
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "triskin/check/routing_rules.hpp"

namespace triskin::check {

/// A joint between two modules, with the lower id first.
using Edge = std::pair<int, int>;
[[nodiscard]] inline Edge edge(int a, int b) {
  return std::minmax(a, b);
}

struct ListedModule {
  std::array<int, 3> beside{-1, -1, -1};  ///< Each entry is the id of the module across that side.
  bool border = true;
};
using ModuleMap = std::map<int, ListedModule>;

struct RouteRow {
  int id, parent, rotation, line, address, depth;
};
struct FailureRow {
  int module, other, strapped, rerouted, one_entry, backed_up;
  std::vector<std::array<int, 2>> backup, adopted;
};
struct RoutePatch {
  int entry, second_entry, second_side, line_hops, max_depth;
  bool border_entry, second_border;
  std::vector<RouteRow> rows;
  std::vector<std::array<int, 2>> cut;
  std::vector<FailureRow> failures;

  [[nodiscard]] const RouteRow* find(int id) const {
    for (const RouteRow& r : rows) {
      if (r.id == id) return &r;
    }
    return nullptr;
  }
};
struct RouteDocument {
  std::vector<RoutePatch> patches;
  int stated_patches, lower_bound, line_hops, max_depth;
  bool proved;
  double mean_loss;
};

struct RoutingFindings {
  DesignReport report;
  void broken(const char* rule, std::string where, std::string text) {
    report.violations.push_back({rule, std::move(where), std::move(text)});
  }
};

[[nodiscard]] ModuleMap read_listed_modules(const nlohmann::json& document);
[[nodiscard]] RouteDocument read_route_document(const nlohmann::json& document);

void check_route_tree(const ModuleMap& modules, const RoutePatch& patch, const std::string& name,
                      const RoutingLimits& limits, RoutingFindings& f);
void check_route_failures(const ModuleMap& modules, const RouteDocument& routes, std::size_t patch,
                          const RoutingLimits& limits, RoutingFindings& f);

}  // namespace triskin::check
