// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>

#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/usb_wire.hpp"

namespace triskin::machine {

/// Models the USB full-speed device (RM0440 §45) with its packet memory: end point registers that toggle, buffer
/// table, transactions, suspend. Double buffers, isochronous end points and link power management are not modelled.
class UsbController final : public Peripheral, public UsbWire {
 public:
  /// `clock_ready` tells that the 48 MHz clock is available, `supplied` that the transceiver has its supply.
  UsbController(Surroundings& around, int irq, std::function<bool()> clock_ready, std::function<bool()> supplied)
      : Peripheral(around), irq_(irq), clock_ready_(std::move(clock_ready)), supplied_(std::move(supplied)) {
    reset();
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  std::uint32_t read_memory(std::uint32_t offset, unsigned size);
  void write_memory(std::uint32_t offset, std::uint32_t value, unsigned size);

  [[nodiscard]] bool attached() const override { return pull_up_ && (control_ & 3) == 0 && supplied_(); }
  void bus_reset() override;
  void bus_suspend(bool suspended) override;
  UsbReply setup(std::uint8_t address, std::span<const std::uint8_t, 8> bytes) override;
  UsbReply out(std::uint8_t address, std::uint8_t endpoint, bool data1, std::span<const std::uint8_t> bytes) override;
  UsbIn in(std::uint8_t address, std::uint8_t endpoint) override;

 private:
  static constexpr std::size_t kEndpoints = 8, kMemoryBytes = 1024;
  std::uint32_t* find(std::uint8_t address, std::uint8_t endpoint);
  [[nodiscard]] std::size_t index_of(const std::uint32_t* r) const {
    return static_cast<std::size_t>(r - endpoints_.data());
  }
  [[nodiscard]] std::uint32_t descriptor(std::size_t n, std::uint32_t field) const;
  void set_descriptor(std::size_t n, std::uint32_t field, std::uint32_t value);
  bool store(std::size_t n, std::span<const std::uint8_t> bytes);
  bool memory_access(std::uint32_t offset, unsigned size);
  void write_endpoint(std::size_t n, std::uint32_t value);
  void write_control(std::uint32_t value);
  [[nodiscard]] std::uint32_t status() const;
  void update_irq();

  int irq_;
  std::function<bool()> clock_ready_, supplied_;
  std::array<std::uint32_t, kEndpoints> endpoints_{};
  std::array<std::uint8_t, kMemoryBytes> memory_{};
  std::uint32_t control_ = 3, events_ = 0, address_ = 0, table_ = 0;
  bool pull_up_ = false;
  Time powered_ = kNever;
};

/// Maps the packet memory into the address space of the bus.
class UsbMemory final : public Peripheral {
 public:
  UsbMemory(Surroundings& around, UsbController& usb) : Peripheral(around), usb_(usb) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override { return usb_.read_memory(offset, size); }
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override {
    usb_.write_memory(offset, value, size);
  }
  void reset() override {}

 private:
  UsbController& usb_;
};

/// Models the clock recovery system (§8), of which only the enable bit matters here.
class Crs final : public Peripheral {
 public:
  explicit Crs(Surroundings& around) : Peripheral(around) {}
  std::uint32_t read(std::uint32_t offset, unsigned) override {
    return offset == 0 ? control_ : offset == 4 ? 0x2022BB7F : 0;
  }
  void write(std::uint32_t offset, std::uint32_t value, unsigned) override {
    if (offset == 0)
      control_ = value;
    else
      around_.violation("CRS: only its control register is modelled");
  }
  void reset() override { control_ = 0x4000; }

 private:
  std::uint32_t control_ = 0x4000;
};

}  // namespace triskin::machine
