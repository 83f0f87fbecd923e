// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::device {

/// A sample of one module as it came over the wire, with the module that it belongs to in the design.
struct ModuleFrame {
  int module = 0;                  ///< id in the design; in the frame it is a row of the controller's table
  std::uint64_t link_time_us = 0;  ///< clock of the link when the frame came
  wire::FullTaxels sample;
};

/// The data stream of all controllers of a design. Each frame is joined with its module; gaps in the sample numbers are
/// counted, so a lost sample is never taken for a quiet skin.
class Stream {
 public:
  using OnFrame = std::function<void(const ModuleFrame&)>;

  /// Switches the full stream on in every controller of the design. `bus` outlives the stream; `handler` is called
  /// inside the waiting calls of the bus. Throws DeviceError when a controller is missing or holds another table,
  /// InputError when the link cannot carry the full stream (no FD frames).
  Stream(Bus& bus, const design::Design& design, OnFrame handler);
  /// Switches the stream off, if the link still works.
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Receives until `until_us` of the link's clock. Throws Unreachable, Cancelled.
  void run_until(std::uint64_t until_us);
  /// Module frames received.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Module frames missing between two received ones of the same module; those before the first do not count.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Node {
    std::vector<int> modules;         // of row k
    std::vector<std::uint32_t> last;  // sample number of row k, 0: none yet
  };
  void handle(const wire::CanFrame& frame);

  Bus& bus_;
  OnFrame handler_;
  std::map<std::uint8_t, Node> nodes_;
  std::uint64_t frames_ = 0, lost_ = 0;
};

}  // namespace triskin::device
