// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/nvic.hpp"

#include <algorithm>

namespace triskin::machine {

void Nvic::reset() {
  pending_ = enabled_ = is_active_ = {};
  priority_ = {};
  active_.clear();
  vtor_ = image_ = map::kFlashCells;  // BOOT0 selects the alias at 0.
  cfsr_ = hfsr_ = bfar_ = 0;
  cpacr_ = tick_control_ = tick_reload_ = 0;
  ++tick_generation_;
  poked = true;
}

void Nvic::set_level(int irq, bool level) {
  level_[at(16 + irq)] = level;
  if (!level) return;
  pending_[at(16 + irq)] = true;
  poked = true;
}

int Nvic::priority(int exception) const {
  if (exception == kNmi) return -2;
  if (exception == kHardFault) return -1;
  return priority_[at(exception)] & 0xF0;  // Four bits are implemented.
}

int Nvic::next() const {
  int best = 0;
  for (int e = kNmi; e < kExceptions; ++e) {
    if (!pending_[at(e)] || is_active_[at(e)] || (e >= 16 && !enabled_[at(e)])) continue;
    if (best == 0 || priority(e) < priority(best)) best = e;
  }
  return best;
}

int Nvic::running_priority() const {
  int lowest = kIdlePriority;
  for (const int e : active_) lowest = std::min(lowest, priority(e));
  return lowest;
}

void Nvic::enter(int exception) {
  pending_[at(exception)] = false;
  is_active_[at(exception)] = true;
  active_.push_back(exception);
}

void Nvic::leave() {
  const int e = active_.back();
  active_.pop_back();
  is_active_[at(e)] = false;
  if (e >= 16 && level_[at(e)]) pending_[at(e)] = true;  // The source still asserts its line.
  poked = true;
}

Time Nvic::tick_period() const {
  return (Time{tick_reload_} + 1) * kSecond / around_.sysclk_hz();
}

void Nvic::book_tick() {
  const std::uint64_t generation = ++tick_generation_;
  if ((tick_control_ & 1) == 0) return;
  tick_base_ = around_.time().now();
  around_.time().after(tick_period(), [this, generation] {
    if (generation != tick_generation_) return;
    tick_control_ |= 0x10000;
    if ((tick_control_ & 2) != 0) pend(kSysTick);
    poked = true;
    book_tick();
  });
}

std::uint32_t Nvic::read(std::uint32_t offset, unsigned) {
  switch (offset) {
    case 0x010: {
      const std::uint32_t v = tick_control_;
      tick_control_ &= ~0x10000U;
      return v;
    }
    case 0x014:
      return tick_reload_;
    case 0x018: {
      if ((tick_control_ & 1) == 0) return 0;
      const Time gone = around_.time().now() - tick_base_;
      return tick_reload_ -
             static_cast<std::uint32_t>(std::min<Time>(tick_reload_, gone * (tick_reload_ + 1) / tick_period()));
    }
    case 0xD00:
      return 0x410FC241;  // CPUID reads Cortex-M4 r0p1.
    case 0xD04:
      return static_cast<std::uint32_t>(running());
    case 0xD08:
      return vtor_;
    case 0xD28:
      return cfsr_;
    case 0xD2C:
      return hfsr_;
    case 0xD34:
    case 0xD38:
      return bfar_;
    case 0xD88:
      return cpacr_;
    default:
      break;
  }
  if (offset >= 0x100 && offset < 0x110) {
    std::uint32_t v = 0;
    for (std::uint32_t k = 0; k < 32; ++k) {
      const std::size_t e = 16 + (offset - 0x100) * 8 + k;
      if (e < kExceptions && enabled_[e]) v |= 1U << k;
    }
    return v;
  }
  return 0;
}

void Nvic::write_bits(std::uint32_t offset, std::uint32_t value) {
  auto& target = offset < 0x200 ? enabled_ : pending_;
  const bool set = (offset & 0x80) == 0;
  for (std::uint32_t k = 0; k < 32; ++k) {
    const std::size_t e = 16 + (offset & 0x7F) * 8 + k;
    if ((value >> k & 1) != 0 && e < kExceptions) target[e] = set;
  }
  if (!set && offset >= 0x200) {  // A level that is still high becomes pending again.
    for (std::size_t e = 16; e < kExceptions; ++e) pending_[e] = pending_[e] || level_[e];
  }
}

void Nvic::write_control(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case 0x010:
      tick_control_ = (tick_control_ & 0x10000U) | (value & 7);
      book_tick();
      break;
    case 0x014:
      tick_reload_ = value & 0xFFFFFF;
      break;
    case 0x018:
      book_tick();
      break;
    case 0xD04:
      if ((value & 1U << 28) != 0) pend(kPendSv);
      if ((value & 1U << 27) != 0) pending_[kPendSv] = false;
      if ((value & 1U << 26) != 0) pend(kSysTick);
      if ((value & 1U << 25) != 0) pending_[kSysTick] = false;
      break;
    case 0xD08:
      if ((value & 0x1FF) != 0) around_.violation("VTOR is not aligned to 512 bytes");
      vtor_ = value;
      if (value >= map::kFlashCells && value < map::kCodeRam) image_ = value;
      break;
    case 0xD0C:
      if (value >> 16 != 0x05FA)
        around_.violation("AIRCR written without its key");
      else if ((value & 4) != 0)
        around_.request_reset(1U << 28);
      break;
    case 0xD88:
      cpacr_ = value;
      break;
    default:
      break;
  }
}

void Nvic::write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  poked = true;
  if (offset >= 0x100 && offset < 0x300) {
    write_bits(offset, value);
  } else if (offset >= 0x400 && offset < 0x400 + map::kInterrupts) {
    for (std::uint32_t k = 0; k < size; ++k)
      priority_[16 + offset - 0x400 + k] = static_cast<std::uint8_t>(value >> (8 * k));
  } else if (offset >= 0xD18 && offset < 0xD24) {
    for (std::uint32_t k = 0; k < size; ++k)
      priority_[4 + offset - 0xD18 + k] = static_cast<std::uint8_t>(value >> (8 * k));
  } else {
    write_control(offset, value);
  }
}

}  // namespace triskin::machine
