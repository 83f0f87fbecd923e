// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "triskin/machine/flash_chip.hpp"
#include "triskin/machine/map.hpp"
#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/profile.hpp"
#include "triskin/machine/usb_wire.hpp"
#include "triskin/machine/vcd.hpp"
#include "triskin/sim/chain_model.hpp"
#include "triskin/sim/i2c_bus.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

enum class Trouble : std::uint8_t { kBusError, kArbitrationLoss, kStretch, kCanError, kNoAcknowledge };

/// An event that has disturbed a bus.
struct Incident {
  std::uint64_t at_us = 0;
  Trouble trouble = Trouble::kBusError;
  std::size_t line = 0;  ///< The I²C line is 0..3; a CAN error does not use it.
};

/// States how often buses are disturbed, in events per hour; each event waits for a transfer or frame to spoil.
struct Disturbances {
  double bus_errors = 0;          ///< These are the spurious I²C bus errors of errata ES0430, 2.15.2.
  double arbitration_losses = 0;  ///< An I²C controller takes a disturbance for another master.
  double clock_stretches = 0;     ///< A chip holds SCL low for 60 … 400 µs.
  double can_errors = 0;          ///< A frame on the CAN bus is spoilt and sent again.
  double no_acknowledges = 0;     ///< An acknowledge of a chip is spoilt on the wire.
  std::uint64_t seed = 20261122;  ///< The seed sets times and lines; equal seeds give equal disturbances.
};

/// Port 0 is A.
struct MachinePin {
  unsigned port = 0, number = 0;
};

/// Tells where a board has its signals; the defaults are those of firmware/board/stm32g474/boards/nucleo_g474re.
struct BoardPins {
  struct Line {
    MachinePin scl, sda;
  };
  std::array<Line, 4> lines{{{{0, 15}, {1, 7}}, {{0, 9}, {0, 8}}, {{2, 8}, {2, 9}}, {{2, 6}, {2, 7}}}};
  /// The alternate functions of the pins of I2C1 … I2C4.
  std::array<unsigned, 4> line_functions{map::kFunctionI2cFirst, map::kFunctionI2cFirst, map::kFunctionI2cSecond,
                                         map::kFunctionI2cSecond};
  MachinePin can_receive{1, 8}, can_send{1, 9}, log{0, 2};
  /// True means that the SCL pins of all lines are one wire, so two masters at once are a violation.
  bool one_scl = false;
};

/// The STM32L452 has bxCAN instead of FDCAN, one bank of flash, other clocks, and DMA without a multiplexer. Its USB
/// is dead until PWR_CR2.USV connects the supply.
enum class Chip : std::uint8_t { kStm32g474, kStm32l452 };

/// What differs from chip to chip of one kind. docs/silicon.md has ranges and sources.
struct ChipSpread {
  double internal_error = 0;  ///< The internal oscillator HSI is faster by this share.
  double watchdog_error = 0;  ///< The same for the watchdog's oscillator LSI.
  double flash_factor = 1;    ///< Erasing and programming take so many times the typical time.
};

/// Connects the hardware around the microcontroller. Everything must outlive the machine.
struct MachineSetup {
  std::array<sim::I2cBus*, 4> lines{};  ///< No pointer may be null.
  FlashChip* flash = nullptr;
  Chip chip = Chip::kStm32g474;
  std::array<std::uint8_t, 12> unique_id{};
  /// The machine calls this when a frame has left the controller.
  std::function<void(const wire::CanFrame&, std::uint64_t now_us)> on_can;
  VcdTrace* trace = nullptr;             ///< The pointer may be null.
  Profile* profile = nullptr;            ///< The pointer may be null; code takes longer to run with a profile.
  std::uint64_t crystal_hz = 8'000'000;  ///< Zero stands for a missing crystal, or one that does not start.
  /// At this time after power-up the crystal stops permanently.
  std::uint64_t crystal_fails_at_us = ~std::uint64_t{0};
  bool will_be_cut = false;  ///< Required for power_cycle(); it makes reading slower.
  bool watch_reads = false;  ///< Loads from a bank that is being written then stall, too, which makes reading slower.
  sim::ChainModel* chain = nullptr;  ///< The chain of the switched modules may be null.
  /// The rise time of all lines from 30 to 70 % lengthens SCL's period by 1.42 times its value.
  std::uint32_t scl_rise_ns = 0;
  ChipSpread spread;
  Disturbances disturbances;  ///< Disturbances occur at random times.
  BoardPins pins{};           ///< The pins belong to the board.
  bool boot_pin_high = true;  ///< PB8 at a reset is the output of the CAN transceiver, which is high on an idle bus.
};

/// All numbers count from power-up.
struct MachineCounts {
  std::uint64_t instructions = 0, exceptions = 0;
  std::uint64_t idle_us = 0;
  int resets = 0;
  Time worst_interrupt = 0;             ///< The time runs from entry to return of the longest exception.
  Time flash_stall = 0;                 ///< The core waited this long for a bank that was being written.
  std::uint64_t flash_read_stalls = 0;  ///< Loads are counted separately, but only with MachineSetup::watch_reads.
  std::array<std::uint64_t, 4> i2c_busy_us{};  ///< The times from start to stop are summed for each line.
  std::uint64_t spurious_bus_errors = 0, arbitration_losses = 0, clock_stretches = 0, can_errors = 0,
                no_acknowledges = 0;  ///< Each counts the injected disturbances of one kind.
  std::uint64_t bus_offs = 0;         ///< The CAN block went bus-off this often.
};

/// Runs an unmodified image on a model of an STM32G474 or STM32L452 (docs/machine.md). Deterministic. Not thread-safe;
/// one instruction counts one cycle.
class Machine {
 public:
  class Core;
  /// Powers the chip up: registers have their reset values, and it starts from the vector table at 0x08000000. All
  /// objects in `setup` must outlive the machine.
  explicit Machine(const MachineSetup& setup);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Runs until virtual time `us`. Throws sim::PowerLost when the flash was told to lose power, DeviceError when the
  /// core locks up.
  void run_until(std::uint64_t us);
  /// Turns power off and on, with these cells in the flash: RAM loses its content. Faster than a new machine.
  void power_cycle(const FlashChip& cells);
  /// Pulls the reset pin low for a moment: RAM keeps its content.
  void press_reset();
  /// A debugger holds the core, or lets it go on: time and peripherals continue, also over a reset.
  void hold_core(bool held);
  /// A debugger writes a word to a register of a block.
  void write_register(std::uint32_t address, std::uint32_t value);
  /// Holds the button at PC13 of a Nucleo board, which is high while pressed.
  void hold_button(bool pressed);
  /// Returns the virtual time since power-up, µs.
  [[nodiscard]] std::uint64_t now_us() const;
  /// Queues a frame on the CAN bus, after those given before.
  void receive(const wire::CanFrame& frame);
  /// Returns how many frames given to receive() have not been on the bus yet.
  [[nodiscard]] std::size_t frames_waiting() const;
  /// Disturbs `line` (0..3) now: a spurious bus error, a lost arbitration, the next acknowledge spoilt, or SCL held low
  /// for `stretch_us` after the next byte; or the frame that is under way on CAN, whatever the line. Returns false if
  /// nothing is under way there, or the last such event is still pending.
  bool disturb(std::size_t line, Trouble trouble, std::uint64_t stretch_us = 0);
  /// Makes the CAN block fail to read its message RAM in time, so it enters restricted operation mode. Only FDCAN has
  /// such a RAM.
  void fail_can_ram();
  /// Lists the disturbances of the buses since power-up, random or not, in order of time.
  [[nodiscard]] const std::vector<Incident>& incidents() const;
  /// Returns the device's end of the USB cable, which lives as long as the machine.
  [[nodiscard]] UsbWire& usb();
  /// Returns the word at an address of flash or RAM, as the core reads it, without side effects. The tests read symbols
  /// of the ELF with it.
  [[nodiscard]] std::uint32_t read_word(std::uint32_t address) const;
  /// Changes a word of RAM, data or code, as no hardware of the chip would: tests make the image fail with it.
  void write_word(std::uint32_t address, std::uint32_t value);
  /// Reads a register of a block as a load of 32 bits does, whether its clock is on or off; reading a data register
  /// removes a byte.
  [[nodiscard]] std::uint32_t read_register(std::uint32_t address) const;
  /// Returns the text that a terminal at USART2's sender (PA2), 115,200 baud, has shown since power-up.
  [[nodiscard]] const std::string& serial_text() const;
  /// Lists the actions of the image so far that the silicon would refuse, in order of time; empty if there were none.
  [[nodiscard]] const std::vector<Violation>& violations() const;
  /// Returns instructions, interrupts, idle time and bus time since power-up.
  [[nodiscard]] const MachineCounts& counts() const;
  /// Returns the present clock of the core, Hz; it changes when the image switches it.
  [[nodiscard]] std::uint64_t sysclk_hz() const;
  /// Returns true if reset found BOOT0 high and the option bits allow it: the ROM's loader runs, and no code of ours
  /// does.
  [[nodiscard]] bool in_rom_loader() const;
  /// Returns the address of the running image's vector table, in flash.
  [[nodiscard]] std::uint32_t vector_table() const;

 private:
  std::unique_ptr<Core> core_;
};

}  // namespace triskin::machine
