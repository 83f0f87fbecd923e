// SPDX-License-Identifier: GPL-3.0-or-later
// Writes MJCF: the skin as a part of a MuJoCo model.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <span>

#include "metres.hpp"
#include "simulator_taxels.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/exports/export.hpp"
#include "triskin/exports/simulators.hpp"

namespace triskin::exports {
namespace {

constexpr double kPlate_mm = 1.0;
constexpr double kPlateMass_kg = 0.001;

std::string three(const design::Vec3& v) {
  return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z());
}

// Returns the plate under the dielectric in the frame of its module, from the plane of the taxels down.
std::string plate_vertices(double corner_cut_mm) {
  const std::array<design::Vec3, 3> corners{design::Vec3(-design::kSide_mm / 2.0, -design::kHeight_mm / 3.0, 0.0),
                                            design::Vec3(design::kSide_mm / 2.0, -design::kHeight_mm / 3.0, 0.0),
                                            design::Vec3(0.0, 2.0 * design::kHeight_mm / 3.0, 0.0)};
  const design::Outline outline = design::outline_of(corners, corner_cut_mm);
  std::string text;
  for (const design::Vec3& p : outline.points()) {
    for (const double z_mm : {0.0, -kPlate_mm})
      text += (text.empty() ? "" : "  ") + three(design::Vec3(p.x(), p.y(), z_mm) * kMetres_per_mm);
  }
  return text;
}

std::string module_body(const std::string& name, const design::Design& design, int id, MjcfTouch touch) {
  const ModulePose pose = frame_of(design.layout.modules[static_cast<std::size_t>(id)]);
  const Eigen::Quaterniond q(pose.axes);
  const std::string link = link_name(design, id);
  std::string xml = fmt::format(
      "      <body name=\"{0}\" pos=\"{1}\" quat=\"{2:.9g} {3:.9g} {4:.9g} {5:.9g}\">\n"
      "        <geom name=\"{0}_plate\" class=\"{6}_plate\" type=\"mesh\" mesh=\"{6}_plate\"/>\n",
      link, three(pose.origin_mm * kMetres_per_mm), q.w(), q.x(), q.y(), q.z(), name);
  // Only contacts of this body count, so the box of the site need not be as narrow as the module.
  if (touch == MjcfTouch::kSites)
    xml += fmt::format("        <site name=\"{0}_touch\" type=\"box\" size=\"0.02 0.02 0.005\" group=\"4\"/>\n", link);
  return xml + "      </body>\n";
}

// Returns vertices, three axes for each as normals, and triangles that use every vertex. MuJoCo's tactile sensor takes
// the first axis as the direction of pressure and the others as those of slip.
std::string taxel_mesh(const design::Design& design, const std::string& name) {
  std::string vertices, normals, faces;
  const auto taxels = simulator_taxels(design);
  for (std::size_t k = 0; k < taxels.size(); ++k) {
    const SimulatorTaxel& t = taxels[k];
    const ModulePose pose = frame_of(design.layout.modules[static_cast<std::size_t>(t.module)]);
    vertices += three(t.position_m) + "  ";
    normals += three(t.normal) + " " + three(pose.axes.col(0)) + " " + three(pose.axes.col(1)) + "  ";
    const bool fan = k >= 2 && taxels[k - 2].module == t.module;
    if (fan) faces += fmt::format("{} {} {}  ", k - 2, k - 1, k);
  }
  return fmt::format("    <mesh name=\"{}_taxels\" inertia=\"shell\" vertex=\"{}\" normal=\"{}\" face=\"{}\"/>\n", name,
                     vertices, normals, faces);
}

std::string sensors(const design::Design& design, const std::string& name, MjcfTouch touch) {
  if (touch == MjcfTouch::kTactile)
    return fmt::format("    <tactile name=\"{0}_tactile\" geom=\"{0}_taxels\" mesh=\"{0}_taxels\"/>\n", name);
  std::string xml;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const std::string link = link_name(design, static_cast<int>(m));
    xml += fmt::format("    <touch name=\"{0}\" site=\"{0}_touch\"/>\n", link);
  }
  return xml;
}

// Fixes the cover to a body of the other model without changing that model's file.
std::string fixing(const design::Design& design, const std::string& name, const std::string& robot_body) {
  const std::string body = escape_markup(robot_body);
  std::string xml = fmt::format(
      "  <equality>\n    <weld name=\"{0}_fixing\" body1=\"{1}\" body2=\"{0}\" relpose=\"0 0 0 1 0 0 0\"/>\n"
      "  </equality>\n  <contact>\n",
      name, body);
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m)
    xml += fmt::format("    <exclude body1=\"{}\" body2=\"{}\"/>\n", body, link_name(design, static_cast<int>(m)));
  return xml + "  </contact>\n";
}

}  // namespace

std::string mjcf(const design::Design& design, MjcfTouch touch, const std::string& robot_body) {
  const std::string name = simulator_name(design);
  const bool tactile = touch == MjcfTouch::kTactile;
  (void)simulator_taxels(design);  // The call throws for a design without modules.
  std::string xml = fmt::format(
      "<mujoco model=\"{0}\">\n  <default>\n    <default class=\"{0}_plate\">\n"
      "      <geom mass=\"{1:g}\" margin=\"{2:g}\" solimp=\"0.1 0.95 {2:g}\" group=\"3\"/>\n    </default>\n"
      "  </default>\n  <asset>\n    <mesh name=\"{0}_plate\" vertex=\"{3}\"/>\n{4}  </asset>\n"
      "  <worldbody>\n    <body name=\"{0}\">\n{5}",
      name, kPlateMass_kg, kDielectric_mm * kMetres_per_mm, plate_vertices(design.layout.corner_cut_mm),
      tactile ? taxel_mesh(design, name) : "",
      robot_body.empty() ? "" : fmt::format("      <freejoint name=\"{}_fixing\"/>\n", name));
  if (tactile)
    xml += fmt::format(
        "      <geom name=\"{0}_taxels\" type=\"mesh\" mesh=\"{0}_taxels\" contype=\"0\" conaffinity=\"0\" mass=\"0\" "
        "group=\"3\"/>\n",
        name);
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m)
    xml += module_body(name, design, static_cast<int>(m), touch);
  xml += "    </body>\n  </worldbody>\n  <sensor>\n" + sensors(design, name, touch);
  xml += "  </sensor>\n";
  if (!robot_body.empty()) xml += fixing(design, name, robot_body);
  return xml + "</mujoco>\n";
}

}  // namespace triskin::exports
