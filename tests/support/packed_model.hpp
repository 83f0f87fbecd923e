// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <minizip/zip.h>

#include <filesystem>
#include <string>
#include <utility>

namespace triskin::test {

/// Writes a 3MF file with this model (the text of 3D/3dmodel.model), packed as 3MF programs do; replaces `path`.
inline void write_packed_model(const std::filesystem::path& path, const std::string& model) {
  const std::string types =
      R"(<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="model" )"
      R"(ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)";
  const std::string root =
      R"(<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r0" )"
      R"(Target="/3D/3dmodel.model" )"
      R"(Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";
  void* const zip = zipOpen(path.c_str(), APPEND_STATUS_CREATE);
  for (const auto& [part, text] : {std::pair<const char*, const std::string&>{"[Content_Types].xml", types},
                                   {"_rels/.rels", root},
                                   {"3D/3dmodel.model", model}}) {
    zipOpenNewFileInZip(zip, part, nullptr, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, Z_DEFAULT_COMPRESSION);
    zipWriteInFileInZip(zip, text.data(), static_cast<unsigned>(text.size()));
    zipCloseFileInZip(zip);
  }
  zipClose(zip, nullptr);
}

}  // namespace triskin::test
