// SPDX-License-Identifier: GPL-3.0-or-later
#include "controller_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "triskin/base/counted.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::diagnose {
namespace {

std::string patches_text(const std::vector<layout::PatchIndex>& patches) {
  return fmt::format("{} {}", noun_after(patches.size() == 1, "patch"), short_list(patches));
}

}  // namespace

ControllerCheck::ControllerCheck(session::Bus& bus, const design::Design& design)
    : bus_(bus), design_(design), claims_(bus.discover()) {
  for (const wire::NodeClaim& c : claims_) {
    if (c.has_table) ++with_table_[layout::NodeAddress{c.node_address}];
  }
  if (claims_.empty()) throw DeviceError(bus.nobody_answers());
}

bool ControllerCheck::check(PatchState& p, std::vector<Finding>& findings) {
  const layout::NodeAddress node{p.image.node_address};
  const auto at_node = with_table_.find(node);
  if (at_node == with_table_.end() || at_node->second > 1) {
    (at_node == with_table_.end() ? absent_ : doubled_).push_back(p.patch);
    return false;
  }
  session::Controller c = p.controller(bus_);
  if (const wire::Hello h = c.hello();
      h.wire_version != wire::kWireVersion || h.layout_version != layout::kLayoutVersion) {
    findings.push_back(controller_finding(Seen::kOtherFirmware, p.patch, fmt::arg("node", node),
                                          fmt::arg("wire", h.wire_version), fmt::arg("layout", h.layout_version),
                                          fmt::arg("own_wire", wire::kWireVersion),
                                          fmt::arg("own_layout", layout::kLayoutVersion)));
    return false;
  }
  const wire::ActiveTable active = c.active_table();
  if (active.design_id == session::kIdentifyDesign) {
    absent_.push_back(p.patch);
    return false;
  }
  if (active.design_id == design_.design_id && session::holds_image(active.crc, p.image)) return true;
  if (active.design_id == design_.design_id && runs_on_backup(p, active.crc, findings)) return true;
  if (!differs_in_kinds(p, c, active, findings)) foreign_[active.design_id].push_back(p.patch);
  return false;
}

namespace {

bool differ_in_kinds_alone(const layout::PatchImage& table, const layout::PatchImage& meant) {
  layout::PatchImage alike = table;
  alike.design_id = meant.design_id;
  alike.positive_input = meant.positive_input;
  for (std::size_t k = 0; k < alike.module_count; ++k) alike.modules[k].module_id = meant.modules[k].module_id;
  if (!(alike == meant)) return false;
  const auto id_beside_kind = [](const layout::ModuleRow& row) { return row.module_id % layout::kIdsBesideKinds; };
  return std::ranges::equal(table.rows(), meant.rows(), {}, id_beside_kind, id_beside_kind) &&
         !std::ranges::equal(table.rows(), meant.rows(), {}, &layout::ModuleRow::module_id,
                             &layout::ModuleRow::module_id);
}

std::string failure_text(const design::Design& design, const session::RouteChoice& choice) {
  const design::ModuleNumber module = design::number_of(design, choice.module);
  return choice.other < 0
             ? fmt::format("module {}", module)
             : fmt::format("the joint of modules {} and {}", design::number_of(design, choice.other), module);
}

}  // namespace

// If the table is of a design with the same modules, places and wiring but other kinds, each affected module gets a
// finding.
bool ControllerCheck::differs_in_kinds(const PatchState& p, session::Controller& c, const wire::ActiveTable& active,
                                       std::vector<Finding>& findings) {
  if (!active.present() || active.modules != p.image.module_count) return false;
  const auto bytes = c.read_table(layout::kHeaderBytes + active.modules * layout::kRowBytes);
  const auto table = layout::decode(bytes);
  if (!table) return false;
  if (!differ_in_kinds_alone(*table, p.image)) return false;
  for (std::size_t k = 0; k < table->module_count; ++k) {
    const int is = table->modules[k].module_id >> layout::kKindShift,
              meant = session::kind_of_row(design_, p.image.modules[k]);
    if (is == meant) continue;
    Finding f =
        controller_finding(Seen::kOtherKind, p.patch, fmt::arg("module", design::number_of(design_, p.module(k))),
                           fmt::arg("is", name_of_kind(is)), fmt::arg("node", p.image.node_address),
                           fmt::arg("meant", name_of_kind(meant)));
    f.module = p.module(k);
    findings.push_back(std::move(f));
  }
  return true;
}

// The other design is not available and may name its kinds differently.
std::string ControllerCheck::name_of_kind(int kind) const {
  if (kind == 0) return "of the standard kind";
  if (kind > static_cast<int>(design_.kinds.kinds.size())) return fmt::format("of kind {}", kind);
  return fmt::format("of kind {} ({})", kind, design_.kinds.kinds[static_cast<std::size_t>(kind) - 1].name);
}

// A table that the design prepared for a failure is valid as well; a finding says what it leaves out.
bool ControllerCheck::runs_on_backup(PatchState& p, std::uint32_t crc, std::vector<Finding>& findings) {
  const design::Patch& patch = design_.patches[static_cast<std::size_t>(p.patch)];
  for (const design::FailureLoss& f : patch.failures) {
    const session::RouteChoice choice{layout::ModuleId{f.node}, layout::ModuleId{f.other_node}};
    if (f.node == patch.entry && f.other_node < 0) continue;
    const layout::PatchImage image = session::image_of(design_, p.patch, choice);
    if (crc32(session::bytes_of(image)) != crc) continue;
    findings.push_back(controller_finding(
        Seen::kBackupTable, p.patch, fmt::arg("failure", failure_text(design_, choice)),
        fmt::arg("read", fmt::format("{} of {} {}", image.module_count, counted(p.image.module_count, "module"),
                                     agreeing(image.module_count, "is", "are")))));
    p.image = image;
    p.on_backup = true;
    return true;
  }
  return false;
}

std::vector<std::string> ControllerCheck::serials_at(layout::NodeAddress node) const {
  std::vector<std::string> serials;
  for (const wire::NodeClaim& c : claims_) {
    if (c.has_table && c.node_address == node) serials.push_back(session::to_text(c.unique_id));
  }
  return serials;
}

// One that does not answer tells nothing.
bool ControllerCheck::has_identify_table(std::uint8_t node) {
  try {
    return session::Controller(bus_, node).active_table().design_id == session::kIdentifyDesign;
  } catch (const session::NoAnswer&) {
    return false;
  }
}

// Also new is a controller that was being identified when its flash was ended. Those that share an address cannot be
// asked.
std::size_t ControllerCheck::count_new_controllers() {
  const auto users = session::users_of_addresses(claims_);
  return static_cast<std::size_t>(std::ranges::count_if(claims_, [&](const wire::NodeClaim& c) {
    return !c.has_table || (users.at(c.node_address) == 1 && has_identify_table(c.node_address));
  }));
}

// The controller of each patch in `without` may be one of the two.
Finding ControllerCheck::duplicate_finding(layout::PatchIndex patch,
                                           const std::vector<layout::PatchIndex>& without) const {
  const layout::NodeAddress node = design::node_address_of(design_, patch);
  const std::vector<std::string> serials = serials_at(node);
  return controller_finding(Seen::kSharedNode, patch, fmt::arg("node", node),
                            fmt::arg("serials", fmt::join(serials, " and ")),
                            fmt::arg("controllers", fmt::format("{} {}", counted(serials.size(), "controller"),
                                                                agreeing(serials.size(), "shares", "share"))),
                            fmt::arg("without", without.empty() ? ""
                                                                : fmt::format("; {} {} none", patches_text(without),
                                                                              without.size() == 1 ? "has" : "have")));
}

// Before it is flashed, nobody knows which of the patches a new controller belongs to.
Finding ControllerCheck::unflashed_finding(std::size_t new_controllers) const {
  const bool some_are_silent = absent_.size() > new_controllers;
  return controller_finding(
      some_are_silent ? Seen::kNoTableAndSilent : Seen::kNoTable, absent_.front(),
      fmt::arg("patches", patches_text(absent_)),
      fmt::arg("tables", absent_.size() == 1 ? "its table" : "their tables"),
      fmt::arg("controllers", claims_.size() == 1
                                  ? "the only controller on the link has no table"
                                  : fmt::format("{} of {} controllers on the link {} no table", new_controllers,
                                                claims_.size(), agreeing(new_controllers, "has", "have"))),
      fmt::arg("silent", absent_.size() - new_controllers));
}

// A wrong file is more likely than a wrongly flashed skin, and trying another file costs nothing.
Finding ControllerCheck::other_design_finding(std::uint64_t held,
                                              const std::vector<layout::PatchIndex>& patches) const {
  const bool other = held != design_.design_id;
  Finding f = controller_finding(
      other ? Seen::kOtherDesign : Seen::kOtherTables, patches.front(), fmt::arg("patches", patches_text(patches)),
      fmt::arg("held", fmt::format("{:016x}", held)), fmt::arg("design", fmt::format("{:016x}", design_.design_id)));
  if (other) f.held_design = held;
  return f;
}

void ControllerCheck::summarise(std::vector<Finding>& findings) {
  const std::size_t new_controllers = absent_.empty() ? 0 : count_new_controllers();
  std::vector<layout::PatchIndex> absent;
  if (new_controllers == 0) absent = absent_;
  for (const layout::PatchIndex patch : doubled_) {
    const auto surplus = with_table_.at(design::node_address_of(design_, patch)) - 1;
    const auto taken = static_cast<std::ptrdiff_t>(std::min(surplus, absent.size()));
    findings.push_back(duplicate_finding(patch, {absent.begin(), absent.begin() + taken}));
    absent.erase(absent.begin(), absent.begin() + taken);
  }
  if (new_controllers > 0) findings.push_back(unflashed_finding(new_controllers));
  for (const auto& [held, patches] : foreign_) findings.push_back(other_design_finding(held, patches));
  for (const layout::PatchIndex patch : absent) {
    findings.push_back(
        controller_finding(Seen::kNoController, patch, fmt::arg("node", design::node_address_of(design_, patch))));
  }
}

}  // namespace triskin::diagnose
