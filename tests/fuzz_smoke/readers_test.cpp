// SPDX-License-Identifier: GPL-3.0-or-later
// Every reader gets damaged files and must quickly return a value or an Error that names the file, and nothing else.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "support/packed_model.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/module_list.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/robot/frames.hpp"
#include "triskin/robot/registration.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin {
namespace {

namespace fs = std::filesystem;
using Random = std::mt19937_64;

std::string damage(std::string text, Random& random) {
  static const std::vector<std::string> kTokens{
      "1e999", "-1",     "nan",  "99999999999999999999", "null",      "{", "[", "]", "\"", "\xff", "0", "inf",
      "-0.0",  "1e-320", "true", std::string(1, '\0'),   "[[[[[[[[[["};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1)); };
  for (std::size_t k = 1 + below(4); k > 0; --k) {
    const std::size_t at = below(text.size());
    switch (random() % 6) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.resize(at);
        break;
      case 2:
        text.insert(at, kTokens[below(kTokens.size())]);
        break;
      case 3:
        text.erase(at, below(20));
        break;
      case 4:
        text.insert(at, text.substr(below(text.size()), below(60)));
        break;
      default: {
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos)
          text.replace(digit, text.find_first_not_of("0123456789.", digit) - digit, kTokens[below(kTokens.size())]);
      }
    }
  }
  return text;
}

void fuzz(const std::string& good, const std::string& extension, int runs,
          const std::function<void(const fs::path&)>& read) {
  const fs::path path = fs::temp_directory_path() / ("readers_test." + std::to_string(::getpid()) + extension);
  const auto write = [&](const std::string& text) {
    fs::remove(path);  // Truncating and rewriting a file would flush it to the disk, so it is removed first.
    std::ofstream(path, std::ios::binary) << text;
  };
  write(good);
  ASSERT_NO_THROW(read(path)) << "the undamaged file";
  Random random(20261121);
  int refused = 0;
  for (int run = 0; run < runs; ++run) {
    std::string text;
    if (run % 10 == 0) {
      for (std::size_t n = random() % 400; n > 0; --n) text.push_back(static_cast<char>(random()));
    } else {
      text = damage(good, random);
    }
    write(text);
    const auto start = std::chrono::steady_clock::now();
    try {
      read(path);
    } catch (const Error& e) {
      ++refused;
      EXPECT_NE(std::string(e.what()).find(path.filename().string()), std::string::npos) << e.what();
    } catch (const std::exception& e) {
      ADD_FAILURE() << extension << " run " << run << ": " << e.what() << "\n" << text.substr(0, 2000);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20)) << text.substr(0, 2000);
  }
  EXPECT_GT(refused, runs / 10);
  fs::remove(path);
}

std::string small_design() {
  const fs::path path = fs::temp_directory_path() / ("readers_test." + std::to_string(::getpid()) + ".good.json");
  design::write_design(path, test::strip(2));
  std::string text = read_file(path);
  fs::remove(path);
  return text;
}

TEST(Readers, design) {
  fuzz(small_design(), ".json", 1000, [](const fs::path& p) { (void)design::read_design(p); });
}
TEST(Readers, checker) {
  fuzz(small_design(), ".json", 1000, [](const fs::path& p) { (void)check::check_design(p); });
}
TEST(Readers, scene) {
  fuzz(small_design(), ".json", 1000, [](const fs::path& p) { (void)hardware::read_scene(p); });
}

TEST(Readers, robot) {
  const std::string good =
      R"({"format":"triskin-robot","version":1,"name":"r","urdf":"r.urdf",
          "buses":[{"name":"left","link":"can:can0","bit_rate":1000000,"data_bit_rate":2000000,"cable_mm":500}],
          "covers":[{"name":"arm","design":"arm.json","design_id":"9f86d081884c7d65","bus":"left","frame":"l_arm",
            "rate_hz":20,"pose":{"matrix":[[0,-1,0,5],[1,0,0,6],[0,0,1,7],[0,0,0,1]]},
            "measured":{"points":8,"rms_mm":1.5},
            "controllers":[{"patch":0,"node":3,"serial":"0123456789abcdef01234567","cable_mm":90}]},
           {"name":"leg","design":"leg.json","design_id":"9f86d081884c7d65","bus":"left",
            "pose":{"xyz_mm":[1,2,3],"rpy_rad":[0.1,0.2,0.3]},"controllers":[]}]})";
  fuzz(good, ".json", 1000, [](const fs::path& p) { (void)robot::read_robot(p); });
}
TEST(Readers, urdf) {
  fuzz(R"(<?xml version="1.0"?><robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed">
          <parent link="a"/><child link="b"/><origin xyz="0.1 0 0.2" rpy="0 1.5 0"/></joint></robot>)",
       ".urdf", 1000, [](const fs::path& p) { (void)robot::Frames::read_urdf(p); });
}
TEST(Readers, touches) {
  fuzz("module,taxel,x_mm,y_mm,z_mm\n4,3,1.5,-2,30\n5,11,0.25,0,0\n", ".csv", 1000,
       [](const fs::path& p) { (void)robot::read_touches(read_file(p), p.string()); });
}

TEST(Readers, kinds) {
  fuzz(
      R"({"format":"triskin-kinds","version":1,"kinds":[{"name":"soft","taxels":10,"dielectric":"foam",
          "sensitivity_counts_per_kpa":80},{"name":"hard"}],"regions":[{"kind":"soft","box":{"low_mm":[0,-1,-1],
          "high_mm":[50,30,1]}},{"kind":"hard","modules":[1,5]},{"kind":"hard","island":1},
          {"kind":"standard","sphere":{"center_mm":[15,8.7,0],"radius_mm":1}}]})",
      ".json", 1000, [](const fs::path& p) { (void)design::read_kind_plan(p); });
}
TEST(Readers, calibration) {
  design::BoardCalibration board;
  board.serial = "0123456789ABCDEF01234567";
  board.made = "2026-11-22T17:30:00Z";
  board.method = wire::CalibrationMethod::kSteps;
  board.max_kpa = 40.0;
  board.taxel_area_mm2 = 39.0;
  design::PlaceCalibration place;
  place.line = 1;
  place.address = 2;
  place.taxels.fill({150.0, 0.5, 0.1});
  board.places.push_back(place);
  fuzz(design::calibration_text(std::span(&board, 1)), ".json", 1000,
       [](const fs::path& p) { (void)design::read_calibration(p); });
}
TEST(Readers, module_list) {
  fuzz(R"({"modules":[{"id":0,"i":3,"j":5,"up":true,"island":0,"border":true},{"id":7,"i":3,"j":5,"up":false}]})",
       ".json", 1000, [](const fs::path& p) { (void)design::read_module_list(p); });
}

TEST(Readers, polygons) {
  const auto read = [](const fs::path& p) { (void)placement::read_polygon(p); };
  fuzz(
      R"({"type":"Polygon","coordinates":[[[0,0],[100,0],[100,80.5],[0,80],[0,0]],[[10,10],[10,20],[20,20],[10,10]]]})",
      ".geojson", 1000, read);
  fuzz("POLYGON ((0 0, 100 0, 100 80.5, 0 80, 0 0), (10 10, 10 20, 20 20, 10 10))", ".wkt", 1000, read);
}

TEST(Readers, meshes) {
  const auto read = [](const fs::path& p) { (void)mesh::read_mesh(p); };
  fuzz("v 0 0 0\nv 100 0 0\nv 100 100 5\nv 0 100 0\nf 1 2 3\nf 1 3 4\n", ".obj", 150, read);
  fuzz("OFF\n4 2 0\n0 0 0\n100 0 0\n100 100 5\n0 100 0\n3 0 1 2\n3 0 2 3\n", ".off", 1500, read);
  fuzz(
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 100 0 0\nvertex 100 100 5\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 100 100 5\nvertex 0 100 0\nendloop\nendfacet\nendsolid s\n",
      ".stl", 150, read);
  fuzz(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n100 0 0\n100 100 5\n0 100 0\n3 0 1 2\n3 0 2 3\n",
      ".ply", 20, read);
}

// Covers damage of the package, and of the model in an intact package.
TEST(Readers, packed_models) {
  const std::string model =
      R"(<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
         <object id="1" name="cover"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="100" y="0" z="0"/>
         <vertex x="100" y="100" z="5"/><vertex x="0" y="100" z="0"/></vertices><triangles>
         <triangle v1="0" v2="1" v3="2"/><triangle v1="0" v2="2" v3="3"/></triangles></mesh></object>
         <object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/></components></object>
         </resources><build><item objectid="2"/></build></model>)";
  const fs::path path = fs::temp_directory_path() / ("readers_test." + std::to_string(::getpid()) + ".whole.3mf");
  test::write_packed_model(path, model);
  fuzz(read_file(path), ".3mf", 300, [](const fs::path& p) { (void)mesh::read_mesh(p); });
  fuzz(model, ".model.3mf", 300, [](const fs::path& p) {
    const std::string text = read_file(p);
    test::write_packed_model(p, text);
    (void)mesh::read_mesh(p);
  });
  fs::remove(path);
}

}  // namespace
}  // namespace triskin
