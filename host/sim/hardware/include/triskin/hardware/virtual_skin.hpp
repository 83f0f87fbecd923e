// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/hardware/board_clock.hpp"
#include "triskin/hardware/flash_memory.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/hardware/skin.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/taxel_id.hpp"
#include "triskin/sim/virtual_controller.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::hardware {

/// A running scene has one virtual controller per patch, its chips, and one CAN bus for all, in virtual time. It is
/// deterministic. Not thread-safe.
class VirtualSkin {
 public:
  static constexpr std::size_t kFlashBytes = std::size_t{64} * 1024;
  using OnFrame = std::function<void(const wire::CanFrame&, std::uint64_t at_us)>;

  /// Powers all controllers. The flash contents are stored in `state_folder` (created when missing), or in memory if it
  /// is empty. Throws InputError or DeviceError as FlashMemory does.
  explicit VirtualSkin(Scene scene, const std::filesystem::path& state_folder = {});
  ~VirtualSkin();
  VirtualSkin(const VirtualSkin&) = delete;
  VirtualSkin& operator=(const VirtualSkin&) = delete;

  /// Returns the virtual time in µs since construction.
  [[nodiscard]] std::uint64_t now_us() const { return now_us_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] Skin& skin() { return skin_; }
  [[nodiscard]] SwitchedHardware& switched() { return switched_; }
  /// Returns the number of controllers, one for each patch.
  [[nodiscard]] std::size_t controllers() const { return nodes_.size(); }

  /// Sets the handler of frames that controllers send. run_until calls it with the virtual time at which the frame has
  /// left the bus. If it is empty, frames are dropped.
  void on_frame(OnFrame handler) { on_frame_ = std::move(handler); }
  /// Puts a frame of the host on the bus, at the current virtual time.
  void send(const wire::CanFrame& frame);
  /// Counts the frames of the host that wait for the bus.
  [[nodiscard]] std::size_t host_frames_waiting() const;
  /// Runs the simulation until virtual time `until_us`; times in the past have no effect.
  void run_until(std::uint64_t until_us) { run(until_us, false); }
  /// Runs until a frame for the host has left the bus (true), at the latest until `until_us`.
  bool run_until_frame(std::uint64_t until_us) { return run(until_us, true); }

  /// Puts a finger on the module for which it is meant (the fault finger_elsewhere moves it); it covers all of its
  /// taxels. Returns an id for release.
  int press_module(layout::ModuleId module);
  /// Puts a finger tip on one taxel, otherwise as above.
  int press_taxel(layout::TaxelId taxel);
  /// Lifts the finger with this id; it has no effect when the finger is gone.
  void release(int id) { skin_.release(id, now_us_); }

  /// Puts the pads of a module (-1: all modules) under `kpa` ≥ 0, in addition to the fingers. Throws
  /// std::out_of_range.
  void pressurize(layout::ModuleId module, double kpa) { skin_.pressurize(module, kpa, now_us_); }

  /// Returns the flash of one controller, in which its power can be cut; a controller that lost power is dead until it
  /// is powered again.
  [[nodiscard]] FlashMemory& flash(std::size_t patch) { return *nodes_[patch].flash; }
  /// Returns the application slots of one controller.
  [[nodiscard]] FlashMemory& slots(std::size_t patch) { return *nodes_[patch].slots; }
  /// Returns false if the controller has lost power in a flash operation.
  [[nodiscard]] bool alive(std::size_t patch) const { return nodes_[patch].controller != nullptr; }
  /// Switches the controller off and on again; its flash keeps its contents.
  void power_cycle(std::size_t patch);
  /// Stops the controller of a patch: it restarts and knows the cause. The crash is then also in its fault memory.
  void crash(std::size_t patch, const wire::Crash& crash);
  /// Returns the virtual time at which the clock of a controller shows `shown_us`, since its last power-up.
  [[nodiscard]] std::uint64_t time_us(std::size_t patch, std::uint64_t shown_us) const {
    return nodes_.at(patch).clock.time_us(shown_us);
  }
  /// Disconnects the host from the bus, or connects it again; while it is disconnected, frames in both directions are
  /// lost.
  void plug(bool plugged) { plugged_ = plugged; }

  /// Returns whether a receiver hears a frame; the receiver is the number of a controller, or kToHost.
  using Hears = std::function<bool(std::size_t receiver, const wire::CanFrame&)>;
  static constexpr std::size_t kToHost = ~std::size_t{0};
  /// Sets a function that is asked for each receiver of each frame and returns false when the receiver loses it. If it
  /// is empty, no frame is lost.
  void on_delivery(Hears hears) { hears_ = std::move(hears); }

  /// Sets whether the bus carries FD frames (it does at first). Power-cycles the controllers.
  void use_fd(bool fd);

  /// Returns the USB device of a controller that has power; call wake() after giving it data.
  [[nodiscard]] wire::UsbFunction& usb(std::size_t patch) { return nodes_.at(patch).controller->usb(); }
  /// Returns a number that changes whenever the controller plugs itself in again.
  [[nodiscard]] int usb_session(std::size_t patch) const { return nodes_.at(patch).controller->usb_session(); }
  /// Lets the controller run at the current virtual time.
  void wake(std::size_t patch) { nodes_.at(patch).run_again_us = now_us_; }

  /// Returns the bit rates of the bus; 0 where the scene sets none.
  [[nodiscard]] wire::BitRates bit_rates() const;
  /// Counts the frames on the bus since construction.
  [[nodiscard]] std::uint64_t bus_frames() const { return bus_frames_; }
  /// Returns the time in µs during which the bus was busy; 0 where the scene sets no bit rate.
  [[nodiscard]] std::uint64_t bus_busy_us() const { return bus_busy_us_; }

 private:
  struct Node {
    std::unique_ptr<FlashMemory> flash, slots;
    BoardClock clock;
    layout::PatchIndex plugged = layout::PatchIndex::none();  // The cable leads to this patch.
    std::deque<ClockedLine> lines;
    sim::VirtualBoard board;
    std::unique_ptr<sim::VirtualController> controller;
    std::uint64_t run_again_us = 0;
    std::size_t in_buffers = 0;  // This many frames were given to the bus and still wait for it.
  };
  static constexpr std::size_t kBuffers = 3;
  struct Pending {
    wire::CanFrame frame;
    std::size_t from;  // The sender is the number of a node, or kHost.
  };
  static constexpr std::size_t kHost = ~std::size_t{0};

  /// Returns the module that the finger meets when it is meant for `module`.
  [[nodiscard]] layout::ModuleId touched_instead_of(layout::ModuleId module) const;
  bool run(std::uint64_t until_us, bool stop_at_frame);
  void build(std::size_t patch, const std::filesystem::path& state_folder, bool other_hardware);
  void plug_in(Node& node, layout::PatchIndex patch);
  void exchange_cables();
  void number_boards();
  [[nodiscard]] wire::CanFrame of_its_firmware(wire::CanFrame frame, layout::PatchIndex patch) const;
  [[nodiscard]] std::unique_ptr<sim::VirtualController> make_controller(std::size_t patch);
  void power_up(std::size_t patch);
  void run_controllers();
  void run_controller(Node& node);
  void deliver(const Pending& pending);
  [[nodiscard]] std::deque<Pending>::iterator winner();
  bool advance_bus();
  [[nodiscard]] std::uint64_t next_event_us() const;
  [[nodiscard]] std::uint64_t frame_us(const wire::CanFrame& frame) const;

  Scene scene_;
  SwitchedHardware switched_;
  Skin skin_;
  std::vector<Node> nodes_;
  OnFrame on_frame_;
  Hears hears_;
  std::deque<Pending> pending_;
  std::vector<Pending> on_wire_;  // The vector holds at most one frame, which occupies the bus until wire_free_us_.
  std::uint64_t wire_free_us_ = 0;
  std::vector<Fault> numberings_;                // Only future ones are listed, the latest first.
  std::vector<std::uint64_t> cable_changes_us_;  // Only future times are listed, the latest first.
  std::uint64_t now_us_ = 0;
  std::uint64_t bus_frames_ = 0;
  std::uint64_t bus_busy_us_ = 0;
  bool plugged_ = true;
  bool frame_came_ = false;
};

/// Returns the folder that stores the flash of simulated controllers between processes: $XDG_STATE_HOME/triskin/sim,
/// else ~/.local/state/…, else the temporary folder. It is not created here.
[[nodiscard]] std::filesystem::path state_folder();
/// Returns the folder of one design: state_folder()/<design id>.
[[nodiscard]] std::filesystem::path state_folder_of(const design::Design& design);

}  // namespace triskin::hardware
