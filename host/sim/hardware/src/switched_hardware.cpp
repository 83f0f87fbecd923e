// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/switched_hardware.hpp"

#include <algorithm>

#include "triskin/design/joint.hpp"
#include "triskin/design/module_side.hpp"

namespace triskin::hardware {
namespace {

using Joints = design::PortEnds;

// Adds a joint that the design does not have, at the first free port of each module.
void add_joint(Joints& joints, int cable_port, layout::TableRow a, layout::TableRow b) {
  const auto free_port = [&](int m) {
    for (int p = 0; p < static_cast<int>(layout::kPorts); ++p) {
      if (joints[static_cast<std::size_t>(m)][static_cast<std::size_t>(p)].row < 0 && !(m == 0 && p == cable_port))
        return p;
    }
    return -1;
  };
  const int p = free_port(a), q = free_port(b);
  if (p < 0 || q < 0) return;
  joints[static_cast<std::size_t>(a)][static_cast<std::size_t>(p)] = {b, q};
  joints[static_cast<std::size_t>(b)][static_cast<std::size_t>(q)] = {a, p};
}

// Returns the joints by row, between modules that have one; a module without a row has −1 in `row_of`.
Joints joints_among(const std::vector<int>& modules,
                    const std::vector<std::array<design::ModuleEnd, layout::kPorts>>& ends,
                    const std::vector<layout::TableRow>& row_of) {
  Joints joints;
  for (const int m : modules) {
    auto& row = joints.emplace_back();
    for (std::size_t p = 0; p < row.size(); ++p) {
      const design::ModuleEnd& e = ends[static_cast<std::size_t>(m)][p];
      const auto other = e.module < 0 ? layout::TableRow::none() : row_of[static_cast<std::size_t>(e.module)];
      if (other >= 0) row[p] = {other, e.port};
    }
  }
  return joints;
}

}  // namespace

SwitchedHardware::SwitchedHardware(const Scene& scene)
    : patch_(scene.design.layout.modules.size(), -1), row_(patch_.size(), layout::TableRow::none()) {
  if (!scene.switched) return;
  joined_ = scene.border_joints;
  if (joined_) add_joined_patches(scene);
  for (std::size_t p = 0; !joined_ && p < scene.design.patches.size(); ++p) add_patch(scene, layout::PatchIndex{p});
  for (const Fault& f : scene.faults) {
    events_.push_back({f.from_us, f, true});
    if (f.until_us != kForever) events_.push_back({f.until_us, f, false});
  }
  std::ranges::stable_sort(events_, {}, &Event::at_us);
  for (SwitchedPatch& p : patches_) p.set_bit_error_rate(scene.effects.chain_bit_error_rate);
}

void SwitchedHardware::add_patch(const Scene& scene, layout::PatchIndex patch) {
  const auto& routed = scene.design.patches[static_cast<std::size_t>(patch)].modules;
  if (routed.empty()) {
    joints_.emplace_back();
    patches_.emplace_back(Joints{}, 0, scene.seed);
    return;
  }
  std::vector<int> rotations;
  for (std::size_t k = 0; k < routed.size(); ++k) {
    patch_[static_cast<std::size_t>(routed[k].node)] = patch;
    row_[static_cast<std::size_t>(routed[k].node)] = layout::TableRow{k};
    rotations.push_back(real_rotation(scene, layout::ModuleId{routed[k].node}));
  }
  Joints joints;
  for (const auto& ends : design::joints_of(scene.design, patch, rotations)) {
    auto& row = joints.emplace_back();
    for (std::size_t p = 0; p < static_cast<int>(layout::kPorts); ++p) row[p] = {ends[p].row, ends[p].port};
  }
  const int cable_port = design::port_at_side(routed[0].rotation, rotations[0]);
  for (const Fault& f : scene.faults) {
    if (f.kind != FaultKind::kExtraJoint || patch_[static_cast<std::size_t>(f.module)] != patch) continue;
    if (patch_[static_cast<std::size_t>(f.other)] == patch)
      add_joint(joints, cable_port, row_of(f.module), row_of(f.other));
  }
  joints_.push_back(joints);
  patches_.emplace_back(std::move(joints), cable_port, scene.seed + static_cast<std::uint64_t>(patch));
  plug_second_cable(scene.design.patches[static_cast<std::size_t>(patch)], rotations);
}

void SwitchedHardware::add_joined_patches(const Scene& scene) {
  std::vector<int> rotations(patch_.size(), 0), modules;
  for (const design::Patch& p : scene.design.patches) {
    for (const design::RoutedModule& m : p.modules) {
      const auto id = static_cast<std::size_t>(m.node);
      patch_[id] = 0;
      row_[id] = layout::TableRow{modules.size()};
      rotations[id] = real_rotation(scene, layout::ModuleId{m.node});
      modules.push_back(m.node);
    }
  }
  if (modules.empty()) return;
  const Joints joints = joints_among(modules, design::module_ends(scene.design, rotations), row_);
  joints_.push_back(joints);
  const auto cable_at = [&](layout::ModuleId module, int side) -> SwitchedPatch::End {
    return {row_of(module), design::port_at_side(side, rotations[static_cast<std::size_t>(module)])};
  };
  for (const design::Patch& p : scene.design.patches) {
    if (p.is_gap()) continue;
    const SwitchedPatch::End cable = cable_at(layout::ModuleId{p.entry}, p.modules[0].rotation);
    int controller = 0;
    if (patches_.empty())
      patches_.emplace_back(joints, cable.port, scene.seed);  // The cable leads to module 0.
    else
      controller = patches_.back().add_controller(cable);
    if (p.second_entry >= 0)
      patches_.back().set_second_cable(cable_at(layout::ModuleId{p.second_entry}, p.second_entry_side), controller);
  }
}

// Plugs the cable where the design has it, unless a wrong joint uses its port.
void SwitchedHardware::plug_second_cable(const design::Patch& designed, const std::vector<int>& rotations) {
  if (designed.second_entry < 0) return;
  const auto row = static_cast<std::size_t>(row_of(layout::ModuleId{designed.second_entry}));
  const int port = design::port_at_side(designed.second_entry_side, rotations[row]);
  if (joints_.back()[row][static_cast<std::size_t>(port)].row < 0)
    patches_.back().set_second_cable({layout::TableRow{row}, port});
}

void SwitchedHardware::advance(std::uint64_t now_us) {
  for (; next_ < events_.size() && events_[next_].at_us <= now_us; ++next_)
    apply(events_[next_].fault, events_[next_].begins);
}

void SwitchedHardware::apply(const Fault& f, bool begins) {
  if (f.module < 0 || patch_[static_cast<std::size_t>(f.module)] < 0) return;
  const int patch = patch_[static_cast<std::size_t>(f.module)];
  const layout::TableRow row = row_of(f.module);
  SwitchedPatch& p = patches_[static_cast<std::size_t>(patch)];
  const auto joint = [&](SwitchedPatch::JointFault kind) {
    const auto& ends = joints_[static_cast<std::size_t>(patch)][static_cast<std::size_t>(row)];
    for (int port = 0; port < static_cast<int>(layout::kPorts); ++port) {
      const int other = ends[static_cast<std::size_t>(port)].row;
      if (other >= 0 && patch_[static_cast<std::size_t>(f.other)] == patch && other == row_of(f.other)) {
        p.set_joint({row, port}, begins ? kind : SwitchedPatch::JointFault::kNone);
      }
    }
  };
  switch (f.kind) {
    case FaultKind::kDeadModule:
      p.set_dead(row, begins);
      break;
    case FaultKind::kHeldLine:
      p.set_stuck_line(row, begins ? f.line : -1);
      break;
    case FaultKind::kStuckBit:
      p.set_stuck_bit(row, f.bit, begins ? f.value : -1);
      break;
    case FaultKind::kModuleReset:
      p.reset_alone(row);
      break;
    case FaultKind::kOpenJoint:
      joint(SwitchedPatch::JointFault::kOpen);
      break;
    case FaultKind::kShortedJoint:
      joint(SwitchedPatch::JointFault::kShort);
      break;
    default:
      break;  // Such faults are not in the chain, or were applied when the patch was assembled.
  }
}

}  // namespace triskin::hardware
