// SPDX-License-Identifier: GPL-3.0-or-later
#include "content_kind.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "off_reader.hpp"
#include "stl_reader.hpp"
#include "text_numbers.hpp"
#include "triskin/base/lower_case.hpp"

namespace triskin::mesh {
namespace {

constexpr std::size_t kLooked = 4096;  // The kind is recognised from this many bytes at the beginning.

struct Sign {
  std::string_view bytes, what;
  std::size_t at = 0;
};

// Each signature is taken from the definition of its format.
constexpr auto kForeign = std::to_array<Sign>({
    {"version https://git-lfs", "a pointer of Git LFS, not the file itself; run \"git lfs pull\""},
    {"\x1F\x8B", "gzip data; unpack it with gunzip"},
    {"BZh", "bzip2 data; unpack it with bunzip2"},
    {"\xFD"
     "7zXZ",
     "xz data; unpack it with unxz"},
    {"\x28\xB5\x2F\xFD", "Zstandard data; unpack it with unzstd"},
    {"7z\xBC\xAF\x27\x1C", "a 7z archive; unpack it"},
    {"Rar!", "a RAR archive; unpack it"},
    {"ustar", "a tar archive; unpack it", 257},
    {"%PDF", "a PDF; export the mesh itself"},
    {"\x89PNG", "a PNG picture"},
    {"\xFF\xD8\xFF", "a JPEG picture"},
    {"GIF8", "a GIF picture"},
    {"\x7F"
     "ELF",
     "a program"},
    {"ISO-10303-21", "STEP: a CAD model, not a mesh"},
    {"**ABCDEFGHIJKLMNOPQRSTUVWXYZ", "Parasolid: a CAD model, not a mesh; export a mesh"},
    {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "a document of a CAD or office program; export a mesh"},
    {"V5_CFV2", "CATIA: a CAD model, not a mesh; export a mesh"},
    {"3D Geometry File Format", "Rhino: a CAD model; export a mesh"},
    {"BLENDER", "a Blender document; export a mesh"},
    {"# vtk DataFile", "VTK; export a mesh as PLY or STL"},
    {"$MeshFormat", "Gmsh; export a mesh as STL or PLY"},
    {"\x89MCAP", "a recording in MCAP"},
    {"\x89HDF", "an HDF5 file"},
    {"SQLite format 3", "a database"},
    {"<<<<<<< ", "a file with an unsolved conflict of git; solve it"},
    {"newmtl ", "materials of an OBJ (.mtl); give the OBJ itself"},
    {"POLYGON", "a polygon in WKT; it belongs to \"triskin place\""},
    {"MULTIPOLYGON", "polygons in WKT; they belong to \"triskin place\""},
});

std::string_view head_of(std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  return bytes.substr(0, kLooked);
}

std::string_view without_space(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r\n");
  return from == std::string_view::npos ? std::string_view() : text.substr(from);
}

// Returns the name of the first element, in lower case and without its prefix; empty if the text is no XML or HTML.
std::string root_element(std::string_view text) {
  text = without_space(text);
  while (text.starts_with("<?") || text.starts_with("<!--") || lower_case(text.substr(0, 9)) == "<!doctype") {
    if (lower_case(text.substr(0, 14)) == "<!doctype html") return "html";
    const std::string_view close = text.starts_with("<!--") ? "-->" : ">";
    const std::size_t end = text.find(close);
    if (end == std::string_view::npos) return "?";
    text = without_space(text.substr(end + close.size()));
  }
  if (!text.starts_with('<') || text.size() < 2 ||
      (std::isalpha(static_cast<unsigned char>(text[1])) == 0 && text[1] != '_'))
    return {};
  std::string name = lower_case(text.substr(1, text.find_first_of(" \t\r\n/>", 1) - 1));
  return name.substr(name.find(':') + 1);
}

std::string foreign_xml(std::string_view text, const std::string& root) {
  if (root == "html") return "a page of HTML, as a download gives that failed; download the file itself";
  if (root == "robot") {
    const bool is_xacro = text.find("xacro") != std::string_view::npos;
    return std::string(is_xacro ? "a xacro" : "a URDF") + " robot description; give one of the meshes that it names";
  }
  if (root == "sdf") return "an SDF robot description; give one of the meshes that it names";
  if (root == "mujoco") return "a MuJoCo model; give one of the meshes that it names";
  if (root == "svg") return "an SVG picture";
  if (root == "model") return "the model part of a 3MF; give the .3mf that it was in";
  return "XML of another kind (<" + root.substr(0, 30) + ">)";
}

std::string foreign_json(std::string_view text) {
  const auto has = [&](std::string_view what) { return text.find(what) != std::string_view::npos; };
  if (has("triskin-design")) return "a design of Triskin, not a mesh";
  if (has("triskin-net")) return "a net of Triskin; it belongs to \"triskin place\"";
  if (has("\"coordinates\"") || has("\"FeatureCollection\"")) return "GeoJSON; it belongs to \"triskin place\"";
  return has("\"asset\"") || has("\"meshes\"") || has("\"accessors\"") ? "" : "JSON of another kind";
}

// Recognises a word that begins a line of an OBJ, with a number or name after it.
bool begins_as_obj(std::string_view text) {
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view word = next_word(line);
    if (word.empty() || word.front() == '#') continue;
    constexpr std::array<std::string_view, 9> kWords{"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"};
    return std::ranges::find(kWords, word) != kWords.end() && !next_word(line).empty();
  }
  return false;
}

bool is_text_stl(std::string_view text) {
  const std::string lower = lower_case(without_space(text));
  return (lower.starts_with("solid") && lower.find("facet") != std::string::npos) || lower.starts_with("facet");
}

}  // namespace

std::string_view name_of(MeshFormat format) {
  constexpr std::array<std::string_view, 10> kNames{
      "OBJ", "STL", "STL", "PLY", "OFF", "3MF", "glTF", "DAE", "another format", "an unknown format"};
  return kNames[static_cast<std::size_t>(format)];
}

MeshFormat format_by_content(const std::string& bytes) {
  const std::string_view head = head_of(bytes), text = without_space(head);
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return MeshFormat::kPly;
  if (head.starts_with("PK\x03\x04")) return MeshFormat::kThreeMf;
  if (head.starts_with("glTF")) return MeshFormat::kGltf;
  if (head.starts_with("Kaydara FBX")) return MeshFormat::kLibrary;
  if (is_binary_stl(bytes) && bytes.size() >= 84) {
    // Only the length that the count demands is proof, because any bytes may hold a zero.
    std::size_t count = 0;
    for (int k = 3; k >= 0; --k)
      count = count << 8 | static_cast<unsigned char>(bytes[80 + static_cast<std::size_t>(k)]);
    if (bytes.size() == 84 + 50 * count) return MeshFormat::kBinaryStl;
  }
  if (is_text_stl(head)) return MeshFormat::kTextStl;
  if (text.starts_with('{') && foreign_json(std::string_view(bytes)).empty()) return MeshFormat::kGltf;
  if (const std::string root = root_element(head); !root.empty()) {
    if (root == "collada") return MeshFormat::kDae;
    return root == "amf" || root == "x3d" ? MeshFormat::kLibrary : MeshFormat::kUnknown;
  }
  if (is_off(head)) return MeshFormat::kOff;
  return begins_as_obj(head) ? MeshFormat::kObj : MeshFormat::kUnknown;
}

MeshFormat format_by_extension(std::string_view extension) {
  constexpr auto kRows = std::to_array<std::pair<std::string_view, MeshFormat>>({
      {".obj", MeshFormat::kObj},
      {".stl", MeshFormat::kTextStl},
      {".ply", MeshFormat::kPly},
      {".off", MeshFormat::kOff},
      {".3mf", MeshFormat::kThreeMf},
      {".gltf", MeshFormat::kGltf},
      {".glb", MeshFormat::kGltf},
      {".dae", MeshFormat::kDae},
      {".fbx", MeshFormat::kLibrary},
      {".3ds", MeshFormat::kLibrary},
      {".x3d", MeshFormat::kLibrary},
      {".amf", MeshFormat::kLibrary},
      {".ac", MeshFormat::kLibrary},
      {".lwo", MeshFormat::kLibrary},
      {".x", MeshFormat::kLibrary},
  });
  const auto* row = std::ranges::find(kRows, extension, &std::pair<std::string_view, MeshFormat>::first);
  return row == kRows.end() ? MeshFormat::kUnknown : row->second;
}

std::string foreign_content(const std::string& bytes) {
  const std::string_view head = head_of(bytes);
  for (const Sign& sign : kForeign) {
    if (!sign.what.empty() && head.size() > sign.at && head.substr(sign.at).starts_with(sign.bytes))
      return std::string(sign.what);
  }
  if (head.size() > 73 && head[72] == 'S' && head.substr(73, 7).find_first_not_of(" 01") == std::string_view::npos)
    return "IGES: a CAD model, not a mesh; export a mesh";
  const std::string_view text = without_space(head);
  if (text.starts_with("0\nSECTION") || text.starts_with("0\r\nSECTION")) return "DXF; export a mesh as STL";
  if (text.starts_with('{')) return foreign_json(bytes);
  const std::string root = root_element(head);
  const bool is_mesh = root.empty() || root == "collada" || root == "amf" || root == "x3d" || root == "?";
  return is_mesh ? std::string() : foreign_xml(head, root);
}

}  // namespace triskin::mesh
