// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/design.hpp"

#include <Eigen/Geometry>
#include <bit>

#include "triskin/design/module_number.hpp"

namespace triskin::design {
namespace {

// Taxel centres on the iCub module relative to its centroid, with x along side 0 and y towards the opposite corner
// (skinGui's triangle). layout/module.hpp says what each taxel measures.
constexpr std::array<std::array<double, 2>, layout::kTaxelsPerModule> kTaxel_mm{{{6.533, 0.0},
                                                                                 {9.8, -5.66},
                                                                                 {3.267, -5.66},
                                                                                 {0.0, 0.0},
                                                                                 {-3.267, -5.66},
                                                                                 {-9.8, -5.66},
                                                                                 {-6.533, -3.75},
                                                                                 {-6.533, 0.0},
                                                                                 {-3.267, 5.66},
                                                                                 {0.0, 11.317},
                                                                                 {0.0, 7.507},
                                                                                 {3.267, 5.66}}};

// Computes FNV-1a, 64 bit, over little-endian words.
class Hash {
 public:
  void add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) {
      state_ ^= (word >> shift) & 0xFFU;
      state_ *= 0x100000001B3ULL;
    }
  }
  void add(int value) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value))); }
  // Rounding lengths to 1 µm keeps differences in their last bits from changing the id.
  void add_length(double value_mm) { add(static_cast<std::uint64_t>(std::llround(value_mm * 1000.0))); }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};

void add_module(const PlacedModule& m, Hash& hash) {
  for (const int field : {m.island, m.tile.i, m.tile.j, m.tile.up ? 1 : 0}) hash.add(field);
  for (const Vec3& c : m.corner_mm) {
    for (int axis = 0; axis < 3; ++axis) hash.add_length(c[axis]);
  }
  for (const int n : m.neighbour) hash.add(n);
}

void add_patch(const Patch& patch, Hash& hash) {
  for (const int field : {patch.entry, patch.second_entry, patch.second_entry_side}) hash.add(field);
  for (const RoutedModule& m : patch.modules) {
    for (const int field : {m.node, m.parent, m.rotation, m.line, m.address}) hash.add(field);
  }
}

void add_kinds(const Design& design, Hash& hash) {
  for (const ModuleKind& k : design.kinds.kinds) {
    for (const std::string& text : {k.name, k.dielectric}) {
      hash.add(static_cast<int>(text.size()));
      for (const char c : text) hash.add(static_cast<int>(static_cast<unsigned char>(c)));
    }
    hash.add(k.taxels);
    hash.add_length(k.sensitivity_counts_per_kpa);  // The hash uses the value rounded to 0.001.
  }
  for (const PlacedModule& m : design.layout.modules) hash.add(m.kind);
}

}  // namespace

std::vector<ModuleWiring> wiring_of(const Design& design) {
  std::vector<ModuleWiring> wiring(design.layout.modules.size());
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    for (const RoutedModule& m : design.patches[p].modules) {
      wiring.at(static_cast<std::size_t>(m.node)) = {layout::PatchIndex{p}, m};
    }
  }
  return wiring;
}

std::vector<layout::PatchIndex> patches_of(const Design& design) {
  std::vector<layout::PatchIndex> patches;
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    if (!design.patches[p].is_gap()) patches.emplace_back(p);
  }
  return patches;
}

bool has_patch(const Design& design, int patch) {
  return patch >= 0 && patch < static_cast<int>(design.patches.size()) &&
         !design.patches[static_cast<std::size_t>(patch)].is_gap();
}

std::string patch_numbers(const Design& design) {
  const std::vector<layout::PatchIndex> patches = patches_of(design);
  return ranges_text(std::vector<int>(patches.begin(), patches.end()));
}

layout::NodeAddress node_address_of(const Design& design, layout::PatchIndex patch) {
  if (design.patches.at(static_cast<std::size_t>(patch)).is_gap()) return {};
  if (design.node_addresses.empty()) return layout::NodeAddress{patch + layout::kFirstNode};
  return layout::NodeAddress{design.node_addresses.at(static_cast<std::size_t>(patch))};
}

layout::PatchIndex patch_at(const Design& design, layout::NodeAddress node) {
  for (layout::PatchIndex p; p < static_cast<int>(design.patches.size()); ++p) {
    if (node != 0 && node_address_of(design, p) == node) return p;
  }
  return layout::PatchIndex::none();
}

std::vector<layout::PatchIndex> patches_here(const Design& design) {
  std::vector<layout::PatchIndex> here;
  for (layout::PatchIndex p; p < static_cast<int>(design.patches.size()); ++p) {
    if (node_address_of(design, p) != 0) here.push_back(p);
  }
  return here;
}

std::array<TaxelPose, layout::kTaxelsPerModule> taxels_of(const PlacedModule& module, int rotation) {
  const auto corner = [&](int k) { return module.corner_mm[static_cast<std::size_t>((k + rotation) % 3)]; };
  const Vec3 centroid = (corner(0) + corner(1) + corner(2)) / 3.0;
  const Vec3 x = (corner(1) - corner(0)).normalized();
  const Vec3 normal = x.cross(corner(2) - corner(0)).normalized();
  const Vec3 y = normal.cross(x);
  std::array<TaxelPose, layout::kTaxelsPerModule> taxels;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    taxels[t] = {centroid + kTaxel_mm[t][0] * x + kTaxel_mm[t][1] * y, normal};
  }
  return taxels;
}

std::uint64_t design_id_of(const Design& design) {
  Hash hash;
  for (const PlacedModule& m : design.layout.modules) add_module(m, hash);
  for (const Jumper& j : design.layout.jumpers) {
    for (const int field : {j.node[0], j.side[0], j.node[1], j.side[1]}) hash.add(field);
  }
  for (const Patch& patch : design.patches) add_patch(patch, hash);
  if (design.layout.corner_cut_mm > 0.0) hash.add_length(design.layout.corner_cut_mm);
  if (!design.kinds.empty()) add_kinds(design, hash);
  for (const int number : design.layout.numbers) hash.add(number);
  const std::vector<int> numbers = all_numbers(design.layout);
  if (!numbers.empty() && design.next_number > numbers.back() + 1) hash.add(design.next_number);
  return hash.value();
}

}  // namespace triskin::design
