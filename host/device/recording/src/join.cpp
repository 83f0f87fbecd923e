// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/join.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "salvage.hpp"
#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording {
namespace {

constexpr std::uint64_t kChunkHeadBytes = 64;  // Start, end, size, CRC and the name of no compression fit.

// Several parts can define the same schema or channel; the joint file gets each definition once.
class Definitions {
 public:
  explicit Definitions(mcap::Writer& writer) : writer_(writer) {}
  std::uint16_t schema(const mcap::Schema& s) {
    const auto [at, is_new] = schemas_.try_emplace({s.name, s.definition}, std::uint16_t{0});
    if (is_new) at->second = writer_.add_schema(s.name, s.definition);
    return at->second;
  }
  std::uint16_t channel(const mcap::Channel& c, std::uint16_t schema) {
    const auto [at, is_new] = channels_.try_emplace({schema, c.topic}, std::uint16_t{0});
    if (is_new) at->second = writer_.add_channel(schema, c.topic, c.metadata);
    return at->second;
  }

 private:
  mcap::Writer& writer_;
  std::map<std::pair<std::string, std::string>, std::uint16_t> schemas_;
  std::map<std::pair<std::uint16_t, std::string>, std::uint16_t> channels_;
};

// A part is read record by record.
class PartReader {
 public:
  explicit PartReader(const JoinPart& part)
      : name_(part.name), source_(part.path), found_(mcap::salvage(source_, part.path.string())) {}

  [[nodiscard]] bool has_next() const { return next_ < found_.records.size(); }
  // Returns the time of the next chunk; records that are not chunks return the earliest time.
  [[nodiscard]] std::uint64_t next_ns() const {
    const mcap::Place& place = found_.records[next_];
    mcap::ChunkHead head;
    if (place.kind != mcap::Kind::kChunk || !mcap::decode(mcap::contents_of(source_, place, kChunkHeadBytes), head))
      return 0;
    return head.start_ns;
  }
  void copy_next(mcap::Writer& writer, Definitions& definitions) {
    const mcap::Place place = found_.records[next_++];
    const auto contents = mcap::contents_of(source_, place);
    mcap::ChunkHead head;
    if (place.kind != mcap::Kind::kChunk) return take(place.kind, contents, writer, definitions);
    if (!mcap::decode(contents, head)) return;
    mcap::each_record(Bytes(contents).subspan(mcap::head_bytes(head)), [&](mcap::Kind kind, Bytes record) {
      take(kind, record, writer, definitions);
      return true;
    });
  }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  void take(mcap::Kind kind, Bytes contents, mcap::Writer& writer, Definitions& definitions) {
    if (kind == mcap::Kind::kSchema) return take_schema(contents, definitions);
    if (kind == mcap::Kind::kChannel) return take_channel(contents, definitions);
    if (kind == mcap::Kind::kMessage) return take_message(contents, writer);
    if (mcap::Attachment a; kind == mcap::Kind::kAttachment && mcap::decode(contents, a)) {
      a.name = name_ + "/" + a.name;
      writer.attach(a);
    }
    if (mcap::Metadata m; kind == mcap::Kind::kMetadata && mcap::decode(contents, m)) {
      m.name += "/" + name_;
      writer.describe(m);
    }
  }
  void take_schema(Bytes contents, Definitions& definitions) {
    if (mcap::Schema s; mcap::decode(contents, s)) schemas_[s.id] = definitions.schema(s);
  }
  void take_channel(Bytes contents, Definitions& definitions) {
    mcap::Channel c;
    if (mcap::decode(contents, c) && schemas_.contains(c.schema))
      channels_[c.id] = definitions.channel(c, schemas_.at(c.schema));
  }
  void take_message(Bytes contents, mcap::Writer& writer) {
    mcap::Message m;
    if (!mcap::decode(contents, m) || !channels_.contains(m.channel)) return;
    writer.write(channels_.at(m.channel), m.log_ns, m.data, m.publish_ns);
    ++messages_;
  }

  std::string name_;
  InputFile source_;
  mcap::Salvage found_;
  std::size_t next_ = 0;
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;  // They are keyed by the part's number.
  std::uint64_t messages_ = 0;
};

}  // namespace

std::uint64_t join(std::span<const JoinPart> parts, OutputFile& file) {
  mcap::Writer writer(file, "ros2", "triskin");
  Definitions definitions(writer);
  std::vector<std::unique_ptr<PartReader>> readers;
  for (const JoinPart& part : parts) readers.push_back(std::make_unique<PartReader>(part));
  const auto time_of = [](const auto& r) { return std::pair(!r->has_next(), r->has_next() ? r->next_ns() : 0); };
  while (std::ranges::any_of(readers, [](const auto& r) { return r->has_next(); }))
    (*std::ranges::min_element(readers, {}, time_of))->copy_next(writer, definitions);
  writer.finish();
  std::uint64_t messages = 0;
  for (const auto& r : readers) messages += r->messages();
  return messages;
}

}  // namespace triskin::recording
