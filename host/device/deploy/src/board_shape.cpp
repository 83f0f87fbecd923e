// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/board_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>

#include "address_moves.hpp"
#include "triskin/diagnose/topology.hpp"
#include "triskin/session/address_users.hpp"

namespace triskin::deploy {
namespace {

using Edges = std::vector<std::vector<int>>;  // Each board has the indices of its seats in ascending order.

// Finds a largest matching of boards and seats by augmenting paths.
class Matching {
 public:
  Matching(const Edges& edges, std::size_t seats) : edges_(edges), board_(seats, -1) {
    for (std::size_t b = 0; b < edges.size(); ++b) {
      std::vector<bool> seen(seats, false);
      if (augment(static_cast<int>(b), seen)) ++size_;
    }
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  // Returns the board of a seat, or −1.
  [[nodiscard]] int board(std::size_t seat) const { return board_[seat]; }

 private:
  bool augment(int board, std::vector<bool>& seen) {
    for (const int s : edges_[static_cast<std::size_t>(board)]) {
      const auto seat = static_cast<std::size_t>(s);
      if (seen[seat]) continue;
      seen[seat] = true;
      if (board_[seat] >= 0 && !augment(board_[seat], seen)) continue;
      board_[seat] = board;
      return true;
    }
    return false;
  }

  const Edges& edges_;
  std::vector<int> board_;
  std::size_t size_ = 0;
};

// Differences are indexed by board and seat, as shape_difference() returns them.
using Differences = std::vector<std::vector<int>>;

// Returns the seats whose patch differs from the board in at most `slack` points more than the nearest one; a negative
// `slack` allows only equal ones.
Edges edges_of(const Differences& differences, int slack) {
  Edges edges(differences.size());
  for (std::size_t b = 0; b < differences.size(); ++b) {
    int least = -1;
    for (const int d : differences[b]) {
      if (d >= 0 && (least < 0 || d < least)) least = d;
    }
    const int most = slack < 0 ? 0 : least + slack;
    for (std::size_t p = 0; p < differences[b].size(); ++p) {
      if (differences[b][p] >= 0 && differences[b][p] <= most) edges[b].push_back(static_cast<int>(p));
    }
  }
  return edges;
}

int strapped_difference(const BoardShape& shape, const design::Patch& patch) {
  std::array<std::uint8_t, layout::kLines> designed{};
  for (const design::RoutedModule& m : patch.modules) {
    auto& line = designed.at(static_cast<std::size_t>(m.line));
    line = static_cast<std::uint8_t>(line | 1U << static_cast<unsigned>(m.address));
  }
  int differences = 0;
  for (std::size_t l = 0; l < designed.size(); ++l)
    differences += std::popcount(static_cast<unsigned>(designed[l] ^ shape.answers[l]));
  return 2 * differences > static_cast<int>(patch.modules.size()) ? -1 : differences;
}

}  // namespace

BoardShape read_shape(session::Controller& controller) {
  BoardShape shape;
  controller.reroute();
  shape.found = controller.topology();
  shape.switched = shape.found.switched;
  if (shape.switched) return shape;
  const auto lines = controller.discover();
  for (std::size_t l = 0; l < lines.size(); ++l) shape.answers[l] = lines[l].answers;
  return shape;
}

int shape_difference(const BoardShape& shape, const design::Design& design, layout::PatchIndex patch) {
  const design::Patch& designed = design.patches.at(static_cast<std::size_t>(patch));
  if (!shape.switched) return strapped_difference(shape, designed);
  if (shape.found.count == 0 || designed.modules.empty()) return -1;
  const diagnose::TopologyMatch match = diagnose::match_topology(shape.found, design, patch);
  return match.another_patch() ? -1 : static_cast<int>(match.differences.size());
}

bool reaches_across(const BoardShape& shape, const design::Design& design, layout::PatchIndex patch,
                    std::span<const layout::PatchIndex> open) {
  if (!shape.switched || shape.found.count == 0 || shape.found.second_cable) return false;
  const wire::FoundTopology expected = diagnose::topology_across(design, patch, open);
  return shape.found.count == expected.count && shape.found.cable_port == expected.cable_port &&
         shape.found.joints == expected.joints;
}

std::vector<Seat> seats_of(const design::Design& design, std::span<const layout::PatchIndex> patches) {
  std::vector<Seat> seats;
  for (const layout::PatchIndex p : patches) seats.push_back({&design, p});
  return seats;
}

namespace {

// Compares every board with every seat, and notes in `across` which boards reach into neighbouring patches.
Differences differences_of(std::span<const BoardShape> shapes, std::span<const Seat> seats, std::vector<bool>& across) {
  std::map<const design::Design*, std::vector<layout::PatchIndex>> open;
  for (const Seat& seat : seats) open[seat.design].push_back(seat.patch);
  for (auto& [design, patches] : open) std::ranges::sort(patches);
  Differences differences;
  across.assign(shapes.size(), false);
  for (std::size_t b = 0; b < shapes.size(); ++b) {
    auto& row = differences.emplace_back();
    for (const Seat& seat : seats) {
      row.push_back(shape_difference(shapes[b], *seat.design, seat.patch));
      if (row.back() == 0 || !reaches_across(shapes[b], *seat.design, seat.patch, open.at(seat.design))) continue;
      row.back() = 0;
      across[b] = true;
    }
  }
  return differences;
}

// Returns the seat that each board has in every largest matching, or −1: without this edge, a matching would be
// smaller.
std::vector<int> certain_seats(const Edges& edges, std::size_t seats) {
  const Matching all(edges, seats);
  std::vector<int> certain(edges.size(), -1);
  for (std::size_t seat = 0; seat < seats; ++seat) {
    if (all.board(seat) < 0) continue;
    const auto b = static_cast<std::size_t>(all.board(seat));
    Edges without = edges;
    std::erase(without[b], static_cast<int>(seat));
    if (Matching(without, seats).size() < all.size()) certain[b] = static_cast<int>(seat);
  }
  return certain;
}

}  // namespace

ShapeAssignment assign_by_shape(std::span<const BoardShape> shapes, std::span<const Seat> seats) {
  ShapeAssignment result;
  const Differences differences = differences_of(shapes, seats, result.across);
  constexpr int kSlack = 1;
  Edges edges = edges_of(differences, -1);
  result.exact = Matching(edges, seats.size()).size() == std::min(shapes.size(), seats.size());
  if (!result.exact) edges = edges_of(differences, kSlack);
  result.seat = certain_seats(edges, seats.size());
  result.likely = std::move(edges);  // The rows are already in ascending order.
  return result;
}

std::vector<wire::NodeClaim> put_apart(session::Bus& bus, std::vector<wire::NodeClaim> claims, bool tables) {
  const auto users = session::users_of_addresses(claims);
  std::map<wire::UniqueId, int> wanted;
  int next = layout::kLastNode;
  for (const wire::NodeClaim& c : claims) {
    if (users.at(c.node_address) < 2 || (c.has_table && !tables)) continue;
    while (next >= layout::kFirstNode && users.contains(static_cast<std::uint8_t>(next))) --next;
    if (next < layout::kFirstNode)
      throw DeviceError(fmt::format("{}: no free node address is left; take controllers off the bus", bus.name()));
    wanted[c.unique_id] = next--;
  }
  if (wanted.empty()) return claims;
  return assign_addresses(bus, std::move(wanted));
}

}  // namespace triskin::deploy
