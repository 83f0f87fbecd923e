// SPDX-License-Identifier: GPL-3.0-or-later
// These tests remove or add records in mesh files, so that the file's own counts no longer match.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "triskin/base/error.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::mesh {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The two triangles have sides of 100 mm. The tests change the contents of the lists.
struct Collada {
  std::string values = "0 0 0 100 0 0 100 100 7 0 100 0", value_count = "12", corners = "0 1 2 0 2 3", count = "2";
  std::string primitive = "triangles", before_corners, offset = "0";
};

std::string text_of(const Collada& c) {
  return fmt::format(
      R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="{}">
{}
</float_array><technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<{} count="{}"><input semantic="VERTEX" source="#v" offset="{}"/>{}<p>
{}
</p></{}></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="w"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>)",
      c.value_count, c.values, c.primitive, c.count, c.offset, c.before_corners, c.corners, c.primitive);
}

class LostRecords : public ::testing::Test {
 protected:
  LostRecords() : folder_(fs::temp_directory_path() / fmt::format("lost_records.{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~LostRecords() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string error_of(const Collada& collada) {
    try {
      (void)read_mesh(file("a.dae", text_of(collada)));
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  }
  fs::path folder_;
};

TEST_F(LostRecords, collada_that_is_whole_is_read_without_a_word) {
  EXPECT_EQ(error_of({}), "");
  const MeshFile read = read_mesh(file("a.dae", text_of({})));
  EXPECT_EQ(read.mesh.faces.size(), 2U);
  EXPECT_THAT(read.report.notes, IsEmpty());
  Collada polygons;
  polygons.primitive = "polylist";
  polygons.count = "1";
  polygons.before_corners = "<vcount>4</vcount>";
  polygons.corners = "0 1 2 3";
  EXPECT_EQ(error_of(polygons), "");
}

TEST_F(LostRecords, a_coordinate_that_is_missing_or_none_is_refused_with_its_line) {
  Collada c;
  c.values = "0 0 0 100 0 100 100 7 0 100 0";
  EXPECT_THAT(error_of(c), HasSubstr("a.dae, line 4: an array of 12 numbers holds 11"));
  c.values = "0 0 0 100 0 0 100 100 7 0 100 0 5";
  EXPECT_THAT(error_of(c), HasSubstr("holds 13"));
  c.values = "0 0 0 100,5 0 0 100 100 7 0 100 0";
  EXPECT_THAT(error_of(c), HasSubstr("decimal commas"));
  c.values = "0 0 0 0x10 0 0 100 100 7 0 100 0";
  EXPECT_THAT(error_of(c), HasSubstr("\"0x10\" is no number"));
}

TEST_F(LostRecords, corners_and_triangles_that_are_missing_are_refused) {
  Collada c;
  c.corners = "0 1 2 0 2";
  EXPECT_THAT(error_of(c), HasSubstr("5 indices are no whole number of triangles"));
  c.corners = "0 1 2 0 2 -3";
  EXPECT_THAT(error_of(c), HasSubstr("\"-3\" in a list of corners is no index"));
  c.corners = "0 1 2";
  EXPECT_THAT(error_of(c), HasSubstr("a list of 2 triangles holds 1"));
  c.corners = "0 1 2 0 2 3 1 2 3";
  EXPECT_THAT(error_of(c), HasSubstr("a list of 2 triangles holds 3"));
}

TEST_F(LostRecords, polygons_have_the_corners_that_they_say) {
  Collada c;
  c.primitive = "polylist";
  c.count = "2";
  c.before_corners = "<vcount>3 3</vcount>";
  c.corners = "0 1 2 0 2";
  EXPECT_THAT(error_of(c), HasSubstr("polygons with 6 corners have 5 indices, not 6"));
  c.before_corners = "<vcount>3</vcount>";
  EXPECT_THAT(error_of(c), HasSubstr("a list of 2 polygons has the corners of 1"));
}

// Zeroed records of a binary STL read as triangles without an area, in place of triangles that were lost.
TEST_F(LostRecords, triangles_without_area_and_doubled_ones_are_said) {
  const std::string vertices = "v 0 0 0\nv 100 0 0\nv 100 100 5\nv 0 100 0\n";
  const MeshFile flat = read_mesh(file("a.obj", vertices + "f 1 2 3\nf 1 3 4\nf 1 1 2\n"));
  EXPECT_THAT(flat.report.notes, ElementsAre("1 of 3 triangles have no area and were left out"));
  const MeshFile twice = read_mesh(file("b.obj", vertices + "f 1 2 3\nf 1 3 4\nf 2 3 1\n"));
  EXPECT_THAT(twice.report.notes, ElementsAre("1 of 3 triangles are there more than once and count once"));
}

TEST_F(LostRecords, a_mesh_without_a_triangle_is_refused_with_what_was_left_out) {
  const std::string vertices = "v 0 0 0\nv 100 0 0\nv 100 100 5\nv 0 100 0\n";
  const auto path = file("surface.obj", vertices + "cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nend\n");
  try {
    (void)read_mesh(path);
    FAIL() << "a file without a triangle was read";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("no triangle with an area in it; 1 free-form curves and surfaces were left out"));
  }
}

}  // namespace
}  // namespace triskin::mesh
