// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files as programs write them: polygons, indices from the end, STL with wrong headers, units that nobody said.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "triskin/geometry/mesh_io.hpp"
#include "triskin/geometry/surface.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

namespace fs = std::filesystem;

class Formats : public testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& bytes) {
    path_ = fs::temp_directory_path() / fmt::format("{}.{}", ::getpid(), name);
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }
  void TearDown() override { fs::remove(path_); }
  std::string error_of(const std::string& name, const std::string& bytes, std::optional<LengthUnit> unit = {}) {
    try {
      (void)read_mesh(file(name, bytes), unit);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  }

 private:
  fs::path path_;
};

double area(const Mesh& m) {
  return Surface(m).area_mm2();
}

std::string binary_stl(const std::string& header, std::uint32_t count,
                       const std::vector<std::array<float, 9>>& facets) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& f : facets) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(f.data()), 36);
    bytes.append(2, '\0');
  }
  return bytes;
}

const std::vector<std::array<float, 9>> kSquare{{0, 0, 0, 100, 0, 0, 100, 100, 0}, {0, 0, 0, 100, 100, 0, 0, 100, 0}};

TEST_F(Formats, ObjKeepsDoublePrecision) {
  const Mesh m =
      read_mesh(file("a.obj", "v 0.123456789012345 0 0\nv 100.000000000001 0 0\nv 0 +1e2 0\nf 1 2 3\n")).mesh;
  EXPECT_EQ(m.vertices[0].x(), 0.123456789012345);
  EXPECT_EQ(m.vertices[1].x(), 100.000000000001);
}

TEST_F(Formats, WrittenMeshIsReadBackBitForBit) {
  Mesh m{{{1.0 / 3.0, 0, 0}, {100.0 / 7.0, 50.0 / 3.0, 1e-3 / 3.0}, {0, 0, 77.0 / 3.0}}, {{0, 1, 2}}};
  const fs::path path = file("b.obj", "");
  write_obj(path, m);
  const Mesh back = read_mesh(path).mesh;
  for (std::size_t v = 0; v < 3; ++v) EXPECT_EQ(back.vertices[v], m.vertices[v]);
}

// An L of 100 × 100 less 60 × 60: a fan from its first corner would cover more than its area.
TEST_F(Formats, ConcavePolygonOfAnObjIsNotCoveredTwice) {
  const std::string corners = "v 100 0 0\nv 100 40 0\nv 40 40 0\nv 40 100 0\nv 0 100 0\nv 0 0 0\n";
  const Mesh m = read_mesh(file("c.obj", corners + "f 1//1 2//1 3//1 4/7/1 -2 -1\n")).mesh;
  EXPECT_EQ(m.faces.size(), 4U);
  EXPECT_NEAR(area(m), 10000.0 - 3600.0, 1e-9);
}

TEST_F(Formats, ObjLinesMayBeContinuedAndEndAsOnWindows) {
  EXPECT_EQ(
      read_mesh(file("d.obj", "v 0 0 0\r\nv 100 \\\r\n0 0\r\nv 0 100 0 # c\r\nf 1 2 \\\r\n3\r\n")).mesh.faces.size(),
      1U);
}

TEST_F(Formats, BrokenObjNamesTheLine) {
  EXPECT_NE(error_of("e.obj", "v 0 0 0\nv 100 0\n").find("line 2"), std::string::npos);
  EXPECT_NE(error_of("e.obj", "v 0 0 0\nv 100 0 0\nf 1 2 3\n").find("line 3"), std::string::npos);
  EXPECT_NE(error_of("e.obj", "v 0 0 0\nv 100 0 0\nv 1 9 0\nf 1 2 -4\n").find("line 4"), std::string::npos);
}

TEST_F(Formats, BinaryStlIsKnownByItsLengthNotByItsFirstWord) {
  EXPECT_NEAR(area(read_mesh(file("f.stl", binary_stl("solid facet by a careless program", 2, kSquare))).mesh), 1e4,
              1e-6);
}

TEST_F(Formats, BinaryStlWithAWrongCountGivesWhatItHolds) {
  EXPECT_EQ(read_mesh(file("g.stl", binary_stl("x", 0, kSquare))).mesh.faces.size(), 2U);
  EXPECT_EQ(read_mesh(file("g.stl", binary_stl("x", 4'000'000'000U, kSquare))).mesh.faces.size(), 2U);
}

TEST_F(Formats, TextStlKeepsDoublePrecision) {
  const Mesh m =
      read_mesh(file("h.stl",
                     "solid x\n facet normal 0 0 1\n  outer loop\n   vertex 0.123456789012345 0 0\n   vertex 100 0 0\n"
                     "   vertex 0 100 0\n  endloop\n endfacet\nendsolid\n"))
          .mesh;
  EXPECT_EQ(m.vertices[0].x(), 0.123456789012345);
}

TEST_F(Formats, PlyTextAndBothByteOrdersGiveTheSameMesh) {
  const auto header = [](const char* format) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment c\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
        "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
        format);
  };
  const double x = 100.123456789012;
  const std::vector<std::array<double, 3>> places{{0, 0, 0}, {x, 0, 0}, {x, 50, 0}, {0, 50, 0}};
  std::string text = header("ascii"), little = header("binary_little_endian"), big = header("binary_big_endian");
  const auto put = [&](const auto value) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof(value));
    little += raw;
    std::ranges::reverse(raw);
    big += raw;
  };
  for (const auto& p : places) {
    text += fmt::format("{} {} {} 255\n", p[0], p[1], p[2]);
    for (const double c : p) put(c);
    put(std::uint8_t{255});
  }
  text += "4 0 1 2 3\n";
  put(std::uint8_t{4});
  for (const std::int32_t v : {0, 1, 2, 3}) put(v);
  for (const std::string& bytes : {text, little, big}) {
    const Mesh m = read_mesh(file("p.ply", bytes)).mesh;
    ASSERT_EQ(m.faces.size(), 2U);
    EXPECT_NEAR(area(m), 50.0 * x, 1e-9);
    EXPECT_NE(error_of("p.ply", bytes.substr(0, bytes.size() - 3)), "");
  }
}

TEST_F(Formats, UnlikelySizesAreAQuestion) {
  const auto triangle = [](double size) { return fmt::format("v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nf 1 2 3\n", size); };
  EXPECT_NE(error_of("i.obj", triangle(0.3)).find("metres"), std::string::npos);
  EXPECT_NE(error_of("i.obj", triangle(10.0)).find("centimetres"), std::string::npos);
  EXPECT_NE(error_of("i.obj", triangle(3000.0)).find("--unit mm"), std::string::npos);
  EXPECT_EQ(error_of("i.obj", triangle(3000.0), LengthUnit::kMillimetre), "");
  EXPECT_EQ(error_of("i.obj", triangle(0.3), LengthUnit::kMetre), "");
}

}  // namespace
}  // namespace triskin::geometry
