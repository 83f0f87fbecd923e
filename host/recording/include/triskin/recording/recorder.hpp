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

/// Formats of a recording.
enum class Format {
  kMcap,  ///< docs/recording.md describes what is in it.
  kCsv,   ///< It has one line for each sample of a module.
};
/// Names of the option --to, which are the extensions of the files too.
inline constexpr NameTable kFormatNames{
    std::array<std::pair<Format, std::string_view>, 2>{{{Format::kMcap, "mcap"}, {Format::kCsv, "csv"}}}};

/// What a recording says of itself.
struct Origin {
  std::string design_text;                   ///< It is the text of the design file as it is.
  std::uint64_t link_start_us = 0;           ///< It is the clock of the link at the start.
  std::uint64_t unix_start_ns = 0;           ///< It is the time of that moment since 1970.
  std::map<std::string, std::string> facts;  ///< They are further entries of the metadata: link, versions, firmware.
  std::uint64_t cloud_period_us = 0;         ///< Two point clouds are this far apart; 0 means that there are none.
  /// The calibration file of the skin (docs/calibration.md), by which contacts have their force_n; empty: none, and
  /// forces are in counts.
  std::string calibration_text;
  std::string rest_text;  ///< the file of the rest values (design/rest_values.hpp) by which contacts are known; empty:
                          ///< by design
  /// Name of the cover on its robot: topics are /skin/PART/…, as the bridge has them, and the frame is skin_PART.
  /// Empty: topics are /skin/… and the frame is skin.
  std::string part;
  std::string parent_frame;  ///< frame in which the skin's frame lies, for /tf_static; empty: none is written
  Pose pose;                 ///< of the skin's frame in parent_frame
};

/// Writes samples as they come. Memory is bounded; every function throws WriteFailed when the file takes no more.
/// Threads: one.
class Recorder {
 public:
  virtual ~Recorder() = default;
  /// Takes a sample.
  virtual void add(const ModuleSample& sample) = 0;
  /// Takes the taxels under pressure at a time of the link. Formats without contacts do nothing.
  virtual void add_contacts(std::uint64_t link_time_us, std::span<const Contact> contacts) = 0;
  /// Writes what has waited for 0.5 s. Call it regularly with a monotonic clock, µs.
  virtual void tick(std::uint64_t steady_us) = 0;
  /// Writes what waits and ends the file. `result` tells how the recording went. To be called once, also after a
  /// failure of the link.
  virtual void finish(const std::map<std::string, std::string>& result) = 0;
};

/// Begins a recording of `design`. `file` and `design` outlive it. Throws WriteFailed.
[[nodiscard]] std::unique_ptr<Recorder> make_recorder(Format format, OutputFile& file, const design::Design& design,
                                                      Origin origin);

}  // namespace triskin::recording
