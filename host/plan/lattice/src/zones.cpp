// SPDX-License-Identifier: GPL-3.0-or-later
#include "zones.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "overlap.hpp"
#include "triskin/base/disjoint_sets.hpp"

namespace triskin::lattice {
namespace {

Vec3 random_direction(Dice& random) {
  for (;;) {
    const double x = random.unit(), y = random.unit(), z = random.unit();
    const Vec3 d = 2.0 * Vec3(x, y, z) - Vec3::Ones();
    if (d.squaredNorm() > 0.01 && d.squaredNorm() < 1.0) return d.normalized();
  }
}

void divide_further(std::vector<Vec3> centers, const Zone& zone, int count, Dice& random, std::vector<Zone>& zones) {
  if (count == 1 || centers.empty()) {
    zones.push_back(zone);
    return;
  }
  const Vec3 direction = random_direction(random);
  const int first = count / 2;
  const auto middle = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() * at(first) / at(count));
  std::ranges::nth_element(centers, middle, {}, [&](const Vec3& c) { return direction.dot(c); });
  const double cut_mm = direction.dot(*middle);
  Zone below = zone, above = zone;
  below.sides.push_back({-direction, -cut_mm + kHalfBand_mm});
  above.sides.push_back({direction, cut_mm + kHalfBand_mm});
  divide_further({centers.begin(), middle}, below, first, random, zones);
  divide_further({middle, centers.end()}, above, count - first, random, zones);
}

// Lists the triangles of all zones, and which of their corners are one vertex.
class Merge {
 public:
  Merge(LatticeMesh empty, const std::vector<ZoneNet>& zones) : net_(std::move(empty)), zones_(zones) {
    collect();
    join_corners();
  }

  LatticeMesh merged() {
    give_numbers();
    find_islands();
    add_triangles();
    remove_conflicts();
    net_.separate();
    return std::move(net_);
  }

 private:
  static constexpr int kShared = -1;
  struct Entry {
    int zone;  // kShared stands for all zones, and such a module is unchanged.
    int triangle;
    int number = -1;  // The number in the merged lattice; −1 until it has one.
    int island = -1;  // The leader is an entry of the same island.
  };

  [[nodiscard]] const LatticeMesh& net_of(const Entry& e) const { return zones_[at(std::max(e.zone, 0))].net; }
  [[nodiscard]] const NetTriangle& triangle_of(const Entry& e) const { return net_of(e).triangles()[at(e.triangle)]; }

  // A fixed triangle is one that no zone changes, unless it is another zone's.
  void collect() {
    std::vector<int> pinned_in(zones_[0].net.triangles().size(), 0);
    for (const ZoneNet& z : zones_) {
      for (const int t : z.pinned) ++pinned_in[at(t)];
    }
    for (int t = 0; t < static_cast<int>(pinned_in.size()); ++t) {
      const bool is_kept = zones_[0].net.used(t) && zones_[0].net.triangles()[at(t)].is_fixed && pinned_in[at(t)] == 0;
      if (is_kept || pinned_in[at(t)] == static_cast<int>(zones_.size())) entries_.push_back({kShared, t});
    }
    for (int z = 0; z < static_cast<int>(zones_.size()); ++z) {
      const LatticeMesh& net = zones_[at(z)].net;
      for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
        if (net.used(t) && !net.triangles()[at(t)].is_fixed) entries_.push_back({z, t});
      }
    }
  }

  [[nodiscard]] int corner(int zone, int vertex) const { return first_corner_[at(zone)] + vertex; }

  void join_corners() {
    int corners = 0;
    for (const ZoneNet& z : zones_) {
      first_corner_.push_back(corners);
      corners += static_cast<int>(z.net.vertices().size());
    }
    corners_.reset(at(corners));
    for (const Entry& e : entries_) {
      if (e.zone != kShared) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        for (int z = 1; z < static_cast<int>(zones_.size()); ++z)
          corners_.join(corner(z, zones_[at(z)].net.triangles()[at(e.triangle)].vertex[c]),
                        corner(0, zones_[0].net.triangles()[at(e.triangle)].vertex[c]));
      }
    }
  }

  [[nodiscard]] std::array<int, 3> corners_of(const Entry& e) {
    std::array<int, 3> of{};
    for (std::size_t c = 0; c < 3; ++c) of[c] = corners_.find(corner(std::max(e.zone, 0), triangle_of(e).vertex[c]));
    return of;
  }

  // An entry keeps its own number; if another entry has that, it gets the least free one. Entries follow the order of
  // their numbers.
  void give_numbers() {
    std::vector<char> is_taken;
    const auto take = [&](Entry& e, int number) {
      if (is_taken.size() <= at(number)) is_taken.resize(at(number) + 1, 0);
      if (is_taken[at(number)]) return;
      is_taken[at(number)] = 1;
      e.number = number;
    };
    for (Entry& e : entries_) take(e, e.triangle);
    int free = 0;
    for (Entry& e : entries_) {
      for (; e.number < 0; ++free) take(e, free);
    }
    std::ranges::sort(entries_, {}, &Entry::number);
  }

  // Connected modules form an island.
  void find_islands() {
    DisjointSets islands(entries_.size());
    std::map<std::pair<int, int>, int> sides;
    for (int k = 0; k < static_cast<int>(entries_.size()); ++k) {
      const auto of = corners_of(entries_[at(k)]);
      for (std::size_t s = 0; s < 3; ++s) {
        const auto side = std::minmax({of[s], of[(s + 1) % 3]});
        const auto [other, is_new] = sides.try_emplace({side.first, side.second}, k);
        if (!is_new) islands.join(other->second, k);
      }
    }
    for (int k = 0; k < static_cast<int>(entries_.size()); ++k) entries_[at(k)].island = islands.find(k);
  }

  void add_triangles() {
    std::map<int, int> vertex, island;  // The keys are a corner and the leader of an island.
    for (const Entry& e : entries_) {
      const NetTriangle& t = triangle_of(e);
      const auto of = corners_of(e);
      std::array<int, 3> vertices{};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [known, is_new] = vertex.try_emplace(of[c], -1);
        if (is_new) known->second = copied_vertex(net_of(e).vertices()[at(t.vertex[c])]);
        vertices[c] = known->second;
      }
      const auto [number, is_new] = island.try_emplace(e.island, -1);
      if (is_new) number->second = net_.new_island();
      const int added = net_.add_triangle(number->second, t.tile, vertices, e.number);
      if (t.is_fixed && !std::ranges::binary_search(zones_[0].pinned, e.triangle)) net_.pin(added, t.rigid);
    }
  }

  int copied_vertex(const NetVertex& v) {
    const int copy = net_.add_vertex(v.point, v.normal, v.i, v.j);
    NetVertex& w = net_.edit_vertex(copy);
    w.lift_mm = v.lift_mm;
    w.on_border = v.on_border;
    w.outward = v.outward;
    return copy;
  }

  void remove_conflicts() {
    std::vector<int> zone_of(net_.triangles().size(), kShared);
    for (const Entry& e : entries_) zone_of[at(e.number)] = e.zone;
    std::map<std::tuple<int, int, int, bool>, int> tiles;
    std::set<int> conflicts;
    std::vector<Entry> by_zone = entries_;
    std::ranges::stable_sort(by_zone, {}, &Entry::zone);
    for (const Entry& e : by_zone) {
      const Tile& tile = triangle_of(e).tile;
      const bool is_first = tiles.try_emplace({e.island, tile.i, tile.j, tile.up}, e.number).second;
      const bool is_near = e.zone != kShared && net_.any_near(net_.center(e.number), kApart_mm, [&](int other) {
        return zone_of[at(other)] != kShared && zone_of[at(other)] < e.zone && !conflicts.contains(other);
      });
      if ((!is_first || is_near) && !net_.triangles()[at(e.number)].is_fixed) conflicts.insert(e.number);
    }
    for (const int t : conflicts) net_.remove_triangle(t);
  }

  LatticeMesh net_;
  const std::vector<ZoneNet>& zones_;
  std::vector<Entry> entries_;
  std::vector<int> first_corner_;
  DisjointSets corners_;  // Joins the vertices of all zones.
};

}  // namespace

std::vector<Zone> divide(const LatticeMesh& net, int count, Dice& random) {
  std::vector<Vec3> centers;
  for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
    if (net.used(t)) centers.push_back(net.center(t));
  }
  std::vector<Zone> zones;
  divide_further(std::move(centers), {}, count, random, zones);
  return zones;
}

std::vector<int> pin_outside(LatticeMesh& net, const Zone& zone) {
  std::vector<int> pinned;
  for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
    if (!net.used(t) || net.triangles()[at(t)].is_fixed || zone.holds(net.center(t))) continue;
    net.pin(t, Triangle(net.triangles()[at(t)].rigid));
    pinned.push_back(t);
  }
  return pinned;
}

void unpin(LatticeMesh& net, const std::vector<int>& triangles) {
  for (const int t : triangles) net.unpin(t);
}

LatticeMesh merge_zones(LatticeMesh empty, const std::vector<ZoneNet>& zones) {
  return Merge(std::move(empty), zones).merged();
}

}  // namespace triskin::lattice
