// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/recording/mcap_file.hpp"
#include "triskin/recording/raw_frames.hpp"
#include "triskin/recording/readers.hpp"
#include "triskin/recording/recorder.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::recording {

/// Writes a recording as MCAP.
class McapRecorder final : public Recorder {
 public:
  McapRecorder(OutputFile& file, const design::Design& design, Origin origin);
  void add(const ModuleSample& sample) override;
  void add_contacts(std::uint64_t link_time_us, std::span<const Contact> contacts) override;
  void tick(std::uint64_t steady_us) override;
  void finish(const std::map<std::string, std::string>& result) override;

 private:
  [[nodiscard]] std::uint64_t unix_ns(std::uint64_t link_time_us) const;
  void add_to_cloud(const ModuleSample& sample);
  void begin(const design::Design& design);
  void put_readers(std::uint64_t link_time_us);

  Origin origin_;
  std::string frame_;  // Coordinates in messages use this frame.
  mcap::Writer writer_;
  std::uint16_t raw_ = 0, layout_ = 0, contacts_ = 0, cloud_channel_ = 0, readers_channel_ = 0;
  std::vector<int> numbers_;  // by module; empty: no gaps
  RawFrames frames_;
  Readers readers_;
  std::optional<PointCloud> cloud_;
  std::uint64_t next_cloud_us_ = 0, first_sample_us_ = 0;
  bool waiting_ = false;  // True means that data arrived since the last flush.
  std::optional<std::uint64_t> waiting_since_us_;
};

}  // namespace triskin::recording
