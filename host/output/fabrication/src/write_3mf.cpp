// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "solids.hpp"
#include "triskin/base/markup.hpp"
#include "zip_file.hpp"

// Follows the 3MF core specification 1.3: an OPC package (zip) of a list of types, one relation and the model.
namespace triskin::fabrication {
namespace {

constexpr const char* kTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr const char* kRelations =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

std::string object_text(const Solid& solid, std::size_t number) {
  std::string text =
      fmt::format("<object id=\"{}\" type=\"model\" name=\"{}\" pid=\"1\" pindex=\"{}\"><mesh><vertices>\n", number + 2,
                  escape_markup(solid.name), number);
  for (const design::Vec3& v : solid.mesh.vertices)
    text += fmt::format("<vertex x=\"{:.6f}\" y=\"{:.6f}\" z=\"{:.6f}\"/>\n", v.x(), v.y(), v.z());
  text += "</vertices><triangles>\n";
  for (const auto& [a, b, c] : solid.mesh.faces)
    text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", a, b, c);
  return text + "</triangles></mesh></object>\n";
}

std::string model_text(const std::vector<Solid>& solids) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><basematerials id=\"1\">\n";
  for (const Solid& solid : solids)
    text += fmt::format("<base name=\"{}\" displaycolor=\"#{:02X}{:02X}{:02X}\"/>\n", escape_markup(solid.name),
                        solid.colour[0], solid.colour[1], solid.colour[2]);
  text += "</basematerials>\n";
  for (std::size_t k = 0; k < solids.size(); ++k) text += object_text(solids[k], k);
  text += "</resources><build>\n";
  for (std::size_t k = 0; k < solids.size(); ++k) text += fmt::format("<item objectid=\"{}\"/>\n", k + 2);
  return text + "</build></model>\n";
}

}  // namespace

void write_3mf(const std::filesystem::path& path, const std::vector<Solid>& solids) {
  ZipFile zip(path);
  zip.add("[Content_Types].xml", kTypes);
  zip.add("_rels/.rels", kRelations);
  zip.add("3D/3dmodel.model", model_text(solids));
  zip.close();
}

}  // namespace triskin::fabrication
