// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "record_walk.hpp"
#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording::mcap {

Writer::Writer(OutputFile& file, std::string_view profile, std::string_view library, ChunkLimits limits)
    : file_(file), limits_(limits) {
  Buffer header;
  header.text(profile);
  header.text(library);
  put(kMagic);
  put(Kind::kHeader, header);
}

void Writer::put(Bytes bytes) {
  file_.write(bytes);
  crc_ = crc32(bytes, crc_);
}

void Writer::put(Kind kind, const Buffer& contents) {
  Buffer record;
  record.record(kind, contents);
  put(record.view());
}

std::uint16_t Writer::add_schema(std::string_view name, std::string_view definition) {
  put(Kind::kSchema, encode(Schema{++schemas_, std::string(name), "ros2msg", std::string(definition)}));
  return schemas_;
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string_view topic, const TextMap& metadata) {
  const auto id = static_cast<std::uint16_t>(sequence_.size() + 1);
  sequence_[id] = 0;
  put(Kind::kChannel, encode(Channel{id, schema, std::string(topic), "cdr", metadata}));
  return id;
}

void Writer::write(std::uint16_t channel, std::uint64_t log_ns, Bytes data, std::uint64_t publish_ns) {
  if (waiting_ > 0 && log_ns > start_ns_ + limits_.span_ns) flush();
  if (waiting_ == 0) start_ns_ = end_ns_ = log_ns;
  start_ns_ = std::min(start_ns_, log_ns);
  end_ns_ = std::max(end_ns_, log_ns);
  chunk_.record(Kind::kMessage,
                encode(Message{channel, sequence_[channel]++, log_ns, publish_ns == 0 ? log_ns : publish_ns, data}));
  ++waiting_;
  if (chunk_.size() >= limits_.size_bytes) flush();
}

void Writer::attach(const Attachment& attachment) {
  flush();
  put(Kind::kAttachment, encode(attachment));
}

void Writer::describe(const Metadata& metadata) {
  flush();
  put(Kind::kMetadata, encode(metadata));
}

void Writer::flush() {
  if (waiting_ == 0) return;
  // The chunk and its index are written in one call, so that a killed process leaves both or neither, if the system
  // writes such calls completely.
  Buffer piece = encode_chunk(start_ns_, end_ns_, chunk_);
  piece.bytes(index_of(chunk_.view()).view());
  chunk_.clear();
  waiting_ = 0;
  put(piece.view());
}

void Writer::finish() {
  flush();
  finish_file(file_, crc_);
}

Buffer index_of(Bytes records) {
  std::map<std::uint16_t, Buffer> entries;
  for (std::size_t at = 0; at + kHeadBytes <= records.size();) {
    ByteReader r(records.subspan(at));
    const auto kind = static_cast<Kind>(r.u8());
    const std::uint64_t length = r.le64();
    if (length > r.rest().size()) break;
    Message m;
    if (kind == Kind::kMessage && decode(r.rest().first(length), m)) {
      entries[m.channel].le64(m.log_ns);
      entries[m.channel].le64(at);
    }
    at += kHeadBytes + length;
  }
  Buffer index;
  for (const auto& [channel, list] : entries) {
    Buffer contents;
    contents.le16(channel);
    contents.le32(static_cast<std::uint32_t>(list.size()));
    contents.bytes(list.view());
    index.record(Kind::kMessageIndex, contents);
  }
  return index;
}

}  // namespace triskin::recording::mcap
