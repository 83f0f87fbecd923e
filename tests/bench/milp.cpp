// SPDX-License-Identifier: GPL-3.0-or-later
#include "milp.hpp"

#include <coin/Cbc_C_Interface.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace triskin::bench {
namespace {

[[nodiscard]] std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

// One island of the module graph with its own numbers; −1 means no neighbour.
struct Island {
  std::vector<std::array<int, 3>> neighbour;
  std::vector<int> node;  // The number in the whole graph.
  [[nodiscard]] int size() const { return static_cast<int>(neighbour.size()); }
};

std::vector<Island> islands_of(const design::ModuleGraph& graph) {
  std::vector<Island> islands;
  std::vector<int> number(graph.nodes.size(), -1);
  for (std::size_t start = 0; start < graph.nodes.size(); ++start) {
    if (number[start] >= 0) continue;
    std::vector<int> nodes{static_cast<int>(start)};
    number[start] = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      for (const int w : graph.nodes[at(nodes[k])].neighbour) {
        if (w < 0 || number[at(w)] >= 0) continue;
        number[at(w)] = static_cast<int>(nodes.size());
        nodes.push_back(w);
      }
    }
    Island& island = islands.emplace_back();
    island.node = nodes;
    for (const int v : nodes) {
      std::array<int, 3> mine = graph.nodes[at(v)].neighbour;
      for (int& w : mine) w = w < 0 ? -1 : number[at(w)];
      island.neighbour.push_back(mine);
    }
  }
  return islands;
}

struct MilpAnswer {
  int lower_bound = 0;  // No solution can have fewer parts.
  int parts = 0;        // Zero means that no solution was found in time.
};

struct Arc {
  int from, to;
};

// What a root and an arc cost; `arc` sees numbers of the island.
struct Costs {
  double root = 1.0;
  std::function<double(int from, int to)> arc = [](int, int) { return 0.0; };
};

class ForestModel {
 public:
  ForestModel(const Island& g, int capacity, int lower_bound, const Costs& costs = {})
      : g_(g), model_(Cbc_newModel(), &Cbc_deleteModel) {
    Cbc_setLogLevel(model(), 0);
    for (int v = 0; v < g.size(); ++v) {
      for (const int w : g.neighbour[at(v)]) {
        if (w >= 0) arcs_.push_back({v, w});
      }
    }
    const int n = g.size(), m = static_cast<int>(arcs_.size());
    for (int v = 0; v < n; ++v) column(0, 1, costs.root, true);              // The columns are r_v.
    for (int v = 0; v < n; ++v) column(0, capacity, 0, false);               // The columns are s_v.
    for (const Arc& a : arcs_) column(0, 1, costs.arc(a.from, a.to), true);  // The columns are y_a.
    for (int a = 0; a < m; ++a) column(0, capacity - 1, 0, false);           // The columns are g_a.
    for (int v = 0; v < n; ++v) node_rows(v, capacity);
    for (int a = 0; a < m; ++a) {
      row({{flow(a), 1.0}, {use(a), -1.0}}, 'G', 0);
      row({{flow(a), 1.0}, {use(a), 1.0 - capacity}}, 'L', 0);
    }
    std::vector<Term> roots;
    for (int v = 0; v < n; ++v) roots.push_back({v, 1.0});
    row(roots, 'G', lower_bound);
  }

  // Returns bounds of the objective; the upper one is infinite without a solution.
  std::array<double, 2> solve_for_price(double time_limit_s) {
    Cbc_setMaximumSeconds(model(), time_limit_s);
    Cbc_setParameter(model(), "threads", "0");
    Cbc_solve(model());
    const bool is_solved = Cbc_numberSavedSolutions(model()) > 0 || Cbc_isProvenOptimal(model()) != 0;
    const double upper = is_solved ? Cbc_getObjValue(model()) : std::numeric_limits<double>::infinity();
    return {Cbc_isProvenOptimal(model()) != 0 ? upper : Cbc_getBestPossibleObjValue(model()), upper};
  }

  MilpAnswer solve(int lower_bound, double time_limit_s) {
    Cbc_setMaximumSeconds(model(), time_limit_s);
    Cbc_setParameter(model(), "threads", "0");
    Cbc_solve(model());
    MilpAnswer answer{lower_bound, 0};
    const double bound = Cbc_getBestPossibleObjValue(model());
    if (std::isfinite(bound)) answer.lower_bound = std::max(lower_bound, static_cast<int>(std::ceil(bound - 1e-6)));
    if (Cbc_numberSavedSolutions(model()) == 0 && Cbc_isProvenOptimal(model()) == 0) return answer;
    count_roots(Cbc_getColSolution(model()), answer);
    if (Cbc_isProvenOptimal(model()) != 0) answer.lower_bound = answer.parts;
    return answer;
  }

 private:
  struct Term {
    int column;
    double factor;
  };
  [[nodiscard]] Cbc_Model* model() const { return model_.get(); }
  [[nodiscard]] int supply(int v) const { return g_.size() + v; }
  [[nodiscard]] int use(int a) const { return 2 * g_.size() + a; }
  [[nodiscard]] int flow(int a) const { return 2 * g_.size() + static_cast<int>(arcs_.size()) + a; }

  void column(double low, double high, double cost, bool integer) {
    Cbc_addCol(model(), std::to_string(columns_++).c_str(), low, high, cost, integer ? 1 : 0, 0, nullptr, nullptr);
  }
  void row(const std::vector<Term>& terms, char sense, double right) {
    std::vector<int> columns;
    std::vector<double> factors;
    for (const Term& t : terms) {
      columns.push_back(t.column);
      factors.push_back(t.factor);
    }
    Cbc_addRow(model(), std::to_string(rows_++).c_str(), static_cast<int>(terms.size()), columns.data(), factors.data(),
               sense, right);
  }
  void node_rows(int v, int capacity) {
    std::vector<Term> one_parent{{v, 1.0}}, balance{{supply(v), 1.0}};
    for (std::size_t a = 0; a < arcs_.size(); ++a) {
      const int k = static_cast<int>(a);
      if (arcs_[a].to == v) {
        one_parent.push_back({use(k), 1.0});
        balance.push_back({flow(k), 1.0});
      }
      if (arcs_[a].from == v) balance.push_back({flow(k), -1.0});
    }
    row(one_parent, 'E', 1);
    row(balance, 'E', 1);
    row({{supply(v), 1.0}, {v, -static_cast<double>(capacity)}}, 'L', 0);
  }

  void count_roots(const double* value, MilpAnswer& answer) const {
    std::vector<bool> is_child(at(g_.size()), false);
    for (std::size_t a = 0; a < arcs_.size(); ++a) {
      if (value[use(static_cast<int>(a))] > 0.5) is_child[at(arcs_[a].to)] = true;
    }
    answer.parts = static_cast<int>(std::ranges::count(is_child, false));
  }

  const Island& g_;
  std::unique_ptr<Cbc_Model, decltype(&Cbc_deleteModel)> model_;
  std::vector<Arc> arcs_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace

PartitionInterval partition_by_milp(const design::ModuleGraph& graph, int capacity, double time_limit_s) {
  const auto start = std::chrono::steady_clock::now();
  PartitionInterval interval;
  bool found_all = true;
  for (const Island& island : islands_of(graph)) {
    const int by_size = (island.size() + capacity - 1) / capacity;
    const MilpAnswer answer = ForestModel(island, capacity, by_size).solve(by_size, time_limit_s);
    interval.lower += answer.lower_bound;
    interval.upper += answer.parts;
    found_all = found_all && answer.parts > 0;
  }
  if (!found_all) interval.upper = 0;
  interval.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return interval;
}

PriceInterval price_by_milp(const design::ModuleGraph& graph, const std::vector<design::Jumper>& places, int capacity,
                            const design::Price& price, double time_limit_s) {
  const auto start = std::chrono::steady_clock::now();
  PriceInterval interval;
  for (const Island& island : islands_of(design::with_jumpers(graph, places))) {
    const Costs costs{price.controller, [&](int from, int to) {
                        const auto [a, b] = std::minmax(island.node[at(from)], island.node[at(to)]);
                        return std::ranges::any_of(places,
                                                   [&](const design::Jumper& j) { return j.node == std::array{a, b}; })
                                   ? price.jumper
                                   : 0.0;
                      }};
    const int by_size = (island.size() + capacity - 1) / capacity;
    const auto [lower, upper] = ForestModel(island, capacity, by_size, costs).solve_for_price(time_limit_s);
    interval.lower += lower;
    interval.upper += upper;
  }
  interval.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return interval;
}

}  // namespace triskin::bench
