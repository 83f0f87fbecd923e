// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/patch_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "triskin/base/error.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/module_side.hpp"

namespace triskin::session {
namespace {

int row_of(const design::Patch& patch, int module) {
  const auto found =
      std::find_if(patch.modules.begin(), patch.modules.end(), [&](const auto& m) { return m.node == module; });
  return found == patch.modules.end() ? -1 : static_cast<int>(found - patch.modules.begin());
}

// After a failure, the design's backup tree connects the rest of the patch.
struct Tree {
  std::vector<design::RoutedModule> modules;  // Parents precede their children.
  int cut_a = -1, cut_b = -1;                 // These are the ends of the failed joint.
};

std::vector<int> parents_after(const design::Patch& patch, const design::FailureLoss& loss) {
  std::vector<int> parents;
  for (const auto& m : patch.modules) {
    const auto changed = std::find_if(loss.backup_tree.begin(), loss.backup_tree.end(),
                                      [&](const auto& pair) { return pair[0] == m.node; });
    parents.push_back(changed == loss.backup_tree.end() ? m.parent : (*changed)[1]);
  }
  return parents;
}

Tree tree_after(const design::Patch& patch, const RouteChoice& choice) {
  const auto loss = std::find_if(patch.failures.begin(), patch.failures.end(), [&](const design::FailureLoss& f) {
    return (f.node == choice.module && f.other_node == choice.other) ||
           (choice.other >= 0 && f.node == choice.other && f.other_node == choice.module);
  });
  Tree tree;
  if (choice.other >= 0) {
    tree.cut_a = choice.module;
    tree.cut_b = choice.other;
  }
  if (loss == patch.failures.end()) {  // A joint outside the tree failed, so the tree does not change.
    tree.modules = patch.modules;
    return tree;
  }
  const std::vector<int> parents = parents_after(patch, *loss);
  const int dead = choice.other >= 0 ? -1 : choice.module;
  if (patch.modules[0].node == dead) return tree;
  tree.modules.push_back(patch.modules[0]);
  for (std::size_t k = 0; k < tree.modules.size(); ++k) {
    for (std::size_t m = 1; m < patch.modules.size(); ++m) {
      const design::RoutedModule& module = patch.modules[m];
      const bool joined = parents[m] == tree.modules[k].node && module.node != dead &&
                          !(choice.other >= 0 && std::minmax(parents[m], module.node) ==
                                                     std::minmax(choice.module.value(), choice.other.value()));
      const bool in =
          std::any_of(tree.modules.begin(), tree.modules.end(), [&](const auto& t) { return t.node == module.node; });
      if (!joined || in) continue;
      tree.modules.push_back(module);
      tree.modules.back().parent = parents[m];
    }
  }
  return tree;
}

// Returns the port with the second cable, by row; 0 where there is none or its module has failed.
std::uint8_t second_entry_of(const design::Patch& patch, const Tree& tree) {
  const auto found = std::ranges::find(tree.modules, patch.second_entry, &design::RoutedModule::node);
  if (patch.second_entry < 0 || found == tree.modules.end()) return 0;
  const int port = design::port_at_side(patch.second_entry_side, found->rotation);
  return layout::joint_to(static_cast<std::size_t>(found - tree.modules.begin()), static_cast<std::size_t>(port));
}

}  // namespace

RouteChoice parse_route(const std::string& text, const design::Design& design) {
  if (text == "normal") return {};
  int module = -1, other = -1;
  char rest = 0;
  const int joint = std::sscanf(text.c_str(), "backup:%d-%d%c", &module, &other, &rest);
  if (joint == 2 && module >= 0 && other >= 0 && module != other)
    return {design::require_module(design, {module}), design::require_module(design, {other})};
  if (std::sscanf(text.c_str(), "backup:%d%c", &module, &rest) == 1 && module >= 0)
    return {design::require_module(design, {module})};
  throw InputError(
      fmt::format("route \"{}\" is unknown; use normal, backup:MODULE or backup:MODULE-MODULE (a failed joint)", text));
}

bool concerns(const design::Patch& patch, const RouteChoice& choice) {
  return choice.module >= 0 && row_of(patch, choice.module) >= 0 &&
         (choice.other < 0 || row_of(patch, choice.other) >= 0);
}

namespace {

[[noreturn]] void refuse(layout::PatchIndex patch_index, const std::string& what) {
  throw InputError(fmt::format("patch {}: {}; run triskin check on the design", patch_index, what));
}

void require_limits(const design::Design& design, layout::PatchIndex patch_index) {
  const std::size_t modules = design.patches.at(static_cast<std::size_t>(patch_index)).modules.size();
  if (design.node_addresses.empty() && design.patches.size() > layout::kMaxNodes)
    refuse(patch_index, fmt::format("a bus has {} node addresses, the design patches {}", layout::kMaxNodes,
                                    design::patch_numbers(design)));
  if (modules == 0 || modules > layout::kMaxModules)
    refuse(patch_index, fmt::format("{} modules, a controller reads 1 … {}", modules, layout::kMaxModules));
  const int last = design::number_of(design, static_cast<int>(design.layout.modules.size()) - 1).value;
  if (last > design::kMaxModuleNumber)
    refuse(patch_index, fmt::format("module numbers beyond {} fit no table", design::kMaxModuleNumber));
  if (!design.kinds.empty() && last >= static_cast<int>(layout::kIdsBesideKinds))
    refuse(patch_index, fmt::format("module numbers beyond {} fit no table beside kinds; divide the cover",
                                    layout::kIdsBesideKinds - 1));
}

/// Returns the row of a module in the table of this tree, or −1.
int row_in(const Tree& tree, int module) {
  const auto found = std::ranges::find(tree.modules, module, &design::RoutedModule::node);
  return found == tree.modules.end() ? -1 : static_cast<int>(found - tree.modules.begin());
}

/// Enters the joints of a row to those modules that the table holds, without the one that failed.
void add_joints(const design::Patch& patch, const Tree& tree, const std::array<design::PortEnd, layout::kPorts>& ends,
                int module, layout::ModuleRow& row) {
  for (std::size_t port = 0; port < layout::kPorts; ++port) {
    if (ends[port].row < 0) continue;
    const int far_module = patch.modules[static_cast<std::size_t>(ends[port].row)].node;
    const bool cut = std::minmax(module, far_module) == std::minmax(tree.cut_a, tree.cut_b);
    const int far = row_in(tree, far_module);
    if (far >= 0 && !cut)
      row.joints[port] = layout::joint_to(static_cast<std::size_t>(far), static_cast<std::size_t>(ends[port].port));
  }
}

/// Enters the parent of row `k`, which must precede it and have a joint to it.
void add_parent(const design::Design& design, layout::PatchIndex patch_index, const Tree& tree, std::size_t k,
                layout::PatchImage& image) {
  const design::RoutedModule& m = tree.modules[k];
  if (m.parent < 0) return;
  const int parent = row_in(tree, m.parent);
  if (parent < 0 || parent >= static_cast<int>(k))
    refuse(patch_index, fmt::format("module {} stands before its parent {}", design::number_of(design, m.node),
                                    design::number_of(design, m.parent)));
  const layout::ModuleRow& above = image.modules[static_cast<std::size_t>(parent)];
  const auto port =
      std::ranges::find_if(above.joints, [&](std::uint8_t j) { return j != 0 && layout::joint_row(j) == k; });
  if (port == above.joints.end())
    refuse(patch_index, fmt::format("module {} is no neighbour of its parent {}", design::number_of(design, m.node),
                                    design::number_of(design, m.parent)));
  image.modules[k].parent = static_cast<std::uint8_t>(parent);
  image.modules[k].parent_port = static_cast<std::uint8_t>(port - above.joints.begin());
}

}  // namespace

layout::PatchImage image_of(const design::Design& design, layout::PatchIndex patch_index, const RouteChoice& choice) {
  require_limits(design, patch_index);
  const design::Patch& patch = design.patches[static_cast<std::size_t>(patch_index)];
  const Tree tree = concerns(patch, choice) ? tree_after(patch, choice) : Tree{patch.modules, -1, -1};
  if (tree.modules.empty()) {
    throw InputError(fmt::format("patch {}: module {} is its entry, nothing is read without it; replace it",
                                 patch_index, design::number_of(design, choice.module)));
  }
  layout::PatchImage image;
  image.design_id = design.design_id;
  image.node_address = static_cast<std::uint8_t>(design::node_address_of(design, patch_index));
  image.module_count = static_cast<std::uint8_t>(tree.modules.size());
  const design::PortEnds ends = design::joints_of(design, patch_index);
  for (std::size_t k = 0; k < tree.modules.size(); ++k) {
    const design::RoutedModule& m = tree.modules[k];
    layout::ModuleRow& row = image.modules[k];
    const int kind = design.layout.modules.at(static_cast<std::size_t>(m.node)).kind;
    row.module_id = static_cast<std::uint16_t>(design::number_of(design, m.node).value + (kind << layout::kKindShift));
    row.line = static_cast<std::uint8_t>(m.line);
    row.address = static_cast<std::uint8_t>(m.address);
    row.rotation = static_cast<std::uint8_t>(m.rotation);
    add_joints(patch, tree, ends[static_cast<std::size_t>(row_of(patch, m.node))], m.node, row);
    add_parent(design, patch_index, tree, k, image);
  }
  image.second_entry = second_entry_of(patch, tree);
  if (const Status s = layout::check(image); s != Status::kOk) {
    refuse(patch_index, s == Status::kDuplicate ? "two modules have one line and address"
                                                : "a joint leaves by the input port or is used twice");
  }
  return image;
}

layout::PatchIndex patch_of_table(const design::Design& design, layout::NodeAddress node, std::uint32_t crc) {
  design::Design then = design;
  then.node_addresses.assign(design.patches.size(), static_cast<std::uint8_t>(node));
  for (const layout::PatchIndex patch : design::patches_of(design)) {
    if (holds_image(crc, image_of(then, patch))) return patch;
  }
  return layout::PatchIndex::none();
}

layout::ModuleId module_of(const design::Design& design, const layout::ModuleRow& row) {
  const int number = design.kinds.empty() ? row.module_id : static_cast<int>(row.module_id % layout::kIdsBesideKinds);
  return design::module_with(design, {number});
}

int kind_of_row(const design::Design& design, const layout::ModuleRow& row) {
  return design.kinds.empty() ? 0 : row.module_id >> layout::kKindShift;
}

std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image) {
  std::vector<std::uint8_t> bytes(layout::kMaxImageBytes);
  const auto size = layout::encode(image, bytes);
  if (!size) throw InputError("table cannot be encoded; run triskin check on the design");
  bytes.resize(*size);
  return bytes;
}

bool holds_image(std::uint32_t crc, const layout::PatchImage& image) {
  layout::PatchImage other = image;
  other.positive_input = !image.positive_input;
  return crc == crc32(bytes_of(image)) || crc == crc32(bytes_of(other));
}

}  // namespace triskin::session
