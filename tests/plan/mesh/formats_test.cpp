// SPDX-License-Identifier: GPL-3.0-or-later
// Reads mesh files as programs write them: polygons, indices from the end, STL with wrong headers, unstated units.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "support/packed_model.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
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
  fs::path package(const std::string& name, const std::string& model) {
    const fs::path path = file(name, "");
    test::write_packed_model(path, model);
    return path;
  }
  std::string error_of(const std::string& name, const std::string& bytes, std::optional<LengthUnit> unit = {},
                       const std::string& object = {}) {
    try {
      (void)read_mesh(file(name, bytes), unit, object);
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

// The polygon is an L of 100 × 100 less 60 × 60: a fan from its first corner would cover more than its area.
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
  // Files that were written to a pipe have 0 or all ones for "unknown"; any other count is binding.
  for (const std::uint32_t unknown : {0U, 0xFFFFFFFFU}) {
    const MeshFile read = read_mesh(file("g.stl", binary_stl("x", unknown, kSquare)));
    EXPECT_EQ(read.mesh.faces.size(), 2U);
    EXPECT_EQ(read.report.notes.size(), 1U);
  }
  EXPECT_NE(error_of("g.stl", binary_stl("x", 4'000'000'000U, kSquare)).find("2 of 4000000000 triangles"),
            std::string::npos);
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

// Makes a geometry of COLLADA with one triangle of legs `size`, named as the node that shows it.
std::string dae_geometry(const std::string& name, int size) {
  return fmt::format(
      R"(<geometry id="{0}-g" name="{0}"><mesh><source id="{0}-p"><float_array id="{0}-a" count="9">
0 0 {1} {1} 0 {1} 0 {1} {1}</float_array><technique_common><accessor source="#{0}-a" count="3" stride="3">
<param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="{0}-v"><input semantic="POSITION" source="#{0}-p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#{0}-v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>)",
      name, size);
}
std::string dae(const std::string& unit) {
  const auto node = [](const char* name) {
    return fmt::format(R"(<node id="{0}" name="{0}"><instance_geometry url="#{0}-g"/></node>)", name);
  };
  return fmt::format(
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{}<up_axis>Z_UP</up_axis></asset><library_geometries>{}{}</library_geometries>
<library_visual_scenes><visual_scene id="s" name="s">{}{}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
      unit, dae_geometry("hull", 30), dae_geometry("fin", 20), node("hull"), node("fin"));
}

// Legs of 30 and 20 cm give 450 + 200 cm².
TEST_F(Formats, DaeSaysItsUnit) {
  const MeshFile cm = read_mesh(file("u.dae", dae(R"(<unit name="centimeter" meter="0.01"/>)")));
  EXPECT_TRUE(cm.report.unit_from_file);
  EXPECT_NEAR(area(cm.mesh), 45000.0 + 20000.0, 0.1);
  const MeshFile inch = read_mesh(file("u.dae", dae(R"(<unit meter = '0.0254' name = 'inch'/>)")));
  EXPECT_NEAR(area(inch.mesh), 650.0 * 25.4 * 25.4, 0.1);
  const MeshFile told = read_mesh(file("u.dae", dae(R"(<unit meter="0.01"/>)")), LengthUnit::kMillimetre);
  EXPECT_NEAR(area(told.mesh), 650.0, 1e-3);
}

TEST_F(Formats, DaeWithoutAUnitIsTakenForMillimetres) {
  const MeshFile file_mm = read_mesh(file("w.dae", dae("")));
  EXPECT_FALSE(file_mm.report.unit_from_file);
  EXPECT_NEAR(area(file_mm.mesh), 650.0, 1e-3);
}

TEST_F(Formats, OneObjectOfADae) {
  const std::string bytes = dae(R"(<unit meter="0.01"/>)");
  EXPECT_NEAR(area(read_mesh(file("o.dae", bytes), {}, "fin").mesh), 20000.0, 0.1);
  const std::string error = error_of("o.dae", bytes, {}, "wing");
  EXPECT_NE(error.find("no object \"wing\""), std::string::npos) << error;
  EXPECT_NE(error.find("fin"), std::string::npos) << error;
  EXPECT_NE(error.find("hull"), std::string::npos) << error;
}

std::string model_3mf(const std::string& unit) {
  const auto object = [](int id, const char* name, int size) {
    return fmt::format(
        R"(<object id="{}" name="{}" type="model"><mesh><vertices>
<vertex x="0" y="0" z="0"/><vertex x="{}" y="0" z="0"/>
<vertex x="0" y="{}" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>)",
        id, name, size, size);
  };
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?><model {} xml:lang="en-US"
xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>{}{}</resources>
<build><item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 0 50"/></build></model>)",
      unit, object(1, "hull", 40), object(2, "fin", 20));
}

TEST_F(Formats, ThreeMfSaysItsUnit) {
  for (const auto& [unit, mm] : {std::pair{"unit=\"inch\"", 25.4}, {"unit='centimeter'", 10.0}, {"", 1.0}}) {
    EXPECT_NEAR(area(read_body(package("m.3mf", model_3mf(unit)))), 1000.0 * mm * mm, 1e-3 * mm * mm) << unit;
  }
  EXPECT_TRUE(read_mesh(package("m.3mf", model_3mf(""))).report.unit_from_file);
  // A part of 1.9 m is asked about, also if the file states its unit; who confirms it gets it.
  const fs::path large = package("m.3mf", model_3mf("unit=\"inch\""));
  EXPECT_THROW((void)read_mesh(large), InputError);
  EXPECT_DOUBLE_EQ(read_mesh(large, LengthUnit::kInch).report.scale_to_mm, 25.4);
}

TEST_F(Formats, OneObjectOfA3mf) {
  const fs::path path = package("n.3mf", model_3mf("unit=\"centimeter\""));
  EXPECT_NEAR(area(read_mesh(path, {}, "fin").mesh), 20000.0, 0.1);
  EXPECT_THROW((void)read_mesh(path, {}, "wing"), InputError);
}

// The fin is turned by 90° about z and moved by 100 cm in x, in an assembly that is moved by 7 in z; nothing else is
// shown.
TEST_F(Formats, ComponentsOfA3mfLieWhereTheirTransformsSay) {
  std::string model = model_3mf("unit=\"centimeter\"");
  const std::string assembly =
      R"(<object id="9" name="boat"><components><component objectid="2" transform="0 1 0 -1 0 0 0 0 1 100 0 0"/>)"
      R"(</components></object></resources><build><item objectid="9" transform="1 0 0 0 1 0 0 0 1 0 0 7"/></build>)";
  model.replace(model.find("</resources>"), model.find("</model>") - model.find("</resources>"), assembly);
  const Mesh m = read_mesh(package("c.3mf", model)).mesh;
  ASSERT_EQ(m.faces.size(), 1U);
  const auto corner = [&](std::size_t k) { return m.vertices[static_cast<std::size_t>(m.faces[0][k])]; };
  EXPECT_EQ(corner(0), Vec3(1000, 0, 70));
  EXPECT_EQ(corner(1), Vec3(1000, 200, 70));
  EXPECT_EQ(corner(2), Vec3(800, 0, 70));
  EXPECT_EQ(read_mesh(package("c.3mf", model), {}, "fin").mesh.faces.size(), 1U);
  model.replace(model.find("objectid=\"2\""), 12, "objectid=\"9\"");
  EXPECT_THROW((void)read_mesh(package("c.3mf", model)), InputError);
}

// The triangle has legs of 0.1 m.
TEST_F(Formats, GltfAndGlbAreInMetres) {
  const std::array<float, 9> corners{0, 0, 0, 0.1F, 0, 0, 0, 0.1F, 0};
  const std::string raw(reinterpret_cast<const char*>(corners.data()), sizeof(corners));
  const auto scene = [](const std::string& uri) {
    return fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"name":"sole"}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0.1,0.1,0]}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36{}}}]}})",
        uri);
  };
  const std::string base64 = "AAAAAAAAAAAAAAAAzczMPQAAAAAAAAAAAAAAAM3MzD0AAAAA";  // The text encodes `raw`.
  std::string json = scene("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  const auto put = [&](std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    glb.append(reinterpret_cast<const char*>(&word), 4);
  };
  put(2);
  put(12 + 8 + json.size() + 8 + raw.size());
  put(json.size());
  glb += "JSON" + json;
  put(raw.size());
  glb += std::string("BIN\0", 4) + raw;
  for (const fs::path& path :
       {file("t.gltf", scene(",\"uri\":\"data:application/octet-stream;base64," + base64 + '"')), file("t.glb", glb)}) {
    const MeshFile read = read_mesh(path, {}, "sole");
    EXPECT_TRUE(read.report.unit_from_file);
    EXPECT_NEAR(area(read.mesh), 5000.0, 1e-2);
    EXPECT_THROW((void)read_mesh(path, {}, "heel"), InputError);
    fs::remove(path);
  }
}

const char* const kTwoObjects =
    "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 40\no front plate\nf 1 2 3\no rib\ng web thin\nf 1 2 4\n";

TEST_F(Formats, OneObjectOfAnObj) {
  EXPECT_NEAR(area(read_mesh(file("j.obj", kTwoObjects), {}, "front plate").mesh), 5000.0, 1e-9);
  EXPECT_NEAR(area(read_mesh(file("j.obj", kTwoObjects), {}, "rib").mesh), 2000.0, 1e-9);
  EXPECT_NEAR(area(read_mesh(file("j.obj", kTwoObjects), {}, "thin").mesh), 2000.0, 1e-9);
  EXPECT_NE(error_of("j.obj", kTwoObjects, {}, "lid").find("front plate"), std::string::npos);
}

TEST_F(Formats, AFormatWithoutNamesSaysSo) {
  const std::string error = error_of("k.off", "OFF\n3 1 0\n0 0 0\n90 0 0\n0 90 0\n3 0 1 2\n", {}, "lid");
  EXPECT_NE(error.find("no named objects"), std::string::npos) << error;
}

TEST_F(Formats, OneSolidOfATextStl) {
  const auto solid = [](const char* name, int size) {
    return fmt::format(
        "solid {0}\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex {1} 0 0\nvertex 0 {1} 0\nendloop\nendfacet\n"
        "endsolid {0}\n",
        name, size);
  };
  const std::string bytes = solid("left shin", 100) + solid("right shin", 60);
  EXPECT_NEAR(area(read_mesh(file("s.stl", bytes), {}, "right shin").mesh), 1800.0, 1e-9);
  EXPECT_NE(error_of("s.stl", bytes, {}, "knee").find("left shin, right shin"), std::string::npos);
}

// The text has capitals, a byte order mark, no "solid" and no end.
TEST_F(Formats, TextStlWithAWrongHeadIsRead) {
  const Mesh m = read_mesh(file("v.stl",
                                "\xEF\xBB\xBF"
                                "FACET NORMAL 0 0 1\n OUTER LOOP\n  VERTEX 0 0 0\n  VERTEX 100 0 0\n  VERTEX 0 100 0\n"
                                " ENDLOOP\nENDFACET\n"))
                     .mesh;
  EXPECT_NEAR(area(m), 5000.0, 1e-9);
}

TEST_F(Formats, BinaryStlThatEndsInAFacetIsRefused) {
  const std::string bytes = binary_stl("x", 2, kSquare);
  EXPECT_NE(error_of("x.stl", bytes.substr(0, bytes.size() - 20)).find("1 of 2 triangles"), std::string::npos);
}

TEST_F(Formats, PlyStripsAreTriangles) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n100 0 0\n0 100 0\n100 100 0\n8 0 1 2 3 -1 3 2 0\n";
  const Mesh m = read_mesh(file("y.ply", text)).mesh;
  ASSERT_EQ(m.faces.size(), 3U);
  EXPECT_EQ(m.faces[0], (std::array{0, 1, 2}));
  EXPECT_EQ(m.faces[1], (std::array{1, 3, 2}));  // The orientation is that of the first, seen from above.
  EXPECT_EQ(m.faces[2], (std::array{3, 2, 0}));
}

TEST_F(Formats, NumbersThatAreNoneAreNamed) {
  for (const char* bad : {"nan", "inf", "-inf", "1e400"}) {
    const std::string v = fmt::format("v 0 0 0\nv 100 {} 0\nv 0 100 0\nf 1 2 3\n", bad);
    EXPECT_NE(error_of("z.obj", v), "") << bad;
  }
  EXPECT_NE(error_of("z.obj", "v 0 0 0\nv 100 nan 0\nv 0 100 0\nf 1 2 3\n").find("vertex 1"), std::string::npos);
  auto facets = kSquare;
  facets[1][4] = std::numeric_limits<float>::infinity();
  EXPECT_NE(error_of("z.stl", binary_stl("x", 2, facets)).find("vertex 4"), std::string::npos);
}

// A vertex without a face lies 10 km off; it used to merge all others, which lie within 1e-7 of that size.
TEST_F(Formats, AVertexWithoutAFaceDoesNotTellTheSize) {
  const std::string text = "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0.3 0 0.5\nv 1e7 1e7 1e7\nf 1 2 3\nf 4 2 3\n";
  const MeshFile read = read_mesh(file("far.obj", text));
  EXPECT_EQ(read.mesh.vertices.size(), 4U);
  EXPECT_EQ(read.report.welded_vertices, 0);
}

}  // namespace
}  // namespace triskin::mesh
