// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "triskin/session/bus.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::session {

/// The board answered the discovery of iCub boards.
struct IcubBoardInfo {
  std::uint8_t address = 0;
  std::uint8_t type = 0;  ///< An MTB4 has type 11.
  int version_major = 0, version_minor = 0, build = 0;
};

/// Reads skin boards that use the iCub protocol (docs/protocol.md, "iCub stream"), either real MTB4 boards or our
/// controllers.
class IcubStream {
 public:
  using OnTaxels = std::function<void(const wire::IcubTaxels&)>;

  /// Discovers the boards (0.2 s), configures the skin boards as an iCub host does (period 50 ms, rest at 245,
  /// temperature compensated, all triangles on), and starts them. `bus` must outlive the stream; the waiting calls of
  /// the bus call `handler`. Throws DeviceError when no skin board answers.
  IcubStream(Bus& bus, OnTaxels handler);
  /// Stops the boards if the link still works.
  ~IcubStream();
  IcubStream(const IcubStream&) = delete;
  IcubStream& operator=(const IcubStream&) = delete;

  /// Receives until `until_us` of the link's clock. Throws Unreachable, Cancelled.
  void run_until(std::uint64_t until_us) { bus_.listen(until_us); }
  /// Returns the boards that were started, by address.
  [[nodiscard]] const std::vector<IcubBoardInfo>& boards() const { return boards_; }
  /// Counts the received triangles, that is complete pairs of frames.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Counts the pairs in which one frame is missing.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  void handle(const wire::CanFrame& frame);
  void poll(std::uint8_t board, std::initializer_list<std::uint8_t> bytes);

  Bus& bus_;
  OnTaxels handler_;
  std::vector<IcubBoardInfo> boards_;
  std::map<std::uint32_t, wire::CanFrame> first_;  // The first frame of each pair is stored by its identifier.
  std::uint64_t frames_ = 0, lost_ = 0;
};

}  // namespace triskin::session
