// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "record_walk.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording::mcap {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{256} << 20;  // A single record may not be larger.

class Reading {
 public:
  Reading(const ByteSource& source, const std::string& name, Visitor& visitor)
      : source_(source), name_(name), visitor_(visitor) {}

  ReadReport run() {
    report_.file_bytes = source_.size();
    std::array<std::uint8_t, kMagic.size()> magic{};
    if (!source_.read(0, magic) || magic != kMagic)
      throw InputError(fmt::format("{}: not an MCAP file{}", name_, what_it_is(source_, name_)));
    report_.whole_bytes = kMagic.size();
    auto place = place_at(source_, kMagic.size());
    while (place && place->kind != Kind::kDataEnd && read(*place)) {
      report_.whole_bytes = place->end();
      place = place_at(source_, place->end());
    }
    finish(place);
    return report_;
  }

 private:
  void finish(const std::optional<Place>& place) {
    // A file without chunks and footer that ends after a record counts as cut too, because nobody knows what followed.
    if (place && place->kind == Kind::kDataEnd) {
      std::array<std::uint8_t, kMagic.size()> magic{};
      const std::uint64_t size = source_.size();
      report_.complete =
          size >= place->end() + kMagic.size() && source_.read(size - magic.size(), magic) && magic == kMagic;
    }
    if (!report_.complete && report_.problem.empty())
      report_.problem = fmt::format("ends at byte {} without having been closed", report_.file_bytes);
    if (due_.empty()) return;
    report_.whole_bytes = chunk_.end();
    report_.unindexed_chunk = chunk_.offset;
  }

  bool fail(const Place& place, const char* what) {
    report_.problem = fmt::format("{} at byte {}", what, place.offset);
    return false;
  }

  bool read(const Place& place) {
    if (place.kind == Kind::kMessageIndex) return read_index(place);
    due_.clear();  // Other writers may omit the index.
    if (place.length > kMaxBytes) return fail(place, "a record is too long");
    const auto contents = contents_of(source_, place);
    if (contents.size() != place.length) return fail(place, "a record cannot be read");
    if (place.kind == Kind::kChunk) return read_chunk(place, contents);
    return read_record(place.kind, contents) || fail(place, "a record is damaged");
  }

  bool read_record(Kind kind, Bytes contents) {
    switch (kind) {
      case Kind::kSchema:
        return pass<Schema>(contents, &Visitor::on_schema);
      case Kind::kChannel:
        return pass<Channel>(contents, &Visitor::on_channel);
      case Kind::kAttachment:
        return pass<Attachment>(contents, &Visitor::on_attachment);
      case Kind::kMetadata:
        return pass<Metadata>(contents, &Visitor::on_metadata);
      case Kind::kMessage:
        ++report_.messages;
        return pass<Message>(contents, &Visitor::on_message);
      default:
        return static_cast<int>(kind) != 0;  // Records of kinds from later versions are skipped.
    }
  }

  template <class Value>
  bool pass(Bytes contents, void (Visitor::*told)(const Value&)) {
    Value value;
    if (!decode(contents, value)) return false;
    (visitor_.*told)(value);
    return true;
  }

  bool read_chunk(const Place& place, Bytes contents) {
    ChunkHead head;
    if (!decode(contents, head)) return fail(place, "a chunk is damaged");
    if (!head.compression.empty())
      throw InputError(
          fmt::format("{}: is compressed with {}, which this program does not read; convert it with the "
                      "tools of the format",
                      name_, head.compression));
    const Bytes records = contents.subspan(head_bytes(head));
    if (records.size() != head.stored_bytes || (head.crc != 0 && crc32(records) != head.crc))
      return fail(place, "a chunk is damaged: wrong CRC");
    chunk_ = place;
    return read_records(records) || fail(place, "a chunk holds a damaged record");
  }

  bool read_records(Bytes records) {
    while (!records.empty()) {
      ByteReader r(records);
      const auto kind = static_cast<Kind>(r.u8());
      const std::uint64_t length = r.le64();
      if (!r.ok() || length > r.rest().size()) return false;
      const Bytes contents = r.rest().first(length);
      if (!read_record(kind, contents)) return false;
      if (kind == Kind::kMessage) due_.insert(ByteReader(contents).le16());
      records = r.rest().subspan(length);
    }
    return true;
  }

  bool read_index(const Place& place) {
    const auto head = contents_of(source_, place, 2);
    due_.erase(ByteReader(head).le16());
    return true;
  }

  const ByteSource& source_;
  const std::string& name_;
  Visitor& visitor_;
  ReadReport report_;
  Place chunk_;
  std::set<std::uint16_t> due_;  // Only channels of the last chunk that still lack an index are listed.
};

}  // namespace

std::string what_it_is(const ByteSource& source, const std::string& name) {
  if (source.size() == 0) return ": it is empty; give one that \"triskin record\" wrote";
  constexpr std::uint64_t kLooked = std::uint64_t{1} << 20;
  std::vector<std::uint8_t> bytes(std::min(kLooked, source.size()));
  if (!source.read(0, bytes)) return " (wrong first bytes)";
  const std::string what =
      not_asked_for({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, FileUse::kRecording, name);
  return what.empty() ? " (wrong first bytes); give one that \"triskin record\" wrote" : ": it is " + what;
}

ReadReport read_file(const ByteSource& source, const std::string& name, Visitor& visitor) {
  return Reading(source, name, visitor).run();
}

}  // namespace triskin::recording::mcap
