// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "salvage.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::recording {
namespace {

// A killed writer leaves at most one open chunk and its index behind the last whole one.
constexpr std::uint64_t kMaxOpenBytes = std::uint64_t{4} << 20;

// Copies the intact parts into another file.
class Rescue {
 public:
  Rescue(const ByteSource& source, const mcap::Salvage& found, OutputFile& file)
      : source_(source), found_(found), file_(file) {}

  // Messages are left out if the definition of their channel is damaged, because no reader could understand them.
  std::uint64_t run() {
    find_definitions();
    file_.write(mcap::kMagic);
    put_header();
    if (!found_.losses.empty()) put_definitions();
    for (const mcap::Place& place : found_.records) {
      if (place.kind != mcap::Kind::kHeader) put(place);
    }
    mcap::finish_file(file_, 0);
    return unreachable_;
  }

 private:
  // A channel is only usable if its type is known, so the types are searched first.
  void find_definitions() {
    for (const auto& [id, contents] : found_.schemas) schemas_.insert(id);
    each_of(mcap::Kind::kSchema, [&](Bytes contents) { schemas_.insert(ByteReader(contents).le16()); });
    for (const auto& [id, contents] : found_.channels) add_channel(contents.view());
    each_of(mcap::Kind::kChannel, [&](Bytes contents) { add_channel(contents); });
  }
  template <class Take>
  void each_of(mcap::Kind kind, Take take) const {
    for (const mcap::Place& place : found_.records) {
      if (place.kind == kind) take(mcap::contents_of(source_, place));
    }
  }
  void add_channel(Bytes contents) {
    ByteReader r(contents);
    const std::uint16_t id = r.le16(), schema = r.le16();
    if (schema == 0 || schemas_.contains(schema)) channels_.insert(id);
  }

  void put_header() {
    const auto header = std::ranges::find(found_.records, mcap::Kind::kHeader, &mcap::Place::kind);
    if (header != found_.records.end()) return put_bytes(mcap::Kind::kHeader, mcap::contents_of(source_, *header));
    mcap::Buffer contents;
    contents.text("ros2");
    contents.text("triskin");
    put_bytes(mcap::Kind::kHeader, contents.view());
  }
  // Types must precede channels, and the definitions from the summary must precede the records.
  void put_definitions() {
    for (const auto& [id, contents] : found_.schemas) put_definition(mcap::Kind::kSchema, contents.view());
    if (found_.channels.empty()) return;
    each_of(mcap::Kind::kSchema, [&](Bytes contents) { put_definition(mcap::Kind::kSchema, contents); });
    for (const auto& [id, contents] : found_.channels) put_definition(mcap::Kind::kChannel, contents.view());
  }
  void put_definition(mcap::Kind kind, Bytes contents) {
    if (put_.insert({kind, ByteReader(contents).le16()}).second) put_bytes(kind, contents);
  }

  void put(const mcap::Place& place) {
    const auto contents = mcap::contents_of(source_, place);
    if (place.kind == mcap::Kind::kChannel && !channels_.contains(ByteReader(contents).le16())) return;
    if (place.kind == mcap::Kind::kMessage && !channels_.contains(ByteReader(contents).le16())) {
      ++unreachable_;
      return;
    }
    if (place.kind == mcap::Kind::kSchema || place.kind == mcap::Kind::kChannel)
      return put_definition(place.kind, contents);
    if (place.kind != mcap::Kind::kChunk) return put_bytes(place.kind, contents);
    put_chunk(contents);
  }
  void put_chunk(Bytes contents) {
    mcap::ChunkHead stated;
    (void)mcap::decode(contents, stated);
    const mcap::ChunkHead head = mcap::head_from(contents, stated);
    const Bytes records = contents.subspan(mcap::head_bytes(head));
    mcap::Buffer kept;
    const std::uint64_t before = unreachable_;
    mcap::each_record(records, [&](mcap::Kind kind, Bytes inside) {
      if (kind == mcap::Kind::kSchema) schemas_.insert(ByteReader(inside).le16());
      if (kind == mcap::Kind::kChannel) add_channel(inside);
      const bool is_known = kind != mcap::Kind::kMessage || channels_.contains(ByteReader(inside).le16());
      unreachable_ += is_known ? 0 : 1;
      mcap::Buffer copy;
      copy.bytes(inside);
      if (is_known) kept.record(kind, copy);
      return true;
    });
    const bool is_head_right =
        stated.start_ns == head.start_ns && stated.end_ns == head.end_ns && stated.size_bytes == head.size_bytes;
    if (unreachable_ == before && is_head_right)
      put_bytes(mcap::Kind::kChunk, contents);
    else
      file_.write(mcap::encode_chunk(head.start_ns, head.end_ns, kept).view());
    file_.write(mcap::index_of(kept.view()).view());
  }
  void put_bytes(mcap::Kind kind, Bytes contents) {
    mcap::Buffer copy, record;
    copy.bytes(contents);
    record.record(kind, copy);
    file_.write(record.view());
  }

  const ByteSource& source_;
  const mcap::Salvage& found_;
  OutputFile& file_;
  std::set<std::uint16_t> schemas_, channels_;
  std::set<std::pair<mcap::Kind, std::uint16_t>> put_;  // The new file already has these definitions.
  std::uint64_t unreachable_ = 0;
};

// Computes for each loss between which messages it lies, in seconds from the first one.
void add_times(const ByteSource& source, const mcap::Salvage& found, std::vector<Loss>& losses) {
  std::optional<std::uint64_t> first_ns;
  for (Loss& loss : losses) loss.to_s = -1.0;
  for (const mcap::Place& place : found.records) {
    mcap::ChunkHead head;
    if (place.kind != mcap::Kind::kChunk || !mcap::decode(mcap::contents_of(source, place, 64), head)) continue;
    if (!first_ns) first_ns = head.start_ns;
    const auto seconds = [&](std::uint64_t ns) { return static_cast<double>(ns - *first_ns) * 1e-9; };
    for (Loss& loss : losses) {
      if (place.offset < loss.offset) loss.from_s = std::max(loss.from_s, seconds(head.end_ns));
      if (place.offset > loss.offset && loss.to_s < 0.0) loss.to_s = seconds(head.start_ns);
    }
  }
}

std::string problem_of(const mcap::Salvage& found, std::uint64_t file_bytes) {
  const auto first = std::ranges::find(found.losses, false, &Loss::is_mended);
  if (first != found.losses.end() && first->offset + first->bytes < file_bytes)
    return fmt::format("{} is damaged at byte {}", first->what, first->offset);
  if (!found.has_footer) return fmt::format("ends at byte {} without having been closed", file_bytes);
  if (!found.losses.empty())
    return fmt::format("{} is damaged at byte {}", found.losses.front().what, found.losses.front().offset);
  return "a byte outside the chunks is another one: the CRC of the whole is wrong";
}

// Returns true if the file is intact up to its last whole record, as after a writer was killed.
bool is_only_cut(const mcap::Salvage& found, std::uint64_t file_bytes) {
  if (found.has_footer || found.is_checksum_wrong) return false;
  const auto reaches_end = [&](const Loss& loss) { return loss.offset + loss.bytes == file_bytes; };
  if (found.losses.empty()) return true;
  const Loss& last = found.losses.back();
  return found.losses.size() == 1 && reaches_end(last) && (last.is_mended || last.bytes <= kMaxOpenBytes);
}

// Returns the end of the data that stays in place; the indexes of a last chunk are excluded and written again.
std::uint64_t end_of_records(const mcap::Salvage& found) {
  return found.records.empty() ? mcap::kMagic.size() : found.records.back().end();
}

mcap::Buffer index_of_last_chunk(const ByteSource& source, const mcap::Salvage& found) {
  if (found.records.empty() || found.records.back().kind != mcap::Kind::kChunk) return {};
  const auto contents = mcap::contents_of(source, found.records.back());
  mcap::ChunkHead head;
  (void)mcap::decode(contents, head);
  return mcap::index_of(Bytes(contents).subspan(mcap::head_bytes(head)));
}

void complete_in_place(const std::filesystem::path& path, std::uint64_t keep_bytes, const mcap::Buffer& index) {
  OutputFile file(path, keep_bytes);
  file.write(index.view());
  mcap::finish_file(file, 0);
  file.close();
}

std::uint64_t dropped_bytes(const std::vector<Loss>& losses) {
  std::uint64_t bytes = 0;
  for (const Loss& loss : losses) bytes += loss.bytes;
  return bytes;
}

}  // namespace

Recovery recover(const std::filesystem::path& path, const std::filesystem::path& output) {
  const std::string name = path.string();
  const InputFile source(path);
  const mcap::Salvage found = mcap::salvage(source, name);
  Recovery r;
  r.was_complete = found.has_footer && found.has_data_end && found.losses.empty() && !found.is_checksum_wrong;
  r.messages = found.messages;
  r.losses = found.losses;
  add_times(source, found, r.losses);
  r.dropped_bytes = dropped_bytes(found.losses);
  r.kept_bytes = source.size() - r.dropped_bytes;
  if (!r.was_complete) r.problem = problem_of(found, source.size());
  if (r.was_complete && output.empty()) return r;
  if (found.messages == 0) throw InputError(fmt::format("{}: holds no whole chunk ({})", name, r.problem));
  if (output.empty() && !is_only_cut(found, source.size())) {
    throw InputError(
        fmt::format("{}: {}; this is damage, not a cut, and the file stays as it is; give -o NEW, which "
                    "gets all that is whole before and behind it",
                    name, r.problem));
  }
  if (output.empty()) {
    complete_in_place(path, end_of_records(found), index_of_last_chunk(source, found));
    return r;
  }
  std::error_code none;
  if (std::filesystem::equivalent(path, output, none))
    throw InputError(fmt::format("{}: is the damaged recording itself; give another file to -o", output.string()));
  OutputFile file(output);
  const std::uint64_t unreachable_modules = Rescue(source, found, file).run();
  file.close();
  r.messages -= unreachable_modules;
  if (unreachable_modules > 0) {
    r.losses.push_back(
        {0, 0, fmt::format("{} messages whose channel has lost its definition", unreachable_modules), false});
  }
  return r;
}

}  // namespace triskin::recording
