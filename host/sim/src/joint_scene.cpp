// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scene/joint_scene.hpp"

#include <algorithm>
#include <string_view>

namespace triskin::scene {
namespace {

constexpr double kApart_mm = 10'000.0;

// FNV-1a with 64 bits gives the same hash on every compiler.
std::uint64_t hash_of(std::string_view text, std::uint64_t more) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  const auto add = [&](std::uint8_t byte) { hash = (hash ^ byte) * 0x100000001B3ULL; };
  for (const char c : text) add(static_cast<std::uint8_t>(c));
  for (int shift = 0; shift < 64; shift += 8) add(static_cast<std::uint8_t>(more >> shift));
  return hash;
}

// Another design has other boards. With a seed their ids are in random order, as on a workbench; without one they
// follow the node addresses.
wire::UniqueId board_of(const SimulatedCover& cover, std::size_t patch, std::optional<std::uint64_t> seed) {
  if (patch < cover.boards.size() && cover.boards[patch] != wire::UniqueId{}) return cover.boards[patch];
  wire::UniqueId id{};
  std::uint64_t hash = hash_of(cover.name, cover.design->design_id);
  if (seed) {
    hash = hash_of(cover.name, hash_of(cover.name, hash ^ *seed) ^ patch);
    const std::uint64_t first = hash_of(cover.name, hash);
    for (std::size_t k = 0; k < 4; ++k) id[k] = static_cast<std::uint8_t>(first >> (24 - 8 * k));
  } else {
    id[0] = static_cast<std::uint8_t>(design::node_address_of(*cover.design, static_cast<int>(patch)));
  }
  for (std::size_t k = 0; k < 8; ++k) id[4 + k] = static_cast<std::uint8_t>(hash >> (56 - 8 * k));
  return id;
}

// Modules keep their ids; a patch on another bus has no controller here.
void leave_out_elsewhere(Scene& scene) {
  design::Design& d = scene.design;
  std::vector<design::Patch> patches;
  std::vector<std::uint8_t> addresses;
  std::vector<wire::UniqueId> boards;
  for (std::size_t p = 0; p < d.patches.size(); ++p) {
    if (d.node_addresses[p] == 0) continue;
    patches.push_back(std::move(d.patches[p]));
    addresses.push_back(d.node_addresses[p]);
    boards.push_back(scene.boards[p]);
  }
  d.patches = std::move(patches);
  d.node_addresses = std::move(addresses);
  scene.boards = std::move(boards);
}

}  // namespace

JointScene join_covers(std::span<const SimulatedCover> covers, const wire::BitRates& rates,
                       std::optional<std::uint64_t> board_seed) {
  JointScene joint;
  joint.scene.board_seed = board_seed;
  std::vector<design::PlacedCover> placed;
  for (const SimulatedCover& c : covers) {
    design::PlacedCover p{c.design, Eigen::Isometry3d::Identity()};
    p.pose.translation().x() = kApart_mm * static_cast<double>(placed.size());
    placed.push_back(p);
    for (std::size_t patch = 0; patch < c.design->patches.size(); ++patch)
      joint.scene.boards.push_back(board_of(c, patch, board_seed));
    for (std::size_t m = 0; m < c.design->layout.modules.size(); ++m)
      joint.scene.module_seeds.push_back(hash_of(c.name, m));
  }
  design::SideBySide side_by_side = design::side_by_side(placed);
  joint.scene.design = std::move(side_by_side.design);
  joint.offsets = std::move(side_by_side.offsets);
  joint.scene.effects.bus_bit_rate = rates.nominal;
  joint.scene.effects.bus_data_bit_rate = rates.data;
  leave_out_elsewhere(joint.scene);
  return joint;
}

}  // namespace triskin::scene
