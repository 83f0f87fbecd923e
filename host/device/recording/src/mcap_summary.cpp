// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "record_walk.hpp"
#include "salvage.hpp"
#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording::mcap {
namespace {

constexpr std::uint64_t kChunkHeadMost = 256;  // Names of compressions are short, so a longer head is damaged.
constexpr std::uint64_t kIndexHead = 6, kIndexEntry = 16;

// The summary has these contents. The indexes of chunks are not stored here, but read again from the file.
struct Contents {
  std::vector<Buffer> schemas, channels, attachments, metadata;
  std::uint32_t chunks = 0;
  std::uint64_t messages = 0, start_ns = 0, end_ns = 0;
  std::map<std::uint16_t, std::uint64_t> counts;
};

Buffer copy_of(const ByteSource& source, const Place& place) {
  Buffer b;
  b.bytes(contents_of(source, place));
  return b;
}

Buffer attachment_index(const ByteSource& source, const Place& place) {
  Attachment a;
  (void)decode(contents_of(source, place), a);
  Buffer b;
  b.le64(place.offset);
  b.le64(place.end() - place.offset);
  b.le64(a.log_ns);
  b.le64(a.create_ns);
  b.le64(a.data.size());
  b.text(a.name);
  b.text(a.media_type);
  return b;
}

Buffer metadata_index(const ByteSource& source, const Place& place) {
  Metadata m;
  (void)decode(contents_of(source, place), m);
  Buffer b;
  b.le64(place.offset);
  b.le64(place.end() - place.offset);
  b.text(m.name);
  return b;
}

struct IndexHead {
  std::uint16_t channel = 0;
  std::uint64_t entries = 0;
};

IndexHead index_head(const ByteSource& source, const Place& place) {
  const auto head = contents_of(source, place, kIndexHead);
  ByteReader r(head);
  IndexHead h;
  h.channel = r.le16();
  h.entries = r.le32() / kIndexEntry;
  return h;
}

void add_chunk(const ByteSource& source, const Place& place, Contents& all) {
  ChunkHead head;
  if (!decode(contents_of(source, place, kChunkHeadMost), head)) return;
  all.start_ns = all.chunks == 0 && all.messages == 0 ? head.start_ns : std::min(all.start_ns, head.start_ns);
  all.end_ns = std::max(all.end_ns, head.end_ns);
  ++all.chunks;
}

std::uint16_t number_of(const Buffer& definition) {
  return ByteReader(definition.view()).le16();
}

// Adds the schemas and channels that other writers put into their chunks.
void add_definitions_in_chunks(const ByteSource& source, Contents& all) {
  std::set<std::uint16_t> schemas, channels;
  for (const Buffer& b : all.schemas) schemas.insert(number_of(b));
  for (const Buffer& b : all.channels) channels.insert(number_of(b));
  for (auto p = place_at(source, kMagic.size()); p; p = place_at(source, p->end())) {
    ChunkHead head;
    if (p->kind != Kind::kChunk) continue;
    const auto chunk = contents_of(source, *p);
    if (!decode(chunk, head) || !head.compression.empty()) continue;
    each_record(Bytes(chunk).subspan(head_bytes(head)), [&](Kind kind, Bytes contents) {
      Buffer definition;
      definition.bytes(contents);
      if (kind == Kind::kSchema && schemas.insert(number_of(definition)).second) all.schemas.push_back(definition);
      if (kind == Kind::kChannel && channels.insert(number_of(definition)).second) all.channels.push_back(definition);
      return true;
    });
  }
}

void add_message(const ByteSource& source, const Place& place, Contents& all) {
  Message m;
  if (!decode(contents_of(source, place), m)) return;
  const bool first = all.messages++ == 0 && all.chunks == 0;
  all.start_ns = first ? m.log_ns : std::min(all.start_ns, m.log_ns);
  all.end_ns = std::max(all.end_ns, m.log_ns);
  ++all.counts[m.channel];
}

Contents survey(const ByteSource& source) {
  Contents all;
  for (auto p = place_at(source, kMagic.size()); p; p = place_at(source, p->end())) {
    if (p->kind == Kind::kSchema) all.schemas.push_back(copy_of(source, *p));
    if (p->kind == Kind::kChannel) all.channels.push_back(copy_of(source, *p));
    if (p->kind == Kind::kAttachment) all.attachments.push_back(attachment_index(source, *p));
    if (p->kind == Kind::kMetadata) all.metadata.push_back(metadata_index(source, *p));
    if (p->kind == Kind::kChunk) add_chunk(source, *p, all);
    if (p->kind == Kind::kMessage) add_message(source, *p, all);  // Chunks are optional.
    if (p->kind != Kind::kMessageIndex) continue;
    const IndexHead index = index_head(source, *p);
    all.counts[index.channel] += index.entries;
    all.messages += index.entries;
  }
  const auto is_defined = [&](const auto& count) {
    return std::ranges::any_of(all.channels, [&](const Buffer& b) { return number_of(b) == count.first; });
  };
  if (!std::ranges::all_of(all.counts, is_defined)) add_definitions_in_chunks(source, all);
  return all;
}

Buffer statistics(const Contents& all) {
  Buffer b;
  b.le64(all.messages);
  b.le16(static_cast<std::uint16_t>(all.schemas.size()));
  b.le32(static_cast<std::uint32_t>(all.channels.size()));
  b.le32(static_cast<std::uint32_t>(all.attachments.size()));
  b.le32(static_cast<std::uint32_t>(all.metadata.size()));
  b.le32(all.chunks);
  b.le64(all.start_ns);
  b.le64(all.end_ns);
  b.le32(static_cast<std::uint32_t>(all.counts.size() * 10));
  for (const auto& [channel, count] : all.counts) {
    b.le16(channel);
    b.le64(count);
  }
  return b;
}

// Makes the index of the chunk at `chunk`; `next` becomes the record behind its message indexes.
Buffer chunk_index(const ByteSource& source, const Place& chunk, std::optional<Place>& next) {
  ChunkHead head;
  (void)decode(contents_of(source, chunk, kChunkHeadMost), head);
  Buffer offsets;
  for (next = place_at(source, chunk.end()); next && next->kind == Kind::kMessageIndex;
       next = place_at(source, next->end())) {
    offsets.le16(index_head(source, *next).channel);
    offsets.le64(next->offset);
  }
  const std::uint64_t end = next ? next->offset : source.size();
  Buffer b;
  b.le64(head.start_ns);
  b.le64(head.end_ns);
  b.le64(chunk.offset);
  b.le64(chunk.end() - chunk.offset);
  b.le32(static_cast<std::uint32_t>(offsets.size()));
  b.bytes(offsets.view());
  b.le64(end - chunk.end());
  b.text(head.compression);
  b.le64(head.stored_bytes);
  b.le64(head.size_bytes);
  return b;
}

// Writes the summary section and the records that follow it.
class Summary {
 public:
  explicit Summary(OutputFile& file) : file_(file), start_(file.size()) {}

  void group(Kind kind, const std::vector<Buffer>& records) {
    open(kind);
    for (const Buffer& contents : records) put(kind, contents);
    close();
  }
  // Summarizes the records up to `end`; meanwhile this object appends to the same file.
  void group_of_chunks(std::uint64_t end) {
    open(Kind::kChunkIndex);
    for (auto p = place_at(file_, kMagic.size()); p && p->offset < end;) {
      if (p->kind != Kind::kChunk) {
        p = place_at(file_, p->end());
        continue;
      }
      const Place chunk = *p;
      put(Kind::kChunkIndex, chunk_index(file_, chunk, p));
    }
    close();
  }
  void footer() {
    const std::uint64_t offsets_at = offsets_.size() > 0 ? file_.size() : 0;
    write(offsets_.view());
    Buffer contents;
    contents.le64(start_);
    contents.le64(offsets_at);
    Buffer head;
    head.u8(static_cast<std::uint8_t>(Kind::kFooter));
    head.le64(contents.size() + 4);
    head.bytes(contents.view());
    write(head.view());
    Buffer tail;
    tail.le32(crc_);
    tail.bytes(kMagic);
    file_.write(tail.view());
  }

 private:
  void write(Bytes bytes) {
    file_.write(bytes);
    crc_ = crc32(bytes, crc_);
  }
  void put(Kind kind, const Buffer& contents) {
    Buffer record;
    record.record(kind, contents);
    write(record.view());
  }
  void open(Kind kind) {
    kind_ = kind;
    group_at_ = file_.size();
  }
  void close() {
    if (file_.size() == group_at_) return;
    Buffer contents;
    contents.u8(static_cast<std::uint8_t>(kind_));
    contents.le64(group_at_);
    contents.le64(file_.size() - group_at_);
    offsets_.record(Kind::kSummaryOffset, contents);
  }

  OutputFile& file_;
  std::uint64_t start_, group_at_ = 0;
  Kind kind_{};
  Buffer offsets_;
  std::uint32_t crc_ = 0;
};

void put_bare_end(OutputFile& file) {
  Buffer b, footer;
  footer.le64(0);
  footer.le64(0);
  footer.le32(0);
  b.record(Kind::kFooter, footer);
  b.bytes(kMagic);
  file.write(b.view());
}

}  // namespace

std::optional<Place> place_at(const ByteSource& source, std::uint64_t offset) {
  std::array<std::uint8_t, kHeadBytes> head{};
  if (offset + kHeadBytes > source.size() || !source.read(offset, head)) return std::nullopt;
  ByteReader r(head);
  Place place;
  place.kind = static_cast<Kind>(r.u8());
  place.offset = offset;
  place.length = r.le64();
  if (place.length > source.size() - place.contents()) return std::nullopt;
  return place;
}

std::vector<std::uint8_t> contents_of(const ByteSource& source, const Place& place, std::uint64_t most) {
  std::vector<std::uint8_t> contents(std::min(most, place.length));
  if (!source.read(place.contents(), contents)) contents.clear();
  return contents;
}

void finish_file(OutputFile& file, std::uint32_t data_crc) {
  const std::uint64_t data_end = file.size();
  const Contents all = file.can_read() ? survey(file) : Contents{};
  Buffer contents, record;
  contents.le32(data_crc);
  record.record(Kind::kDataEnd, contents);
  file.write(record.view());
  if (!file.can_read()) return put_bare_end(file);
  Summary summary(file);
  summary.group(Kind::kSchema, all.schemas);
  summary.group(Kind::kChannel, all.channels);
  summary.group(Kind::kStatistics, {statistics(all)});
  summary.group_of_chunks(data_end);
  summary.group(Kind::kAttachmentIndex, all.attachments);
  summary.group(Kind::kMetadataIndex, all.metadata);
  summary.footer();
}

}  // namespace triskin::recording::mcap
