// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "record_walk.hpp"

namespace triskin::recording {
namespace {

// A writer that was killed leaves at most one open chunk and its index behind the last whole one.
constexpr std::uint64_t kMaxOpenBytes = std::uint64_t{4} << 20;

class Samples final : public mcap::Visitor {
 public:
  Samples(Summary& summary, const std::string& name, const std::function<void(const ModuleSample&)>& handler)
      : summary_(summary), name_(name), handler_(handler) {}

  void on_schema(const mcap::Schema& schema) override { schemas_[schema.id] = schema.name; }
  void on_channel(const mcap::Channel& channel) override {
    if (schemas_[channel.schema] == kRawFrameType.name) raw_ = channel.id;
    if (schemas_[channel.schema] == kReadersType.name) readers_channel_ = channel.id;
  }
  void on_attachment(const mcap::Attachment& attachment) override {
    if (attachment.name == "design.json") summary_.design_text = attachment.data;
    if (attachment.name == kCalibrationName) summary_.calibration_text = attachment.data;
    if (attachment.name == kRestName) summary_.rest_text = attachment.data;
  }
  void on_metadata(const mcap::Metadata& metadata) override {
    if (metadata.name == "triskin") summary_.facts = metadata.entries;
    if (metadata.name == "triskin_result") summary_.result = metadata.entries;
  }
  void on_message(const mcap::Message& message) override {
    if (message.channel != 0 && message.channel == raw_) take_samples(message);
    if (message.channel != 0 && message.channel == readers_channel_) take_readers(message);
  }

 private:
  [[noreturn]] void malformed(const MessageType& type) const {
    throw InputError(fmt::format("{}: a message of {} is malformed", name_, type.name));
  }
  void take_samples(const mcap::Message& message) {
    auto samples = decode_raw(message.data);
    if (!samples) malformed(kRawFrameType);
    for (ModuleSample& s : *samples) {
      const auto m = static_cast<std::size_t>(s.module);
      if (m < readers_.size() && readers_[m] != own_[m]) s.adopter = readers_[m].patch;
      if (summary_.samples++ == 0) summary_.first_us = s.link_time_us;
      summary_.last_us = std::max(summary_.last_us, s.link_time_us);
      if (handler_) handler_(s);
    }
  }
  // The first message has each module's own controller.
  void take_readers(const mcap::Message& message) {
    auto at = decode_readers(message.data);
    if (!at || (!own_.empty() && at->readers.size() != own_.size())) malformed(kReadersType);
    if (own_.empty()) own_ = readers_ = at->readers;
    for (std::size_t m = 0; m < own_.size(); ++m) {
      if (at->readers[m] == readers_[m]) continue;
      const bool own = at->readers[m] == own_[m];
      summary_.reader_changes.push_back({at->link_time_us, static_cast<int>(m), at->readers[m], own});
    }
    readers_ = std::move(at->readers);
  }

  Summary& summary_;
  const std::string& name_;
  const std::function<void(const ModuleSample&)>& handler_;
  std::map<std::uint16_t, std::string> schemas_;
  std::uint16_t raw_ = 0, readers_channel_ = 0;
  std::vector<Reader> own_, readers_;  // by module; empty: the recording says nothing of it
};

struct Reached {};  // ends read_origin

void copy(const ByteSource& from, OutputFile& to, std::uint64_t bytes) {
  std::vector<std::uint8_t> piece(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < bytes;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), bytes - at));
    if (!from.read(at, std::span(piece).first(n))) throw InputError("the recording cannot be read");
    to.write(std::span(piece).first(n));
    at += n;
  }
}

// The index of the last chunk, where it is not whole.
mcap::Buffer missing_index(const ByteSource& source, const mcap::ReadReport& report) {
  if (report.unindexed_chunk == 0) return {};
  const auto place = mcap::place_at(source, report.unindexed_chunk);
  if (!place) return {};
  const auto contents = mcap::contents_of(source, *place);
  mcap::ChunkHead head;
  if (!mcap::decode(contents, head)) return {};
  return mcap::index_of(Bytes(contents).subspan(mcap::head_bytes(head)));
}

void complete(OutputFile& file, const mcap::Buffer& index) {
  file.write(index.view());
  mcap::finish_file(file, 0);
  file.close();
}

}  // namespace

Summary read_recording(const std::filesystem::path& path, const std::function<void(const ModuleSample&)>& handler) {
  const std::string name = path.string();
  const InputFile source(path);
  Summary summary;
  Samples samples(summary, name, handler);
  summary.file = mcap::read_file(source, name, samples);
  return summary;
}

Summary read_origin(const std::filesystem::path& path) {
  const std::string name = path.string();
  const InputFile source(path);
  Summary summary;
  const std::function<void(const ModuleSample&)> stop = [](const ModuleSample&) { throw Reached{}; };
  Samples samples(summary, name, stop);
  try {
    summary.file = mcap::read_file(source, name, samples);
  } catch (const Reached&) {
    summary.samples = 0;
  }
  return summary;
}

Recovery recover(const std::filesystem::path& path, const std::filesystem::path& output) {
  const std::string name = path.string();
  mcap::Visitor nobody;
  mcap::ReadReport report;
  mcap::Buffer index;
  bool in_summary = false;
  {
    const InputFile source(path);
    report = mcap::read_file(source, name, nobody);
    index = missing_index(source, report);
    const auto next = mcap::place_at(source, report.whole_bytes);
    in_summary = next && next->kind == mcap::Kind::kDataEnd;
  }
  Recovery r{report.complete, report.messages, report.whole_bytes, report.file_bytes - report.whole_bytes,
             report.problem};
  if (report.complete && output.empty()) return r;
  if (report.messages == 0) throw InputError(fmt::format("{}: holds no whole chunk ({})", name, report.problem));
  if (!output.empty()) {
    const InputFile source(path);
    OutputFile file(output);
    copy(source, file, report.whole_bytes);
    complete(file, index);
    return r;
  }
  if (r.dropped_bytes > kMaxOpenBytes && !in_summary)
    throw InputError(
        fmt::format("{}: {}, and {} bytes follow: this is damage, not a cut; give -o NEW, which gets what "
                    "stands before it",
                    name, report.problem, r.dropped_bytes));
  OutputFile file(path, report.whole_bytes);
  complete(file, index);
  return r;
}

}  // namespace triskin::recording
