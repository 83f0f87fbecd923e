// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/device/patch_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/host/error.hpp"

namespace triskin::device {
namespace {

constexpr std::size_t kMaxPatches = 126;  // node addresses 1..126

int row_of(const geometry::Patch& patch, int node) {
  const auto found = std::find_if(patch.modules.begin(), patch.modules.end(), [&](const auto& m) { return m.node == node; });
  return found == patch.modules.end() ? -1 : static_cast<int>(found - patch.modules.begin());
}

// Port p of a module that is turned by r lies at tile side (p + r) % 3.
int port_towards(const model::Design& design, const geometry::RoutedModule& from, int node) {
  const auto& neighbour = design.layout.modules[static_cast<std::size_t>(from.node)].neighbour;
  for (int port = 0; port < 3; ++port) {
    if (neighbour[static_cast<std::size_t>((port + from.rotation) % 3)] == node) return port;
  }
  return -1;
}

}  // namespace

layout::PatchImage image_of(const model::Design& design, int patch_index) {
  const geometry::Patch& patch = design.patches.at(static_cast<std::size_t>(patch_index));
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("patch {}: {}; run triskin check on the design", patch_index, what));
  };
  if (design.patches.size() > kMaxPatches) refuse(fmt::format("a bus has {} node addresses, the design {} patches", kMaxPatches, design.patches.size()));
  if (patch.modules.empty() || patch.modules.size() > layout::kMaxModules) refuse(fmt::format("{} modules, a controller reads 1 … 16", patch.modules.size()));
  if (design.layout.modules.size() > 0xFFFF) refuse("module ids beyond 65535 fit no table");
  layout::PatchImage image;
  image.design_id = design.design_id;
  image.node_address = static_cast<std::uint8_t>(patch_index + 1);
  image.module_count = static_cast<std::uint8_t>(patch.modules.size());
  for (std::size_t k = 0; k < patch.modules.size(); ++k) {
    const geometry::RoutedModule& m = patch.modules[k];
    layout::ModuleRow& row = image.modules[k];
    row.module_id = static_cast<std::uint16_t>(m.node);
    row.line = static_cast<std::uint8_t>(m.line);
    row.address = static_cast<std::uint8_t>(m.address);
    row.rotation = static_cast<std::uint8_t>(m.rotation);
    row.kept_joints = 1;  // port A: the cable or the parent
    if (m.parent < 0) continue;
    const int parent = row_of(patch, m.parent);
    if (parent < 0 || parent >= static_cast<int>(k)) refuse(fmt::format("module {} stands before its parent {}", m.node, m.parent));
    const int port = port_towards(design, patch.modules[static_cast<std::size_t>(parent)], m.node);
    if (port < 0) refuse(fmt::format("module {} is no neighbour of its parent {}", m.node, m.parent));
    row.parent = static_cast<std::uint8_t>(parent);
    row.parent_port = static_cast<std::uint8_t>(port);
    layout::ModuleRow& parent_row = image.modules[static_cast<std::size_t>(parent)];
    parent_row.kept_joints = static_cast<std::uint8_t>(parent_row.kept_joints | 1U << port);
  }
  if (const Status s = layout::check(image); s != Status::kOk) {
    refuse(s == Status::kDuplicate ? "two modules have one line and address" : "a joint leaves by the input port or is used twice");
  }
  return image;
}

std::vector<std::uint8_t> bytes_of(const layout::PatchImage& image) {
  std::vector<std::uint8_t> bytes(layout::kMaxImageBytes);
  const auto size = layout::encode(image, bytes);
  if (!size) throw InputError("table cannot be encoded; run triskin check on the design");
  bytes.resize(*size);
  return bytes;
}

}  // namespace triskin::device
