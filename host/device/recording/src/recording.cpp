// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/design/design_text.hpp"

namespace triskin::recording {
namespace {

class Samples final : public mcap::Visitor {
 public:
  // `numbers`: those of the modules of the design.
  Samples(Summary& summary, const std::string& name, const std::function<void(const ModuleSample&)>& handler,
          std::vector<int> numbers)
      : summary_(summary), name_(name), handler_(handler), numbers_(std::move(numbers)) {}

  void on_schema(const mcap::Schema& schema) override { schemas_[schema.id] = schema.name; }
  void on_channel(const mcap::Channel& channel) override {
    if (schemas_[channel.schema] == kRawFrameType.name) {
      if (!raw_.empty() && channel.topic != raw_topic_) throw_several_covers();
      raw_topic_ = channel.topic;
      raw_.insert(channel.id);
    }
    if (schemas_[channel.schema] == kReadersType.name) readers_channels_.insert(channel.id);
    if (channels_.insert(channel.id).second) note_type(channel);
  }
  void on_attachment(const mcap::Attachment& attachment) override {
    if (attachment.name == "design.json") {
      if (!summary_.design_text.empty() && summary_.design_text != attachment.data) throw_several_covers();
      summary_.design_text = attachment.data;
    }
    if (attachment.name == kCalibrationName) summary_.calibration_text = attachment.data;
    if (attachment.name == kRestName) summary_.rest_text = attachment.data;
    if (attachment.name == kSettledName) summary_.settled_text = attachment.data;
  }
  void on_metadata(const mcap::Metadata& metadata) override {
    if (metadata.name == "triskin") summary_.facts = metadata.entries;
    if (metadata.name == "triskin_result") summary_.result = metadata.entries;
  }
  void on_message(const mcap::Message& message) override {
    if (raw_.contains(message.channel)) take_samples(message);
    if (readers_channels_.contains(message.channel)) take_readers(message);
  }

 private:
  // A topic of raw frames is .../raw; a program that rewrote the file may have lost or renamed its type.
  void note_type(const mcap::Channel& channel) {
    const auto type = schemas_.find(channel.schema);
    const bool is_known = channel.schema != 0 && type != schemas_.end() && !type->second.empty();
    if (!channel.topic.ends_with("/raw") || (is_known && type->second == kRawFrameType.name)) return;
    const std::string why = is_known ? fmt::format("has the type {}", type->second)
                            : channel.schema == 0
                                ? "has no type (its schema is 0)"
                                : fmt::format("names schema {}, which is not in the file", channel.schema);
    summary_.not_understood.push_back(
        fmt::format("{} {}, where samples of a skin have {}", channel.topic, why, kRawFrameType.name));
  }
  // Modules of different covers share numbers, so one reader would mix them.
  [[noreturn]] void throw_several_covers() const {
    throw InputError(
        fmt::format("{}: holds several covers of a robot, for viewers; record the robot into a folder (-o FOLDER), and "
                    "each cover has a file of its own",
                    name_));
  }
  [[noreturn]] void malformed(const MessageType& type) const {
    throw InputError(fmt::format("{}: a message of {} is malformed", name_, type.name));
  }
  void take_samples(const mcap::Message& message) {
    auto samples = decode_raw(message.data, numbers_);
    if (!samples) malformed(kRawFrameType);
    for (ModuleSample& s : *samples) {
      const auto m = static_cast<std::size_t>(s.module);
      if (m < readers_.size() && readers_[m] != own_[m]) s.adopter = readers_[m].patch;
      // Messages may stand in any order.
      summary_.first_us = summary_.samples++ == 0 ? s.link_time_us : std::min(summary_.first_us, s.link_time_us);
      summary_.last_us = std::max(summary_.last_us, s.link_time_us);
      if (handler_) handler_(s);
    }
  }
  // The first message names each module's own controller.
  void take_readers(const mcap::Message& message) {
    auto at = decode_readers(message.data);
    if (!at || (!own_.empty() && at->readers.size() != own_.size())) malformed(kReadersType);
    if (own_.empty()) own_ = readers_ = at->readers;
    for (std::size_t m = 0; m < own_.size(); ++m) {
      if (at->readers[m] == readers_[m]) continue;
      const bool own = at->readers[m] == own_[m];
      summary_.reader_changes.push_back({at->link_time_us, layout::ModuleId{m}, at->readers[m], own});
    }
    readers_ = std::move(at->readers);
  }

  Summary& summary_;
  const std::string& name_;
  const std::function<void(const ModuleSample&)>& handler_;
  std::vector<int> numbers_;
  std::map<std::uint16_t, std::string> schemas_;
  // A topic may have several channels: a program that merges files keeps those of each.
  std::set<std::uint16_t> channels_, raw_, readers_channels_;
  std::string raw_topic_;
  // Entries are indexed by module; they are empty if the recording does not name the readers.
  std::vector<Reader> own_, readers_;
};

// Finds what the whole file has to be read for before its samples can be: whether the times of the raw frames go back
// anywhere, as MCAP allows messages in any order, and the design, which may stand at the end.
class Survey final : public mcap::Visitor {
 public:
  void on_schema(const mcap::Schema& schema) override { schemas_[schema.id] = schema.name; }
  void on_channel(const mcap::Channel& channel) override {
    if (schemas_[channel.schema] == kRawFrameType.name) raw_.insert(channel.id);
  }
  void on_message(const mcap::Message& message) override {
    if (!raw_.contains(message.channel)) return;
    goes_back = goes_back || message.log_ns < last_ns_;
    last_ns_ = message.log_ns;
  }
  void on_attachment(const mcap::Attachment& attachment) override {
    if (attachment.name == "design.json") design_text = attachment.data;
  }
  bool goes_back = false;
  std::string design_text;

 private:
  std::map<std::uint16_t, std::string> schemas_;
  std::set<std::uint16_t> raw_;
  std::uint64_t last_ns_ = 0;
};

// Returns the numbers of the modules of a design; empty if they have no gaps. What is wrong with a design is said by
// those who use the rest of it.
std::vector<int> numbers_in(const std::string& design_text) {
  try {
    return design::parse_design(design_text, "design.json").layout.numbers;
  } catch (const InputError&) {
    return {};
  }
}

struct Reached {};  // The exception ends read_origin() at the first sample.

}  // namespace

Summary read_recording(const std::filesystem::path& path, const std::function<void(const ModuleSample&)>& handler) {
  const std::string name = path.string();
  const InputFile source(path);
  Summary summary;
  Survey survey;
  if (handler) (void)mcap::read_file(source, name, survey);
  std::vector<int> numbers = numbers_in(survey.design_text);
  if (!survey.goes_back) {
    Samples samples(summary, name, handler, std::move(numbers));
    summary.file = mcap::read_file(source, name, samples);
    return summary;
  }
  std::vector<ModuleSample> kept;
  const std::function<void(const ModuleSample&)> keep = [&](const ModuleSample& s) { kept.push_back(s); };
  Samples samples(summary, name, keep, std::move(numbers));
  summary.file = mcap::read_file(source, name, samples);
  std::ranges::stable_sort(kept, {}, &ModuleSample::link_time_us);
  std::ranges::for_each(kept, handler);
  return summary;
}

Summary read_origin(const std::filesystem::path& path) {
  const std::string name = path.string();
  const InputFile source(path);
  Summary summary;
  const std::function<void(const ModuleSample&)> stop = [](const ModuleSample&) { throw Reached{}; };
  Samples samples(summary, name, stop, {});
  try {
    summary.file = mcap::read_file(source, name, samples);
  } catch (const Reached&) {
    summary.samples = 0;
  }
  return summary;
}

}  // namespace triskin::recording
