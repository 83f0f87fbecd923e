// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "triskin/bridge/dds.hpp"
#include "triskin/recording/raw_frames.hpp"

namespace triskin::bridge {

struct BridgeOptions {
  std::string part;  ///< It names the topics /skin/PART/… in letters, digits and _; see part_name.
  std::string parent_frame = "base_link";  ///< It is the frame of the link that carries the cover.
  Pose pose;                               ///< It is the pose of the cover's frame in that frame.
  double points_hz = 10.0;                 ///< So many point clouds are published each second; 0 publishes none.
  bool raw = true;                         ///< Every sample is published.
  recording::Calibration calibration;      ///< It gives the forces of contacts.
};

/// A name of a topic or frame made of `text`: what ROS does not allow becomes "_"; in front of a digit stands "p".
[[nodiscard]] std::string part_name(const std::string& text);

/// How many messages were handed to DDS, by topic.
struct Published {
  std::uint64_t raw = 0, points = 0, contacts = 0, diagnostics = 0;
  std::uint64_t samples = 0;  ///< It counts the samples in the raw messages.
};

/// Publishes one cover: /skin/PART/raw, points, contacts, layout, and its part of /diagnostics and /tf_static. Times
/// are those of the samples. Threads: one.
class Bridge {
 public:
  /// Advertises the topics, publishes layout and transform. `domain` and `design` outlive it. `now_ns`: since 1970.
  /// Throws DeviceError, InputError for a part that is no name of a topic.
  Bridge(Domain& domain, const design::Design& design, const BridgeOptions& options, std::uint64_t now_ns);

  /// Takes a sample whose `sampled_ns` is known. Throws DeviceError as all of these.
  void add(const recording::ModuleSample& sample);
  /// Publishes the contacts; none once when there were some before. Throws DeviceError.
  void add_contacts(std::span<const recording::Contact> contacts, std::uint64_t stamp_ns);
  /// Publishes how the parts do. Throws DeviceError.
  void add_diagnostics(std::span<const Diagnosis> parts, std::uint64_t stamp_ns);
  /// Publishes what waits for samples that may still come.
  void flush();
  /// Counts of the messages published so far.
  [[nodiscard]] const Published& published() const { return published_; }
  /// Readers of its topics that match now, over all topics.
  [[nodiscard]] int readers() const;
  /// Other programs that publish the same part in this domain now: readers would get both skins mixed. Throws
  /// DeviceError.
  [[nodiscard]] int other_publishers() const;
  /// Frame of the positions.
  [[nodiscard]] const std::string& frame() const { return frame_; }

 private:
  void put_raw(std::span<const recording::ModuleSample> samples);

  Domain& domain_;
  std::string base_;  // "/skin/PART/"
  std::string frame_;
  std::uint64_t points_period_ns_;
  recording::Calibration calibration_;
  std::unique_ptr<Publisher> raw_, points_, contacts_, layout_, diagnostics_, transforms_;
  recording::RawFrames frames_;
  recording::PointCloud cloud_;
  std::uint64_t next_points_ns_ = 0;
  bool had_contacts_ = false;
  Published published_;
};

}  // namespace triskin::bridge
