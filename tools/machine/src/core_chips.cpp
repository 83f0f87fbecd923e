// SPDX-License-Identifier: GPL-3.0-or-later
// Each chip has other blocks at other places; the rest of the core is the same.
#include <algorithm>

#include "core.hpp"
#include "triskin/machine/map.hpp"
#include "triskin/machine/map_l452.hpp"

namespace triskin::machine {

std::unique_ptr<ClockControl> Machine::Core::clock_of(Surroundings& around, const MachineSetup& setup) {
  const bool fails = setup.crystal_fails_at_us != ~std::uint64_t{0};
  const CrystalSetup crystal{setup.crystal_hz, fails ? setup.crystal_fails_at_us * kMicrosecond : kNever,
                             setup.spread.internal_error};
  if (setup.chip == Chip::kStm32l452) return std::make_unique<RccL4>(around, crystal);
  return std::make_unique<Rcc>(around, crystal);
}

Dma::Memory Machine::Core::dma_memory() {
  return [this](std::uint32_t address) {
    return address >= map::kRam && address < map::kRam + map::kRamBytes ? &ram_[address - map::kRam] : nullptr;
  };
}

void Machine::Core::open_i2c(const LineIrqs& irqs, const std::array<Dma*, 4>& channels) {
  for (std::size_t k = 0; k < i2c_.size(); ++k) {
    i2c_[k] =
        std::make_unique<I2cController>(*this, static_cast<int>(k), *setup_.lines[k], irqs[k].event, irqs[k].error,
                                        *channels[k], setup_.trace, [this, k] { return gpio_.line_ready(k); });
  }
}

// These blocks are at the same places in both chips.
void Machine::Core::open_shared_windows() {
  windows_ = {{&tim2_, map::kTim2, 0x400, map::kApb1, map::kTim2Bit, "TIM2"},
              {&iwdg_, map::kIwdg, 0x400, 0, 0, "IWDG"},
              {&spi_, map::kSpi2, 0x400, map::kApb1, map::kSpi2Bit, "SPI2"},
              {&usart_, map::kUsart2, 0x400, map::kApb1, map::kUsart2Bit, "USART2"},
              {i2c_[0].get(), map::kI2c1, 0x400, map::kApb1, map::kI2c1Bit, "I2C1"},
              {i2c_[1].get(), map::kI2c2, 0x400, map::kApb1, map::kI2c2Bit, "I2C2"},
              {i2c_[3].get(), map::kI2c4, 0x400, map::kApb1Second, map::kI2c4Bit, "I2C4"},
              {&pwr_, map::kPwr, 0x400, map::kApb1, map::kPwrBit, "PWR"},
              {rcc_.get(), map::kRcc, 0x400, 0, 0, "RCC"},
              {&flash_, map::kFlash, 0x400, map::kAhb1, map::kFlashBit, "FLASH"}};
}

void Machine::Core::open_g474() {
  open_i2c({{{map::kI2c1Event, map::kI2c1Error},
             {map::kI2c2Event, map::kI2c2Error},
             {map::kI2c3Event, map::kI2c3Error},
             {map::kI2c4Event, map::kI2c4Error}}},
           {&dma_, &dma_, &dma_, &dma_});
  auto can = std::make_unique<Fdcan>(*this, setup_.on_can, setup_.trace, [this] { return gpio_.can_ready(); });
  can_ram_ = std::make_unique<FdcanRam>(*this, *can);
  can_ = std::move(can);
  open_shared_windows();
  const std::initializer_list<Window> own{
      {&crs_, map::kCrs, 0x400, map::kApb1, map::kCrsBit, "CRS"},
      {&usb_, map::kUsb, 0x400, map::kApb1, map::kUsbBit, "USB"},
      {&usb_memory_, map::kUsbMemory, 0x400, map::kApb1, map::kUsbBit, "USB packet memory"},
      {can_.get(), map::kFdcan, 0x400, map::kApb1, map::kFdcanBit, "FDCAN"},
      {can_ram_.get(), map::kFdcanRam, 0x400, map::kApb1, map::kFdcanBit, "FDCAN RAM"},
      {i2c_[2].get(), map::kI2c3, 0x400, map::kApb1, map::kI2c3Bit, "I2C3"},
      {&tim16_, map::kTim16, 0x400, map::kApb2, map::kTim16Bit, "TIM16"},
      {&dma_, map::kDma1, 0x400, map::kAhb1, map::kDma1Bit, "DMA1"},
      {&dma_mux_, map::kDmaMux, 0x400, map::kAhb1, map::kDmaMuxBit, "DMAMUX"}};
  windows_.insert(windows_.end(), own);
}

void Machine::Core::open_l452() {
  using namespace map::l452;
  open_i2c({{{map::kI2c1Event, map::kI2c1Error},
             {map::kI2c2Event, map::kI2c2Error},
             {kI2c3Event, kI2c3Error},
             {kI2c4Event, kI2c4Error}}},
           {&l4_dma1_, &l4_dma1_, &l4_dma1_, &l4_dma2_});
  can_ = std::make_unique<Bxcan>(*this, setup_.on_can, setup_.trace, [this] { return gpio_.can_ready(); });
  open_shared_windows();
  const std::initializer_list<Window> own{{i2c_[2].get(), kI2c3, 0x400, map::kApb1, kI2c3Bit, "I2C3"},
                                          {&crs_, kCrs, 0x400, map::kApb1, kCrsBit, "CRS"},
                                          {&usb_, kUsb, 0x400, map::kApb1, kUsbBit, "USB"},
                                          {&usb_memory_, kUsbMemory, 0x400, map::kApb1, kUsbBit, "USB packet memory"},
                                          {can_.get(), kCan, 0x400, map::kApb1, kCanBit, "CAN1"},
                                          {&l4_dma1_, map::kDma1, 0x400, map::kAhb1, map::kDma1Bit, "DMA1"},
                                          {&l4_dma2_, kDma2, 0x400, map::kAhb1, kDma2Bit, "DMA2"}};
  windows_.insert(windows_.end(), own);
}

void Machine::Core::open_lines() {
  for (const auto& line : i2c_) line->set_rise(setup_.scl_rise_ns);
  for (std::size_t k = 0; setup_.pins.one_scl && k < 4; ++k) {
    i2c_[k]->share_scl([this, k] {
      return std::ranges::any_of(i2c_, [&](const auto& other) { return other != i2c_[k] && other->on_bus(); });
    });
  }
}

}  // namespace triskin::machine
