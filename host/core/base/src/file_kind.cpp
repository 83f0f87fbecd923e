// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/file_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "triskin/base/lower_case.hpp"

namespace triskin {
namespace {

constexpr std::size_t kLooked = 4096;  // The kind is recognised from this many bytes at the beginning.

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
constexpr auto kSigns = std::to_array<Sign>({
    {"version https://git-lfs", "a pointer of Git LFS, not the file itself", kPacked, "run \"git lfs pull\""},
    {"\x1F\x8B", "gzip data", kPacked, "unpack it with gunzip"},
    {"BZh", "bzip2 data", kPacked, "unpack it with bunzip2"},
    {"\xFD"
     "7zXZ",
     "xz data", kPacked, "unpack it with unxz"},
    {"\x28\xB5\x2F\xFD", "Zstandard data", kPacked, "unpack it with unzstd"},
    {"7z\xBC\xAF\x27\x1C", "a 7z archive", kPacked, "unpack it"},
    {"Rar!", "a RAR archive", kPacked, "unpack it"},
    {"ustar", "a tar archive", kPacked, "unpack it", 257},
    {"%PDF", "a PDF"},
    {"%!PS", "a PostScript document", kDrawing},
    {"\x89PNG", "a PNG picture"},
    {"\xFF\xD8\xFF", "a JPEG picture"},
    {"GIF8", "a GIF picture"},
    {"BM", "a BMP picture", kOther, {}, 0, "\0\0\0\0"sv, 6},
    {"II*\0"sv, "a TIFF picture"},
    {"RIFF", "a WebP picture", kOther, {}, 0, "WEBP", 8},
    {"ftyphei", "a HEIC picture", kOther, {}, 4},
    {"ftypmif1", "a HEIC picture", kOther, {}, 4},
    {"ftyp", "a video", kOther, {}, 4},
    {"DICM", "a medical picture (DICOM)", kOther,
     "make a surface of it in a program for segmentation, such as 3D Slicer", 128},
    {"\x7F"
     "ELF",
     "a program (ELF)", kFirmware},
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
    {"(kicad_pcb", "a circuit board of KiCad", kOther, "export it as STEP"},
    {"DBRep_DrawableShape", "a BREP file of OpenCASCADE", kCad},
    {"CASCADE Topology", "a BREP file of OpenCASCADE", kCad},
    {"AC10", "an AutoCAD drawing (DWG)", kDrawing, "save it as DXF for \"triskin place\", or export a solid as STEP"},
    {"AutoCAD Binary DXF", "a binary DXF drawing", kDrawing, "save it as a text DXF"},
    {"BLENDER", "a Blender document", kMesh},
    {"//Maya ASCII", "a Maya scene", kMesh},
    {"FOR4", "a Maya scene (binary)", kMesh},
    {"*HEADING", "a mesh of finite elements (Abaqus)", kMesh},
    {"*NODE", "a mesh of finite elements (Abaqus)", kMesh},
    {"$ ", "a mesh of finite elements (Nastran)", kMesh, {}, 0, "BULK"},
    {"BEGIN BULK", "a mesh of finite elements (Nastran)", kMesh},
    {"(0 \"", "a mesh of Fluent", kMesh},
    {"#usda", "a USD scene (text)", kMesh},
    {"PXR-USDC", "a USD scene (binary)", kMesh},
    {"Kaydara FBX", "an FBX scene", kMesh},
    {"; FBX", "an FBX scene (text)", kMesh},
    {"#VRML", "a VRML scene", kMesh},
    {"xof 0", "a DirectX mesh (.x)", kMesh},
    {"AC3D", "an AC3D mesh", kMesh},
    {"LWO", "a LightWave mesh", kMesh, {}, 8},
    {"U3D\0"sv, "a U3D scene", kMesh},
    {"DRACO", "a mesh compressed by Draco", kMesh},
    {"# vtk DataFile", "a VTK file", kMesh},
    {"$MeshFormat", "a Gmsh mesh", kMesh},
    {"# .PCD", "a cloud of points (PCD)", kTable},
    {"LASF", "a cloud of points (LAS)", kTable},
    {"\x89MCAP", "a recording in MCAP", kRecording, "\"triskin replay\" plays it"},
    {"\x89HDF", "an HDF5 file", kLog},
    {"#ROSBAG", "a bag of ROS 1", kLog},
    {"SQLite format 3", "a database (SQLite, as bags of ROS 2 are stored)", kLog},
    {"MDF     ", "a measurement in MDF", kLog},
    {"LOGG", "a log of Vector tools (BLF)", kLog},
    {"date ", "a log of Vector tools (ASC)", kLog, {}, 0, "base "},
    {";$FILEVERSION=", "a trace of PEAK tools (TRC)", kLog},
    {"rosbag2_bagfile_information", "the list of a bag of ROS 2 (metadata.yaml)", kLog, "give the .mcap beside it"},
    {"PAR1", "a table in Parquet", kTable},
    {"\x93NUMPY", "an array of NumPy", kTable},
    {"MATLAB 5.0", "data of MATLAB", kTable},
    {"\x80\x04\x95", "pickled data of Python", kTable},
    {"UF2\n", "an image in UF2", kFirmware},
    {"DfuSe\1", "an image for DFU (DfuSe)", kFirmware},
    {"\xD4\xC3\xB2\xA1", "a capture of packets (pcap)", kLog},
    {"\x0A\x0D\x0D\x0A", "a capture of packets (pcapng)", kLog},
    {"<<<<<<< ", "a file with an unsolved conflict of git", kOther, "solve it"},
    {"newmtl ", "materials of an OBJ (.mtl)", kOther, "give the OBJ itself"},
    {"POLYGON", "a polygon in WKT", kOutline},
    {"MULTIPOLYGON", "polygons in WKT", kOutline},
    {"#!", "a script"},
    {"import ", "a program in Python"},
    {"#include ", "a program in C"},
    {"; generated by ", "a program for a printer (G-code)"},
    {";FLAVOR:", "a program for a printer (G-code)"},
});

std::string_view without_space(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r\n");
  return from == std::string_view::npos ? std::string_view() : text.substr(from);
}

// The lines of the beginning, without line ends; the last one may be cut.
std::vector<std::string_view> lines_of(std::string_view head) {
  std::vector<std::string_view> lines;
  while (!head.empty() && lines.size() < 8) {
    const std::size_t end = head.find('\n');
    std::string_view line = head.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    head = end == std::string_view::npos ? std::string_view() : head.substr(end + 1);
  }
  return lines;
}

bool is_hex(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isxdigit(c) != 0; });
}
bool is_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
}

// ":LLAAAATT…CC": every byte of the record sums to 0 (Intel, Hexadecimal Object File Format Specification).
bool is_intel_hex(std::string_view line) {
  return line.size() >= 11 && line.size() % 2 == 1 && line.front() == ':' && is_hex(line.substr(1));
}
// Motorola S-record: S, type, length and data in hexadecimal digits.
bool is_s_record(std::string_view line) {
  return line.size() >= 10 && line.size() % 2 == 0 && line.front() == 'S' && is_hex(line.substr(1));
}
// "(1700000000.000100) can0 7DF#…" of candump -l, or "can0  7DF   [8]  …" of candump.
bool is_candump(std::string_view line) {
  const std::string_view text = without_space(line);
  if (text.starts_with('(')) {
    const std::size_t close = text.find(')');
    return close != std::string_view::npos && is_digits(text.substr(1, text.find('.') - 1)) &&
           (text.find('#', close) != std::string_view::npos || text.find('[', close) != std::string_view::npos);
  }
  const std::size_t name = text.find("  ");
  if (name == std::string_view::npos || name == 0 || name > 16) return false;
  const std::string_view id = without_space(text.substr(name));
  return is_hex(id.substr(0, id.find(' '))) && id.find('[') != std::string_view::npos;
}
// The first line has four whole numbers: version, records, entities, flags (Spatial, SAT format).
bool is_acis_text(const std::vector<std::string_view>& lines) {
  if (lines.size() < 2) return false;
  std::string_view rest = lines[0];
  int numbers = 0;
  for (; !(rest = without_space(rest)).empty(); ++numbers) {
    const std::string_view word = rest.substr(0, rest.find(' '));
    if (!is_digits(word)) return false;
    rest = rest.substr(word.size());
  }
  return numbers == 4 && std::ranges::any_of(lines, [](std::string_view line) {
           return line.find("ACIS") != std::string_view::npos || line.find(" ASM ") != std::string_view::npos ||
                  line.starts_with("body ") || line.starts_with("asmheader ");
         });
}
// Each line is a word of a letter G, M or T with a number, and its arguments; a comment may stand between.
bool is_g_code(const std::vector<std::string_view>& lines) {
  int commands = 0;
  for (const std::string_view line : lines) {
    if (line.empty() || line.starts_with(';') || line.starts_with('(') || line.starts_with('%')) continue;
    const std::string_view word = line.substr(0, line.find_first_of(" \t;"));
    if (word.size() < 2 || !is_digits(word.substr(1)) ||
        std::string_view("GMT").find(word[0]) == std::string_view::npos)
      return false;
    ++commands;
  }
  return commands >= 2;
}
// Two lines or more of three to seven numbers between blanks: a point in each.
bool is_point_list(const std::vector<std::string_view>& lines) {
  // Counts alone begin an OFF without its first word.
  if (lines[0].find('.') == std::string_view::npos) return false;
  std::size_t rows = 0, columns = 0;
  for (std::size_t k = 0; k + 1 < lines.size() || (k < lines.size() && k < 2); ++k) {
    std::string_view rest = without_space(lines[k]);
    if (rest.empty()) continue;
    std::size_t count = 0;
    for (; !rest.empty(); ++count) {
      const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
      if (word.find_first_not_of("0123456789+-.eE") != std::string_view::npos) return false;
      rest = without_space(rest.substr(word.size()));
    }
    if (count < 3 || count > 7 || (rows > 0 && count != columns)) return false;
    columns = count;
    ++rows;
  }
  return rows >= 2;
}
// Pairs of lines: a group code, then its value; the first is 0 SECTION, or 999 and a comment.
bool is_dxf(const std::vector<std::string_view>& lines) {
  const auto word = [&](std::size_t k) { return k < lines.size() ? without_space(lines[k]) : std::string_view(); };
  std::size_t k = 0;
  while (word(k) == "999") k += 2;
  return word(k) == "0" && word(k + 1).starts_with("SECTION");
}
// Several columns between commas or semicolons; the first line may name them.
bool is_table(const std::vector<std::string_view>& lines) {
  if (lines.size() < 2 || lines[0].starts_with('#') || lines[0].starts_with("v ") ||
      lines[0].find('(') != std::string_view::npos)
    return false;
  for (const char separator : {',', ';', '\t'}) {
    const auto columns = [&](std::string_view line) { return std::ranges::count(line, separator); };
    const bool is_numbers = lines[1].find_first_not_of("0123456789+-.eE,; \t") == std::string_view::npos;
    if (columns(lines[0]) >= (is_numbers ? 1 : 2) && columns(lines[0]) == columns(lines[1]) &&
        lines[1].find_first_of("0123456789") != std::string_view::npos &&
        lines[1].find_first_of("{}<>()") == std::string_view::npos)
      return true;
  }
  return false;
}

// A URDF that xacro wrote may keep the declaration of its namespace, and calls within comments. `text` is the whole
// file, as the first call may stand far down.
bool is_xacro(std::string_view text) {
  bool declares = false, has_expression = false;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t comment = std::min(text.find("<!--", from), text.size());
    const std::string_view part = text.substr(from, comment - from);
    const auto named = [&](std::string_view what) { return part.find(what) != std::string_view::npos; };
    if (named("<xacro:")) return true;
    declares = declares || named("xmlns:xacro");
    has_expression = has_expression || named("${") || named("$(");
    const std::size_t end = text.find("-->", comment);
    from = end == std::string_view::npos ? text.size() : end + 3;
  }
  return declares && has_expression;
}

// `text` is the beginning of the file.
std::optional<FileKind> xml_kind(std::string_view text, const std::string& root, std::string_view file) {
  const auto named = [&](std::string_view what) { return text.find(what) != std::string_view::npos; };
  if (root == "html")
    return FileKind{"a web page (HTML), as a failed download leaves", kOther, "download the file itself"};
  if (root == "robot" && is_xacro(file))
    return FileKind{"a xacro robot description", kOtherRobot, "make a URDF of it: xacro FILE > robot.urdf"};
  if (root == "robot" && !named("<link") && (named("<group") || named("<disable_collisions")))
    return FileKind{"an SRDF of MoveIt", kOtherRobot};
  if (root == "robot") return FileKind{"a URDF robot description", kRobot};
  if (root == "sdf") return FileKind{"an SDF robot description", kOtherRobot};
  if (root == "mujoco") return FileKind{"a MuJoCo model", kOtherRobot};
  if (root == "svg") return FileKind{"an SVG drawing", kOutline};
  if (root == "amf") return FileKind{"an AMF", kMesh};
  if (root == "x3d") return FileKind{"an X3D scene", kMesh};
  if (root == "model") return FileKind{"the model part of a 3MF", kOther, "give the .3mf that it was in"};
  if (root == "mesh" || root == "vtkfile") return FileKind{"a mesh in XML (<" + root + ">)", kMesh};
  if (root == "gerber" || root == "eagle") return FileKind{"a circuit board in XML", kOther};
  return FileKind{"XML of another kind (<" + root.substr(0, 30) + ">)", kOther};
}

bool has_suffix(const std::string& name, std::string_view suffix) {
  return lower_case(name).ends_with(suffix);
}

// A 3MF gives nothing, because it is read.
std::optional<FileKind> zip_kind(std::string_view bytes) {
  const std::vector<std::string> names = names_in_zip(bytes);
  const auto has = [&](std::string_view name) { return std::ranges::find(names, name) != names.end(); };
  const auto any = [&](std::string_view suffix) {
    return std::ranges::any_of(names, [&](const std::string& name) { return has_suffix(name, suffix); });
  };
  if (names.empty()) return std::nullopt;
  if (has("Document.xml")) return FileKind{"a FreeCAD document", kCad};
  if (any(".usdc") || any(".usda") || any(".usd")) return FileKind{"a USD scene (USDZ)", kMesh};
  if (any(".model")) return std::nullopt;
  if (any(".npy")) return FileKind{"an archive of NumPy arrays", kTable};
  if (any(".f3d") || any("manifest.dat")) return FileKind{"a Fusion document", kCad};
  if (has("[Content_Types].xml")) return FileKind{"a document of an office program", kOther};
  constexpr std::size_t kShown = 3;
  std::string list;
  std::size_t files = 0;
  for (const std::string& name : names) {
    if (name.ends_with('/') || name.starts_with("__MACOSX/")) continue;
    if (files++ < kShown) list += (list.empty() ? "" : ", ") + name.substr(0, 80);
  }
  if (files > kShown) list += fmt::format(" and {} more", files - kShown);
  if (files == 0) list = "no file";
  return FileKind{fmt::format("a zip archive with {} in it", list), kPacked, "unpack it"};
}

std::uint32_t little_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t k = count; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

std::optional<FileKind> text_kind(std::string_view head) {
  const std::string_view text = without_space(head);
  const std::vector<std::string_view> lines = lines_of(text);
  if (lines.empty()) return std::nullopt;
  if (is_dxf(lines)) return FileKind{"a DXF drawing", kOutline};
  if (is_intel_hex(lines[0])) return FileKind{"an Intel HEX file", kFirmware};
  if (is_s_record(lines[0])) return FileKind{"a file of Motorola S-records", kFirmware};
  if (is_candump(lines[0])) return FileKind{"a candump log", kLog};
  if (is_acis_text(lines)) return FileKind{"an ACIS model (SAT)", kCad};
  if (is_g_code(lines)) return FileKind{"a program for a machine tool or a printer (G-code)", kOther};
  if (is_point_list(lines)) return FileKind{"a list of points", kTable};
  if (is_table(lines)) return FileKind{"a table of text (CSV)", kTable};
  return std::nullopt;
}

// What a person who was asked for something else does next.
std::string next_step(const FileKind& kind, FileUse asked_for) {
  const bool is_robot = kind.use == kRobot || kind.use == kOtherRobot;
  if (asked_for == kMesh && is_robot) return "give one of the meshes that it names";
  if (!kind.remedy.empty()) return kind.remedy;
  switch (asked_for) {
    case kMesh:
      if (kind.use == kCad) return "export the part as STEP, or as a mesh (STL, OBJ, 3MF)";
      if (kind.use == kMesh) return "export it as OBJ, STL, 3MF or glTF";
      if (kind.use == kOutline) return "it belongs to \"triskin place\"; a cover needs a surface in space (STL, STEP)";
      if (kind.use == kDesign) return "give the mesh that it was made from; \"triskin edit\" changes a design";
      return "give a mesh (OBJ, STL, PLY, OFF, DAE, glTF, GLB, 3MF) or a part in STEP or IGES";
    case kOutline:
      if (kind.use == kPart)
        return "\"triskin design\" covers a part; for a flat patch, export its outline as a drawing (DXF, SVG)";
      return "give a polygon in WKT or GeoJSON, or a drawing in DXF or SVG";
    case kRecording:
      return "give an MCAP file that \"triskin record\" wrote";
    case kFirmware:
      return "give the firmware's package, triskin_firmware.tsf; a board without a loader takes its image from a "
             "programmer (docs/program_board.md)";
    case kRobot:
      return "give a URDF";
    case kDesign:
      if (kind.use == kPart) return "\"triskin design\" makes a design of it";
      return "give a design, which \"triskin design\" makes of a mesh or a CAD file";
    default:
      return "give another file";
  }
}

}  // namespace

std::vector<std::string> names_in_zip(std::string_view bytes) {
  // The end record (22 bytes and a comment of at most 65,535) leads to the table of contents (APPNOTE.TXT of PKWARE).
  constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kMaxComment = 65'535;
  const std::size_t searched = std::min(bytes.size(), kEndBytes + kMaxComment);
  const std::size_t end = bytes.rfind("PK\x05\x06");
  if (end == std::string_view::npos || bytes.size() - end > searched || bytes.size() - end < kEndBytes) return {};
  std::vector<std::string> names;
  for (std::size_t at = little_endian(bytes, end + 16, 4);
       at <= bytes.size() && bytes.size() - at >= kEntryBytes && bytes.substr(at).starts_with("PK\x01\x02");) {
    const std::size_t length = little_endian(bytes, at + 28, 2);
    names.emplace_back(bytes.substr(at + kEntryBytes, length));
    at += kEntryBytes + length + little_endian(bytes, at + 30, 2) + little_endian(bytes, at + 32, 2);
  }
  return names;
}

std::string root_element(std::string_view text) {
  text = without_space(text.substr(0, kLooked));
  while (text.starts_with("<?") || text.starts_with("<!--") || lower_case(text.substr(0, 9)) == "<!doctype") {
    if (lower_case(text.substr(0, 14)) == "<!doctype html") return "html";
    const std::string_view close = text.starts_with("<!--") ? "-->" : ">";
    // A document type may hold declarations of its own between [ and ].
    const bool has_subset = text.starts_with("<!") && close == ">" && text.find('[') < text.find('>');
    const std::size_t end = text.find(close, has_subset ? text.find(']') : 0);
    if (end == std::string_view::npos) return "?";
    text = without_space(text.substr(end + close.size()));
  }
  if (!text.starts_with('<') || text.size() < 2 ||
      (std::isalpha(static_cast<unsigned char>(text[1])) == 0 && text[1] != '_'))
    return {};
  std::string name = lower_case(text.substr(1, text.find_first_of(" \t\r\n/>", 1) - 1));
  return name.substr(name.find(':') + 1);
}

std::optional<FileKind> file_kind(std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  const std::string_view head = bytes.substr(0, kLooked);
  for (const Sign& sign : kSigns) {
    if (sign.is_of(head)) return FileKind{std::string(sign.what), sign.use, std::string(sign.remedy)};
  }
  if (head.starts_with("PK\x03\x04") || head.starts_with("PK\x05\x06")) return zip_kind(bytes);
  // The chunk "main" of a 3DS states the length of the whole file.
  if (head.size() >= 6 && head.starts_with("MM") && little_endian(head, 2, 4) == bytes.size())
    return FileKind{"a 3DS scene", kMesh};
  if (head.starts_with("Version ") && head.substr(0, 80).find(" JT ") != std::string_view::npos)
    return FileKind{"a JT model", kCad};
  const std::string_view text = without_space(head);
  const auto has = [&](std::string_view what) { return bytes.find(what) != std::string_view::npos; };
  if (text.starts_with('{')) {
    if (has("triskin-design")) return FileKind{"a design of Triskin", kDesign};
    if (has("triskin-net")) return FileKind{"a net of Triskin", kOutline};
    if (has("\"coordinates\"") || has("\"FeatureCollection\"")) return FileKind{"GeoJSON", kOutline};
    if (has("\"asset\"") || has("\"meshes\"") || has("\"accessors\"")) return std::nullopt;  // glTF
    return FileKind{"JSON of another kind", kOther};
  }
  if (const std::string root = root_element(head); !root.empty())
    return root == "collada" || root == "?" ? std::nullopt : xml_kind(head, root, bytes);
  return text_kind(head);
}

std::optional<FileKind> part_kind(std::string_view bytes) {
  constexpr std::size_t kStlHead = 84, kStlFacet = 50;
  const std::string_view text = without_space(bytes.substr(0, kLooked));
  const auto named = [&](std::string_view what) { return text.find(what) != std::string_view::npos; };
  if (text.starts_with("ISO-10303-21") && (named("(('IFC") || named("(( 'IFC")))
    return FileKind{"an IFC building model", kCad};
  if (text.starts_with("ISO-10303-21")) return FileKind{"a part in STEP", kPart};
  if (text.starts_with("solid") && named("facet")) return FileKind{"a mesh (STL)", kPart};
  if (bytes.size() > kStlHead && bytes.size() == kStlHead + kStlFacet * little_endian(bytes, kStlHead - 4, 4))
    return FileKind{"a mesh (STL)", kPart};
  if (text.starts_with("ply")) return FileKind{"a mesh (PLY)", kPart};
  if (text.starts_with("OFF")) return FileKind{"a mesh (OFF)", kPart};
  if (text.starts_with("glTF")) return FileKind{"a mesh (GLB)", kPart};
  if (text.starts_with("v ") || named("\nv ")) return FileKind{"a mesh (OBJ)", kPart};
  if (bytes.starts_with("PK") && !names_in_zip(bytes).empty()) return FileKind{"a mesh (3MF)", kPart};
  return std::nullopt;
}

std::string not_asked_for(std::string_view bytes, FileUse asked_for) {
  std::optional<FileKind> kind = file_kind(bytes);
  if (!kind && (asked_for == kDesign || asked_for == kOutline)) kind = part_kind(bytes);
  if (!kind || (kind->use == asked_for && asked_for != FileUse::kMesh && asked_for != FileUse::kFirmware)) return {};
  return kind->what + "; " + next_step(*kind, asked_for);
}

}  // namespace triskin
