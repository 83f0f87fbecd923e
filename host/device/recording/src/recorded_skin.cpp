// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/recorded_skin.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::recording {

namespace {

std::string serial_of(const mcap::TextMap& facts, layout::NodeAddress node) {
  const auto serial = facts.find(serial_fact(node));
  return serial == facts.end() ? "" : serial->second;
}

// Counts what a file holds that has no design.
class Contents final : public mcap::Visitor {
 public:
  void on_schema(const mcap::Schema& schema) override { schemas_[schema.id] = schema.name; }
  void on_channel(const mcap::Channel& channel) override {
    topics_.insert(channel.topic);
    has_samples = has_samples || schemas_[channel.schema] == kRawFrameType.name;
  }
  [[nodiscard]] std::vector<std::string> topics() const { return {topics_.begin(), topics_.end()}; }
  bool has_samples = false;

 private:
  std::map<std::uint16_t, std::string> schemas_;
  std::set<std::string> topics_;
};

std::string what_is_missing(const std::string& file) {
  Contents contents;
  const mcap::ReadReport report = mcap::read_file(InputFile(file), file, contents);
  const std::vector<std::string> topics = contents.topics();
  if (contents.has_samples)
    return fmt::format(
        "{}: holds samples of a skin ({}) but not its design: the program that rewrote the recording left the "
        "attachments out. Use the file that triskin wrote, or add the design to this one as the attachment design.json "
        "(mcap add attachment)",
        file, short_list(topics, 3));
  if (!topics.empty())
    return fmt::format("{}: holds {}, but nothing of a skin; give a file that \"triskin record\" wrote", file,
                       short_list(topics, 3));
  return report.complete ? fmt::format("{}: holds no message; give a file that \"triskin record\" wrote", file)
                         : fmt::format("{}: was cut before its first sample ({}); nothing of the recording is left",
                                       file, report.problem);
}

}  // namespace

RecordedSkin recorded_skin(const std::string& file) {
  Summary origin = read_origin(file);
  // A program that rewrote the recording may have put its attachments behind the samples.
  if (origin.design_text.empty()) origin = read_recording(file, {});
  if (origin.design_text.empty()) throw InputError(what_is_missing(file));
  RecordedSkin skin{design::parse_design(origin.design_text, file + ": design.json"), {}, {}, {}, origin.facts};
  for (layout::PatchIndex patch; patch < static_cast<int>(skin.design.patches.size()); ++patch)
    skin.serials.push_back(serial_of(origin.facts, design::node_address_of(skin.design, patch)));
  if (!origin.rest_text.empty())
    skin.rest.kept = design::parse_rest(origin.rest_text, file + ": " + kRestName, skin.design.layout.modules.size());
  if (!origin.settled_text.empty())
    skin.rest.settled =
        design::parse_settled(origin.settled_text, file + ": " + kSettledName, skin.design.layout.modules.size());
  if (origin.calibration_text.empty()) return skin;
  const auto boards = design::parse_calibration(origin.calibration_text, file + ": " + kCalibrationName);
  const auto serial_of = [&](layout::PatchIndex patch) { return skin.serials[static_cast<std::size_t>(patch)]; };
  skin.calibration = design::SkinCalibration(skin.design, boards, serial_of);
  return skin;
}

}  // namespace triskin::recording
