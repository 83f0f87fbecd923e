// SPDX-License-Identifier: GPL-3.0-or-later
// Implements R1 … R7 of the paper (Section V), with R4 as Algorithm 3 (Appendix A).
#include <cmath>
#include <random>
#include <stdexcept>

#include "triskin/placement/paper/heuristics.hpp"

namespace triskin::placement::paper {
namespace {

int draws_of(Heuristic heuristic, std::int64_t vertices, const HeuristicOptions& options) {
  if (options.draws > 0) return options.draws;
  switch (heuristic) {
    case Heuristic::kR1:
      return 1000;
    case Heuristic::kR6:
      return 2;
    case Heuristic::kR7:
      return static_cast<int>((vertices + 1) / 2);
    default:
      return 1;
  }
}

class Producer {
 public:
  Producer(Heuristic heuristic, const Polygon& polygon, const HeuristicOptions& options, const PlacementVisitor& visit)
      : vertices_(polygon.outer),
        n_(static_cast<int>(vertices_.size())),
        options_(options),
        visit_(visit),
        draws_(draws_of(heuristic, n_, options)),
        line_rad_(options.line_deg * M_PI / 180.0),
        node_(grid_point(options.node[0], options.node[1])),
        random_(options.seed) {}

  // Monte Carlo: θ uniform in [0°, 60°), the first vertex uniform within the modules of one period of the grid.
  void r1() {
    for (int k = 0; k < draws_; ++k) {
      const double theta = random_angle();
      if (!lay(0, theta, random_place())) return;
    }
  }
  // Puts each vertex in turn on the node and lays its edges to the next and to the preceding vertex on the line.
  bool r2() {
    return for_edges([&](int k, double theta) { return lay(k, theta, node_); });
  }
  // Lays the segment between each pair of vertices on the line, with the first of them on the node.
  bool r3() {
    return for_pairs([&](int i, double theta) { return lay(i, theta, node_); });
  }
  // Algorithm 3 takes R3, and for each pair puts every vertex v_k in turn on the node as the pivot of the turn.
  void r4() {
    for_pairs([&](int, double theta) {
      for (int k = 0; k < n_; ++k) {
        if (!lay(k, theta, node_)) return false;
      }
      return true;
    });
  }
  // Takes R2 and moves each of its placements to random places.
  void r5() {
    if (r2()) for_edges([&](int k, double theta) { return lay_at_random_places(k, theta); });
  }
  // Puts each vertex in turn on the node, at random angles.
  void r6() {
    for (int k = 0; k < n_; ++k) {
      for (int draw = 0; draw < draws_; ++draw) {
        if (!lay(k, random_angle(), node_)) return;
      }
    }
  }
  // Takes R3 and moves each of its placements to random places.
  void r7() {
    if (r3()) for_pairs([&](int i, double theta) { return lay_at_random_places(i, theta); });
  }

 private:
  // Turns the polygon by theta about vertex v, and moves v to `target` on the grid (line 7 of Algorithm 3).
  bool lay(int v, double theta, const Vec2& target) {
    const Vec2 by = target - vertices_[static_cast<std::size_t>(v)];
    return visit_({by.x(), by.y(), theta, v});
  }
  bool lay_at_random_places(int v, double theta) {
    for (int draw = 0; draw < draws_; ++draw) {
      if (!lay(v, theta, random_place())) return false;
    }
    return true;
  }

  // Returns the turn that lays the segment from vertex i to vertex j along the line (line 8 of Algorithm 3).
  [[nodiscard]] double angle_to_line(int i, int j) const {
    const Vec2 d = vertices_[static_cast<std::size_t>(j)] - vertices_[static_cast<std::size_t>(i)];
    return line_rad_ - std::atan2(d.y(), d.x());
  }
  // Returns false when a visit ended the list.
  template <class Visit>
  bool for_edges(Visit visit) {
    for (int k = 0; k < n_; ++k) {
      if (!visit(k, angle_to_line(k, (k + 1) % n_)) || !visit(k, angle_to_line(k, (k + n_ - 1) % n_))) return false;
    }
    return true;
  }
  template <class Visit>
  bool for_pairs(Visit visit) {
    std::int64_t pair = 0;
    for (int i = 0; i < n_; ++i) {
      for (int j = i + 1; j < n_; ++j) {
        if (pair++ % options_.pair_step == 0 && !visit(i, angle_to_line(i, j))) return false;
      }
    }
    return true;
  }

  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  double random_angle() { return unit() * M_PI / 3.0; }
  // An up module and the down module beside it form one period; one of them alone would omit half of all places.
  Vec2 random_place() {
    const double u = unit(), v = unit();
    return {kSide_mm * (u + 0.5 * v), kHeight_mm * v};
  }

  const std::vector<Vec2>& vertices_;
  const int n_;
  const HeuristicOptions& options_;
  const PlacementVisitor& visit_;
  const int draws_;
  const double line_rad_;
  const Vec2 node_;
  std::mt19937_64 random_;
};

void require_valid(const HeuristicOptions& o) {
  if (o.line_deg != 0 && o.line_deg != 60 && o.line_deg != 300)
    throw std::invalid_argument("generating lines run at 0, 60 and 300 degrees");
  if (o.draws < 0) throw std::invalid_argument("the number of draws cannot be negative");
  if (o.pair_step < 1) throw std::invalid_argument("the step between pairs must be at least 1");
}

}  // namespace

void produce_placements(Heuristic heuristic, const Polygon& polygon, const HeuristicOptions& options,
                        const PlacementVisitor& visit) {
  require_valid(options);
  Producer producer(heuristic, polygon, options, visit);
  switch (heuristic) {
    case Heuristic::kR1:
      return producer.r1();
    case Heuristic::kR2:
      producer.r2();
      return;
    case Heuristic::kR3:
      producer.r3();
      return;
    case Heuristic::kR4:
      return producer.r4();
    case Heuristic::kR5:
      return producer.r5();
    case Heuristic::kR6:
      return producer.r6();
    case Heuristic::kR7:
      return producer.r7();
  }
}

std::int64_t placement_count(Heuristic heuristic, std::int64_t vertices, const HeuristicOptions& options) {
  const std::int64_t pairs = vertices * (vertices - 1) / 2, draws = draws_of(heuristic, vertices, options);
  switch (heuristic) {
    case Heuristic::kR1:
      return draws;
    case Heuristic::kR2:
      return 2 * vertices;
    case Heuristic::kR3:
      return pairs;
    case Heuristic::kR4:
      return vertices * pairs;
    case Heuristic::kR5:
      return 2 * vertices * (1 + draws);
    case Heuristic::kR6:
      return vertices * draws;
    default:
      return pairs * (1 + draws);
  }
}

}  // namespace triskin::placement::paper
