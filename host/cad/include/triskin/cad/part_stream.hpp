// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// What the reader process writes to its standard output: frames of one byte for the kind, eight bytes for the length
/// (little endian) and the payload. Any number of kStage, then one kError or one kPart.
enum class FrameKind : char {
  kStage = 'S',  ///< The text says what the reader does next, for the message if it dies there.
  kError = 'E',  ///< The text is a sentence without the name of the file.
  kPart = 'P',   ///< The payload is that of encode_part().
};

/// One frame as bytes.
[[nodiscard]] std::string frame(FrameKind kind, std::string_view payload);

/// A part as bytes: eight bytes for the length of a JSON text, that text (docs/cad.md lists its keys), then the
/// vertices (three doubles each), the triangles (three 32-bit indices each) and the face of each triangle (32 bits),
/// all little endian. Cost: linear.
[[nodiscard]] std::string encode_part(const Part& part);

/// The part of encode_part(). Errors: InputError for bytes that are none, with an index out of range or a coordinate
/// that is not finite: the reader process is not trusted. Cost: linear.
[[nodiscard]] Part decode_part(std::string_view bytes);

/// All that a reader process said.
struct ReaderOutput {
  std::string stage;                 ///< It is the last stage that was reported.
  std::optional<std::string> error;  ///< It is the message of kError.
  std::optional<std::string> part;   ///< It is the payload of kPart.
};
/// Takes the frames apart; what follows an incomplete one is dropped. Cost: linear.
[[nodiscard]] ReaderOutput parse_frames(std::string_view bytes);

}  // namespace triskin::cad
