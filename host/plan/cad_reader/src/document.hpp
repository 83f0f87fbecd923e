// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace triskin::cad_reader {

/// Holds what a file says about one face, solid or shell, whatever its place in an assembly.
struct Label {
  std::string name, colour, entity;
  bool is_hidden = false;  ///< Its author switched it off.
};

/// A solid, a shell or a single face at its place, in the unit of the document (mm).
struct PlacedBody {
  TopoDS_Shape shape;
  std::string name, path, colour;
  bool is_hidden = false;  ///< Its author switched off this component or one above it.
};

/// Holds the bodies of a file and the labels of their faces.
struct Document {
  std::string unit;      ///< The file calls its unit of length so; empty if there is none.
  double unit_mm = 1.0;  ///< The kernel scaled one unit to this length.
  std::vector<PlacedBody> bodies;
  std::unordered_map<const void*, Label> labels;  ///< The key is the shared shape of a face.
  /// Each warning is one sentence about information that could not be read beside the shapes.
  std::vector<std::string> warnings;
  std::vector<std::string> faults;  ///< Each fault is one sentence about entities that gave no shape.
};

/// Receives the name of the next step.
using StageSink = std::function<void(const std::string&)>;

/// Reads STEP from a stream, whose first line names the entities that are switched off. Errors: std::runtime_error with
/// a sentence.
[[nodiscard]] Document read_step(std::istream& text, const StageSink& stage);
/// Reads IGES from a file. Errors: std::runtime_error with a sentence.
[[nodiscard]] Document read_iges(const std::string& path, const StageSink& stage);

/// Returns the label of a face; an empty one if the file has none. Constant cost.
[[nodiscard]] const Label& label_of(const Document& document, const TopoDS_Shape& shape);

}  // namespace triskin::cad_reader
