// SPDX-License-Identifier: GPL-3.0-or-later
#include "milp.hpp"

#include <coin/Cbc_C_Interface.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace triskin::geometry {
namespace {

struct Arc {
  int from, to;
};

class ForestModel {
 public:
  ForestModel(const LocalGraph& g, int capacity, int lower_bound) : g_(g), model_(Cbc_newModel(), &Cbc_deleteModel) {
    Cbc_setLogLevel(model(), 0);
    for (int v = 0; v < g.size(); ++v) {
      for (const int w : g.neighbour[at(v)]) {
        if (w >= 0) arcs_.push_back({v, w});
      }
    }
    const int n = g.size(), m = static_cast<int>(arcs_.size());
    for (int v = 0; v < n; ++v) column(0, 1, 1, true);              // r_v
    for (int v = 0; v < n; ++v) column(0, capacity, 0, false);      // s_v
    for (int a = 0; a < m; ++a) column(0, 1, 0, true);              // y_a
    for (int a = 0; a < m; ++a) column(0, capacity - 1, 0, false);  // g_a
    for (int v = 0; v < n; ++v) node_rows(v, capacity);
    for (int a = 0; a < m; ++a) {
      row({{flow(a), 1.0}, {use(a), -1.0}}, 'G', 0);
      row({{flow(a), 1.0}, {use(a), 1.0 - capacity}}, 'L', 0);
    }
    std::vector<Term> roots;
    for (int v = 0; v < n; ++v) roots.push_back({v, 1.0});
    row(roots, 'G', lower_bound);
  }

  MilpAnswer solve(int lower_bound, double time_limit_s) {
    Cbc_setMaximumSeconds(model(), time_limit_s);
    Cbc_setParameter(model(), "threads", "0");
    Cbc_solve(model());
    MilpAnswer answer{lower_bound, 0, {}};
    const double bound = Cbc_getBestPossibleObjValue(model());
    if (std::isfinite(bound)) answer.lower_bound = std::max(lower_bound, static_cast<int>(std::ceil(bound - 1e-6)));
    if (Cbc_numberSavedSolutions(model()) == 0 && Cbc_isProvenOptimal(model()) == 0) return answer;
    read_forest(Cbc_getColSolution(model()), answer);
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

  void read_forest(const double* value, MilpAnswer& answer) const {
    std::vector<int> parent(at(g_.size()), -1);
    for (std::size_t a = 0; a < arcs_.size(); ++a) {
      if (value[use(static_cast<int>(a))] > 0.5) parent[at(arcs_[a].to)] = arcs_[a].from;
    }
    answer.part_of.assign(at(g_.size()), -1);
    for (int v = 0; v < g_.size(); ++v) {
      if (parent[at(v)] < 0) answer.part_of[at(v)] = answer.parts++;
    }
    for (int v = 0; v < g_.size(); ++v) {
      int root = v;
      while (parent[at(root)] >= 0) root = parent[at(root)];
      answer.part_of[at(v)] = answer.part_of[at(root)];
    }
  }

  const LocalGraph& g_;
  std::unique_ptr<Cbc_Model, decltype(&Cbc_deleteModel)> model_;
  std::vector<Arc> arcs_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace

MilpAnswer divide_by_milp(const LocalGraph& g, int capacity, int lower_bound, double time_limit_s) {
  return ForestModel(g, capacity, lower_bound).solve(lower_bound, time_limit_s);
}

}  // namespace triskin::geometry
