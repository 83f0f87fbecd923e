// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/machine/dma.hpp"
#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/vcd.hpp"
#include "triskin/sim/i2c_bus.hpp"

namespace triskin::machine {

/// Models I²C version 2 as a master (RM0440 §39.9): timing from TIMINGR, data register and shift register, automatic
/// end, NACK and stop, SCL time-out, DMA requests. The bytes go to an I2cBus. The GPIO block can take its pins away
/// (bus clear).
class I2cController final : public Peripheral {
 public:
  I2cController(Surroundings& around, int line, sim::I2cBus& bus, int event_irq, int error_irq, Dma& dma,
                VcdTrace* trace, std::function<bool()> pins_ready)
      : Peripheral(around),
        line_(line),
        bus_(bus),
        event_irq_(event_irq),
        error_irq_(error_irq),
        dma_(dma),
        trace_(trace),
        pins_ready_(std::move(pins_ready)) {
    reset();
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  [[nodiscard]] sim::I2cBus& bus() { return bus_; }
  /// Makes a transfer see a bus error that does not exist, and continue (errata ES0430, 2.15.2). Returns false if no
  /// transfer is under way, or the last error is still pending.
  bool spurious_bus_error();
  /// Makes the controller take a disturbance for another master: it lets go in the middle of a transfer, and the chips
  /// are left as they are. The bus counts as busy until a stop. Returns false if no transfer is under way, or the
  /// controller holds SCL low itself.
  bool lose_arbitration();
  /// Spoils the chip's next acknowledge on the wire: the chip takes the byte, but the controller sees no acknowledge.
  /// Returns false if no further one is expected in this transfer, or the last one is still pending.
  bool spoil_acknowledge();
  /// Makes a chip hold SCL low for this long after the next byte. Returns false if no transfer is under way.
  bool stretch(Time by);
  [[nodiscard]] Time busy_time() const { return busy_time_; }
  [[nodiscard]] Time scl_period() const;
  /// Sets the rise time of SCL from 30 to 70 %, ns, as UM10204 counts it.
  void set_rise(std::uint32_t rise_ns) { rise_ns_ = rise_ns; }
  /// Tells that other controllers share the SCL wire; `others_busy` returns whether one of them drives it.
  void share_scl(std::function<bool()> others_busy) { others_busy_ = std::move(others_busy); }
  [[nodiscard]] bool on_bus() const { return on_bus_; }

 private:
  void after(Time delay, std::function<void()> action);
  void write_control2(std::uint32_t value);
  void check_timing();
  void begin();
  void address_sent();
  void shift_out();
  void shift_in();
  void deliver();
  void finish_phase();
  void send_stop();
  void hang();
  [[nodiscard]] bool holds_scl() const;
  [[nodiscard]] bool lines_free() const { return bus_.scl() && bus_.sda(); }
  void update_irqs();
  void serve_dma();
  [[nodiscard]] std::uint32_t receive_request() const {
    return 16 + 2 * static_cast<std::uint32_t>(line_);
  }  // The values are those of RM0440 table 91.
  std::uint8_t take_received();
  void load(std::uint8_t byte);

  int line_;
  sim::I2cBus& bus_;
  int event_irq_, error_irq_;
  Dma& dma_;
  VcdTrace* trace_;
  std::function<bool()> pins_ready_, others_busy_;
  std::uint32_t cr1_ = 0, cr2_ = 0, timing_ = 0, timeout_ = 0, isr_ = 1;
  std::uint8_t rx_ = 0, tx_ = 0, held_ = 0;
  bool reading_ = false, tx_waits_ = false, shifting_ = false, stretched_ = false;
  std::uint32_t count_ = 0, loaded_ = 0, moved_ = 0;
  std::uint32_t rise_ns_ = 0;
  std::uint64_t generation_ = 0;
  bool on_bus_ = false, spoilt_ = false;
  Time stretch_ = 0;
  Time busy_since_ = 0, busy_time_ = 0;
};

}  // namespace triskin::machine
