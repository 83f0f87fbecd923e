// SPDX-License-Identifier: GPL-3.0-or-later
// Writes URDF and SDF: one link for the cover, one frame for each module, the taxels as boxes and as a table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "metres.hpp"
#include "module_names.hpp"
#include "simulator_taxels.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/exports/export.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::exports {
namespace {

// Converts a rotation matrix to turns about the fixed axes x, y, z, as in URDF and SDF. At pitch ±90° yaw is 0.
design::Vec3 roll_pitch_yaw_of(const Eigen::Matrix3d& r) {
  const double pitch = std::asin(std::clamp(-r(2, 0), -1.0, 1.0));
  if (std::abs(r(2, 0)) > 1.0 - 1e-12) return {std::atan2(r(2, 0) < 0 ? r(0, 1) : -r(0, 1), r(1, 1)), pitch, 0.0};
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

std::string numbers(const design::Vec3& v) {
  return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z());
}

// Both formats write position and rotation in this form.
struct Pose {
  std::string xyz_m, rpy_rad;
};
Pose pose_of(const design::PlacedModule& m) {
  const ModulePose frame = frame_of(m);
  return {numbers(frame.origin_mm * kMetres_per_mm), numbers(roll_pitch_yaw_of(frame.axes))};
}
// Returns the height of a cut module over its side 0 in mm.
double height_mm(double corner_cut_mm) {
  return design::kHeight_mm - design::cut_height_mm(corner_cut_mm);
}
// Returns the distance from the centroid, which is a third of the whole height over side 0, to the centre of the box
// around the cut outline.
double box_shift_mm(double corner_cut_mm) {
  return height_mm(corner_cut_mm) / 2.0 - design::kHeight_mm / 3.0;
}
Pose box_pose_of(const design::PlacedModule& m, double corner_cut_mm) {
  const ModulePose frame = frame_of(m);
  return {numbers((frame.origin_mm + box_shift_mm(corner_cut_mm) * frame.axes.col(1)) * kMetres_per_mm),
          numbers(roll_pitch_yaw_of(frame.axes))};
}

// Returns one row for each taxel: position and normal in the module's frame.
std::string taxel_rows(const design::Design& design, const design::ModuleWiring& wiring, int id) {
  const design::PlacedModule& m = design.layout.modules[static_cast<std::size_t>(id)];
  const ModulePose frame = frame_of(m);
  const std::string cover = design.covers.empty() ? "" : " cover=\"" + escape_markup(cover_name(design, id)) + "\"";
  std::string rows;
  const auto taxels = design::taxels_of(m, wiring.routed.rotation);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const design::Vec3 at = frame.axes.transpose() * (taxels[t].position_mm - frame.origin_mm) * kMetres_per_mm;
    const design::Vec3 normal = frame.axes.transpose() * taxels[t].normal;
    rows += fmt::format(
        "      <triskin:taxel{} module=\"{}\" index=\"{}\" measures=\"{}\" frame=\"{}\" xyz=\"{}\" normal=\"{}\"/>\n",
        cover, design::number_of(design, id), t, layout::measures_pressure(t) ? "pressure" : "temperature",
        module_name(design, id), numbers(at), numbers(normal));
  }
  return rows;
}

std::string taxel_table(const design::Design& design, const std::vector<design::ModuleWiring>& wiring) {
  std::string table = fmt::format(
      "    <triskin:skin xmlns:triskin=\"urn:triskin:skin:1\" design=\"{:016x}\" modules=\"{}\" "
      "taxels_per_module=\"{}\">\n",
      design.design_id, design.layout.modules.size(), layout::kTaxelsPerModule);
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    table += taxel_rows(design, wiring[k], static_cast<int>(k));
  return table + "    </triskin:skin>\n";
}

// Returns the size of the thin plate that represents a module in pictures and contacts: the box around its outline.
std::string plate_size(double corner_cut_mm) {
  return fmt::format("{:.9g} {:.9g} 0.001", (design::kSide_mm - corner_cut_mm) * kMetres_per_mm,
                     height_mm(corner_cut_mm) * kMetres_per_mm);
}

}  // namespace

ModulePose frame_of(const design::PlacedModule& module) {
  const auto& c = module.corner_mm;
  ModulePose frame;
  frame.origin_mm = (c[0] + c[1] + c[2]) / 3.0;
  const design::Vec3 x = (c[1] - c[0]).normalized(), z = x.cross(c[2] - c[0]).normalized();
  frame.axes.col(0) = x;
  frame.axes.col(1) = z.cross(x);
  frame.axes.col(2) = z;
  return frame;
}

std::string urdf(const design::Design& design) {
  const auto wiring = design::wiring_of(design);
  std::string xml = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"cover\"/>\n",
                                escape_markup(design.name));
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const Pose pose = pose_of(design.layout.modules[k]);
    xml += fmt::format(
        "  <link name=\"{0}\">\n    <visual>\n      <origin xyz=\"0 {1:.9g} 0\"/>\n      <geometry><box "
        "size=\"{2}\"/></geometry>\n    </visual>\n  </link>\n"
        "  <joint name=\"cover_to_{0}\" type=\"fixed\">\n    <parent link=\"cover\"/>\n    <child "
        "link=\"{0}\"/>\n    <origin xyz=\"{3}\" rpy=\"{4}\"/>\n  </joint>\n",
        module_name(design, static_cast<int>(k)), box_shift_mm(design.layout.corner_cut_mm) * kMetres_per_mm,
        plate_size(design.layout.corner_cut_mm), pose.xyz_m, pose.rpy_rad);
  }
  return xml + taxel_table(design, wiring) + "</robot>\n";
}

std::string sdf(const design::Design& design) {
  const auto wiring = design::wiring_of(design);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<sdf version=\"1.7\">\n  <model name=\"{}\">\n    <static>true</static>\n    <link "
      "name=\"cover\">\n",
      escape_markup(is_reserved_in_simulators(design.name) ? simulator_name(design) : design.name));
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const Pose pose = box_pose_of(design.layout.modules[k], design.layout.corner_cut_mm);
    xml += fmt::format(
        "      <visual name=\"{}\">\n        <pose>{} {}</pose>\n        "
        "<geometry><box><size>{}</size></box></geometry>\n"
        "      </visual>\n",
        module_name(design, static_cast<int>(k)), pose.xyz_m, pose.rpy_rad, plate_size(design.layout.corner_cut_mm));
  }
  xml += "    </link>\n";
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const Pose pose = pose_of(design.layout.modules[k]);
    xml += fmt::format("    <frame name=\"{}\" attached_to=\"cover\"><pose>{} {}</pose></frame>\n",
                       module_name(design, static_cast<int>(k)), pose.xyz_m, pose.rpy_rad);
  }
  return xml + taxel_table(design, wiring) + "  </model>\n</sdf>\n";
}

}  // namespace triskin::exports
