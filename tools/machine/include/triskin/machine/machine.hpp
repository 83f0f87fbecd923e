// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "triskin/machine/flash_chip.hpp"
#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/usb_wire.hpp"
#include "triskin/machine/vcd.hpp"
#include "triskin/sim/chain_model.hpp"
#include "triskin/sim/i2c_bus.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// What disturbs a bus.
enum class Trouble : std::uint8_t { kBusError, kArbitrationLoss, kStretch, kCanError, kNoAcknowledge };

/// Something that has disturbed a bus.
struct Incident {
  std::uint64_t at_us = 0;
  Trouble trouble = Trouble::kBusError;
  std::size_t line = 0;  ///< 0..3, of I²C; without meaning for a CAN error
};

/// How often something disturbs the buses, times an hour; each waits for a transfer or frame to spoil.
struct Disturbances {
  double bus_errors = 0;          ///< spurious I²C bus errors (errata ES0430, 2.15.2)
  double arbitration_losses = 0;  ///< An I²C controller takes a disturbance for another master.
  double clock_stretches = 0;     ///< A chip holds SCL low, for 60 … 400 µs.
  double can_errors = 0;          ///< A frame on the CAN bus is spoilt and sent again.
  double no_acknowledges = 0;     ///< An acknowledge of a chip is spoilt on the wire.
  std::uint64_t seed = 20261122;  ///< Seed of times and lines: equal seeds give equal disturbances.
};

/// A pin of the chip: port 0 is A.
struct MachinePin {
  unsigned port = 0, number = 0;
};

/// Where a board has what; at first as firmware/board/stm32g474/boards/nucleo_g474re.
struct BoardPins {
  struct Line {
    MachinePin scl, sda;
  };
  std::array<Line, 4> lines{{{{0, 15}, {1, 7}}, {{0, 9}, {0, 8}}, {{2, 8}, {2, 9}}, {{2, 6}, {2, 7}}}};
  MachinePin can_receive{1, 8}, can_send{1, 9}, log{0, 2};
  bool one_scl = false;  ///< the SCL pins of all lines are one wire: two masters at once are a violation
};

/// Hardware around the microcontroller. Everything must outlive the machine.
struct MachineSetup {
  std::array<sim::I2cBus*, 4> lines{};  ///< none null
  FlashChip* flash = nullptr;
  std::array<std::uint8_t, 12> unique_id{};
  std::function<void(const wire::CanFrame&, std::uint64_t now_us)> on_can;  ///< A frame has left the controller.
  VcdTrace* trace = nullptr;                                                ///< may be null
  std::uint64_t crystal_hz = 8'000'000;                                     ///< 0: none, or one that does not start
  std::uint64_t crystal_fails_at_us = ~std::uint64_t{0};  ///< Time after power-up when it stops for ever.
  bool will_be_cut = false;                               ///< power_cycle() will be used: reading is slower
  bool watch_reads = false;          ///< Loads from a bank that is written stall, too: reading is slower.
  sim::ChainModel* chain = nullptr;  ///< chain of the switched modules; may be null
  std::uint32_t scl_rise_ns = 0;     ///< rise time of all lines, 30 to 70 %: SCL's period grows by 1.42 of it
  Disturbances disturbances;         ///< disturbances at random times
  BoardPins pins{};                  ///< of the board
  bool boot_pin_high = true;         ///< PB8 at a reset: the CAN transceiver's output, high on an idle bus
};

/// Counted since power-up.
struct MachineCounts {
  std::uint64_t instructions = 0, exceptions = 0;
  std::uint64_t idle_us = 0;
  int resets = 0;
  Time worst_interrupt = 0;                    ///< entry to return of the longest exception
  Time flash_stall = 0;                        ///< The core waited for a bank that was written.
  std::uint64_t flash_read_stalls = 0;         ///< loads among these, with MachineSetup::watch_reads
  std::array<std::uint64_t, 4> i2c_busy_us{};  ///< Start to stop, summed.
  std::uint64_t spurious_bus_errors = 0, arbitration_losses = 0, clock_stretches = 0, can_errors = 0,
                no_acknowledges = 0;  ///< number of injected disturbances of each kind
  std::uint64_t bus_offs = 0;         ///< number of times that the CAN block went bus-off
};

/// An STM32G474 that runs an unmodified image (docs/machine.md). Deterministic. Not thread-safe; one instruction counts
/// one cycle.
class Machine {
 public:
  class Core;
  /// Powers the chip up: registers at their reset values, start from the vector table at 0x08000000. What `setup`
  /// points to must outlive the machine.
  explicit Machine(const MachineSetup& setup);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Runs until virtual time `us`. Throws sim::PowerLost when the flash was told to lose power, DeviceError when the
  /// core locks up.
  void run_until(std::uint64_t us);
  /// Power goes and comes back, with these cells in the flash: RAM has lost what it held. Faster than a new machine.
  void power_cycle(const FlashChip& cells);
  /// The reset pin is pulled low for a moment: RAM keeps what it holds.
  void press_reset();
  /// The button at PC13 of a Nucleo board, high while it is pressed.
  void hold_button(bool pressed);
  /// Virtual time since power-up, µs.
  [[nodiscard]] std::uint64_t now_us() const;
  /// A frame on the CAN bus, after those given before.
  void receive(const wire::CanFrame& frame);
  /// Frames given to receive() that have not been on the bus yet.
  [[nodiscard]] std::size_t frames_waiting() const;
  /// Disturbs `line` (0..3) now: a spurious bus error, a lost arbitration, the next acknowledge spoilt, or SCL held low
  /// for `stretch_us` after the next byte. False: no transfer is under way there, or the last such thing still stands.
  /// Not for CAN errors.
  bool disturb(std::size_t line, Trouble trouble, std::uint64_t stretch_us = 0);
  /// What has disturbed the buses since power-up, random or not, in order of time.
  [[nodiscard]] const std::vector<Incident>& incidents() const;
  /// The device's end of the USB cable. Lives as long as the machine.
  [[nodiscard]] UsbWire& usb();
  /// Word at an address of flash or RAM, as the core reads it, without side effects. The tests read symbols of the ELF
  /// with it.
  [[nodiscard]] std::uint32_t read_word(std::uint32_t address) const;
  /// Changes a word of RAM, data or code, as nothing on the chip would: tests make the image fail with it.
  void write_word(std::uint32_t address, std::uint32_t value);
  /// A register of a block as a load of 32 bits finds it, its clock on or off; of a data register this takes a byte.
  [[nodiscard]] std::uint32_t read_register(std::uint32_t address) const;
  /// What a terminal at USART2's sender (PA2), 115,200 baud, has shown since power-up.
  [[nodiscard]] const std::string& serial_text() const;
  /// What the image has done so far that the silicon would refuse, in order of time; empty: nothing.
  [[nodiscard]] const std::vector<Violation>& violations() const;
  /// Instructions, interrupts, idle time and bus time since power-up.
  [[nodiscard]] const MachineCounts& counts() const;
  /// Clock of the core at present, Hz: changes when the image switches it.
  [[nodiscard]] std::uint64_t sysclk_hz() const;
  /// Reset found BOOT0 high and the option bits listening to it: the ROM's loader runs, nothing of ours does.
  [[nodiscard]] bool in_rom_loader() const;
  [[nodiscard]] std::uint32_t vector_table() const;  ///< address of the running image's table, in flash

 private:
  std::unique_ptr<Core> core_;
};

}  // namespace triskin::machine
