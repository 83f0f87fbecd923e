// SPDX-License-Identifier: GPL-3.0-or-later
#include "mcap_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace triskin::recording {
namespace {

constexpr std::uint64_t kMaxWait_us = 500'000;
// A point cloud waits this long for modules that were not heard yet; a module normally sends every 37 ms.
constexpr std::uint64_t kMaxUnheard_us = 1'000'000;

// What is written once has to reach those who subscribe later: players offer a topic as its channel says, and a
// listener of /tf_static takes no other offer. The numbers are those of rmw/types.h (keep last, reliable, transient
// local, no deadline), in the YAML of rosbag2_storage/qos.cpp.
constexpr const char* kLatched = R"(- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false)";

}  // namespace

McapRecorder::McapRecorder(OutputFile& file, const design::Design& design, Origin origin)
    : origin_(std::move(origin)),
      frame_(origin_.part.empty() ? std::string(kMeshFrame) : "skin_" + origin_.part),
      writer_(file, "ros2", "triskin"),
      numbers_(design.layout.numbers),
      frames_([this](std::span<const ModuleSample> frame) {
        writer_.write(raw_, unix_ns(frame.front().link_time_us), encode_raw(frame, numbers_), frame.front().sampled_ns);
      }),
      readers_(design) {
  begin(design);
}

std::uint64_t McapRecorder::unix_ns(std::uint64_t link_time_us) const {
  return origin_.unix_start_ns + (link_time_us - origin_.link_start_us) * 1000;
}

void McapRecorder::begin(const design::Design& design) {
  const std::string base = origin_.part.empty() ? "/skin/" : "/skin/" + origin_.part + "/";
  const auto channel = [&](const MessageType& type, const std::string& topic, const char* qos = "") {
    return writer_.add_channel(writer_.add_schema(type.name, type.definition), topic, {{"offered_qos_profiles", qos}});
  };
  raw_ = channel(kRawFrameType, base + "raw");
  layout_ = channel(kLayoutType, base + "layout", kLatched);
  contacts_ = channel(kContactsType, base + "contacts");
  readers_channel_ = channel(kReadersType, base + "readers");
  if (origin_.cloud_period_us > 0) {
    cloud_channel_ = channel(kPointCloudType, base + "points");
    cloud_.emplace(design);
  }
  const std::uint64_t start_ns = origin_.unix_start_ns;
  writer_.attach({start_ns, 0, "design.json", "application/json", origin_.design_text});
  if (!origin_.calibration_text.empty())
    writer_.attach({start_ns, 0, kCalibrationName, "application/json", origin_.calibration_text});
  if (!origin_.rest_text.empty()) writer_.attach({start_ns, 0, kRestName, "application/json", origin_.rest_text});
  if (!origin_.settled_text.empty())
    writer_.attach({start_ns, 0, kSettledName, "application/json", origin_.settled_text});
  mcap::TextMap facts = origin_.facts;
  facts["design_id"] = fmt::format("{:016x}", design.design_id);
  facts["design"] = design.name;
  facts["unix_start_ns"] = fmt::format("{}", start_ns);
  facts["link_start_us"] = fmt::format("{}", origin_.link_start_us);
  facts["clock"] =
      "log time: when it came, ns since 1970, of the clock of the link in µs since link_start_us; publish time: when "
      "it "
      "was sampled, within error_us";
  facts["units"] =
      fmt::format("values: converter counts; forces of contacts: {}; lengths: m",
                  !origin_.calibration_text.empty() ? "N, by the calibration in calibration.json" : "counts");
  writer_.describe({"triskin", facts});
  if (!origin_.parent_frame.empty())
    writer_.write(channel(kTransformsType, "/tf_static", kLatched), start_ns,
                  encode_transform(origin_.parent_frame, frame_, origin_.pose, start_ns));
  writer_.write(layout_, start_ns, encode_layout(design, start_ns, frame_));
  put_readers(origin_.link_start_us);
  writer_.flush();
}

void McapRecorder::put_readers(std::uint64_t link_time_us) {
  const std::uint64_t log_ns = unix_ns(link_time_us);
  writer_.write(readers_channel_, log_ns, encode_readers(readers_.all(), link_time_us, log_ns));
}

void McapRecorder::add(const ModuleSample& sample) {
  if (readers_.add(sample)) {
    frames_.flush();  // Samples that arrived before the message belong to the previous readers.
    put_readers(sample.link_time_us);
  }
  frames_.add(sample);
  waiting_ = true;
  if (cloud_) add_to_cloud(sample);
}

// The first cloud has the values of all modules, unless one of them does not send.
void McapRecorder::add_to_cloud(const ModuleSample& sample) {
  cloud_->add(sample);
  if (first_sample_us_ == 0) first_sample_us_ = sample.link_time_us;
  if (!cloud_->is_complete() && sample.link_time_us < first_sample_us_ + kMaxUnheard_us) return;
  if (sample.link_time_us < next_cloud_us_) return;
  const std::uint64_t log_ns = unix_ns(sample.link_time_us);
  writer_.write(cloud_channel_, log_ns, cloud_->encode(log_ns, frame_));
  next_cloud_us_ = sample.link_time_us + origin_.cloud_period_us;
}

void McapRecorder::add_contacts(std::uint64_t link_time_us, std::span<const Contact> contacts) {
  writer_.write(contacts_, unix_ns(link_time_us),
                encode_contacts(contacts, unix_ns(link_time_us), frame_,
                                {.by_taxel = !origin_.calibration_text.empty()}, numbers_));
}

void McapRecorder::tick(std::uint64_t steady_us) {
  if (!waiting_) return;
  if (!waiting_since_us_) waiting_since_us_ = steady_us;
  if (steady_us - *waiting_since_us_ < kMaxWait_us) return;
  frames_.flush();
  writer_.flush();
  waiting_ = false;
  waiting_since_us_.reset();
}

void McapRecorder::finish(const std::map<std::string, std::string>& result) {
  frames_.flush();
  writer_.describe({"triskin_result", result});
  writer_.finish();
}

}  // namespace triskin::recording
