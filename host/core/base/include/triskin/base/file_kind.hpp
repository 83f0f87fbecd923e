// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace triskin {

/// What a file is good for, by which a command tells its reader where it belongs.
enum class FileUse : std::uint8_t {
  kMesh,        ///< triangles in a format that is not read
  kPart,        ///< what `triskin design` reads
  kCad,         ///< exact geometry in a format that is not read
  kOutline,     ///< plane curves: `triskin place`
  kDrawing,     ///< plane curves in a format that is not read
  kPacked,      ///< an archive or compressed file; `remedy` says how to unpack it
  kRecording,   ///< MCAP: `triskin replay`
  kCloud,       ///< points in space without triangles
  kLog,         ///< recordings of other programs
  kDesign,      ///< a design file of triskin
  kRobot,       ///< URDF
  kOtherRobot,  ///< xacro, SDF, MuJoCo
  kFirmware,    ///< images for a programmer
  kTable,       ///< rows of numbers
  kOther,
};

struct FileKind {
  std::string what;  ///< with its article: "a FreeCAD document"
  FileUse use = FileUse::kOther;
  std::string remedy{};  ///< the next step where the kind alone tells it, else empty
};

/// Recognises a file by its first bytes and, for a zip archive, by the names in it. Formats that some command of
/// triskin reads as a part (OBJ, STL, PLY, OFF, DAE, glTF, 3MF, STEP, IGES) give nothing, and so does what is not
/// known. Sources are the definitions of the formats. Cost: constant, for an archive linear in its entries.
[[nodiscard]] std::optional<FileKind> file_kind(std::string_view bytes);

/// Recognises a part that some command reads, which file_kind() leaves out, for one who gave it in place of a design
/// or an outline; empty for anything else.
[[nodiscard]] std::optional<FileKind> part_kind(std::string_view bytes);

/// "a FreeCAD document; export the part as STEP, or as a mesh (STL, OBJ, 3MF)": what a file is, and the next step for
/// somebody who gave it where a part, an outline, a recording, a design, a URDF (`kRobot`) or firmware was asked for.
/// Where the contents say nothing, the ending of its `name` does. Empty for a file that neither tells, and for one of
/// the use that was asked for.
[[nodiscard]] std::string not_asked_for(std::string_view bytes, FileUse asked_for, std::string_view name = {});

/// The names in a zip archive, in the order of its table of contents; empty if it has none that can be read.
[[nodiscard]] std::vector<std::string> names_in_zip(std::string_view bytes);

/// The name of the first XML element, in lower case and without prefix; empty for other text, "?" if it is not within
/// the first 4 kB.
[[nodiscard]] std::string root_element(std::string_view text);

}  // namespace triskin
