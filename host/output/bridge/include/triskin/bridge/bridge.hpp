// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "triskin/base/ascii_name.hpp"
#include "triskin/bridge/dds.hpp"
#include "triskin/recording/raw_frames.hpp"

namespace triskin::bridge {

struct BridgeOptions {
  std::string part;  ///< Topics are skin/PART/…, so the name has only letters, digits and _; see part_name.
  std::string parent_frame = "base_link";  ///< The frame belongs to the link that carries the cover.
  std::string frame_prefix;                ///< Stands before both frames, as that of robot_state_publisher: "left/".
  Pose pose;                               ///< The pose is that of the cover's frame in parent_frame.
  double points_hz = 10.0;                 ///< This many point clouds are published per second; 0 publishes none.
  bool raw = true;                         ///< True publishes every sample.
  bool markers = true;                     ///< True publishes triangles and arrows for viewers.
  bool stop = false;                       ///< True publishes whether somebody presses hard; see add_stop.
  recording::Calibration calibration;      ///< The calibration gives the forces of contacts.
};

using triskin::part_name;

/// Counts the messages that were handed to DDS, by topic.
struct Published {
  std::uint64_t raw = 0, points = 0, contacts = 0, wrenches = 0, stops = 0, diagnostics = 0;
  std::uint64_t samples = 0;  ///< Samples are counted inside the raw messages.
};

/// Publishes one cover: skin/PART/raw, points, contacts, wrench, markers, stop, layout, and its part of /diagnostics
/// and /tf_static. Times are those of the samples, or of /clock. Threads: one.
class Bridge {
 public:
  /// Advertises the topics and publishes layout and transform. `domain` and `design` must outlive the bridge. `now_ns`
  /// counts from 1970. Throws DeviceError, and InputError for a part that cannot be the name of a topic.
  Bridge(Domain& domain, const design::Design& design, const BridgeOptions& options, std::uint64_t now_ns);

  /// Publishes a sample whose `sampled_ns` is known. Throws DeviceError, as the following functions do.
  void add(const recording::ModuleSample& sample);
  /// Publishes the contacts; when the last contact ends, an empty list is published once. The wrench, if forces are in
  /// newton, and markers (at least one a second) come with each call. Throws DeviceError.
  void add_contacts(std::span<const recording::Contact> contacts, std::uint64_t stamp_ns);
  /// Publishes whether the robot should stop, as std_msgs/msg/Bool. Throws DeviceError.
  void add_stop(bool stop);
  /// From now on this is added to all times: a simulator's clock minus ours.
  void set_clock_offset(std::int64_t offset_ns) { clock_offset_ns_ = offset_ns; }
  /// Publishes the state of the parts. Throws DeviceError.
  void add_diagnostics(std::span<const Diagnosis> parts, std::uint64_t stamp_ns);
  /// Publishes messages that still wait for samples.
  void flush();
  /// Returns the counts of the messages published so far.
  [[nodiscard]] const Published& published() const { return published_; }
  /// Counts the readers that match now, over all topics.
  [[nodiscard]] int readers() const;
  /// Counts other programs that publish the same part in this domain now, because readers would get both skins mixed.
  /// Throws DeviceError.
  [[nodiscard]] int other_publishers() const;
  /// Returns the frame of the positions.
  [[nodiscard]] const std::string& frame() const { return frame_; }

 private:
  void put_raw(std::span<const recording::ModuleSample> samples);
  [[nodiscard]] std::uint64_t on_clock(std::uint64_t ns) const {
    return ns + static_cast<std::uint64_t>(clock_offset_ns_);
  }

  Domain& domain_;
  const design::Design& design_;
  std::string base_;  // All topics of the cover begin with "skin/PART/".
  std::string frame_, parent_;
  Pose pose_;
  std::uint64_t points_period_ns_;
  recording::Calibration calibration_;
  std::vector<int> numbers_;  // by module; empty: no gaps
  std::unique_ptr<Publisher> raw_, points_, contacts_, wrench_, markers_, stop_, layout_, diagnostics_, transforms_;
  recording::RawFrames frames_;
  recording::PointCloud cloud_;
  std::uint64_t next_points_ns_ = 0;
  bool had_contacts_ = false;
  std::size_t arrows_ = 0;  // in the last markers
  std::uint64_t next_markers_ns_ = 0;
  std::int64_t clock_offset_ns_ = 0;
  Published published_;
};

}  // namespace triskin::bridge
