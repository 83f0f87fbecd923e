// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/file_kind.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace triskin {
namespace {

using namespace std::string_literals;

// An archive with one empty file, byte by byte (APPNOTE.TXT of PKWARE, 4.3): local header of 30 bytes and the name,
// entry of 46 bytes and the name, end record of 22 bytes.
std::string zip_with(const std::string& name) {
  const auto length = static_cast<char>(name.size());
  const std::string local = "PK\x03\x04"s + std::string(22, '\0') + length + "\0\0\0"s + name;
  const std::string entry = "PK\x01\x02"s + std::string(24, '\0') + length + std::string(17, '\0') + name;
  const auto start = static_cast<char>(local.size());
  return local + entry + "PK\x05\x06"s + std::string(12, '\0') + start + "\0\0\0\0\0"s;
}

TEST(FileKind, is_told_by_content) {
  const std::vector<std::pair<std::string, std::string>> kinds{
      {zip_with("cover.stl"), "a zip archive with cover.stl in it"},
      {zip_with("Document.xml"), "a FreeCAD document"},
      {zip_with("a.usdc"), "a USD scene (USDZ)"},
      {zip_with("v.npy"), "an archive of NumPy arrays"},
      {"BM\x36\0\0\0\0\0\0\0"s, "a BMP picture"},
      {"RIFF\x10\0\0\0WEBPVP8 "s, "a WebP picture"},
      {"\0\0\0\x18"
       "ftypheic"s,
       "a HEIC picture"},
      {"\0\0\0\x18"
       "ftypisom"s,
       "a video"},
      {std::string(128, '\0') + "DICM", "a medical picture (DICOM)"},
      {"*HEADING\n*NODE\n", "a mesh of finite elements (Abaqus)"},
      {"$ made by\nBEGIN BULK\nGRID,1\n", "a mesh of finite elements (Nastran)"},
      {"date Mon Jan 1 10:00:00 2024\nbase hex  timestamps absolute\n", "a log of Vector tools (ASC)"},
      {"M73 P0\nG28 ; home\n", "a program for a machine tool or a printer (G-code)"},
      {"0.0 0.0 0.0\n1.0 0.0 0.0\n", "a list of points"},
      {"t,kpa\n1,2\n", "a table of text (CSV)"},
      {"<robot name=\"r\"><group name=\"arm\"/></robot>", "an SRDF of MoveIt"},
      {"**ABCDEFGHIJKLMNOPQRSTUVWXYZabc", "a Parasolid model (text)"},
      {"PS\0\0?"s, "a Parasolid model (binary)"},
      {"Ogawa\xFF\0\1"s, "an Alembic scene"},
      {"ASTM-E57\1\0\0\0"s, "a cloud of points (E57)"},
      {"IN;SP1;PU0,0;", "a plot (HPGL)"},
      {"G04 edge*\n%FSLAX46Y46*%\n%MOMM*%\n", "a layer of a circuit board (Gerber)"},
      {"\1\0\0\0"s + std::string(36, '\0') + " EMF", "an enhanced metafile (EMF)"},
      {"\0\0\x27\x0A"s + std::string(96, '\0'), "an ESRI shapefile"},
      {"SQLite format 3\0"s + std::string(52, '\0') + "GPKG", "a map (GeoPackage)"},
      {"SQLite format 3\0"s + std::string(80, '\0'), "a database (SQLite, as bags of ROS 2 are stored)"},
      {"<kml xmlns=\"http://www.opengis.net/kml/2.2\"/>", "a map (kml)"},
      {zip_with("doc.kml"), "a map (KMZ)"},
      {R"({"type":"Topology","arcs":[]})", "a map (TopoJSON)"},
      {"@F800\n31 40 00 03\nq\n", "an image in TI-TXT"},
      // The stack ends at 0x2002'0000, the program starts at 0x0800'01C1.
      {"\0\0\2\x20\xC1\1\0\x08"s + std::string(56, '\0'), "a raw image for a microcontroller"},
      {"700 0 1 0\n16 Autodesk AutoCAD 19 ASM 225.0 1.2 NT 24\n", "an ACIS model (SAT)"},
      {"MM\x0E\0\0\0........"s, "a 3DS scene"},
      {"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", "a DXF drawing"},
      {"999\nby hand\n0\nSECTION\n2\nENTITIES\n", "a DXF drawing"},
      {"<?xml version='1.0'?>\n<!-- a --><svg:svg xmlns:svg='http://www.w3.org/2000/svg'/>", "an SVG drawing"},
      {":10010000214601360121470136007EFE09D2190140\n", "an Intel HEX file"},
      {"S00600004844521B\n", "a file of Motorola S-records"},
      {"(1700000000.000100) can0 18DA01F1#0322F190\n", "a candump log"},
      {"  can0  7DF   [8]  02 01 0C 00 00 00 00 00\n", "a candump log"},
      {"x;y;z\n1,0;2,0;3,0\n", "a table of text (CSV)"}};
  for (const auto& [bytes, what] : kinds) {
    const auto kind = file_kind(bytes);
    ASSERT_TRUE(kind) << what;
    EXPECT_EQ(kind->what, what);
  }
}

// What a command reads as a part has no kind here, and neither has what nobody knows.
TEST(FileKind, meshes_and_unknown_bytes_have_none) {
  for (const std::string& bytes :
       {"v 0 0 0\nv 1,5 2,5 3,5\n"s, "solid x\nfacet normal 0 0 1\n"s, "OFF\n3 1 0\n"s, "ply\nformat ascii 1.0\n"s,
        "PSALM 1\n"s, "3 1 0\n0 0 0\n1 0 0\n"s, "G\nM\n G1\n"s, zip_with("3D/3dmodel.model"),
        R"({"asset":{"version":"2.0"}})"s, "<COLLADA/>"s, ""s, "\1\2\3"s,
        "\0\0\2\x20\xC0\1\0\x08"s + std::string(56, '\0')})  // as an image, but the start is even
    EXPECT_FALSE(file_kind(bytes)) << bytes;
}

TEST(FileKind, ending_counts_where_the_contents_say_nothing) {
  EXPECT_EQ(not_asked_for("\1\2\3", FileUse::kMesh, "part.CATPart"),
            "a CATIA model; export the part as STEP, or as a mesh (STL, OBJ, 3MF)");
  EXPECT_EQ(not_asked_for("\1\2\3", FileUse::kOutline, "part.prt"),
            "a part of NX or Creo; export the outline as DXF or SVG");
  EXPECT_EQ(not_asked_for("v 0 0 0\n", FileUse::kMesh, "part.prt"), "");  // an OBJ all the same
  EXPECT_EQ(not_asked_for("\1\2\3", FileUse::kMesh, "part.unknown"), "");
  EXPECT_EQ(not_asked_for("%PDF-1.7", FileUse::kMesh, "part.prt").substr(0, 5), "a PDF");
}

TEST(FileKind, parts_are_named_to_those_who_asked_for_something_else) {
  const std::string iges = std::string(72, ' ') + "S      1\n";
  for (const auto& [bytes, what] : {std::pair{iges, "a part in IGES"}, std::pair{"<COLLADA/>"s, "a mesh (DAE)"},
                                    std::pair{R"({"asset":{"version":"2.0"}})"s, "a mesh (glTF)"}}) {
    EXPECT_EQ(not_asked_for(bytes, FileUse::kMesh), "");
    EXPECT_TRUE(not_asked_for(bytes, FileUse::kOutline).starts_with(what)) << what;
    EXPECT_TRUE(not_asked_for(bytes, FileUse::kRecording).starts_with(what)) << what;
  }
}

TEST(FileKind, next_step_depends_on_what_was_asked_for) {
  EXPECT_EQ(not_asked_for("#usda 1.0\n", FileUse::kMesh), "a USD scene (text); export it as OBJ, STL, 3MF or glTF");
  EXPECT_EQ(not_asked_for(zip_with("Document.xml"), FileUse::kMesh),
            "a FreeCAD document; export the part as STEP, or as a mesh (STL, OBJ, 3MF)");
  EXPECT_EQ(not_asked_for("<robot xmlns:xacro='x'><xacro:arm/></robot>", FileUse::kRobot),
            "a xacro robot description; make a URDF of it: xacro FILE > robot.urdf");
  EXPECT_EQ(not_asked_for("<robot xmlns:xacro='x'><origin xyz='0 0 ${h}'/></robot>", FileUse::kMesh),
            "a xacro robot description; give one of the meshes that it names");
  EXPECT_EQ(not_asked_for("<robot xmlns:xacro='x'><!-- <xacro:arm x='${h}'/> --></robot>", FileUse::kRobot), "")
      << "xacro keeps its namespace and comments in the URDF that it writes";
  EXPECT_EQ(not_asked_for("<robot/>", FileUse::kRobot), "");
  EXPECT_EQ(not_asked_for("\x89MCAP0\r\n", FileUse::kRecording), "");
  EXPECT_EQ(not_asked_for("<svg/>", FileUse::kOutline), "");
}

TEST(FileKind, names_of_a_damaged_archive_are_none) {
  const std::string whole = zip_with("cover.stl");
  EXPECT_EQ(names_in_zip(whole), std::vector<std::string>{"cover.stl"});
  for (std::size_t cut = 0; cut < whole.size(); ++cut) EXPECT_TRUE(names_in_zip(whole.substr(0, cut)).empty()) << cut;
}

}  // namespace
}  // namespace triskin
