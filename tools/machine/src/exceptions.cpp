// SPDX-License-Identifier: GPL-3.0-or-later
// Implements exception entry and return (ARMv7-M ARM, B1.5.6 … B1.5.8).
#include <algorithm>

#include "core.hpp"

namespace triskin::machine {
namespace {

constexpr std::array<int, 6> kStacked{UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                                      UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR};
constexpr std::uint32_t kBasicFrame = 0x20, kExtendedFrame = 0x68;
constexpr Time kEntryCycles = 12, kReturnCycles = 12;

}  // namespace

bool Machine::Core::in_memory(std::uint32_t address, std::uint32_t bytes) const {
  const auto inside = [&](std::uint32_t base, std::uint32_t size) {
    return address >= base && address + bytes <= base + size;
  };
  return inside(map::kRam, map::kRamBytes) || inside(map::kCodeRam, map::kCodeRamBytes);
}

int Machine::Core::mask_priority() const {
  int p = nvic_.running_priority();
  if ((reg(UC_ARM_REG_PRIMASK) & 1) != 0) p = std::min(p, 0);
  const std::uint32_t base = reg(UC_ARM_REG_BASEPRI) & 0xF0;
  return base == 0 ? p : std::min(p, static_cast<int>(base));
}

// A pending interrupt ends a sleep even if PRIMASK keeps it from being taken.
void Machine::Core::take_exception() {
  const int e = nvic_.next();
  waits_behind_mask_ = false;
  if (e == 0) return;
  if (sleeping_ && nvic_.priority(e) < nvic_.running_priority()) {
    sleeping_ = false;
    if (setup_.trace != nullptr) setup_.trace->sleeping(false, time_.now());
  }
  if (sleeping_) return;
  if (nvic_.priority(e) < mask_priority())
    enter_exception(e);
  else
    waits_behind_mask_ = nvic_.priority(e) < nvic_.running_priority();
}

// Returns false if the stack has left its memory. Then nothing of the frame is written, and a hard fault is entered
// instead (ARMv7-M B1.5.11).
bool Machine::Core::push_frame(bool extended) {
  const std::uint32_t sp = reg(UC_ARM_REG_SP);
  const bool pad = (sp & 4) != 0;
  const std::uint32_t frame = sp - (pad ? 4 : 0) - (extended ? kExtendedFrame : kBasicFrame);
  if (!in_memory(frame, extended ? kExtendedFrame : kBasicFrame)) {
    constexpr std::uint32_t kStacking = 1U << 12;
    nvic_.note_fault(kStacking, 0);
    reg(UC_ARM_REG_SP, frame);
    return false;
  }
  std::uint32_t at = frame;
  for (const int id : kStacked) {
    store(at, reg(id));
    at += 4;
  }
  store(frame + 24, reg(UC_ARM_REG_PC) & ~1U);
  const std::uint32_t flags =
      (reg(UC_ARM_REG_XPSR) & 0xF80F0000) | 1U << 24 | static_cast<std::uint32_t>(nvic_.running());
  store(frame + 28, flags | (pad ? 1U << 9 : 0));
  if (extended) {
    for (int k = 0; k < 16; ++k) store(frame + 0x20 + 4 * static_cast<std::uint32_t>(k), reg(UC_ARM_REG_S0 + k));
    store(frame + 0x60, reg(UC_ARM_REG_FPSCR));
  }
  reg(UC_ARM_REG_SP, frame);
  return true;
}

// Unicorn banks the stack pointers when IPSR is written, so the frame is pushed on the current stack first.
void Machine::Core::enter_exception(int exception) {
  const bool thread = nvic_.running() == 0, process_stack = thread && (reg(UC_ARM_REG_CONTROL) & 2) != 0,
             extended = fp_active_;
  if (!push_frame(extended) && exception != Nvic::kHardFault) {
    violation("the stack of an exception frame has left its memory");
    exception = Nvic::kHardFault;
  }
  fp_active_ = false;
  exception_entry_.push_back(time_.now());
  nvic_.enter(exception);
  ++counts_.exceptions;
  if (setup_.trace != nullptr) setup_.trace->exception(exception, time_.now());
  reg(UC_ARM_REG_IPSR, static_cast<std::uint32_t>(exception));
  reg(UC_ARM_REG_LR, 0xFFFFFFE1U | (extended ? 0U : 0x10U) | (thread ? 8U : 0U) | (process_stack ? 4U : 0U));
  reg(UC_ARM_REG_PC, load(nvic_.vtor() + 4 * static_cast<std::uint32_t>(exception)) | 1);
  time_.advance(kEntryCycles * kSecond / rcc_->sysclk_hz());
}

void Machine::Core::leave_exception(std::uint32_t code) {
  const bool extended = (code & 0x10) == 0, process_stack = (code & 4) != 0;
  const int left = nvic_.running();
  nvic_.leave();
  if (left == Nvic::kNmi && flash_.nmi_pending()) nvic_.pend(Nvic::kNmi);
  counts_.worst_interrupt = std::max(counts_.worst_interrupt, time_.now() - exception_entry_.back());
  exception_entry_.pop_back();
  const std::uint32_t frame = process_stack ? reg(UC_ARM_REG_PSP) : reg(UC_ARM_REG_SP);
  std::array<std::uint32_t, 6> saved{};
  for (std::uint32_t k = 0; k < 6; ++k) saved[k] = load(frame + 4 * k);
  const std::uint32_t pc = load(frame + 24), flags = load(frame + 28);
  reg(UC_ARM_REG_IPSR, flags & 0x1FF);  // IPSR comes first, because it selects the stack.
  for (std::size_t k = 0; k < saved.size(); ++k) reg(kStacked[k], saved[k]);
  if (extended) {
    for (int k = 0; k < 16; ++k) reg(UC_ARM_REG_S0 + k, load(frame + 0x20 + 4 * static_cast<std::uint32_t>(k)));
    reg(UC_ARM_REG_FPSCR, load(frame + 0x60));
  }
  fp_active_ = extended;
  reg(UC_ARM_REG_SP, frame + (extended ? kExtendedFrame : kBasicFrame) + ((flags >> 9 & 1) != 0 ? 4 : 0));
  reg(UC_ARM_REG_APSR_NZCVQ, flags & 0xF8000000);  // Writing the whole XPSR would clear IPSR.
  reg(UC_ARM_REG_PC, pc | 1);
  if (setup_.trace != nullptr) setup_.trace->exception(nvic_.running(), time_.now());
  time_.advance(kReturnCycles * kSecond / rcc_->sysclk_hz());
}

}  // namespace triskin::machine
