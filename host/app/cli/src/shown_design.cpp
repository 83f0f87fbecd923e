// SPDX-License-Identifier: GPL-3.0-or-later
#include "shown_design.hpp"

#include <span>

#include "triskin/robot/site.hpp"

namespace triskin::cli {
namespace {

std::vector<view::CoverNote> covers_of(const robot::Assembly& assembly, std::span<const design::CoverOffset> offsets) {
  std::vector<view::CoverNote> notes;
  for (std::size_t c = 0; c < offsets.size(); ++c) {
    const design::Design& d = assembly.designs[c];
    notes.push_back({assembly.robot.covers[c].name, offsets[c].module, offsets[c].patch, offsets[c].island,
                     static_cast<int>(d.layout.modules.size()), d.report.area_cm2, d.report.coverage});
  }
  return notes;
}

}  // namespace

ShownDesign read_shown_design(const std::string& file, bool is_deployed) {
  if (!robot::is_robot_file(file))
    return {is_deployed ? design::read_intact_design(file) : design::read_design(file), {{}}};
  const robot::Assembly assembly = robot::read_assembly(file);
  design::SideBySide joint = robot::in_base(assembly);
  view::Notes notes;
  notes.covers = covers_of(assembly, joint.offsets);
  return {std::move(joint.design), std::move(joint.offsets), std::move(notes)};
}

std::vector<design::Design> read_covers(const std::string& robot_file) {
  robot::Assembly assembly = robot::read_assembly(robot_file);
  for (std::size_t c = 0; c < assembly.designs.size(); ++c) {
    design::Design& cover = assembly.designs[c];
    cover.name = assembly.robot.covers[c].name;
    cover.node_addresses.assign(cover.patches.size(), 0);
    for (const robot::ControllerEntry& e : assembly.robot.covers[c].controllers)
      cover.node_addresses.at(static_cast<std::size_t>(e.patch)) = static_cast<std::uint8_t>(e.node);
  }
  return std::move(assembly.designs);
}

}  // namespace triskin::cli
