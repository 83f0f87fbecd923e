// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <random>
#include <span>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/sim/chain_model.hpp"

namespace triskin::hardware {

/// The model covers switched modules with their joints, registers, arbiters, broken chains, faults and virtual time.
/// The chain moves whole bytes, which is exact because every register is one byte long; it moves single bits only while
/// they can flip. Joined modules of several patches form one object with a controller for each patch. As a ChainModel
/// it is the chain of controller 0.
class SwitchedPatch final : public sim::ChainModel {
 public:
  using End = design::PortEnd;  ///< The row belongs to the patch.
  enum class JointFault : std::uint8_t { kNone, kOpen, kShort };

  /// `joints[m][p]` is the far end of port p of module m, with row −1 for none; it must be symmetric. Module 0 is the
  /// entry, and its cable is at `cable_port`.
  SwitchedPatch(std::vector<std::array<End, layout::kPorts>> joints, int cable_port, std::uint64_t seed);

  void enable(std::uint8_t cables) override { enable(0, cables); }
  void exchange(Bytes out, std::span<std::uint8_t> in) override { exchange(0, out, in); }
  void latch() override { latch(0); }
  [[nodiscard]] std::uint8_t stuck_lines() const override { return stuck_lines(0); }

  /// Plugs the cable of another controller into a port without joint; returns its number, from 1 on.
  int add_controller(End cable);
  /// Returns the chain of a controller as its master sees it; it is valid as long as this object. Throws
  /// std::out_of_range.
  [[nodiscard]] sim::ChainModel& chain_of(int controller);

  // Modules are numbered by their position in the patch, ports 0..2, lines 0..3.

  /// Plugs a second cable of a controller into a port without joint.
  void set_second_cable(End end, int controller = 0) { at_controller(controller).cables[1] = end; }
  /// Removes the supply of a module's logic (true) or restores it.
  void set_dead(layout::TableRow module, bool dead);
  /// Sets the fault of the joint at `end`, for both of its ends.
  void set_joint(End end, JointFault fault);
  /// Makes the module hold `line` low while its switches are closed; −1 means none.
  void set_stuck_line(layout::TableRow module, int line);
  /// Fixes output bit 0..7 of the module's register at 0 or 1; value −1 means that none is fixed.
  void set_stuck_bit(layout::TableRow module, int bit, int value);
  /// Clears the register of one module, as a dip of its supply does.
  void reset_alone(layout::TableRow module);
  /// Sets the probability, 0..1, that a bit flips while it passes one module.
  void set_bit_error_rate(double rate) { bit_errors_ = rate; }

  /// Returns true if the lines of a controller reach the module.
  [[nodiscard]] bool reached(layout::TableRow module) const { return controller_of(module) >= 0; }
  /// Returns the controller whose lines reach the module, or −1.
  [[nodiscard]] int controller_of(layout::TableRow module) const { return walk_up(module).controller; }
  /// Bit l is set if line l of a controller is low while nobody drives it.
  [[nodiscard]] std::uint8_t stuck_lines(int controller) const;
  /// Returns the line, 0..3, that the module's register selects.
  [[nodiscard]] int line_of(layout::TableRow module) const { return output(module) & 3; }
  /// Returns the address, 0..3, on that line that the module's register selects.
  [[nodiscard]] int address_of(layout::TableRow module) const { return output(module) >> 2 & 3; }
  /// Returns the number of joints between module and cable; −1 if the module is not reached.
  [[nodiscard]] int depth_of(layout::TableRow module) const { return walk_up(module).depth; }
  /// Returns the time in µs that exchanges of the chain have taken since construction.
  [[nodiscard]] double time_us() const { return time_us_; }

 private:
  struct Module {
    std::uint8_t shift = 0, latched = 0;
    int grant = 3;
    bool dead = false;
    int stuck_line = -1, stuck_bit = -1, stuck_value = 0;
  };
  struct Controller {
    std::array<End, 2> cables;
    std::uint8_t enabled = 0;  // Bit c is EN of cable c.
  };
  class Chain final : public sim::ChainModel {
   public:
    Chain(SwitchedPatch& patch, int controller) : patch_(patch), controller_(controller) {}
    void enable(std::uint8_t cables) override { patch_.enable(controller_, cables); }
    void exchange(Bytes out, std::span<std::uint8_t> in) override { patch_.exchange(controller_, out, in); }
    void latch() override { patch_.latch(controller_); }
    [[nodiscard]] std::uint8_t stuck_lines() const override { return patch_.stuck_lines(controller_); }

   private:
    SwitchedPatch& patch_;
    int controller_;
  };
  struct WayUp {
    int depth = -1, controller = -1;
  };
  void enable(int controller, std::uint8_t cables);
  void exchange(int controller, Bytes out, std::span<std::uint8_t> in);
  void latch(int controller);
  [[nodiscard]] WayUp walk_up(int module) const;
  [[nodiscard]] Controller& at_controller(int c) { return controllers_.at(static_cast<std::size_t>(c)); }
  [[nodiscard]] const Controller& at_controller(int c) const { return controllers_.at(static_cast<std::size_t>(c)); }
  [[nodiscard]] Module& at(int m) { return modules_[static_cast<std::size_t>(m)]; }
  [[nodiscard]] const Module& at(int m) const { return modules_[static_cast<std::size_t>(m)]; }
  [[nodiscard]] End end(int m, int p) const {
    return joints_[static_cast<std::size_t>(m)][static_cast<std::size_t>(p)];
  }
  [[nodiscard]] JointFault fault(int m, int p) const {
    return faults_[static_cast<std::size_t>(m)][static_cast<std::size_t>(p)];
  }
  [[nodiscard]] std::uint8_t output(int m) const;
  [[nodiscard]] std::uint8_t opened(int m) const;  ///< The result has the EN outputs.
  [[nodiscard]] std::uint8_t raised(int m) const;  ///< The result has the EN inputs.
  /// Returns the controller of a cable at this port whose EN is high, or −1.
  [[nodiscard]] int at_cable(int m, int port) const;
  [[nodiscard]] bool attached_child(int m, int p) const;
  [[nodiscard]] bool shorted(int controller) const;
  [[nodiscard]] std::vector<std::vector<int>> chains(int controller) const;
  void collect(int m, std::vector<int>& chain) const;
  std::uint8_t shift_byte(const std::vector<int>& chain, std::uint8_t carry);
  std::uint8_t shift_bits(const std::vector<int>& chain, std::uint8_t out);
  void settle();

  std::vector<std::array<End, layout::kPorts>> joints_;
  std::vector<std::array<JointFault, layout::kPorts>> faults_;
  std::vector<Module> modules_;
  std::vector<Controller> controllers_;
  std::deque<Chain> chains_;
  double bit_errors_ = 0.0, time_us_ = 0.0;
  std::mt19937_64 random_, flips_;
};

}  // namespace triskin::hardware
