// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace triskin::cad_reader {

/// What a file says of one face, solid or shell, whatever its place in an assembly.
struct Label {
  std::string name, colour, entity;
};

/// A solid, a shell or a lone face in its place, in the unit of the document (mm).
struct PlacedBody {
  TopoDS_Shape shape;
  std::string name, path, colour;
};

/// Bodies of a file with what it says of their faces.
struct Document {
  std::string unit;      ///< It is the name of the unit of length in the file, and empty where there is none.
  double unit_mm = 1.0;  ///< The kernel applied this length for one unit.
  std::vector<PlacedBody> bodies;
  std::unordered_map<const void*, Label> labels;  ///< They are keyed by the shared shape of a face.
  std::vector<std::string> warnings;  ///< Each is one sentence about what could not be read beside the shapes.
  std::vector<std::string> faults;    ///< Each is one sentence about entities that gave no shape.
};

/// Called with what is done next.
using StageSink = std::function<void(const std::string&)>;

/// Reads STEP from a stream. Errors: std::runtime_error with a sentence.
[[nodiscard]] Document read_step(std::istream& text, const StageSink& stage);
/// Reads IGES from a file. Errors: std::runtime_error with a sentence.
[[nodiscard]] Document read_iges(const std::string& path, const StageSink& stage);

/// The label of a face; an empty one where the file says nothing. Constant cost.
[[nodiscard]] const Label& label_of(const Document& document, const TopoDS_Shape& shape);

}  // namespace triskin::cad_reader
