// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/core/bytes.hpp"

/// The records follow the public specification of the format MCAP, version 0 (mcap.dev/spec). All numbers are
/// little-endian; every record consists of its kind (1 byte), the length of its contents (8) and the contents.
namespace triskin::recording::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kHeadBytes = 9;  ///< A record begins with its kind and length.

enum class Kind : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kAttachment = 9,
  kAttachmentIndex = 10,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

using TextMap = std::map<std::string, std::string>;

/// A schema defines a message type.
struct Schema {
  std::uint16_t id = 0;  ///< Valid ids begin at 1.
  std::string name, encoding, definition;
  bool operator==(const Schema&) const = default;
};

/// All messages of a topic have one schema.
struct Channel {
  std::uint16_t id = 0, schema = 0;
  std::string topic, encoding;
  TextMap metadata;
  bool operator==(const Channel&) const = default;
};

/// The `data` of a message is valid as long as the buffer that it was read from.
struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_ns = 0, publish_ns = 0;
  Bytes data;
};

/// A recording can have files embedded.
struct Attachment {
  std::uint64_t log_ns = 0, create_ns = 0;
  std::string name, media_type, data;
};

/// Metadata are a table of texts.
struct Metadata {
  std::string name;
  TextMap entries;
};

/// The head of a chunk precedes its records.
struct ChunkHead {
  /// Both times are those of messages, the earliest and the latest; the size is that of the records.
  std::uint64_t start_ns = 0, end_ns = 0, size_bytes = 0;
  std::uint32_t crc = 0;           ///< The CRC covers the records; 0 means that there is none.
  std::string compression;         ///< An empty text means that the chunk is not compressed.
  std::uint64_t stored_bytes = 0;  ///< The records take this many bytes in the file.
};

/// The buffer grows as needed and knows the encodings of the format.
class Buffer {
 public:
  /// Appends one byte.
  void u8(std::uint8_t v) { bytes_.push_back(v); }
  /// Appends two bytes.
  void le16(std::uint16_t v) { little(v, 2); }
  /// Appends four bytes.
  void le32(std::uint32_t v) { little(v, 4); }
  /// Appends eight bytes.
  void le64(std::uint64_t v) { little(v, 8); }
  /// Appends the bytes unchanged.
  void bytes(Bytes in);
  /// Appends the length in 4 bytes, then the text. Throws nothing of its own.
  void text(std::string_view text);
  /// Appends the length in 4 bytes, then keys and values.
  void text_map(const TextMap& map);
  /// Appends a record: kind, length, contents.
  void record(Kind kind, const Buffer& contents);
  void clear() { bytes_.clear(); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  /// Returns the bytes so far; the view is valid until more is appended.
  [[nodiscard]] Bytes view() const { return bytes_; }

 private:
  void little(std::uint64_t v, int n);
  std::vector<std::uint8_t> bytes_;
};

/// Encodes the record of a schema, without the record's head. Throws nothing of its own.
[[nodiscard]] Buffer encode(const Schema& schema);
/// Encodes the record of a channel, without the record's head. Throws nothing of its own.
[[nodiscard]] Buffer encode(const Channel& channel);
/// Encodes the record of a message, without the record's head. Throws nothing of its own.
[[nodiscard]] Buffer encode(const Message& message);
/// Encodes the record of an attachment with its CRC, without the record's head. Throws nothing of its own.
[[nodiscard]] Buffer encode(const Attachment& attachment);
/// Encodes the record of a table of metadata, without the record's head. Throws nothing of its own.
[[nodiscard]] Buffer encode(const Metadata& metadata);
/// Makes a whole, uncompressed chunk record of `records`, whose messages lie in start_ns … end_ns.
[[nodiscard]] Buffer encode_chunk(std::uint64_t start_ns, std::uint64_t end_ns, const Buffer& records);

/// Decodes the record of a schema; returns false if it is malformed. Throws nothing of its own.
[[nodiscard]] bool decode(Bytes contents, Schema& schema);
/// Decodes the record of a channel; returns false if it is malformed. Throws nothing of its own.
[[nodiscard]] bool decode(Bytes contents, Channel& channel);
/// Decodes the record of a message; returns false if it is malformed. Throws nothing of its own.
[[nodiscard]] bool decode(Bytes contents, Message& message);
/// Decodes the record of an attachment; returns false if it is malformed or its CRC is wrong. Throws nothing of its
/// own.
[[nodiscard]] bool decode(Bytes contents, Attachment& attachment);
/// Decodes the record of a table of metadata; returns false if it is malformed. Throws nothing of its own.
[[nodiscard]] bool decode(Bytes contents, Metadata& metadata);
/// Decodes the head of a chunk from the first bytes of its contents; returns false if it is malformed. Throws nothing
/// of its own.
[[nodiscard]] bool decode(Bytes contents, ChunkHead& head);
/// Returns the number of bytes of a chunk's contents before its records.
[[nodiscard]] std::size_t head_bytes(const ChunkHead& head);

}  // namespace triskin::recording::mcap
