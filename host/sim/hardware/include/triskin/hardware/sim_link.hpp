// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>

#include "triskin/hardware/virtual_skin.hpp"
#include "triskin/link/link.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/link/node_map.hpp"
#include "triskin/link/touch_actuator.hpp"
#include "triskin/wire/usb_packet.hpp"

namespace triskin::hardware {

/// All links to a simulation in this process have this base. Waiting advances virtual time; nothing depends on the wall
/// clock. Threads: one.
class InProcessLink : public link::Link, public link::TouchActuator {
 public:
  [[nodiscard]] std::uint64_t now_us() const override { return skin_.now_us(); }
  [[nodiscard]] bool fd() const override { return true; }
  [[nodiscard]] std::uint64_t answer_us() const override;
  void press(layout::ModuleId module) override;
  void press(layout::TaxelId taxel) override;
  void lift() override;
  void pressurize(layout::ModuleId module, double kpa) override { skin_.pressurize(module, kpa); }
  /// Returns the simulated hardware, so that it can be changed while it runs.
  [[nodiscard]] hardware::VirtualSkin& skin() { return skin_; }

 protected:
  InProcessLink(hardware::Scene scene, const std::filesystem::path& state_folder)
      : skin_(std::move(scene), state_folder) {}
  hardware::VirtualSkin skin_;

 private:
  int touch_ = 0;
};

/// Connects all controllers to one CAN bus.
class SimLink final : public InProcessLink {
 public:
  /// Powers the skin of the scene. `state_folder` stores the flash of its controllers; if it is empty, memory does.
  /// Throws as hardware::VirtualSkin does.
  explicit SimLink(hardware::Scene scene, const std::filesystem::path& state_folder = {});

  void send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::string name() const override { return link::kSimulatedBus; }
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override { return wire::full_sample_ns(skin_.bit_rates()); }

 private:
  std::deque<wire::CanFrame> inbox_;
};

/// Makes each controller a USB device with the vendor interface, all behind one full-speed hub, with their CAN ports
/// open. The hub carries 19 bulk packets per millisecond (USB 2.0 §5.8.4), both directions together, and asks the
/// devices in turn, so that none starves another. Frames, device states and descriptors are those of wire::UsbFunction.
class SimUsbLink final : public InProcessLink {
 public:
  /// Powers the skin as SimLink does, but bit rates of the scene's bus have no effect.
  explicit SimUsbLink(hardware::Scene scene, const std::filesystem::path& state_folder = {});

  /// Sends a request to the device that has answered from its node address, and all other frames to every device.
  /// Throws DeviceError for a frame longer than frame_bytes().
  void send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint8_t frame_bytes() const override { return wire::kUsbFrameBytes; }
  [[nodiscard]] std::string name() const override { return link::kSimulatedHub; }
  [[nodiscard]] int wire_of(std::uint8_t node) const override { return nodes_.wire_of(node).value_or(0); }
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override { return wire::kUsbBulkFrame_ns; }
  /// Counts the packets that crossed the hub in both directions since construction.
  [[nodiscard]] std::uint64_t packets() const { return packets_; }

 private:
  [[nodiscard]] bool ready(std::size_t device);
  [[nodiscard]] bool fetch();
  void occupy_hub();
  void wait_for_hub();

  std::deque<wire::CanFrame> inbox_;
  link::NodeMap nodes_;
  std::vector<int> sessions_;  // The number of a device changes when it reconnects.
  std::size_t next_ = 0;       // The devices take turns, and this one is asked first.
  std::uint64_t hub_free_ns_ = 0;
  std::uint64_t packets_ = 0;
};

}  // namespace triskin::hardware
