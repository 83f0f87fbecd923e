// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// The reader process writes frames to its standard output: one byte for the kind, eight bytes for the length (little
/// endian) and the payload. Any number of kStage is followed by one kError or one kPart.
enum class FrameKind : char {
  kStage = 'S',  ///< The text names the next step of the reader, for the message if it dies there.
  kError = 'E',  ///< The text is a sentence without the name of the file.
  kPart = 'P',   ///< encode_part() made the payload.
};

/// Returns one frame as bytes.
[[nodiscard]] std::string frame(FrameKind kind, std::string_view payload);

/// Encodes a part as bytes: eight bytes for the length of a JSON text, that text (docs/cad.md lists its keys), then the
/// vertices (three doubles each), the triangles (three 32-bit indices each) and the face of each triangle (32 bits),
/// all little endian. Cost: linear.
[[nodiscard]] std::string encode_part(const Part& part);

/// Decodes the bytes of encode_part(). Errors: InputError for other bytes, with an index out of range or a coordinate
/// that is not finite, because the reader process is not trusted. Cost: linear.
[[nodiscard]] Part decode_part(std::string_view bytes);

/// Collects all output of a reader process.
struct ReaderOutput {
  std::string stage;                 ///< The reader reported this stage last.
  std::optional<std::string> error;  ///< The message of kError, if there was one.
  std::optional<std::string> part;   ///< The payload of kPart, if there was one.
};
/// Splits output into frames; bytes after an incomplete one are dropped. Cost: linear.
[[nodiscard]] ReaderOutput parse_frames(std::string_view bytes);

}  // namespace triskin::cad
