// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/recording/messages.hpp"
#include "triskin/recording/output_file.hpp"

namespace triskin::recording {

enum class Format {
  kMcap,  ///< docs/recording.md describes the contents.
  kCsv,   ///< Each sample of a module is one line.
};
/// The option --to uses these names, which are also the extensions of the files.
inline constexpr NameTable kFormatNames{
    std::array<std::pair<Format, std::string_view>, 2>{{{Format::kMcap, "mcap"}, {Format::kCsv, "csv"}}}};

/// A recording stores these facts about itself.
struct Origin {
  std::string design_text;                   ///< The text is that of the design file, unchanged.
  std::uint64_t link_start_us = 0;           ///< The recording starts at this time of the link's clock.
  std::uint64_t unix_start_ns = 0;           ///< At the start, this time has passed since 1970.
  std::map<std::string, std::string> facts;  ///< The metadata get these further entries: link, versions, firmware.
  std::uint64_t cloud_period_us = 0;         ///< Point clouds are written at this interval; 0 disables them.
  /// The text of the skin's calibration file (docs/calibration.md) gives contacts their force_n; if it is empty, forces
  /// are in counts.
  std::string calibration_text;
  /// The text of the file of rest values (design/rest_values.hpp) is used to find contacts; if it is empty, the
  /// first values say where the taxels rest.
  std::string rest_text;
  /// The text of what the controllers said of the rest (design::settled_text) tells which first values are pressure; it
  /// is empty if they said nothing, or if there are rest values.
  std::string settled_text;
  /// Name of the cover on its robot. Topics are then /skin/PART/…, as in the bridge, and the frame is skin_PART. If
  /// it is empty, topics are /skin/… and the frame is skin.
  std::string part;
  std::string parent_frame;  ///< If set, /tf_static gets the pose of the skin's frame in this frame.
  Pose pose;                 ///< The pose is that of the skin's frame in parent_frame.
};

/// Writes samples as they arrive. Memory is bounded; every function throws WriteFailed when the file accepts no more
/// bytes. Threads: one.
class Recorder {
 public:
  virtual ~Recorder() = default;
  virtual void add(const ModuleSample& sample) = 0;
  /// Adds the contacts at a time of the link. Formats without contacts ignore them.
  virtual void add_contacts(std::uint64_t link_time_us, std::span<const Contact> contacts) = 0;
  /// Writes data that has waited for 0.5 s. Call it regularly with a monotonic clock in µs.
  virtual void tick(std::uint64_t steady_us) = 0;
  /// Writes all waiting data and completes the file. `result` describes how the recording went. Call it once, even
  /// after a failure of the link.
  virtual void finish(const std::map<std::string, std::string>& result) = 0;
};

/// Starts a recording of `design`. `file` and `design` must outlive it. Throws WriteFailed.
[[nodiscard]] std::unique_ptr<Recorder> make_recorder(Format format, OutputFile& file, const design::Design& design,
                                                      Origin origin);

}  // namespace triskin::recording
