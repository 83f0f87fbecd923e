// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/mcap.hpp"

namespace triskin::recording::mcap {
namespace {

Bytes bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

bool take(ByteReader& r, std::uint64_t n, std::string& text) {
  const Bytes rest = r.rest();
  if (!r.ok() || n > rest.size()) return false;
  text.assign(reinterpret_cast<const char*>(rest.data()), n);
  r = ByteReader(rest.subspan(n));
  return true;
}

bool take_text(ByteReader& r, std::string& text) {
  const std::uint32_t n = r.le32();
  return take(r, n, text);
}

bool take_map(ByteReader& r, TextMap& map) {
  std::string packed;
  if (!take_text(r, packed)) return false;
  ByteReader inner(bytes_of(packed));
  while (!inner.rest().empty()) {
    std::string key, value;
    if (!take_text(inner, key) || !take_text(inner, value)) return false;
    map[key] = value;
  }
  return true;
}

}  // namespace

void Buffer::bytes(Bytes in) {
  bytes_.insert(bytes_.end(), in.begin(), in.end());
}

void Buffer::little(std::uint64_t v, int n) {
  for (int k = 0; k < n; ++k) bytes_.push_back(static_cast<std::uint8_t>(v >> (8 * k)));
}

void Buffer::text(std::string_view text) {
  le32(static_cast<std::uint32_t>(text.size()));
  bytes(bytes_of(text));
}

void Buffer::text_map(const TextMap& map) {
  Buffer packed;
  for (const auto& [key, value] : map) {
    packed.text(key);
    packed.text(value);
  }
  le32(static_cast<std::uint32_t>(packed.size()));
  bytes(packed.view());
}

void Buffer::record(Kind kind, const Buffer& contents) {
  u8(static_cast<std::uint8_t>(kind));
  le64(contents.size());
  bytes(contents.view());
}

Buffer encode(const Schema& schema) {
  Buffer b;
  b.le16(schema.id);
  b.text(schema.name);
  b.text(schema.encoding);
  b.text(schema.definition);
  return b;
}

Buffer encode(const Channel& channel) {
  Buffer b;
  b.le16(channel.id);
  b.le16(channel.schema);
  b.text(channel.topic);
  b.text(channel.encoding);
  b.text_map(channel.metadata);
  return b;
}

Buffer encode(const Message& message) {
  Buffer b;
  b.le16(message.channel);
  b.le32(message.sequence);
  b.le64(message.log_ns);
  b.le64(message.publish_ns);
  b.bytes(message.data);
  return b;
}

Buffer encode(const Attachment& attachment) {
  Buffer b;
  b.le64(attachment.log_ns);
  b.le64(attachment.create_ns);
  b.text(attachment.name);
  b.text(attachment.media_type);
  b.le64(attachment.data.size());
  b.bytes(bytes_of(attachment.data));
  b.le32(crc32(b.view()));
  return b;
}

Buffer encode(const Metadata& metadata) {
  Buffer b;
  b.text(metadata.name);
  b.text_map(metadata.entries);
  return b;
}

Buffer encode_chunk(std::uint64_t start_ns, std::uint64_t end_ns, const Buffer& records) {
  Buffer contents;
  contents.le64(start_ns);
  contents.le64(end_ns);
  contents.le64(records.size());
  contents.le32(crc32(records.view()));
  contents.text("");
  contents.le64(records.size());
  contents.bytes(records.view());
  Buffer record;
  record.record(Kind::kChunk, contents);
  return record;
}

bool decode(Bytes contents, Schema& schema) {
  ByteReader r(contents);
  schema.id = r.le16();
  return take_text(r, schema.name) && take_text(r, schema.encoding) && take_text(r, schema.definition);
}

bool decode(Bytes contents, Channel& channel) {
  ByteReader r(contents);
  channel.id = r.le16();
  channel.schema = r.le16();
  return take_text(r, channel.topic) && take_text(r, channel.encoding) && take_map(r, channel.metadata);
}

bool decode(Bytes contents, Message& message) {
  ByteReader r(contents);
  message.channel = r.le16();
  message.sequence = r.le32();
  message.log_ns = r.le64();
  message.publish_ns = r.le64();
  message.data = r.rest();
  return r.ok();
}

bool decode(Bytes contents, Attachment& attachment) {
  ByteReader r(contents);
  attachment.log_ns = r.le64();
  attachment.create_ns = r.le64();
  if (!take_text(r, attachment.name) || !take_text(r, attachment.media_type)) return false;
  const std::uint64_t size = r.le64();
  if (!take(r, size, attachment.data)) return false;
  const std::size_t before = contents.size() - r.rest().size();
  const std::uint32_t crc = r.le32();
  return r.ok() && (crc == 0 || crc == crc32(contents.first(before)));
}

bool decode(Bytes contents, Metadata& metadata) {
  ByteReader r(contents);
  return take_text(r, metadata.name) && take_map(r, metadata.entries);
}

bool decode(Bytes contents, ChunkHead& head) {
  ByteReader r(contents);
  head.start_ns = r.le64();
  head.end_ns = r.le64();
  head.size_bytes = r.le64();
  head.crc = r.le32();
  if (!take_text(r, head.compression)) return false;
  head.stored_bytes = r.le64();
  return r.ok();
}

std::size_t head_bytes(const ChunkHead& head) {
  return 8 + 8 + 8 + 4 + 4 + head.compression.size() + 8;
}

}  // namespace triskin::recording::mcap
