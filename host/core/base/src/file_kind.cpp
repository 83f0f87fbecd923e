// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/file_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "file_signs.hpp"
#include "triskin/base/lower_case.hpp"

namespace triskin {
namespace {

constexpr std::size_t kLooked = 4096;  // The kind is recognised from this many bytes at the beginning.

using enum FileUse;
using file_signs::kToMillimetres;

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
std::uint32_t little_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t k = count; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

// The table of vectors of a Cortex-M: the end of the stack in the memory at 0x2000'0000, then the start, an odd address
// in the flash of an STM32 (Arm, ARMv7-M Architecture Reference Manual, B1.5.3).
bool is_cortex_image(std::string_view head) {
  constexpr std::uint32_t kMemory = 0x2000'0000, kMemoryEnd = 0x2010'0000, kFlash = 0x0800'0000,
                          kFlashEnd = 0x0820'0000;
  if (head.size() < 64) return false;
  const std::uint32_t stack = little_endian(head, 0, 4), start = little_endian(head, 4, 4);
  return stack > kMemory && stack <= kMemoryEnd && stack % 4 == 0 && start > kFlash && start < kFlashEnd &&
         start % 2 == 1;
}
// "@F800", then bytes in hexadecimal digits with blanks (Texas Instruments, SLAU131).
bool is_ti_text(const std::vector<std::string_view>& lines) {
  return lines.size() >= 2 && lines[0].size() >= 5 && lines[0].front() == '@' && is_hex(lines[0].substr(1)) &&
         lines[1].size() >= 2 && lines[1].find_first_not_of("0123456789ABCDEFabcdef ") == std::string_view::npos;
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
  if (root == "meshlabproject") return FileKind{"a project of MeshLab", kMesh};
  if (root == "model_3dxml") return FileKind{"a 3DXML scene", kMesh};
  if (root == "uos") return FileKind{"a part in STEP, in XML (AP242)", kCad};
  if (root == "plmxml") return FileKind{"a structure of parts (PLMXML)", kCad};
  for (const std::string_view map : {"kml", "gpx", "osm"})
    if (root == map) return FileKind{"a map (" + std::string(map) + ")", kDrawing, std::string(kToMillimetres)};
  if (root == "opensimdocument") return FileKind{"an OpenSim model", kOtherRobot};
  if (root == "launch") return FileKind{"a launch file of ROS", kOther};
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
  if (has("doc.kml")) return FileKind{"a map (KMZ)", kDrawing, std::string(kToMillimetres)};
  if (any(".3dxml")) return FileKind{"a 3DXML scene", kMesh};
  if (has("content.xml") && has("mimetype")) return FileKind{"a document of an office program", kOther};
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
  if (is_ti_text(lines)) return FileKind{"an image in TI-TXT", kFirmware};
  if (is_point_list(lines)) return FileKind{"a list of points", kCloud};
  if (is_table(lines)) return FileKind{"a table of text (CSV)", kTable};
  return std::nullopt;
}

// Section letter and number stand in columns 73 to 80 of each line (ANSI US PRO/IPO-100); some begin with an empty
// line.
bool is_iges(std::string_view bytes) {
  constexpr std::size_t kLine = 80, kSection = 72;
  bytes = bytes.substr(std::min(bytes.find_first_not_of("\r\n"), bytes.size()));
  const std::string_view line = bytes.substr(0, bytes.find('\n'));
  return line.size() >= kLine && (line[kSection] == 'S' || line[kSection] == 'F') &&
         line.substr(kSection + 1, 7).find_first_not_of("0123456789 ") == std::string_view::npos;
}

std::optional<FileKind> kind_by_ending(std::string_view name) {
  const std::string lower = lower_case(std::string(name));
  for (const file_signs::Ending& e : file_signs::kEndings) {
    if (lower.ends_with(e.ending)) return FileKind{std::string(e.what), e.use, std::string(e.remedy)};
  }
  return std::nullopt;
}

// What a person who was asked for something else does next.
std::string next_step(const FileKind& kind, FileUse asked_for) {
  const bool is_robot = kind.use == kRobot || kind.use == kOtherRobot;
  if (asked_for == kMesh && is_robot) return "give one of the meshes that it names";
  if (asked_for == kMesh && kind.use == kCloud)
    return "make a surface of the points (MeshLab: Screened Poisson) and give that, as PLY, OBJ or STL";
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
      if (kind.use == kDrawing || kind.use == kCad) return "export the outline as DXF or SVG";
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
  for (const file_signs::Sign& sign : file_signs::kSigns) {
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
    if (has("triskin-robot")) return FileKind{"a robot file of Triskin", kOther};
    if (has("\"Topology\"") && has("\"arcs\""))
      return FileKind{"a map (TopoJSON)", kDrawing, std::string(kToMillimetres)};
    if (has("\"coordinates\"") || has("\"FeatureCollection\"")) return FileKind{"GeoJSON", kOutline};
    if (has("\"asset\"") || has("\"meshes\"") || has("\"accessors\"")) return std::nullopt;  // glTF
    return FileKind{"JSON of another kind", kOther};
  }
  if (is_cortex_image(head)) return FileKind{"a raw image for a microcontroller", kFirmware};
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
  if (text.starts_with('{') && (named("\"asset\"") || named("\"accessors\""))) return FileKind{"a mesh (glTF)", kPart};
  if (root_element(text) == "collada") return FileKind{"a mesh (DAE)", kPart};
  if (is_iges(bytes)) return FileKind{"a part in IGES", kPart};
  if (text.starts_with("v ") || named("\nv ")) return FileKind{"a mesh (OBJ)", kPart};
  if (bytes.starts_with("PK") && !names_in_zip(bytes).empty()) return FileKind{"a mesh (3MF)", kPart};
  return std::nullopt;
}

std::string not_asked_for(std::string_view bytes, FileUse asked_for, std::string_view name) {
  std::optional<FileKind> kind = file_kind(bytes);
  const std::optional<FileKind> part = kind ? std::nullopt : part_kind(bytes);
  if (part && asked_for != kMesh) kind = part;
  if (!kind && !part) kind = kind_by_ending(name);
  if (!kind || (kind->use == asked_for && asked_for != FileUse::kMesh && asked_for != FileUse::kFirmware)) return {};
  return kind->what + "; " + next_step(*kind, asked_for);
}

}  // namespace triskin
