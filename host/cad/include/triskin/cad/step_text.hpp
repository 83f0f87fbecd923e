// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace triskin::cad {

/// Content of a STEP file's text, read before any geometry is built.
struct StepText {
  std::string text;    ///< the same file in the form that every reader takes: no comments, no white space between `#12`
                       ///< and `=`, no control characters in strings, strings in ASCII with \X2\ escapes
  std::string schema;  ///< It is "AP203", "AP214", "AP242" or the name in FILE_SCHEMA.
  bool has_length_unit = false;             ///< The context of a shape names a unit of length.
  int faces = 0;                            ///< It counts exact faces: ADVANCED_FACE and FACE_SURFACE.
  int tessellated = 0;                      ///< It counts AP242 triangles without exact faces.
  int csg = 0;                              ///< It counts primitives and set operations of constructive solids.
  std::vector<std::string> external_files;  ///< They are names that DOCUMENT_FILE refers to, with any characters.
  std::vector<std::string> warnings;        ///< Each is one sentence.
};

/// What a file that is no STEP file seems to be ("an STL", "a gzip archive", "an IGES file"); empty: nothing known.
[[nodiscard]] std::string looks_like(std::string_view bytes);

/// True when the bytes begin as a STEP file does, white space, comments and a byte order mark aside.
[[nodiscard]] bool is_step(std::string_view bytes);
/// True when the bytes have the columns of an IGES file.
[[nodiscard]] bool is_iges(std::string_view bytes);

/// Reads a STEP file (ISO 10303-21) as text and refuses what no geometry kernel should see: damage of the syntax,
/// numbers that are not finite, entities that refer to themselves, products that contain themselves, brackets deeper
/// than 64. Errors: InputError with one sentence that names the entity (`#23`) or line, without the name of the file.
/// Cost: linear in time and memory (about five times the file). Thread-safe.
[[nodiscard]] StepText read_step_text(std::string_view bytes);

}  // namespace triskin::cad
