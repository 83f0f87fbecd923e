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

/// The surroundings of a patch controller must outlive it.
struct VirtualBoard {
  std::array<I2cBus*, layout::kLines> lines{};  ///< None of these pointers may be null.
  FlashModel* flash = nullptr;  ///< The flash holds the table slots, the fault memory and the node address.
  wire::UniqueId unique_id{};
  std::function<void(const wire::CanFrame&)> send;  ///< The controller calls this for every frame that it sends.
  bool can_fd = true;                               ///< True means that the bus carries CAN FD frames.
  /// The switched modules are reached through this chain; null means that the board has none.
  ChainModel* chain = nullptr;
  /// Both application slots are here, one after the other; null means a board without a loader.
  FlashModel* slots = nullptr;
  /// The function returns whether a transmit buffer is free; if it is empty, one always is.
  std::function<bool()> room{};
  wire::BoardHealth health = healthy();  ///< The board reports this as its health.
  std::optional<wire::Crash> crash{};    ///< The board reports this crash until a host clears the fault memory.

  [[nodiscard]] static wire::BoardHealth healthy() {
    wire::BoardHealth h;
    h.clock = {wire::Crystal::kUsed, 8, 8000};
    h.reset_cause = wire::reset_cause::kPower;
    return h;
  }
};

/// Both application slots together have this size.
inline constexpr std::size_t kSlotsBytes = std::size_t{2} * 0x3C000;

/// The patch controller's application runs on virtual ports, with the same logic as on the microcontroller. An image in
/// a slot is stored, checked, counted and confirmed as there, but the code that runs is always that of this program. If
/// the running image has a label, the controller takes part in broadcast updates and reports the version of the label.
/// The caller provides the virtual time. Not thread-safe.
class VirtualController {
 public:
  virtual ~VirtualController() = default;
  /// Accepts a frame, which the next run_until handles.
  virtual void receive(const wire::CanFrame& frame) = 0;
  /// Returns the USB device to attach to a bus. After the session has changed it is another device, which has to be
  /// plugged in again.
  [[nodiscard]] virtual wire::UsbFunction& usb() = 0;
  [[nodiscard]] virtual int usb_session() const = 0;
  /// Runs the application until the virtual time `now_us` (monotonic). May throw PowerLost from the flash model, and
  /// std::logic_error when the firmware asks for time again and again without doing anything, which is a mistake in it.
  virtual void run_until(std::uint64_t now_us) = 0;
  /// Returns the earliest virtual time at which the application has work; a time ≤ now means that it is busy.
  [[nodiscard]] virtual std::uint64_t next_event_us() const = 0;
};

/// Starts the application as after power-up. firmware/board/posix implements this function, and the linker binds it.
[[nodiscard]] std::unique_ptr<VirtualController> make_virtual_controller(const VirtualBoard& board);

}  // namespace triskin::sim
