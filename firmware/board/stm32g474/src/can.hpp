// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"

namespace triskin::board {

/// Which identifiers come through.
enum class CanFilters : std::uint8_t {
  kLoader,       ///< requests, the loader's own, iCub commands
  kApplication,  ///< also discovery, assignment and leases
};

/// FDCAN1 at 1 Mbit/s, data phase 2 Mbit/s, on PB8 and PB9. Both directions go through queues that the interrupt
/// serves.
class Stm32CanPort final : public fw::CanPort {
 public:
  void open(CanFilters filters);
  [[nodiscard]] bool fd() const override { return true; }
  bool send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive() override;
  [[nodiscard]] bool frame_waits() const;
  [[nodiscard]] bool has_room() const override;
  void on_interrupt();
};

extern Stm32CanPort can;

}  // namespace triskin::board
