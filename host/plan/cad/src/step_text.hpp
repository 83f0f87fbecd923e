// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace triskin::cad {

/// Holds what the text of a STEP file says before any geometry is built.
struct StepText {
  /// The same file in a form that every reader accepts: no comments, no white space between `#12` and `=`, no control
  /// characters in strings, strings in ASCII with \X2\ escapes.
  std::string text;
  std::string schema;                       ///< The schema is "AP203", "AP214", "AP242" or the name in FILE_SCHEMA.
  bool has_length_unit = false;             ///< True if the context of a shape names a unit of length.
  int faces = 0;                            ///< Only exact faces count: ADVANCED_FACE and FACE_SURFACE.
  int tessellated = 0;                      ///< Triangles of AP242 without exact faces count here.
  int csg = 0;                              ///< Primitives and set operations of constructive solids count here.
  std::vector<std::string> external_files;  ///< DOCUMENT_FILE refers to these names, which may contain any characters.
  std::vector<std::int64_t> hidden;  ///< Entities that the author made invisible, by a style or a layer; ascending.
  std::vector<std::string> warnings;
};

/// Guesses what a file that is no STEP file is ("an STL", "a gzip archive", "an IGES file"); empty if unknown.
[[nodiscard]] std::string looks_like(std::string_view bytes);

/// Returns true when the bytes begin as a STEP file does, ignoring white space, comments and a byte order mark.
[[nodiscard]] bool is_step(std::string_view bytes);
/// Returns true when the bytes have the columns of an IGES file.
[[nodiscard]] bool is_iges(std::string_view bytes);

/// Reads a STEP file (ISO 10303-21) as text and refuses input that is unsafe for a geometry kernel: damaged syntax,
/// numbers that are not finite, entities that refer to themselves, products that contain themselves, brackets deeper
/// than 64. Errors: InputError with one sentence that names the entity (`#23`) or line, without the name of the file.
/// Cost: linear in time and memory (about five times the file). Thread-safe.
[[nodiscard]] StepText read_step_text(std::string_view bytes);

}  // namespace triskin::cad
