// SPDX-License-Identifier: GPL-3.0-or-later
// Exports for other programs are read back by code that shares nothing with the writers.
#include "triskin/exports/export.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "support/strip_design.hpp"
#include "triskin/base/base64.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/exports/simulators.hpp"

namespace triskin::test {
namespace {

using design::Vec3;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// Makes a strip whose modules are turned in all ways, including x axes that point straight down or up.
design::Design turned_strip() {
  design::Design d = strip(20, 16);
  for (std::size_t k = 0; k < d.layout.modules.size(); ++k) {
    const double angle_rad = 0.7 * static_cast<double>(k);
    Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(angle_rad, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(0.3, Vec3::UnitX())).matrix();
    // Side 0 of an up tile runs along x of the strip.
    if (k == 2) turn = Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitY()).matrix();
    if (k == 4) turn = Eigen::AngleAxisd(-1.5707963267948966, Vec3::UnitY()).matrix();
    for (Vec3& corner : d.layout.modules[k].corner_mm) corner = turn * corner + Vec3(5, -7, 11);
  }
  return d;
}

double number(const json& value) {
  return value.get<double>();
}
Vec3 vector(const json& value) {
  return {number(value[0]), number(value[1]), number(value[2])};
}

// Returns a corner of the module's triangle in its frame, mm: side 0 along x, centroid at the origin.
Vec3 corner_in_module(int corner) {
  const double h = design::kHeight_mm;
  return corner == 0 ? Vec3(-15, -h / 3, 0) : corner == 1 ? Vec3(15, -h / 3, 0) : Vec3(0, 2 * h / 3, 0);
}

TEST(Base64, agrees_with_the_vectors_of_rfc_4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFB\xFF"), "+/8=");
}

TEST(ExportGltf, puts_modules_and_taxels_where_the_design_has_them) {
  const design::Design d = turned_strip();
  const auto wiring = design::wiring_of(d);
  const json scene = json::parse(exports::gltf(d));
  std::size_t modules = 0, taxels = 0;
  for (const json& node : scene["nodes"]) {
    const json extras = node.value("extras", json::object());
    if (!extras.contains("module") || extras.contains("taxel")) continue;
    const auto id = extras["module"].get<std::size_t>();
    const Vec3 at = vector(node["translation"]) * 1e3;
    const json& q = node["rotation"];
    const Eigen::Quaterniond turn(number(q[3]), number(q[0]), number(q[1]), number(q[2]));
    for (int c = 0; c < 3; ++c) {
      const Vec3 expected = d.layout.modules[id].corner_mm[static_cast<std::size_t>(c)];
      EXPECT_LT((turn * corner_in_module(c) + at - expected).norm(), 1e-9) << id;
    }
    const auto poses = design::taxels_of(d.layout.modules[id], wiring[id].routed.rotation);
    for (const json& child : node["children"]) {
      const json& taxel = scene["nodes"][child.get<std::size_t>()];
      const auto index = taxel["extras"]["taxel"].get<std::size_t>();
      EXPECT_EQ(taxel["extras"]["measures"], index == 6 || index == 10 ? "temperature" : "pressure");
      const Vec3 drawn = turn * (vector(taxel["translation"]) * 1e3) + at;
      EXPECT_LT((drawn - 0.1 * poses[index].normal - poses[index].position_mm).norm(), 1e-9);
      ++taxels;
    }
    EXPECT_EQ(extras["line"], wiring[id].routed.line);
    ++modules;
  }
  EXPECT_EQ(modules, 20U);
  EXPECT_EQ(taxels, 240U);
}

TEST(ExportGltf, carries_the_surface_in_its_buffer) {
  const json scene = json::parse(exports::gltf(strip(2)));
  const json& cover = scene["meshes"][0]["primitives"][0];
  const json& points = scene["accessors"][cover["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(points["count"], 4);
  EXPECT_EQ(points["max"][0], 1.0);  // The value is 1000 mm in metres.
  EXPECT_EQ(scene["accessors"][cover["indices"].get<std::size_t>()]["count"], 6);
  design::Design bare = strip(2);
  bare.surface = {};
  EXPECT_THROW((void)exports::gltf(bare), InputError);
}

// A cut of 5 mm leaves long sides of 20 mm and short ones of 5 mm, in the frame of the module.
TEST(ExportGltf, draws_cut_corners) {
  design::Design d = strip(1);
  d.layout.corner_cut_mm = 5.0;
  const json scene = json::parse(exports::gltf(d));
  EXPECT_EQ(scene["nodes"].back()["extras"]["corner_cut_mm"], 5.0);
  const json& shape = scene["meshes"][1]["primitives"][0];
  const json& points = scene["accessors"][shape["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(points["count"], 6);
  EXPECT_EQ(scene["accessors"][shape["indices"].get<std::size_t>()]["count"], 12);
  // The lowest long side runs from x = −10 to 10 mm; the widest points lie 5 mm up the other sides, at x = ±12.5 mm.
  EXPECT_NEAR(number(points["max"][0]), 0.0125, 1e-7);
  EXPECT_NEAR(number(points["max"][1]), (2 * design::kHeight_mm / 3 - 5 * 0.8660254037844386) / 1e3, 1e-7);
}

TEST(ExportGltf, draws_jumpers_between_the_middles_of_two_sides) {
  design::Design d = strip(2);
  d.layout.jumpers.push_back({{0, 1}, {0, 1}, 12.5, 0.0, design::JumperKind::kCable});
  const json scene = json::parse(exports::gltf(d));
  std::size_t found = 0;
  for (const json& node : scene["nodes"]) {
    if (!node.value("extras", json::object()).contains("jumper")) continue;
    ++found;
    EXPECT_EQ(node["extras"]["modules"], json::array({0, 1}));
    EXPECT_EQ(node["extras"]["length_mm"], 12.5);
    const json& line = scene["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
    EXPECT_EQ(line["mode"], 1);
    // Side 0 of module 0 has its middle at (15, 0), side 1 of module 1 at (30, h).
    const json& ends = scene["accessors"][line["attributes"]["POSITION"].get<std::size_t>()];
    EXPECT_NEAR(number(ends["min"][0]), 0.015, 1e-8);
    EXPECT_NEAR(number(ends["max"][0]), 0.030, 1e-8);
    EXPECT_NEAR(number(ends["max"][1]), design::kHeight_mm / 1e3, 1e-8);
  }
  EXPECT_EQ(found, 1U);
}

// Turns about the fixed axes x, then y, then z.
Eigen::Matrix3d turn_of(const Vec3& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()))
      .matrix();
}
Vec3 three(const std::string& text) {
  std::istringstream in(text);
  Vec3 v;
  in >> v.x() >> v.y() >> v.z();
  return v;
}
void expect_corners(const design::PlacedModule& module, const Vec3& at_m, const Vec3& rpy_rad) {
  for (int c = 0; c < 3; ++c) {
    const Vec3 corner = turn_of(rpy_rad) * corner_in_module(c) + 1e3 * at_m;
    // The file has nine digits of a metre.
    EXPECT_LT((corner - module.corner_mm[static_cast<std::size_t>(c)]).norm(), 1e-5);
  }
}

TEST(ExportUrdf, has_a_link_in_the_frame_of_each_module) {
  const design::Design d = turned_strip();
  const std::string urdf = exports::urdf(d);
  const std::regex joint("<child link=\"module_(\\d+)\"/>\\s*<origin xyz=\"([^\"]*)\" rpy=\"([^\"]*)\"/>");
  std::size_t found = 0;
  for (auto at = std::sregex_iterator(urdf.begin(), urdf.end(), joint); at != std::sregex_iterator(); ++at, ++found)
    expect_corners(d.layout.modules[std::stoul((*at)[1])], three((*at)[2]), three((*at)[3]));
  EXPECT_EQ(found, 20U);
}

TEST(ExportUrdf, lists_every_taxel_in_the_frame_of_its_module) {
  const design::Design d = turned_strip();
  const auto wiring = design::wiring_of(d);
  const std::string urdf = exports::urdf(d);
  const std::regex row(
      "<triskin:taxel module=\"(\\d+)\" index=\"(\\d+)\" measures=\"(\\w+)\" frame=\"module_(\\d+)\" xyz=\"([^\"]*)\" "
      "normal=\"([^\"]*)\"/>");
  std::size_t found = 0;
  for (auto at = std::sregex_iterator(urdf.begin(), urdf.end(), row); at != std::sregex_iterator(); ++at, ++found) {
    const std::size_t module = std::stoul((*at)[1]), taxel = std::stoul((*at)[2]);
    const auto frame = exports::frame_of(d.layout.modules[module]);
    const auto pose = design::taxels_of(d.layout.modules[module], wiring[module].routed.rotation)[taxel];
    EXPECT_LT((frame.axes * three((*at)[5]) * 1e3 + frame.origin_mm - pose.position_mm).norm(), 1e-5);
    EXPECT_LT((frame.axes * three((*at)[6]) - pose.normal).norm(), 1e-8);
    EXPECT_EQ((*at)[3], taxel == 6 || taxel == 10 ? "temperature" : "pressure");
  }
  EXPECT_EQ(found, 240U);
}

TEST(ExportUrdf, is_accepted_by_check_urdf) {
  if (std::system("command -v check_urdf > /dev/null") != 0) GTEST_SKIP() << "check_urdf is not installed";
  design::Design d = turned_strip();
  d.name = "<arm> & \"hand\"";
  const auto file = std::filesystem::temp_directory_path() / fmt::format("export_test.{}.urdf", ::getpid());
  d.surface.vertices = {{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}};
  d.surface.faces = {{0, 1, 2}};
  for (const exports::CoverBody& body :
       {exports::CoverBody{}, {.prefix = "l_", .mass_kg = 0.3, .mesh_uri = "a&b.stl"}}) {
    write_file_atomically(file, exports::urdf(d, body));
    EXPECT_EQ(std::system(("check_urdf " + file.string() + " > /dev/null").c_str()), 0);
  }
  std::filesystem::remove(file);
}

// A cut of 4 mm leaves 26 mm width and 25.98 − 3.46 mm height; the middle lies 11.26 − 8.66 mm over the centroid.
TEST(ExportUrdf, draws_the_box_of_what_is_left_of_a_module) {
  design::Design d = strip(1);
  EXPECT_THAT(exports::urdf(d), HasSubstr("<origin xyz=\"0 0.00433012702 0\"/>"));
  EXPECT_THAT(exports::urdf(d), HasSubstr("<box size=\"0.03 0.0259807621 0.001\"/>"));
  d.layout.corner_cut_mm = 4.0;
  EXPECT_THAT(exports::urdf(d), HasSubstr("<origin xyz=\"0 0.00259807621 0\"/>"));
  EXPECT_THAT(exports::urdf(d), HasSubstr("<box size=\"0.026 0.0225166605 0.001\"/>"));
  EXPECT_THAT(exports::sdf(d), HasSubstr("<size>0.026 0.0225166605 0.001</size>"));
}

// A square of 2 m, two triangles of 1 kg each: about its middle 1/12 m l2 = 2/3 kg m2 in its plane, 4/3 about z.
TEST(ExportUrdf, mass_and_inertia_are_those_of_a_shell) {
  design::Design d = strip(1);
  d.name = "plate";
  d.surface.vertices = {{0, 0, 500}, {2000, 0, 500}, {2000, 2000, 500}, {0, 2000, 500}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  const exports::CoverBody body{.prefix = "left_", .mass_kg = 2.0, .mesh_uri = "package://robot/plate.stl"};
  const std::string urdf = exports::urdf(d, body);
  EXPECT_THAT(urdf, HasSubstr("<link name=\"left_skin_plate\"/>"));
  EXPECT_THAT(urdf, HasSubstr("<parent link=\"left_skin_plate\"/>\n    <child link=\"left_cover\"/>"));
  EXPECT_THAT(urdf, HasSubstr("<link name=\"left_module_0\">"));
  EXPECT_THAT(urdf, HasSubstr("frame=\"left_module_0\""));
  EXPECT_THAT(urdf,
              HasSubstr("<collision>\n      <geometry><mesh filename=\"package://robot/plate.stl\"/></geometry>"));
  EXPECT_THAT(urdf, HasSubstr("<origin xyz=\"1 1 0.5\"/>\n      <mass value=\"2\"/>"));
  const std::string sdf = exports::sdf(d, body);
  EXPECT_THAT(sdf, HasSubstr("<static>false</static>"));
  EXPECT_THAT(sdf, HasSubstr("<pose>1 1 0.5 0 0 0</pose>\n        <mass>2</mass>"));
  EXPECT_THAT(sdf, HasSubstr("<mesh><uri>package://robot/plate.stl</uri></mesh>"));
  EXPECT_THAT(sdf, HasSubstr("<frame name=\"skin_plate\" attached_to=\"cover\"/>"));
  for (const auto& [term, wanted] : std::map<std::string, double>{
           {"ixx", 2.0 / 3}, {"iyy", 2.0 / 3}, {"izz", 4.0 / 3}, {"ixy", 0.0}, {"ixz", 0.0}, {"iyz", 0.0}}) {
    EXPECT_NEAR(std::stod(urdf.substr(urdf.find(term) + 5)), wanted, 5e-9) << term;  // nine significant digits
    EXPECT_NEAR(std::stod(sdf.substr(sdf.find("<" + term + ">") + 5)), wanted, 5e-9) << term;
  }
  d.surface.faces.clear();
  EXPECT_THROW((void)exports::urdf(d, body), InputError);
}

TEST(ExportUrdf, the_mesh_of_the_cover_is_its_surface_in_metres) {
  design::Design d = strip(1);
  d.surface.vertices = {{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}};
  d.surface.faces = {{0, 1, 2}};
  const std::string stl = exports::cover_stl(d);
  ASSERT_EQ(stl.size(), 84U + 50U);
  EXPECT_EQ(stl[80], 1);
  const auto number = [&](std::size_t k) {
    float v = 0.0F;
    std::memcpy(&v, stl.data() + 84 + 4 * k, 4);
    return v;
  };
  const std::vector<float> wanted{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};  // normal, then the corners
  for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_EQ(number(k), wanted[k]) << k;
}

TEST(ExportSdf, has_a_frame_for_each_module) {
  const design::Design d = turned_strip();
  const std::string sdf = exports::sdf(d);
  const std::regex frame(
      "<frame name=\"module_(\\d+)\" attached_to=\"cover\"><pose>(\\S+ \\S+ \\S+) ([^<]*)</pose></frame>");
  std::size_t found = 0;
  for (auto at = std::sregex_iterator(sdf.begin(), sdf.end(), frame); at != std::sregex_iterator(); ++at, ++found)
    expect_corners(d.layout.modules[std::stoul((*at)[1])], three((*at)[2]), three((*at)[3]));
  EXPECT_EQ(found, 20U);
}

TEST(ExportSdf, a_reserved_name_is_none_of_a_model) {
  design::Design d = strip(1);
  d.name = "world";
  EXPECT_THAT(exports::sdf(d), HasSubstr("<model name=\"world_skin\">"));
  EXPECT_THAT(exports::mjcf(d, exports::MjcfTouch::kSites, ""), HasSubstr("<body name=\"world_skin\">"));
  d.name = "__model__";
  EXPECT_THAT(exports::sdf(d), HasSubstr("<model name=\"__model___skin\">"));
}

TEST(ExportXml, keeps_a_name_from_a_file_out_of_the_markup) {
  design::Design d = strip(1);
  d.name = "a\"><x y=\"\n";
  for (const std::string& xml : {exports::urdf(d), exports::sdf(d)}) {
    EXPECT_THAT(xml, Not(HasSubstr("<x")));
    EXPECT_THAT(xml, HasSubstr("name=\"a&quot;&gt;&lt;x y=&quot;&#10;\""));
  }
}

}  // namespace
}  // namespace triskin::test
