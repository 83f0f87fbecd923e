// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string_view>

#include "triskin/base/file_kind.hpp"

/// How files of other programs begin and end their names, for file_kind(). Sources are the definitions of the formats;
/// where a format has none that is public, what its program writes.
namespace triskin::file_signs {

struct Sign {
  std::string_view bytes, what;
  FileUse use = FileUse::kOther;
  std::string_view remedy = {};
  std::size_t at = 0;
  // Bytes that have to be there too: at `also_at`, or for 0 anywhere among those that are looked at.
  std::string_view also = {};
  std::size_t also_at = 0;

  [[nodiscard]] bool is_of(std::string_view head) const {
    if (head.size() <= at || !head.substr(at).starts_with(bytes)) return false;
    if (also_at == 0) return head.find(also) != std::string_view::npos;
    return head.size() > also_at && head.substr(also_at).starts_with(also);
  }
};

using enum FileUse;
using namespace std::string_view_literals;  // for signatures with a byte 0

constexpr std::string_view kSegment = "make a surface of it in a program for segmentation, such as 3D Slicer";
constexpr std::string_view kToMillimetres = "convert it to GeoJSON or DXF with coordinates in mm (QGIS)";

// The first that matches counts, so special ones stand before general ones.
constexpr auto kSigns = std::to_array<Sign>({
    // Archives and compressed files.
    {"version https://git-lfs", "a pointer of Git LFS, not the file itself", kPacked, "run \"git lfs pull\""},
    {"\x1F\x8B", "gzip data", kPacked, "unpack it with gunzip"},
    {"\x1F\x9D", "compressed data (.Z)", kPacked, "unpack it with uncompress"},
    {"BZh", "bzip2 data", kPacked, "unpack it with bunzip2"},
    {"\xFD"
     "7zXZ",
     "xz data", kPacked, "unpack it with unxz"},
    {"\x28\xB5\x2F\xFD", "Zstandard data", kPacked, "unpack it with unzstd"},
    {"\x04\x22\x4D\x18", "LZ4 data", kPacked, "unpack it with unlz4"},
    {"7z\xBC\xAF\x27\x1C", "a 7z archive", kPacked, "unpack it"},
    {"Rar!", "a RAR archive", kPacked, "unpack it"},
    {"MSCF", "a cabinet archive", kPacked, "unpack it"},
    {"ustar", "a tar archive", kPacked, "unpack it", 257},
    {"-----BEGIN PGP MESSAGE", "an encrypted message (PGP)", kPacked, "decrypt it"},
    {"-----BEGIN ", "a key or certificate"},
    // Pictures, films and papers.
    {"%PDF", "a PDF", kDrawing},
    {"%!PS", "a PostScript document", kDrawing},
    {"\xC5\xD0\xD3\xC6", "a PostScript document (EPS)", kDrawing},
    {"\x89PNG", "a PNG picture"},
    {"\xFF\xD8\xFF", "a JPEG picture"},
    {"GIF8", "a GIF picture"},
    {"BM", "a BMP picture", kOther, {}, 0, "\0\0\0\0"sv, 6},
    {"II*\0"sv, "a TIFF picture"},
    {"MM\0*"sv, "a TIFF picture"},
    {"8BPS", "a Photoshop picture"},
    {"gimp xcf", "a GIMP picture"},
    {"RIFF", "a WebP picture", kOther, {}, 0, "WEBP", 8},
    {"RIFF", "a CorelDRAW drawing", kDrawing, {}, 0, "CDR", 8},
    {"RIFF", "a sound (WAV)", kOther, {}, 0, "WAVE", 8},
    {"RIFF", "a video", kOther, {}, 0, "AVI ", 8},
    {"\x1A\x45\xDF\xA3", "a video"},
    {"ftyphei", "a HEIC picture", kOther, {}, 4},
    {"ftypmif1", "a HEIC picture", kOther, {}, 4},
    {"ftyp", "a video", kOther, {}, 4},
    {"{\\rtf", "a text document (RTF)"},
    {"\\documentclass", "a LaTeX document"},
    // Slices of a body.
    {"DICM", "a medical picture (DICOM)", kOther, kSegment, 128},
    {"NRRD", "a medical picture (NRRD)", kOther, kSegment},
    {"n+1\0"sv, "a medical picture (NIfTI)", kOther, kSegment, 344},
    {"ObjectType = Image", "a medical picture (MetaImage)", kOther, kSegment},
    {" BDV", "a volume (OpenVDB)", kMesh},
    // Programs, keys of firmware.
    {"\x7F"
     "ELF",
     "a program (ELF)", kFirmware},
    {"MZ", "a program of Windows", kOther, {}, 0, "PE\0\0"sv},
    {"\xCF\xFA\xED\xFE", "a program of macOS"},
    {"\x3D\xB8\xF3\x96", "an image for MCUboot", kFirmware},
    {"UF2\n", "an image in UF2", kFirmware},
    {"DfuSe\1", "an image for DFU (DfuSe)", kFirmware},
    // CAD.
    {"**ABCDEFGHIJKLMNOPQRSTUVWXYZ", "a Parasolid model (text)", kCad},
    {"PS\0\0"sv, "a Parasolid model (binary)", kCad},
    {"ACIS BinaryFile", "an ACIS model (SAB)", kCad},
    {"ASM BinaryFile", "an ACIS model (SAB)", kCad},
    {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "a document of a CAD or office program (SolidWorks, Inventor, Solid Edge)",
     kCad},
    {"V5_CFV2", "a CATIA model", kCad},
    {"3D Geometry File Format", "a Rhino model", kCad},
    {"#UGC:", "a part of Creo", kCad},
    {"PTC", "a part of Creo", kCad},
    {"\xFF\xFE\xFF\x0E"
     "S\0k\0e\0t\0c\0h\0U\0p"sv,
     "a SketchUp model", kCad},
    {"\xE0\xBB\xBF"
     "SketchUp",
     "a SketchUp model", kCad},  // once it was converted from UTF-16, as which it begins
    {"\xB1\xB2\xB3SolveSpace", "a SolveSpace sketch", kCad},
    {"\xC2\xB1\xC2\xB2\xC2\xB3SolveSpace", "a SolveSpace sketch", kCad},
    {"(kicad_pcb", "a circuit board of KiCad", kOther, "export it as STEP"},
    {"DBRep_DrawableShape", "a BREP file of OpenCASCADE", kCad},
    {"CASCADE Topology", "a BREP file of OpenCASCADE", kCad},
    {"Open CASCADE Topology", "a BREP file of OpenCASCADE", kCad},
    // Drawings and maps.
    {"AC10", "an AutoCAD drawing (DWG)", kDrawing, "save it as DXF for \"triskin place\", or export a solid as STEP"},
    {"AutoCAD Binary DXF", "a binary DXF drawing", kDrawing, "save it as a text DXF"},
    {"\x08\x09\xFE\x02", "a MicroStation drawing (DGN)", kDrawing},
    {"\1\0\0\0"sv, "an enhanced metafile (EMF)", kDrawing, {}, 0, " EMF", 40},
    {"\xD7\xCD\xC6\x9A", "a Windows metafile (WMF)", kDrawing},
    {"IN;", "a plot (HPGL)", kDrawing},
    {"\x1B%-1B", "a plot (HPGL)", kDrawing},
    {"SP1;", "a plot (HPGL)", kDrawing},
    {"M48\n", "a drill file (Excellon)", kDrawing},
    {"M48\r", "a drill file (Excellon)", kDrawing},
    {"", "a layer of a circuit board (Gerber)", kDrawing, {}, 0, "%FSLA"},
    {"", "a layer of a circuit board (Gerber)", kDrawing, {}, 0, "%MOMM*%"},
    {"", "a layer of a circuit board (Gerber)", kDrawing, {}, 0, "%MOIN*%"},
    {"\0\0\x27\x0A"sv, "an ESRI shapefile", kDrawing, kToMillimetres},
    {"SQLite format 3", "a map (GeoPackage)", kDrawing, kToMillimetres, 0, "GPKG", 68},
    {"POLYGON", "a polygon in WKT", kOutline},
    {"MULTIPOLYGON", "polygons in WKT", kOutline},
    // Meshes and scenes.
    {"BLENDER", "a Blender document", kMesh},
    {"//Maya ASCII", "a Maya scene", kMesh},
    {"FOR4", "a Maya scene (binary)", kMesh},
    {"QC4DC4D6", "a Cinema 4D scene", kMesh},
    {"*HEADING", "a mesh of finite elements (Abaqus)", kMesh},
    {"*NODE", "a mesh of finite elements (Abaqus)", kMesh},
    {"*KEYWORD", "a mesh of finite elements (LS-DYNA)", kMesh},
    {"/COM,ANSYS", "a mesh of finite elements (Ansys)", kMesh},
    {"/PREP7", "a mesh of finite elements (Ansys)", kMesh},
    {"$ ", "a mesh of finite elements (Nastran)", kMesh, {}, 0, "BULK"},
    {"SOL ", "a mesh of finite elements (Nastran)", kMesh, {}, 0, "CEND"},
    {"BEGIN BULK", "a mesh of finite elements (Nastran)", kMesh},
    {"    -1\n", "a mesh of finite elements (I-DEAS)", kMesh},
    {"    -1\r", "a mesh of finite elements (I-DEAS)", kMesh},
    {"# Created by COMSOL", "a mesh of finite elements (COMSOL)", kMesh},
    {"NDIME", "a mesh of SU2", kMesh},
    {"FoamFile", "a mesh of OpenFOAM", kMesh},
    {"CDF\1", "a netCDF file (as Exodus meshes are)", kMesh},
    {"CDF\2", "a netCDF file (as Exodus meshes are)", kMesh},
    {"(0 \"", "a mesh of Fluent", kMesh},
    {"#usda", "a USD scene (text)", kMesh},
    {"PXR-USDC", "a USD scene (binary)", kMesh},
    {"Ogawa", "an Alembic scene", kMesh},
    {"Kaydara FBX", "an FBX scene", kMesh},
    {"; FBX", "an FBX scene (text)", kMesh},
    {"#VRML_SIM", "a world of Webots", kOtherRobot, "export the robot as URDF from it"},
    {"#VRML", "a VRML scene", kMesh},
    {"#Inventor", "a scene of Open Inventor", kMesh},
    {"xof 0", "a DirectX mesh (.x)", kMesh},
    {"AC3D", "an AC3D mesh", kMesh},
    {"LWO", "a LightWave mesh", kMesh, {}, 8},
    {"LXOB", "a Modo scene", kMesh, {}, 8},
    {"U3D\0"sv, "a U3D scene", kMesh},
    {"PRC", "a PRC scene", kMesh, {}, 0, "\0"sv},
    {"DRACO", "a mesh compressed by Draco", kMesh},
    {"# vtk DataFile", "a VTK file", kMesh},
    {"$MeshFormat", "a Gmsh mesh", kMesh},
    {"HIERARCHY", "a motion of a skeleton (BVH)", kOther, {}, 0, "ROOT"},
    // Points.
    {"# .PCD", "a cloud of points (PCD)", kCloud},
    {"LASF", "a cloud of points (LAS)", kCloud},
    {"ASTM-E57", "a cloud of points (E57)", kCloud},
    // Recordings.
    {"\x89MCAP", "a recording in MCAP", kRecording, "\"triskin replay\" plays it"},
    {"\x89HDF", "an HDF5 file", kLog},
    {"#ROSBAG", "a bag of ROS 1", kLog},
    {"SQLite format 3", "a database (SQLite, as bags of ROS 2 are stored)", kLog},
    {"MDF     ", "a measurement in MDF", kLog},
    {"TDSm", "a measurement of LabVIEW (TDMS)", kLog},
    {"ULog\x01\x12\x35", "a log of PX4 (ULog)", kLog},
    {"\xED\xA1\xDA\x01", "a log of LCM", kLog},
    {"LOGG", "a log of Vector tools (BLF)", kLog},
    {"date ", "a log of Vector tools (ASC)", kLog, {}, 0, "base "},
    {";$FILEVERSION=", "a trace of PEAK tools (TRC)", kLog},
    {"***BUSMASTER", "a log of BUSMASTER", kLog},
    {"rosbag2_bagfile_information", "the list of a bag of ROS 2 (metadata.yaml)", kLog, "give the .mcap beside it"},
    {"\xD4\xC3\xB2\xA1", "a capture of packets (pcap)", kLog},
    {"\xA1\xB2\xC3\xD4", "a capture of packets (pcap)", kLog},
    {"\x0A\x0D\x0D\x0A", "a capture of packets (pcapng)", kLog},
    // Tables.
    {"PAR1", "a table in Parquet", kTable},
    {"ARROW1", "a table in Arrow (Feather)", kTable},
    {"\x93NUMPY", "an array of NumPy", kTable},
    {"MATLAB 5.0", "data of MATLAB", kTable},
    {"\x80\x04\x95", "pickled data of Python", kTable},
    {"\x80\x05\x95", "pickled data of Python", kTable},
    // Texts.
    {"<<<<<<< ", "a file with an unsolved conflict of git", kOther, "solve it"},
    {"newmtl ", "materials of an OBJ (.mtl)", kOther, "give the OBJ itself"},
    {"#!", "a script"},
    {"import ", "a program in Python"},
    {"#include ", "a program in C"},
    {"; generated by ", "a program for a printer (G-code)"},
    {";FLAVOR:", "a program for a printer (G-code)"},
    {"%YAML", "YAML"},
    {"---\n", "YAML"},
});

/// What the end of a name tells where the contents tell nothing, as many CAD programs do not say how their files begin.
struct Ending {
  std::string_view ending, what;
  FileUse use = FileUse::kOther;
  std::string_view remedy = {};
};
constexpr auto kEndings = std::to_array<Ending>({
    {".prt", "a part of NX or Creo", kCad},
    {".asm", "an assembly of a CAD program", kCad},
    {".catpart", "a CATIA model", kCad},
    {".catproduct", "a CATIA model", kCad},
    {".cgr", "a CATIA model", kCad},
    {".ipt", "a part of Inventor", kCad},
    {".sldprt", "a part of SolidWorks", kCad},
    {".sldasm", "an assembly of SolidWorks", kCad},
    {".par", "a part of Solid Edge", kCad},
    {".psm", "a part of Solid Edge", kCad},
    {".x_t", "a Parasolid model (text)", kCad},
    {".x_b", "a Parasolid model (binary)", kCad},
    {".sat", "an ACIS model (SAT)", kCad},
    {".sab", "an ACIS model (SAB)", kCad},
    {".jt", "a JT model", kCad},
    {".f3d", "a Fusion document", kCad},
    {".f3z", "a Fusion document", kCad},
    {".scad", "a program of OpenSCAD", kCad, "render it and export it as STL or 3MF"},
    {".vwx", "a Vectorworks document", kCad},
    {".g", "a BRL-CAD database", kCad},
    {".3dxml", "a 3DXML scene", kMesh},
    {".max", "a scene of 3ds Max", kMesh},
    {".c4d", "a Cinema 4D scene", kMesh},
    {".ztl", "a tool of ZBrush", kMesh},
    {".zpr", "a project of ZBrush", kMesh},
    {".abc", "an Alembic scene", kMesh},
    {".usd", "a USD scene", kMesh},
    {".x3db", "an X3D scene (binary)", kMesh},
    {".3ds", "a 3DS scene", kMesh},
    {".iv", "a scene of Open Inventor", kMesh},
    {".cdb", "a mesh of finite elements (Ansys)", kMesh},
    {".bdf", "a mesh of finite elements (Nastran)", kMesh},
    {".nas", "a mesh of finite elements (Nastran)", kMesh},
    {".inp", "a mesh of finite elements (Abaqus)", kMesh},
    {".unv", "a mesh of finite elements (I-DEAS)", kMesh},
    {".e57", "a cloud of points (E57)", kCloud},
    {".laz", "a cloud of points (LAZ)", kCloud},
    {".fls", "a cloud of points (FARO)", kCloud},
    {".rcp", "a cloud of points (ReCap)", kCloud},
    {".rcs", "a cloud of points (ReCap)", kCloud},
    {".zfs", "a cloud of points (Z+F)", kCloud},
    {".ptx", "a cloud of points (PTX)", kCloud},
    {".pts", "a cloud of points (PTS)", kCloud},
    {".xyz", "a list of points", kCloud},
    {".plt", "a plot (HPGL)", kDrawing},
    {".hpgl", "a plot (HPGL)", kDrawing},
    {".gbr", "a layer of a circuit board (Gerber)", kDrawing},
    {".gko", "a layer of a circuit board (Gerber)", kDrawing},
    {".gm1", "a layer of a circuit board (Gerber)", kDrawing},
    {".gtl", "a layer of a circuit board (Gerber)", kDrawing},
    {".drl", "a drill file (Excellon)", kDrawing},
    {".dwg", "an AutoCAD drawing (DWG)", kDrawing, "save it as DXF for \"triskin place\", or export a solid as STEP"},
    {".dgn", "a MicroStation drawing (DGN)", kDrawing},
    {".cdr", "a CorelDRAW drawing", kDrawing},
    {".ai", "an Illustrator drawing", kDrawing},
    {".afdesign", "an Affinity drawing", kDrawing},
    {".dbf", "the table of a shapefile", kTable},
    {".mat", "data of MATLAB", kTable},
    {".xls", "a spreadsheet", kTable},
    {".rds", "data of R", kTable},
    {".mf4", "a measurement in MDF", kLog},
    {".ulg", "a log of PX4 (ULog)", kLog},
    {".c3d", "a recording of motion (C3D)", kLog},
    {".edf", "a recording of signals (EDF)", kLog},
    {".pklg", "a capture of packets", kLog},
    {".ttt", "a scene of CoppeliaSim", kOtherRobot, "export the robot as URDF from it"},
    {".proto", "a description of a robot or a message (.proto)", kOtherRobot},
});

}  // namespace triskin::file_signs
