// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the inputs of real users, kind by kind (docs/measurements/robustness.md): one open quarter pipe in many
// formats. Its area, its number of faces and the side to which its faces point are known, so that a reader cannot be
// wrong silently.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "support/packed_model.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/open_side.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kAcross = 8, kAlong = 6;

// The pipe lies around y, open towards -z; its faces point away from the axis.
Mesh quarter_pipe(double scale = 1.0) {
  Mesh mesh;
  for (int j = 0; j <= kAlong; ++j) {
    for (int i = 0; i <= kAcross; ++i) {
      const double angle = std::numbers::pi * (0.75 - 0.5 * i / kAcross);
      mesh.vertices.emplace_back(scale * 60.0 * std::cos(angle), scale * 15.0 * j, scale * 60.0 * std::sin(angle));
    }
  }
  const auto at = [](int i, int j) { return j * (kAcross + 1) + i; };
  for (int j = 0; j < kAlong; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}
constexpr std::size_t kFaces = 2 * kAcross * kAlong;

std::string obj_of(const Mesh& mesh, const std::string& end = "\n") {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}{}", v.x(), v.y(), v.z(), end);
  for (const auto& f : mesh.faces) text += fmt::format("f {} {} {}{}", f[0] + 1, f[1] + 1, f[2] + 1, end);
  return text;
}

std::string off_of(const Mesh& mesh, const std::string& head, double w, const std::string& end) {
  std::string text = head + end + fmt::format("{} {} 0{}", mesh.vertices.size(), mesh.faces.size(), end);
  for (const Vec3& v : mesh.vertices) {
    text += fmt::format("{} {} {}", w * v.x(), w * v.y(), w * v.z());
    text += (head == "4OFF" ? fmt::format(" {}", w) : "") + end;
  }
  for (const auto& f : mesh.faces) text += fmt::format("3 {} {} {}{}", f[0], f[1], f[2], end);
  return text;
}

std::string stl_of(const Mesh& mesh, const std::string& end = "\n") {
  std::string text = "solid x" + end;
  for (const auto& f : mesh.faces) {
    text += "facet normal 0 0 0" + end + "outer loop" + end;
    for (const int v : f) {
      const Vec3& p = mesh.vertices[static_cast<std::size_t>(v)];
      text += fmt::format("vertex {} {} {}{}", p.x(), p.y(), p.z(), end);
    }
    text += "endloop" + end + "endfacet" + end;
  }
  return text + "endsolid x" + end;
}

std::string ply_of(const Mesh& mesh, const std::string& end = "\n") {
  std::string text = "ply" + end + "format ascii 1.0" + end + fmt::format("element vertex {}", mesh.vertices.size());
  for (const char* axis : {"x", "y", "z"}) text += end + "property double " + axis;
  text += end + fmt::format("element face {}", mesh.faces.size()) + end;
  text += "property list uchar int vertex_indices" + end + "end_header" + end;
  for (const Vec3& v : mesh.vertices) text += fmt::format("{} {} {}{}", v.x(), v.y(), v.z(), end);
  for (const auto& f : mesh.faces) text += fmt::format("3 {} {} {}{}", f[0], f[1], f[2], end);
  return text;
}

template <class Value>
void put(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

// The buffer has floats, then indices of two bytes.
std::string buffer_of(const Mesh& mesh) {
  std::string bytes;
  for (const Vec3& v : mesh.vertices)
    for (const double c : v) put(bytes, static_cast<float>(c));
  for (const auto& f : mesh.faces)
    for (const int v : f) put(bytes, static_cast<std::uint16_t>(v));
  return bytes;
}

// Makes a glTF whose one node contains `node`; `more` is at the top level.
std::string gltf_of(const Mesh& mesh, const std::string& uri, const std::string& node, const std::string& more = "") {
  const std::size_t n = mesh.vertices.size(), positions = 12 * n, indices = 6 * mesh.faces.size();
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},{6}"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{0}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{1},"type":"VEC3"}},
{{"bufferView":1,"componentType":5123,"count":{2},"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":{3}}},{{"buffer":0,"byteOffset":{3},"byteLength":{4}}}],
"buffers":[{{"byteLength":{5},"uri":"{7}"}}]}})",
      node, n, 3 * mesh.faces.size(), positions, indices, positions + indices, more, uri);
}

std::string model_of(const Mesh& mesh, const std::string& prefix, const std::string& item,
                     const std::string& attributes = "", const std::string& type = "model") {
  const std::string p = prefix.empty() ? "" : prefix + ":", declared = prefix.empty() ? "" : ":" + prefix;
  std::string text = fmt::format(R"(<?xml version="1.0"?><{0}model unit="millimeter" xmlns{1}=)"
                                 R"("http://schemas.microsoft.com/3dmanufacturing/core/2015/02" {2}>)"
                                 R"(<{0}resources><{0}object id="1" type="{3}"><{0}mesh><{0}vertices>)",
                                 p, declared, attributes, type);
  for (const Vec3& v : mesh.vertices)
    text += fmt::format(R"(<{}vertex x="{}" y="{}" z="{}"/>)", p, v.x(), v.y(), v.z());
  text += fmt::format("</{0}vertices><{0}triangles>", p);
  for (const auto& f : mesh.faces) text += fmt::format(R"(<{}triangle v1="{}" v2="{}" v3="{}"/>)", p, f[0], f[1], f[2]);
  return text + fmt::format("</{0}triangles></{0}mesh></{0}object></{0}resources><{0}build>{1}</{0}build></{0}model>",
                            p, item);
}

// Makes a COLLADA file in mm with one node, which contains `transform`.
std::string dae_of(const Mesh& mesh, const std::string& up_axis, const std::string& transform = "") {
  std::string points, corners;
  for (const Vec3& v : mesh.vertices) points += fmt::format("{} {} {} ", v.x(), v.y(), v.z());
  for (const auto& f : mesh.faces) corners += fmt::format("{} {} {} ", f[0], f[1], f[2]);
  return fmt::format(
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>{0}</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="{1}">{2}</float_array><technique_common><accessor source="#a" count="{3}"
stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="{4}"><input semantic="VERTEX" source="#v" offset="0"/><p>{5}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="w"><node id="n">{6}<instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)",
      up_axis, 3 * mesh.vertices.size(), points, mesh.vertices.size(), mesh.faces.size(), corners, transform);
}

class Inputs : public ::testing::Test {
 protected:
  Inputs() : folder_(fs::temp_directory_path() / fmt::format("inputs.{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~Inputs() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  fs::path package(const std::string& name, const std::string& model) {
    test::write_packed_model(folder_ / name, model);
    return folder_ / name;
  }
  static std::string error_of(const fs::path& path, std::optional<LengthUnit> unit = {}) {
    try {
      (void)read_mesh(path, unit);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  }
  // Expects the pipe: all of its faces, their area, and the side to which they face.
  static void expect_pipe(const fs::path& path, double area_of_scale = 1.0, std::optional<LengthUnit> unit = {}) {
    SCOPED_TRACE(path.filename().string());
    MeshFile read;
    ASSERT_NO_THROW(read = read_mesh(path, unit)) << error_of(path, unit);
    EXPECT_EQ(read.mesh.faces.size(), kFaces);
    const double area = Surface(quarter_pipe()).area_mm2();
    EXPECT_NEAR(Surface(read.mesh).area_mm2(), area_of_scale * area, 1e-4 * area);
    EXPECT_GT(open_side_of(read.mesh).normal.z(), 0.8) << "its faces look inward";
  }

  fs::path folder_;
  const Mesh pipe_ = quarter_pipe();
};

TEST_F(Inputs, a_mirrored_node_or_item_turns_its_faces) {
  const Mesh metres = quarter_pipe(1e-3);
  (void)file("pipe.bin", buffer_of(metres));
  for (const char* node : {"", R"(,"scale":[-1,1,1])", R"(,"scale":[-1,-1,1])", R"(,"scale":[1,-1,1])",
                           R"(,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])", R"(,"rotation":[0,0,1,0])"})
    expect_pipe(file("mirror.gltf", gltf_of(metres, "pipe.bin", node)));
  for (const char* item : {R"(<item objectid="1"/>)", R"(<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>)",
                           R"(<item objectid="1" transform="-1 0 0 0 -1 0 0 0 1 500 0 0"/>)"})
    expect_pipe(package("mirror.3mf", model_of(pipe_, "", item)));
  Mesh reversed = pipe_;
  turn_over(reversed);
  EXPECT_EQ(open_side_of(reversed).toward_middle, 1.0);
  EXPECT_LT(open_side_of(reversed).normal.z(), -0.8);
  EXPECT_TRUE(open_side_of(pipe_).is_open);
}

// RViz and MoveIt turn nothing, whichever axis the file calls up.
TEST_F(Inputs, collada_keeps_the_numbers_of_the_file) {
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"}) {
    const fs::path path = file(fmt::format("{}.dae", up), dae_of(pipe_, up));
    expect_pipe(path);
    const Mesh read = read_mesh(path).mesh;
    for (std::size_t f = 0; f < read.faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& is = read.vertices[static_cast<std::size_t>(read.faces[f][k])];
        const Vec3& wanted = pipe_.vertices[static_cast<std::size_t>(pipe_.faces[f][k])];
        // The library stores single precision, so 60 mm have 24 bits.
        EXPECT_LT((is - wanted).norm(), 1e-5) << up << ", face " << f;
      }
    }
  }
}
TEST_F(Inputs, a_mirrored_collada_node_turns_its_faces) {
  expect_pipe(file("mirrored.dae", dae_of(pipe_, "Z_UP", "<scale>-1 1 1</scale>")));
  expect_pipe(file("twice.dae", dae_of(pipe_, "Z_UP", "<scale>-1 -1 1</scale>")));
  const MeshFile moved = read_mesh(file("moved.dae", dae_of(pipe_, "Y_UP", "<translate>5 0 0</translate>")));
  EXPECT_NEAR(moved.mesh.vertices[0].x(), pipe_.vertices[0].x() + 5.0, 1e-5);
}

TEST_F(Inputs, line_ends_marks_and_notations_of_numbers) {
  for (const std::string end : {"\n", "\r", "\r\n"}) {
    expect_pipe(file("ends.obj", obj_of(pipe_, end)));
    expect_pipe(file("ends.stl", stl_of(pipe_, end)));
    expect_pipe(file("ends.off", off_of(pipe_, "OFF", 1.0, end)));
    expect_pipe(file("ends.ply", ply_of(pipe_, end)));
  }
  expect_pipe(file("mark.obj", "\xEF\xBB\xBF" + obj_of(pipe_)));
  expect_pipe(file("free.off", off_of(pipe_, "OFF", 1.0, " ")));
  expect_pipe(file("free.stl", stl_of(pipe_, " ")));
  expect_pipe(file("four.off", off_of(pipe_, "4OFF", 2.0, "\n")));
  const Mesh fortran = read_mesh(file("d.obj", "v 0 0 1.5D+02\nv 1d2 0 0\nv 0 +1E2 0\nf 1 2 3\n")).mesh;
  EXPECT_EQ(fortran.vertices[0].z(), 150.0);
}

TEST_F(Inputs, text_in_utf16_is_read) {
  std::string utf16 = "\xFF\xFE";
  for (const char c : obj_of(pipe_)) utf16 += std::string{c, '\0'};
  expect_pipe(file("little.obj", utf16));
  std::string big;
  for (const char c : stl_of(pipe_)) big += std::string{'\0', c};
  expect_pipe(file("big.stl", big));
}

TEST_F(Inputs, decimal_commas_are_named) {
  for (const auto& [name, bytes] : std::map<std::string, std::string>{
           {"a.obj", "v 1,5 2,5 3,5\n"},
           {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 1,5 2,5 3,5\n"},
           {"a.off", "OFF\n3 1 0\n1,5 2,5 3,5\n"},
           {"a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n1,5 2,5 3,5\n"}})
    EXPECT_THAT(error_of(file(name, bytes)), HasSubstr("decimal commas")) << name;
}

TEST_F(Inputs, what_is_no_mesh_is_called_what_it_is) {
  const std::vector<std::pair<std::string, std::string>> contents{
      {"version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "git lfs pull"},
      {"\x1F\x8B\x08 packed", "gzip"},
      {"<!DOCTYPE html><html><body>404</body></html>", "HTML"},
      {"<?xml version='1.0'?><robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:macro/></robot>",
       "xacro"},
      {"<robot name='r'/>", "URDF"},
      {"<sdf version='1.7'/>", "SDF"},
      {"<svg xmlns='http://www.w3.org/2000/svg'/>", "SVG"},
      {"ISO-10303-21;\nHEADER;", "it was cut"},
      {"%PDF-1.7", "PDF"},
      {"\x89PNG\r\n\x1A\n", "PNG"},
      {"{\"type\":\"Polygon\",\"coordinates\":[]}", "GeoJSON"},
      {"{\"format\":\"triskin-design\"}", "design of Triskin"},
      {"BLENDER-v300", "Blender"},
      {"# vtk DataFile Version 3.0\n", "VTK"},
      {"<<<<<<< HEAD\nv 0 0 0\n", "conflict"},
      {"\x7F"
       "ELF\x02",
       "program"}};
  for (const auto& [bytes, what] : contents) {
    for (const char* name : {"x.obj", "x.stl", "x.ply", "x.dae", "x"})
      EXPECT_THAT(error_of(file(name, bytes)), HasSubstr(what)) << name;
  }
  EXPECT_THAT(error_of(file("x.obj", "no mesh at all\n")), Not(HasSubstr("json")));
}

TEST_F(Inputs, the_content_says_the_format_and_a_wrong_name_is_said) {
  for (const auto& [name, bytes] : std::map<std::string, std::string>{{"a.stl", obj_of(pipe_)},
                                                                      {"b.obj", stl_of(pipe_)},
                                                                      {"c.dae", ply_of(pipe_)},
                                                                      {"d.obj", off_of(pipe_, "OFF", 1.0, "\n")}}) {
    const fs::path path = file(name, bytes);
    expect_pipe(path);
    ASSERT_EQ(read_mesh(path).report.notes.size(), 1U) << name;
    EXPECT_THAT(read_mesh(path).report.notes[0], HasSubstr("although its name says"));
  }
  expect_pipe(file("no_extension", ply_of(pipe_)));
}

TEST_F(Inputs, three_mf_by_its_rules) {
  const std::string item = R"(<item objectid="1"/>)";
  expect_pipe(package("plain.3mf", model_of(pipe_, "", item)));
  expect_pipe(package("prefix.3mf", model_of(pipe_, "m", R"(<m:item objectid="1"/>)")));
  expect_pipe(
      package("comment.3mf",
              model_of(pipe_, "", item + R"(<!-- <item objectid="1" transform="1 0 0 0 1 0 0 0 1 900 0 0"/> -->)")));
  expect_pipe(package("surface.3mf", model_of(pipe_, "", item, "", "surface")));
  expect_pipe(package(
      "material.3mf",
      model_of(pipe_, "", item,
               R"(xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" requiredextensions="m")")));
  EXPECT_THAT(error_of(package("support.3mf", model_of(pipe_, "", item, "", "support"))), HasSubstr("no triangle"));
  EXPECT_THAT(
      error_of(package("beam.3mf", model_of(pipe_, "", item, R"(xmlns:b="http://x.org/beam" requiredextensions="b")"))),
      HasSubstr("http://x.org/beam"));
  EXPECT_THAT(error_of(package("empty.3mf", model_of(pipe_, "", ""))), HasSubstr("build has no items"));
  EXPECT_THAT(
      error_of(package("eleven.3mf", model_of(pipe_, "", R"(<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0"/>)"))),
      HasSubstr("11 numbers"));
  const std::string cut = model_of(pipe_, "", item);
  const std::string error = error_of(package("cut.3mf", cut.substr(0, cut.size() / 2)));
  EXPECT_THAT(error, HasSubstr("it was cut"));
}

TEST_F(Inputs, gltf_by_its_rules) {
  const Mesh metres = quarter_pipe(1e-3);
  (void)file("a b.bin", buffer_of(metres));
  expect_pipe(file("percent.gltf", gltf_of(metres, "a%20b.bin", "")));
  const auto required = [](const char* name) {
    return fmt::format(R"("extensionsUsed":["{0}"],"extensionsRequired":["{0}"],)", name);
  };
  expect_pipe(file("unlit.gltf", gltf_of(metres, "a%20b.bin", "", required("KHR_materials_unlit"))));
  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_new_thing"})
    EXPECT_THAT(error_of(file("required.gltf", gltf_of(metres, "a%20b.bin", "", required(name)))), HasSubstr(name));
  EXPECT_THAT(error_of(file("missing.gltf", gltf_of(metres, "none.bin", ""))), HasSubstr("none.bin"));
  (void)file("short.bin", buffer_of(metres).substr(0, 500));
  EXPECT_THAT(error_of(file("short.gltf", gltf_of(metres, "short.bin", ""))), HasSubstr("was cut"));
  EXPECT_THAT(error_of(file("json.gltf", gltf_of(metres, "a%20b.bin", "").substr(0, 300))),
              Not(HasSubstr("json.exception")));
}

TEST_F(Inputs, quantized_positions_are_read) {
  std::string bytes;
  for (const Vec3& v : pipe_.vertices) {
    for (const double c : v) put(bytes, static_cast<std::int16_t>(std::lround(c * 100.0)));
    put(bytes, std::int16_t{0});
  }
  const std::size_t positions = bytes.size();
  for (const auto& f : pipe_.faces)
    for (const int v : f) put(bytes, static_cast<std::uint16_t>(v));
  (void)file("q.bin", bytes);
  const std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_mesh_quantization"],
"extensionsRequired":["KHR_mesh_quantization"],
"nodes":[{{"mesh":0,"scale":[1e-5,1e-5,1e-5]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5122,"count":{0},"type":"VEC3"}},
{{"bufferView":1,"componentType":5123,"count":{1},"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":{2},"byteStride":8}},{{"buffer":0,"byteOffset":{2},"byteLength":{3}}}],
"buffers":[{{"byteLength":{4},"uri":"q.bin"}}]}})",
      pipe_.vertices.size(), 3 * pipe_.faces.size(), positions, bytes.size() - positions, bytes.size());
  const MeshFile read = read_mesh(file("q.gltf", json));
  EXPECT_EQ(read.mesh.faces.size(), kFaces);
  EXPECT_NEAR(Surface(read.mesh).area_mm2(), Surface(pipe_).area_mm2(), 1.0);
}

TEST_F(Inputs, what_is_read_in_part_or_flattened_is_said) {
  const auto notes_of = [](const fs::path& path) {
    return fmt::format("{}", fmt::join(read_mesh(path).report.notes, "; "));
  };
  (void)file("pipe.bin", buffer_of(quarter_pipe(1e-3)));
  const auto gltf = gltf_of(quarter_pipe(1e-3), "pipe.bin", R"(,"scale":[1,1,0])");
  EXPECT_THAT(notes_of(file("flat.gltf", gltf)), HasSubstr("1 of its shown meshes are flattened by a scale of 0"));
  const std::string item = R"(<item objectid="1" transform="1 0 0 0 1 0 0 0 0 0 0 0"/>)";
  EXPECT_THAT(notes_of(package("flat.3mf", model_of(pipe_, "", item))), HasSubstr("flattened by a scale of 0"));
  std::string weighted, plain, coloured;
  for (const Vec3& v : pipe_.vertices) {
    weighted += fmt::format("v {} {} {} 2\n", v.x(), v.y(), v.z());
    plain += fmt::format("v {} {} {} 1.0\n", v.x(), v.y(), v.z());
    coloured += fmt::format("v {} {} {} 0.5 0.5 0.2\n", v.x(), v.y(), v.z());
  }
  std::string faces;
  for (const auto& f : pipe_.faces) faces += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  EXPECT_THAT(notes_of(file("weighted.obj", weighted + faces)), HasSubstr("63 vertices have a weight other than 1"));
  EXPECT_EQ(notes_of(file("plain.obj", plain + faces)), "");
  EXPECT_EQ(notes_of(file("coloured.obj", coloured + faces)), "");
}

TEST_F(Inputs, collada_that_the_library_cannot_follow_is_refused_by_name) {
  EXPECT_THAT(error_of(file("skew.dae", dae_of(pipe_, "Z_UP", "<skew>30 1 0 0 0 1 0</skew>"))), HasSubstr("skew"));
  const std::string self = R"(<instance_node url="#n"/>)";
  EXPECT_THAT(error_of(file("self.dae", dae_of(pipe_, "Z_UP", self))), HasSubstr("\"n\" is an instance of itself"));
  for (const char* unit : {"0", "-0.001", "abc", "inf", ""}) {
    std::string text = dae_of(pipe_, "Z_UP");
    text.replace(text.find("0.001"), 5, unit);
    EXPECT_THAT(error_of(file("unit.dae", text)), HasSubstr(fmt::format("its unit is \"{}\" metres", unit)));
  }
}

TEST_F(Inputs, inches_are_offered_where_they_fit_and_read) {
  const fs::path path = file("inch.obj", obj_of(quarter_pipe(1.0 / 25.4)));
  EXPECT_THAT(error_of(path), HasSubstr("--unit in"));
  EXPECT_THAT(error_of(path), Not(HasSubstr("feet")));
  expect_pipe(path, 1.0, LengthUnit::kInch);
  EXPECT_THAT(error_of(file("small.obj", obj_of(quarter_pipe(1e-3)))), HasSubstr("--unit m"));
}

TEST_F(Inputs, coordinates_are_bounded) {
  Mesh far = pipe_;
  for (Vec3& v : far.vertices) v += Vec3(4.5e9, 0, 0);
  EXPECT_EQ(read_mesh(file("far.obj", obj_of(far))).mesh.faces.size(), kFaces);
  for (Vec3& v : far.vertices) v += Vec3(1e12, 0, 0);
  EXPECT_THAT(error_of(file("farther.obj", obj_of(far))), HasSubstr("10,000 km"));
}

// A file that is cut at any byte, in any format, is refused, gives a note, or gives the same mesh.
TEST_F(Inputs, a_cut_at_any_byte_is_never_silent) {
  const Mesh m{{{0, 0, 0}, {100, 0, 0}, {100, 100, 7}, {0, 100, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Mesh metres{{{0, 0, 0}, {.1, 0, 0}, {.1, .1, .007}, {0, .1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  (void)file("cut.bin", buffer_of(metres));
  std::map<std::string, std::string> files{{"c.obj", obj_of(m)},
                                           {"c.stl", stl_of(m)},
                                           {"c.off", off_of(m, "OFF", 1.0, "\n")},
                                           {"c.ply", ply_of(m)},
                                           {"c.gltf", gltf_of(metres, "cut.bin", "")}};
  for (const auto& [name, whole] : files) {
    const Mesh right = read_mesh(file(name, whole)).mesh;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const fs::path path = file(name, whole.substr(0, size));
      try {
        const MeshFile read = read_mesh(path);
        const bool is_same = read.mesh.vertices == right.vertices && read.mesh.faces == right.faces;
        ASSERT_TRUE(is_same || !read.report.notes.empty() || (name == "c.obj" && whole[size - 1] == '\n'))
            << name << " cut at byte " << size << " is read without a word";
      } catch (const InputError& e) {
        ASSERT_THAT(e.what(), Not(HasSubstr("exception"))) << name;
      }
    }
  }
}

// Numbers are changed in a text: whatever is read, nothing crashes, and no message of a library is shown.
TEST_F(Inputs, changed_bytes_are_read_or_refused) {
  std::mt19937_64 random(37);
  const Mesh m{{{0, 0, 0}, {100, 0, 0}, {100, 100, 7}, {0, 100, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const std::string with = "0123456789.,-+eE \n\r\t/#x<>\"{}[]\0\xFF";
  for (const auto& [name, whole] : std::map<std::string, std::string>{
           {"m.obj", obj_of(m)}, {"m.stl", stl_of(m)}, {"m.off", off_of(m, "OFF", 1.0, "\n")}, {"m.ply", ply_of(m)}}) {
    for (int trial = 0; trial < 300; ++trial) {
      std::string bytes = whole;
      for (int k = 0; k <= trial % 3; ++k) bytes[random() % bytes.size()] = with[random() % with.size()];
      const std::string error = error_of(file(name, bytes));
      ASSERT_THAT(error, Not(HasSubstr("exception"))) << bytes;
    }
  }
}

TEST_F(Inputs, a_mesh_is_written_as_its_name_says) {
  write_mesh(folder_ / "out.stl", pipe_);
  expect_pipe(folder_ / "out.stl");
  write_mesh(folder_ / "out.obj", pipe_);
  expect_pipe(folder_ / "out.obj");
  EXPECT_THROW(write_mesh(folder_ / "out.3mf", pipe_), InputError);
  EXPECT_FALSE(fs::exists(folder_ / "out.3mf"));
}

}  // namespace
}  // namespace triskin::mesh
