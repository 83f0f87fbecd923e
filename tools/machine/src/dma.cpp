// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/dma.hpp"

#include <fmt/format.h>

namespace triskin::machine {
namespace {

constexpr std::uint32_t kEnable = 1, kFromMemory = 1U << 4, kMemoryIncrement = 1U << 7, kSizes = 15U << 8;
constexpr std::uint32_t kFirst = 0x08, kStride = 20;

}  // namespace

void Dma::reset() {
  channels_ = {};
}

std::uint32_t Dma::read(std::uint32_t offset, unsigned) {
  if (offset < kFirst || offset >= kFirst + kStride * channels_.size()) return 0;
  const Channel& c = channels_[(offset - kFirst) / kStride];
  switch ((offset - kFirst) % kStride) {
    case 0:
      return c.control;
    case 4:
      return c.count;
    case 8:
      return c.peripheral;
    case 12:
      return c.memory;
    default:
      return 0;
  }
}

// Count and addresses cannot change while a channel is on (§12.6.4 … §12.6.6).
void Dma::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  if (offset < kFirst) return;  // These are flags; no interrupt of a channel is modelled.
  if (offset >= kFirst + kStride * channels_.size())
    return around_.violation(fmt::format("DMA register {:#x} is not modelled", offset));
  Channel& c = channels_[(offset - kFirst) / kStride];
  const std::uint32_t field = (offset - kFirst) % kStride;
  const bool on = (c.control & kEnable) != 0;
  if (on && (field != 0 || (value & ~kEnable) != (c.control & ~kEnable))) {
    return around_.violation(fmt::format("DMA channel {} changed while it is on", (offset - kFirst) / kStride + 1));
  }
  switch (field) {
    case 0:
      if ((value & kSizes) != 0) around_.violation("DMA: only bytes are modelled");
      if (!on && (value & kEnable) != 0) c.at = c.memory;
      c.control = value;
      break;
    case 4:
      c.count = value & 0xFFFF;
      break;
    case 8:
      c.peripheral = value;
      break;
    case 12:
      c.memory = value;
      break;
    default:
      break;
  }
}

Dma::Channel* Dma::channel_for(std::uint32_t request, bool from_memory) {
  for (Channel& c : channels_) {
    if (c.request == request && (c.control & kEnable) != 0 && c.count != 0 &&
        ((c.control & kFromMemory) != 0) == from_memory)
      return &c;
  }
  return nullptr;
}

std::uint8_t* Dma::next_byte(Channel& c) {
  std::uint8_t* byte = memory_(c.at);
  if (byte == nullptr) around_.violation(fmt::format("DMA reaches {:#x}, where it cannot", c.at));
  --c.count;
  if ((c.control & kMemoryIncrement) != 0) ++c.at;
  return byte;
}

std::optional<std::uint8_t> Dma::fetch(std::uint32_t request) {
  Channel* c = channel_for(request, true);
  if (c == nullptr) return std::nullopt;
  const std::uint8_t* byte = next_byte(*c);
  return byte != nullptr ? *byte : std::uint8_t{0};
}

void Dma::store(std::uint32_t request, std::uint8_t byte) {
  Channel* c = channel_for(request, false);
  if (c == nullptr) return;
  if (std::uint8_t* to = next_byte(*c); to != nullptr) *to = byte;
}

void DmaMux::reset() {
  for (Dma::Channel& c : dma_.channels_) c.request = 0;
}

std::uint32_t DmaMux::read(std::uint32_t offset, unsigned) {
  return offset / 4 < dma_.channels_.size() ? dma_.channels_[offset / 4].request : 0;
}

void DmaMux::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  if (offset / 4 >= dma_.channels_.size())
    return around_.violation(fmt::format("DMAMUX register {:#x} is not modelled", offset));
  dma_.channels_[offset / 4].request = value & 0x7F;
}

namespace {

// RM0394, tables of requests of DMA1 and DMA2: controller, channel, value in CSELR, and the request.
struct Fixed {
  int controller;
  unsigned channel;
  std::uint32_t selection, request;
};
constexpr Fixed kFixed[]{{1, 7, 3, 16}, {1, 6, 3, 17}, {1, 5, 3, 18}, {1, 4, 3, 19},
                         {1, 3, 3, 20}, {1, 2, 3, 21}, {2, 1, 0, 22}, {2, 2, 0, 23}};
constexpr std::uint32_t kSelection = 0xA8, kChannelEight = 0x94, kOther = ~0U;

}  // namespace

void SelectingDma::reset() {
  Dma::reset();
  select(0);
}

void SelectingDma::select(std::uint32_t value) {
  for (unsigned channel = 1; channel <= 7; ++channel) {
    const std::uint32_t now = value >> (4 * (channel - 1)) & 15, before = selection_ >> (4 * (channel - 1)) & 15;
    Channel& c = channels_[channel - 1];
    if (now != before && (c.control & kEnable) != 0)
      around_.violation(fmt::format("DMA{}: request of channel {} changed while it is on", controller_, channel));
    c.request = kOther;
    for (const Fixed& f : kFixed) {
      if (f.controller == controller_ && f.channel == channel && f.selection == now) c.request = f.request;
    }
  }
  selection_ = value;
}

std::uint32_t SelectingDma::read(std::uint32_t offset, unsigned size) {
  return offset == kSelection ? selection_ : Dma::read(offset, size);
}

void SelectingDma::write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  if (offset == kSelection) return select(value);
  if (offset >= kChannelEight) return around_.violation(fmt::format("DMA{}: there is no channel 8", controller_));
  Dma::write(offset, value, size);
}

}  // namespace triskin::machine
