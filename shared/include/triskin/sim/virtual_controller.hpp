// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "triskin/layout/module.hpp"
#include "triskin/sim/chain_model.hpp"
#include "triskin/sim/flash_model.hpp"
#include "triskin/sim/i2c_bus.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/health.hpp"
#include "triskin/wire/unique_id.hpp"
#include "triskin/wire/usb_function.hpp"

namespace triskin::sim {

/// What surrounds one patch controller. Everything outlives the controller.
struct VirtualBoard {
  std::array<I2cBus*, layout::kLines> lines{};  ///< No line may be null.
  FlashModel* flash = nullptr;                  ///< It holds the table slots, the fault memory and the node address.
  wire::UniqueId unique_id{};
  std::function<void(const wire::CanFrame&)> send;  ///< It is called for every frame that leaves the controller.
  bool can_fd = true;                               ///< It says whether the bus carries FD frames.
  ChainModel* chain = nullptr;  ///< It is the chain of the switched modules; null means a board without one.
  /// Both application slots follow each other here; null means a board without a loader.
  FlashModel* slots = nullptr;
  std::function<bool()> room{};          ///< It says whether a transmit buffer is free; an empty function means always.
  wire::BoardHealth health = healthy();  ///< The board reports this as its health.
  std::optional<wire::Crash> crash{};    ///< The board reports this crash until a host clears the fault memory.

  [[nodiscard]] static wire::BoardHealth healthy() {
    wire::BoardHealth h;
    h.clock = {wire::Crystal::kUsed, 8, 8000};
    h.reset_cause = wire::reset_cause::kPower;
    return h;
  }
};

/// Bytes of the two application slots.
inline constexpr std::size_t kSlotsBytes = std::size_t{2} * 0x3C000;

/// The patch controller's application on virtual ports: the same logic that runs on the microcontroller. An image in a
/// slot is stored, checked, counted and confirmed as there, but what runs is always the application of this program. It
/// takes part in broadcast updates when the image that it runs from has a label, and has the version that stands there.
/// Time is virtual and given by the caller. Not thread-safe.
class VirtualController {
 public:
  virtual ~VirtualController() = default;
  /// A frame arrives. It is handled by the next run_until.
  virtual void receive(const wire::CanFrame& frame) = 0;
  /// Its USB device, to be attached to a bus; another one, which has to be plugged in anew, when the session has
  /// changed.
  [[nodiscard]] virtual wire::UsbFunction& usb() = 0;
  [[nodiscard]] virtual int usb_session() const = 0;
  /// Runs the application until virtual time `now_us` (monotonic). May throw PowerLost from the flash model.
  virtual void run_until(std::uint64_t now_us) = 0;
  /// Earliest virtual time at which the application has something to do; ≤ now when it is busy.
  [[nodiscard]] virtual std::uint64_t next_event_us() const = 0;
};

/// Starts the application as after power-up. Implemented by firmware/board/posix, bound at link time.
[[nodiscard]] std::unique_ptr<VirtualController> make_virtual_controller(const VirtualBoard& board);

}  // namespace triskin::sim
