// SPDX-License-Identifier: GPL-3.0-or-later
#include "salvage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording::mcap {
namespace {

constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kFooterBytes = 20, kDataEndBytes = 4;
constexpr std::size_t kMessageHeadBytes = 22;  // channel, sequence and two times
constexpr std::uint64_t kSearchStepBytes = std::uint64_t{1} << 20;

enum class State : std::uint8_t {
  kWhole,
  kContentDamaged,  // The record's length is right, so the next record begins behind it.
  kDamaged,         // Even the length of the record is unreliable.
};

// Each value is encoded again for comparison, because decoding alone accepts bytes behind the last field.
template <class Value>
bool is_exact(Bytes contents) {
  Value value;
  return decode(contents, value) && encode(value).size() == contents.size();
}

bool is_exact_index(Bytes contents) {
  ByteReader r(contents);
  (void)r.le16();
  const std::uint32_t bytes = r.le32();
  return r.ok() && bytes % 16 == 0 && bytes == r.rest().size();
}

bool is_exact_header(Bytes contents) {
  ByteReader r(contents);
  for (int text = 0; text < 2; ++text) {
    const std::uint32_t length = r.le32();
    if (!r.ok() || length > r.rest().size()) return false;
    r = ByteReader(r.rest().subspan(length));
  }
  return r.rest().empty();
}

// Checks, independently of the CRC, that the sizes stated in an attachment fill its record.
bool attachment_fills(Bytes contents) {
  ByteReader r(contents);
  (void)r.le64();
  (void)r.le64();
  for (int text = 0; text < 2; ++text) {
    const std::uint32_t length = r.le32();
    if (!r.ok() || length > r.rest().size()) return false;
    r = ByteReader(r.rest().subspan(length));
  }
  const std::uint64_t size = r.le64();
  return r.ok() && r.rest().size() >= 4 && size == r.rest().size() - 4;
}

bool is_name_of_compression(const std::string& text) {
  return text.size() <= 16 && std::ranges::all_of(text, [](char c) { return c >= 'a' && c <= 'z'; });
}

bool is_exact_inside(Kind kind, Bytes contents) {
  if (kind == Kind::kSchema) return is_exact<Schema>(contents);
  if (kind == Kind::kChannel) return is_exact<Channel>(contents);
  Message message;
  return kind != Kind::kMessage || decode(contents, message);
}

State state_of_chunk(Bytes contents, const std::string& name) {
  ChunkHead head;
  if (!decode(contents, head) || head_bytes(head) + head.stored_bytes != contents.size()) return State::kDamaged;
  if (!is_name_of_compression(head.compression)) return State::kContentDamaged;
  if (!head.compression.empty()) {
    throw InputError(fmt::format(
        "{}: is compressed with {}, which this program does not read; convert it with the tools of the format", name,
        head.compression));
  }
  const Bytes records = contents.subspan(head_bytes(head));
  const bool is_whole = (head.crc == 0 || crc32(records) == head.crc) && each_record(records, is_exact_inside);
  return is_whole ? State::kWhole : State::kContentDamaged;
}

std::uint64_t messages_in(Bytes chunk) {
  ChunkHead head;
  if (!decode(chunk, head)) return 0;
  std::uint64_t count = 0;
  each_record(chunk.subspan(head_bytes(head)), [&](Kind kind, Bytes) {
    count += kind == Kind::kMessage ? 1 : 0;
    return true;
  });
  return count;
}

// Walks through a file once.
class Walk {
 public:
  Walk(const ByteSource& source, const std::string& name) : source_(source), name_(name) {}

  Salvage run() {
    require_mcap();
    read_tail();
    std::uint64_t at = kMagic.size();
    while (at < source_.size() && !found_.has_data_end) at = step(at);
    found_.data_end = at;
    check_summary_region();
    compare_with_summary();
    check_data_crc();
    return std::move(found_);
  }

 private:
  void require_mcap() {
    std::array<std::uint8_t, kMagic.size()> magic{};
    const bool has_magic = source_.read(0, magic) && magic == kMagic;
    const auto header = place_at(source_, kMagic.size());
    if (!has_magic && (!header || header->kind != Kind::kHeader || state_of(*header) != State::kWhole))
      throw InputError(fmt::format("{}: not an MCAP file{}", name_, what_it_is(source_, name_)));
    if (!has_magic) lose(0, kMagic.size(), "the first bytes of the file");
  }

  [[nodiscard]] State state_of(const Place& place) const {
    if (place.length > kMaxRecordBytes) return State::kDamaged;
    const auto contents = contents_of(source_, place);
    if (contents.size() != place.length) return State::kDamaged;
    const auto exact = [](bool is) { return is ? State::kWhole : State::kDamaged; };
    switch (place.kind) {
      case Kind::kHeader:
        return exact(place.offset == kMagic.size() && is_exact_header(contents));
      case Kind::kSchema:
        return exact(is_exact<Schema>(contents));
      case Kind::kChannel:
        return exact(is_exact<Channel>(contents));
      case Kind::kMetadata:
        return exact(is_exact<Metadata>(contents));
      case Kind::kMessageIndex:
        return exact(is_exact_index(contents));
      case Kind::kDataEnd:
        return exact(contents.size() == kDataEndBytes);
      case Kind::kMessage:
        return exact(contents.size() >= kMessageHeadBytes);
      case Kind::kAttachment:
        if (!attachment_fills(contents)) return State::kDamaged;
        return is_exact<Attachment>(contents) ? State::kWhole : State::kContentDamaged;
      case Kind::kChunk:
        return state_of_chunk(contents, name_);
      default:
        return State::kDamaged;
    }
  }

  // Returns whether a record that can follow another one begins at `at`, or the file ends there.
  [[nodiscard]] bool can_follow(std::uint64_t at) const {
    if (at == source_.size()) return true;
    const auto place = place_at(source_, at);
    if (!place) return false;
    if (place->kind == Kind::kFooter) return place->length == kFooterBytes;
    return state_of(*place) != State::kDamaged;
  }

  std::uint64_t step(std::uint64_t at) {
    const auto place = place_at(source_, at);
    const State state = place ? state_of(*place) : State::kDamaged;
    if (state == State::kWhole) return keep(*place);
    const char* what = !place ? "a record that is not whole" : what_is(place->kind);
    if (state == State::kContentDamaged && can_follow(place->end())) {
      lose(at, place->end() - at, what);
      return skip_indexes(place->end());
    }
    // Bytes may be missing from the record, so a verified record may begin before the stated end. An unverified one
    // there counts as part of the contents.
    const std::uint64_t next = next_record(at + 1, state == State::kContentDamaged ? place->end() : at + 1);
    lose(at, next - at, what);
    return skip_indexes(next);
  }

  static const char* what_is(Kind kind) {
    switch (kind) {
      case Kind::kHeader:
        return "the header";
      case Kind::kSchema:
        return "the definition of a type";
      case Kind::kChannel:
        return "the definition of a channel";
      case Kind::kMetadata:
        return "a table";
      case Kind::kAttachment:
        return "a file that was attached";
      case Kind::kChunk:
        return "a chunk";
      default:
        return "a record";
    }
  }

  std::uint64_t keep(const Place& place) {
    if (place.kind == Kind::kDataEnd) {
      found_.has_data_end = true;
      data_end_place_ = place;
      return place.offset;
    }
    if (place.kind == Kind::kMessageIndex) {
      lose(place.offset, place.end() - place.offset, "an index without its chunk");
      return place.end();
    }
    found_.records.push_back(place);
    if (place.kind == Kind::kMessage) ++found_.messages;
    if (place.kind != Kind::kChunk) return place.end();
    const auto contents = contents_of(source_, place);
    ChunkHead head;
    (void)decode(contents, head);
    const ChunkHead right = head_from(contents, head);
    found_.messages += messages_in(contents);
    const auto is_same = [](const ChunkHead& a, const ChunkHead& b) {
      return a.start_ns == b.start_ns && a.end_ns == b.end_ns && a.size_bytes == b.size_bytes;
    };
    if (!is_same(head, right)) mend(place.offset, kHeadBytes + head_bytes(head), "the head of a chunk");
    return check_index(place, contents);
  }

  // An incomplete index of a chunk can be rebuilt, so nothing is lost.
  std::uint64_t check_index(const Place& chunk, Bytes contents) {
    ChunkHead head;
    (void)decode(contents, head);
    const Buffer wanted = index_of(contents.subspan(head_bytes(head)));
    std::vector<std::uint8_t> there(std::min<std::uint64_t>(wanted.size(), source_.size() - chunk.end()));
    if (source_.read(chunk.end(), there) && std::ranges::equal(there, wanted.view()))
      return chunk.end() + wanted.size();
    const std::uint64_t behind = skip_indexes(chunk.end(), false);
    const bool is_same = indexes_agree(chunk.end(), behind, wanted.view());
    if (is_same || behind == source_.size() || can_follow(behind)) {
      if (!is_same && behind > chunk.end()) mend(chunk.end(), behind - chunk.end(), "the index of a chunk");
      return behind;
    }
    const std::uint64_t next = skip_indexes(next_record(chunk.end() + 1, chunk.end() + 1));
    mend(chunk.end(), next - chunk.end(), "the index of a chunk");
    return next;
  }

  // Other writers may order the entries of an index, and the indexes of a chunk, differently.
  [[nodiscard]] bool indexes_agree(std::uint64_t from, std::uint64_t to, Bytes wanted) const {
    std::vector<std::uint8_t> bytes(to - from);
    return source_.read(from, bytes) && entries_of(bytes) == entries_of(wanted);
  }
  static std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> entries_of(Bytes indexes) {
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> entries;
    each_record(indexes, [&](Kind, Bytes contents) {
      ByteReader r(contents);
      auto& list = entries[r.le16()];
      for (std::uint32_t bytes = r.le32(); bytes >= 16 && r.ok(); bytes -= 16) {
        const std::uint64_t time = r.le64();
        list.emplace_back(time, r.le64());
      }
      std::ranges::sort(list);
      return true;
    });
    std::erase_if(entries, [](const auto& e) { return e.second.empty(); });
    return entries;
  }

  // Returns the position after the message indexes that begin at `at`; `is_lost` says that their chunk is lost.
  std::uint64_t skip_indexes(std::uint64_t at, bool is_lost = true) {
    for (auto place = place_at(source_, at); place && place->kind == Kind::kMessageIndex;
         place = place_at(source_, at)) {
      if (state_of(*place) != State::kWhole) return at;
      if (is_lost) lose(at, place->end() - at, "its index");
      at = place->end();
    }
    return at;
  }

  // Returns the first offset from `from` on where a record of the data section begins, or the size of the file. Before
  // `trusted_from` only a record with a CRC counts.
  [[nodiscard]] std::uint64_t next_record(std::uint64_t from, std::uint64_t trusted_from) const {
    const std::uint64_t size = source_.size();
    std::vector<std::uint8_t> window;
    for (std::uint64_t base = from; base + kHeadBytes <= size; base += kSearchStepBytes) {
      window.resize(std::min(kSearchStepBytes + kHeadBytes - 1, size - base));
      if (!source_.read(base, window)) return size;
      for (std::size_t k = 0; k + kHeadBytes <= window.size(); ++k) {
        if (may_begin(Bytes(window).subspan(k, kHeadBytes), size - base - k) &&
            begins_record(base + k, base + k >= trusted_from))
          return base + k;
      }
    }
    return size;
  }
  // Nearly all bytes fail this quick test.
  static bool may_begin(Bytes head, std::uint64_t left) {
    const auto kind = static_cast<Kind>(head[0]);
    const bool is_wanted = kind == Kind::kSchema || kind == Kind::kChannel || kind == Kind::kChunk ||
                           kind == Kind::kAttachment || kind == Kind::kMetadata || kind == Kind::kDataEnd;
    return is_wanted && ByteReader(head.subspan(1)).le64() <= left - kHeadBytes;
  }
  [[nodiscard]] bool begins_record(std::uint64_t at, bool is_trusted) const {
    const auto place = place_at(source_, at);
    if (!place) return false;
    if (place->kind == Kind::kChunk && !is_plausible_chunk(*place)) return false;
    const State state = state_of(*place);
    const bool proves_itself = place->kind == Kind::kChunk || place->kind == Kind::kAttachment;
    if (state == State::kWhole && proves_itself) return true;
    return is_trusted && state == State::kWhole && can_follow(place->end()) && place->end() < source_.size();
  }
  // Reads only the head, because the search must not read a megabyte for each byte that looks like a chunk.
  [[nodiscard]] bool is_plausible_chunk(const Place& place) const {
    ChunkHead head;
    return decode(contents_of(source_, place, 64), head) && head.compression.empty() &&
           head_bytes(head) + head.stored_bytes == place.length;
  }

  void lose(std::uint64_t offset, std::uint64_t bytes, std::string what) {
    if (bytes == 0) return;
    if (!found_.losses.empty()) {
      Loss& last = found_.losses.back();
      if (!last.is_mended && last.offset + last.bytes == offset) {
        last.bytes += bytes;
        return;
      }
    }
    found_.losses.push_back({offset, bytes, std::move(what), false});
  }
  void mend(std::uint64_t offset, std::uint64_t bytes, const char* what) {
    found_.losses.push_back({offset, bytes, what, true});
  }

  // Examines footer and magic bytes at the end of the file.
  void read_tail() {
    std::array<std::uint8_t, kHeadBytes + kFooterBytes + kMagic.size()> tail{};
    const std::uint64_t size = source_.size();
    if (size < tail.size() + kMagic.size() || !source_.read(size - tail.size(), tail)) return;
    const Bytes bytes(tail);
    if (!std::ranges::equal(bytes.last(kMagic.size()), kMagic)) return;
    ByteReader r(bytes);
    found_.has_footer = r.u8() == static_cast<std::uint8_t>(Kind::kFooter) && r.le64() == kFooterBytes;
    if (!found_.has_footer) return;
    const std::uint64_t start = r.le64();
    (void)r.le64();
    const std::uint32_t crc = r.le32();
    const std::uint64_t crc_at = size - kMagic.size() - 4;
    is_summary_unproved_ = start == 0 || crc == 0;  // The format allows a summary without position and without CRC.
    if (start < kMagic.size() || start >= crc_at) return;
    std::vector<std::uint8_t> summary(crc_at - start);
    if (summary.size() > kMaxRecordBytes || !source_.read(start, summary)) return;
    found_.has_summary = crc != 0 && crc32(summary) == crc;
    if (found_.has_summary) read_summary(summary);
  }
  void read_summary(Bytes summary) {
    each_record(summary, [&](Kind kind, Bytes contents) {
      if (kind == Kind::kSchema || kind == Kind::kChannel) {
        Buffer copy;
        copy.bytes(contents);
        (kind == Kind::kSchema ? found_.schemas : found_.channels)[ByteReader(contents).le16()] = std::move(copy);
      }
      return true;
    });
  }

  // Skips the records of the summary section, because recover() writes them again.
  void check_summary_region() {
    if (!found_.has_data_end || found_.has_summary) return;
    const std::uint64_t from = data_end_place_.offset;
    if (!found_.has_footer || !is_summary_unproved_)
      found_.losses.push_back({from, source_.size() - from, "the summary", true});
  }

  // If a definition differs from the summary, whose CRC is right, the one in the data section is damaged.
  void compare_with_summary() {
    if (!found_.has_summary) return;
    std::erase_if(found_.records, [&](const Place& place) {
      if (place.kind != Kind::kSchema && place.kind != Kind::kChannel) return false;
      auto& known = place.kind == Kind::kSchema ? found_.schemas : found_.channels;
      const auto contents = contents_of(source_, place);
      const auto same =
          std::ranges::find_if(known, [&](const auto& k) { return std::ranges::equal(k.second.view(), contents); });
      if (same != known.end()) {
        known.erase(same);
        return false;
      }
      const auto id = ByteReader(contents).le16();
      if (!known.contains(id) && seen_twice(place, id)) return false;
      found_.losses.push_back({place.offset, place.end() - place.offset, what_is(place.kind), true});
      return true;
    });
    std::ranges::sort(found_.losses, {}, &Loss::offset);
  }
  // The file may repeat a definition.
  [[nodiscard]] bool seen_twice(const Place& place, std::uint16_t id) const {
    const auto contents = contents_of(source_, place);
    return std::ranges::any_of(found_.records, [&](const Place& other) {
      if (other.kind != place.kind || other.offset == place.offset) return false;
      const auto also = contents_of(source_, other);
      return ByteReader(also).le16() == id && also == contents;
    });
  }

  void check_data_crc() {
    if (!found_.has_data_end) return;
    const auto contents = contents_of(source_, data_end_place_);
    const std::uint32_t stated = ByteReader(contents).le32();
    if (stated == 0) return;
    std::uint32_t crc = 0;
    std::vector<std::uint8_t> piece;
    for (std::uint64_t at = 0; at < found_.data_end; at += piece.size()) {
      piece.resize(std::min(kSearchStepBytes, found_.data_end - at));
      if (!source_.read(at, piece)) return;
      crc = crc32(piece, crc);
    }
    found_.is_checksum_wrong = crc != stated;
  }

  const ByteSource& source_;
  const std::string& name_;
  Place data_end_place_;
  bool is_summary_unproved_ = false;
  Salvage found_;
};

}  // namespace

ChunkHead head_from(Bytes contents, const ChunkHead& stated) {
  const Bytes records = contents.subspan(head_bytes(stated));
  ChunkHead head = stated;
  head.size_bytes = records.size();
  bool is_first = true;
  each_record(records, [&](Kind kind, Bytes inside) {
    Message message;
    if (kind != Kind::kMessage || !decode(inside, message)) return true;
    head.start_ns = is_first ? message.log_ns : std::min(head.start_ns, message.log_ns);
    head.end_ns = is_first ? message.log_ns : std::max(head.end_ns, message.log_ns);
    is_first = false;
    return true;
  });
  return head;
}

Salvage salvage(const ByteSource& source, const std::string& name) {
  return Walk(source, name).run();
}

}  // namespace triskin::recording::mcap
