// SPDX-License-Identifier: GPL-3.0-or-later
// Writes URDF and SDF: one link for the cover, one frame for each module, the taxels as boxes and as a table.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "metres.hpp"
#include "module_names.hpp"
#include "simulator_taxels.hpp"
#include "triskin/base/ascii_name.hpp"
#include "triskin/base/error.hpp"
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
std::string taxel_rows(const design::Design& design, const design::ModuleWiring& wiring, int id,
                       const std::string& prefix) {
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
        prefix + module_name(design, id), numbers(at), numbers(normal));
  }
  return rows;
}

std::string taxel_table(const design::Design& design, const std::vector<design::ModuleWiring>& wiring,
                        const std::string& prefix) {
  std::string table = fmt::format(
      "    <triskin:skin xmlns:triskin=\"urn:triskin:skin:1\" design=\"{:016x}\" modules=\"{}\" "
      "taxels_per_module=\"{}\">\n",
      design.design_id, design.layout.modules.size(), layout::kTaxelsPerModule);
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    table += taxel_rows(design, wiring[k], static_cast<int>(k), prefix);
  return table + "    </triskin:skin>\n";
}

// Returns the size of the thin plate that represents a module in pictures and contacts: the box around its outline.
std::string plate_size(double corner_cut_mm) {
  return fmt::format("{:.9g} {:.9g} 0.001", (design::kSide_mm - corner_cut_mm) * kMetres_per_mm,
                     height_mm(corner_cut_mm) * kMetres_per_mm);
}

void require_surface(const design::Design& design) {
  if (design.surface.faces.empty())
    throw InputError(fmt::format("{}: the design has no surface, so its cover has no mesh and no mass", design.name));
}

// Mass, centre and inertia about it of a thin shell of even thickness: the second moment of a triangle of mass m about
// the origin is m/12 (aa' + bb' + cc' + ss') with s = a + b + c.
struct Inertia {
  design::Vec3 centre_m{0, 0, 0};
  Eigen::Matrix3d about_centre = Eigen::Matrix3d::Zero();  // kg m2
};
Inertia inertia_of(const design::Design& design, double mass_kg) {
  require_surface(design);
  double area = 0.0;
  design::Vec3 moment{0, 0, 0};
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& face : design.surface.faces) {
    std::array<design::Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = design.surface.vertices[static_cast<std::size_t>(face[k])] * kMetres_per_mm;
    const double part = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    const design::Vec3 sum = p[0] + p[1] + p[2];
    area += part;
    moment += part * sum / 3.0;
    second += part / 12.0 * (sum * sum.transpose());
    for (const design::Vec3& v : p) second += part / 12.0 * (v * v.transpose());
  }
  Inertia inertia;
  inertia.centre_m = moment / area;
  const Eigen::Matrix3d central = mass_kg * (second / area - inertia.centre_m * inertia.centre_m.transpose());
  inertia.about_centre = central.trace() * Eigen::Matrix3d::Identity() - central;
  return inertia;
}

// Six numbers with their names, as attributes of URDF or as elements of SDF.
std::string inertia_terms(const Eigen::Matrix3d& i, const char* form) {
  std::string text;
  constexpr std::array<std::pair<const char*, std::pair<int, int>>, 6> kTerms{
      {{"ixx", {0, 0}}, {"ixy", {0, 1}}, {"ixz", {0, 2}}, {"iyy", {1, 1}}, {"iyz", {1, 2}}, {"izz", {2, 2}}}};
  for (const auto& [name, at] : kTerms) text += fmt::format(fmt::runtime(form), name, i(at.first, at.second));
  return text;
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

std::string urdf(const design::Design& design, const CoverBody& body) {
  const auto wiring = design::wiring_of(design);
  std::string cover;
  if (!body.mesh_uri.empty()) {
    require_surface(design);
    for (const char* part : {"visual", "collision"})
      cover += fmt::format("    <{0}>\n      <geometry><mesh filename=\"{1}\"/></geometry>\n    </{0}>\n", part,
                           escape_markup(body.mesh_uri));
  }
  if (body.mass_kg > 0.0) {
    const Inertia i = inertia_of(design, body.mass_kg);
    cover += fmt::format(
        "    <inertial>\n      <origin xyz=\"{}\"/>\n      <mass value=\"{:.9g}\"/>\n      <inertia{}/>\n    "
        "</inertial>\n",
        numbers(i.centre_m), body.mass_kg, inertia_terms(i.about_centre, " {}=\"{:.9g}\""));
  }
  const std::string prefix = escape_markup(body.prefix);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<robot name=\"{0}\">\n  <link name=\"{1}skin_{2}\"/>\n"
      "  <link name=\"{1}cover\"{3}"
      "  <joint name=\"{1}skin_to_cover\" type=\"fixed\">\n    <parent link=\"{1}skin_{2}\"/>\n    <child "
      "link=\"{1}cover\"/>\n  </joint>\n",
      escape_markup(design.name), prefix, part_name(design.name),
      cover.empty() ? "/>\n" : ">\n" + cover + "  </link>\n");
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const Pose pose = pose_of(design.layout.modules[k]);
    const std::string plate = fmt::format(
        "      <origin xyz=\"0 {:.9g} 0\"/>\n      <geometry><box size=\"{}\"/></geometry>\n",
        box_shift_mm(design.layout.corner_cut_mm) * kMetres_per_mm, plate_size(design.layout.corner_cut_mm));
    xml += fmt::format(
        "  <link name=\"{0}{1}\">\n    <visual>\n{2}    </visual>\n    <collision>\n{2}    </collision>\n  </link>\n"
        "  <joint name=\"{0}cover_to_{1}\" type=\"fixed\">\n    <parent link=\"{0}cover\"/>\n    <child "
        "link=\"{0}{1}\"/>\n    <origin xyz=\"{3}\" rpy=\"{4}\"/>\n  </joint>\n",
        prefix, module_name(design, static_cast<int>(k)), plate, pose.xyz_m, pose.rpy_rad);
  }
  return xml + taxel_table(design, wiring, prefix) + "</robot>\n";
}

std::string sdf(const design::Design& design, const CoverBody& body) {
  const auto wiring = design::wiring_of(design);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<sdf version=\"1.7\">\n  <model name=\"{}\">\n    <static>{}</static>\n    <link "
      "name=\"cover\">\n",
      escape_markup(is_reserved_in_simulators(design.name) ? simulator_name(design) : design.name),
      body.mass_kg > 0.0 ? "false" : "true");
  if (body.mass_kg > 0.0) {
    const Inertia i = inertia_of(design, body.mass_kg);
    xml += fmt::format(
        "      <inertial>\n        <pose>{} 0 0 0</pose>\n        <mass>{:.9g}</mass>\n        <inertia>{}</inertia>\n"
        "      </inertial>\n",
        numbers(i.centre_m), body.mass_kg, inertia_terms(i.about_centre, "<{0}>{1:.9g}</{0}>"));
  }
  if (!body.mesh_uri.empty()) {
    require_surface(design);
    for (const char* part : {"visual", "collision"})
      xml += fmt::format(
          "      <{0} name=\"cover_{0}\">\n        <geometry><mesh><uri>{1}</uri></mesh></geometry>\n"
          "      </{0}>\n",
          part, escape_markup(body.mesh_uri));
  }
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const Pose pose = box_pose_of(design.layout.modules[k], design.layout.corner_cut_mm);
    for (const char* part : {"visual", "collision"})
      xml += fmt::format(
          "      <{4} name=\"{0}{5}\">\n        <pose>{1} {2}</pose>\n        "
          "<geometry><box><size>{3}</size></box></geometry>\n"
          "      </{4}>\n",
          module_name(design, static_cast<int>(k)), pose.xyz_m, pose.rpy_rad, plate_size(design.layout.corner_cut_mm),
          part, std::string_view(part) == "visual" ? "" : "_collision");
  }
  xml += fmt::format("    </link>\n    <frame name=\"skin_{}\" attached_to=\"cover\"/>\n", part_name(design.name));
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const Pose pose = pose_of(design.layout.modules[k]);
    xml += fmt::format("    <frame name=\"{}\" attached_to=\"cover\"><pose>{} {}</pose></frame>\n",
                       module_name(design, static_cast<int>(k)), pose.xyz_m, pose.rpy_rad);
  }
  return xml + taxel_table(design, wiring, "") + "  </model>\n</sdf>\n";
}

std::string cover_stl(const design::Design& design) {
  require_surface(design);
  const auto little = [](auto value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    std::string bytes;
    for (unsigned k = 0; k < 4; ++k) bytes += static_cast<char>(bits >> (8 * k) & 0xFFU);
    return bytes;
  };
  const auto vector = [&](const design::Vec3& v) {
    return little(static_cast<float>(v.x())) + little(static_cast<float>(v.y())) + little(static_cast<float>(v.z()));
  };
  constexpr std::size_t kHead_bytes = 80;  // not read by anybody; "solid" at its beginning would mean text
  std::string stl(kHead_bytes, ' ');
  stl += little(static_cast<std::uint32_t>(design.surface.faces.size()));
  for (const auto& face : design.surface.faces) {
    std::array<design::Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = design.surface.vertices[static_cast<std::size_t>(face[k])] * kMetres_per_mm;
    stl += vector((p[1] - p[0]).cross(p[2] - p[0]).normalized());
    for (const design::Vec3& v : p) stl += vector(v);
    stl += std::string(2, '\0');
  }
  return stl;
}

}  // namespace triskin::exports
