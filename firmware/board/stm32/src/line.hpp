// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/board/registers/dma.hpp"
#include "triskin/board/registers/gpio.hpp"
#include "triskin/ports/ports.hpp"

namespace triskin::board {

/// Where a line is on the chip: its I²C block, the block's pins with their alternate function and interrupts, and the
/// channels of the DMA that serve it.
struct LinePlace {
  std::uint32_t base = 0;
  Pin scl, sda;
  std::uint32_t alternate = 0;
  int event_irq = 0, error_irq = 0;
  dma_reg::Channel receiver, sender;
};
/// Each chip has its table and connects the requests of the blocks to these channels; both need clocks that
/// connect_lines() enables.
extern const std::array<LinePlace, layout::kLines> line_places;
void connect_lines();

/// I2C1 … I2C4 are masters at 400 kHz. DMA moves the bytes; one interrupt switches from writing to reading, another
/// ends the transfer. Every transfer has a deadline that depends on its bytes, so that a line that hangs without an
/// error flag is also noticed. A transfer that a disturbance interrupted is repeated while the bus can be cleared, for
/// 20 ms at most.
class Stm32I2cLine final : public fw::I2cLine {
 public:
  void open(const LinePlace& place);
  void start(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) override;
  std::optional<Status> poll() override;
  [[nodiscard]] std::uint64_t started_us() const override { return started_us_; }
  [[nodiscard]] std::uint64_t ended_us() const override { return ended_us_; }
  Status recover() override;
  /// Returns when poll() must be called even without an interrupt; the largest value when no transfer is running.
  [[nodiscard]] std::uint64_t deadline_us() const { return active_ ? deadline_us_ : UINT64_MAX; }
  /// Returns true if the outcome is known and waits for poll().
  [[nodiscard]] bool finished() const { return active_ && outcome_ != Outcome::kRunning; }
  /// Returns true if SDA or SCL is low; call it while no transfer is running.
  [[nodiscard]] bool low() const { return !Gpio(place_.scl).level() || !Gpio(place_.sda).level(); }
  /// The interrupt handlers call this function.
  void on_event();
  void on_error();

 private:
  enum class Outcome : std::uint8_t { kRunning, kDone, kNack, kStuck, kLost };
  [[nodiscard]] dma_reg::Channel sender() const { return place_.sender; }
  [[nodiscard]] dma_reg::Channel receiver() const { return place_.receiver; }
  void begin_transfer();
  void begin_reading();
  [[nodiscard]] bool moves();
  [[nodiscard]] bool repeat();
  void begin_again();
  [[nodiscard]] Register reg(std::uint32_t offset) const { return Register(place_.base + offset); }
  void enable();
  void disable();
  void end(Outcome outcome);
  void pins_to_bus() const;

  LinePlace place_;
  Bytes write_;
  std::span<std::uint8_t> read_;
  std::uint8_t address_ = 0;
  bool reading_ = false, active_ = false, nack_ = false;
  volatile Outcome outcome_ = Outcome::kRunning;
  std::uint8_t refusals_ = 0;
  std::size_t left_ = 0;  // This many bytes had not moved when the deadline was set.
  std::uint64_t deadline_us_ = 0, started_us_ = 0, ended_us_ = 0;
};

extern Stm32I2cLine lines[4];
void open_lines();

}  // namespace triskin::board
