// SPDX-License-Identifier: Apache-2.0
// Covers the time from reset to main: vectors, FPU, memory, and the faults that the core reports.
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/registers/usb.hpp"
#include "triskin/board/survivor.hpp"
#include "triskin/layout/image_label.hpp"

extern "C" {
extern std::uint32_t triskin_data_load, triskin_data_start, triskin_data_end, triskin_bss_start, triskin_bss_end,
    triskin_stack_bottom, triskin_stack_top;
// These symbols bound the vectors and code in RAM; they are empty in the loader.
extern std::uint32_t triskin_ram_vectors_start, triskin_ram_vectors_end, triskin_code_load, triskin_code_start,
    triskin_code_end;
using Constructor = void (*)();
extern const Constructor triskin_constructors_start, triskin_constructors_end;

void reset_handler();
[[noreturn]] void start_up();
int main();
void nmi_handler();
void hard_fault_handler();
void note_fault(const std::uint32_t* frame);
void default_handler();
// A part of the board overrides the handlers that it needs.
#define TRISKIN_HANDLER(name) void name() __attribute__((weak, alias("default_handler")))
TRISKIN_HANDLER(sys_tick_handler);
TRISKIN_HANDLER(tim2_handler);
TRISKIN_HANDLER(can_handler);
TRISKIN_HANDLER(usb_handler);
TRISKIN_HANDLER(i2c1_event_handler);
TRISKIN_HANDLER(i2c1_error_handler);
TRISKIN_HANDLER(i2c2_event_handler);
TRISKIN_HANDLER(i2c2_error_handler);
TRISKIN_HANDLER(i2c3_event_handler);
TRISKIN_HANDLER(i2c3_error_handler);
TRISKIN_HANDLER(i2c4_event_handler);
TRISKIN_HANDLER(i2c4_error_handler);
}

triskin::board::Budget triskin_budget;

extern "C" {
// The linker scripts of the loader and of the application put it at the same place, right behind the stack. It consists
// of plain words, because an object with initial values would get them at each start, and nothing would survive.
[[gnu::section(".survivor")]] std::uint32_t triskin_survivor[sizeof(triskin::board::Survivor) / 4];
static_assert(sizeof(triskin::board::Survivor) % 4 == 0 && alignof(triskin::board::Survivor) <= 4);
// A stack that has overflowed cannot serve the handler of the fault.
alignas(8) std::uint32_t triskin_fault_stack[128];
// Objects live for ever, because the program never exits and there is no heap.
void* __dso_handle = nullptr;
int __cxa_atexit(void (*)(void*), void*, void*) {
  return 0;
}
[[noreturn]] void __cxa_pure_virtual() {
  triskin::board::fail(triskin::wire::CrashCause::kProgram);
}
}
void operator delete(void*) noexcept {
  triskin::board::fail(triskin::wire::CrashCause::kProgram);
}
void operator delete(void*, std::size_t) noexcept {
  triskin::board::fail(triskin::wire::CrashCause::kProgram);
}

namespace triskin::board {
namespace {

using Handler = void (*)();
// The number is from RM0440 table 97; other chips have fewer, but the label of an image stays at its place.
constexpr int kInterrupts = 102;
constexpr std::uint32_t kStackPaint = 0x5AFE5AFE;

struct Vectors {
  std::uint32_t* stack;
  std::array<Handler, 15 + kInterrupts> handlers;
};

static_assert(sizeof(Vectors) == layout::kLabelOffset);  // The label of an application follows.

consteval Vectors make_vectors() {
  Vectors v{&triskin_stack_top, {}};
  for (Handler& h : v.handlers) h = default_handler;
  const auto exception = [&v](int number, Handler h) { v.handlers[static_cast<std::size_t>(number - 1)] = h; };
  exception(1, reset_handler);
  exception(2, nmi_handler);
  for (int k = 3; k <= 6; ++k) exception(k, hard_fault_handler);
  exception(15, sys_tick_handler);
  exception(16 + usb_reg::kIrq, usb_handler);
  for (int k = can_irq::kFirst; k <= can_irq::kLast; ++k) exception(16 + k, can_handler);
  exception(16 + tim2_reg::kIrq, tim2_handler);
  exception(16 + i2c_reg::kI2c1Event, i2c1_event_handler);
  exception(16 + i2c_reg::kI2c1Error, i2c1_error_handler);
  exception(16 + i2c_reg::kI2c2Event, i2c2_event_handler);
  exception(16 + i2c_reg::kI2c2Error, i2c2_error_handler);
  exception(16 + i2c_reg::kI2c3Event, i2c3_event_handler);
  exception(16 + i2c_reg::kI2c3Error, i2c3_error_handler);
  exception(16 + i2c_reg::kI2c4Event, i2c4_event_handler);
  exception(16 + i2c_reg::kI2c4Error, i2c4_error_handler);
  return v;
}

}  // namespace

extern "C" {
[[gnu::section(".vectors")]] extern const Vectors triskin_vectors;
constinit const Vectors triskin_vectors = make_vectors();
}

std::uint32_t image_origin() {
  return reinterpret_cast<std::uint32_t>(&triskin_vectors);
}

}  // namespace triskin::board

namespace {

// The loops must not become calls of memcpy, which is in the code that is being copied.
[[gnu::noinline, gnu::optimize("no-tree-loop-distribute-patterns")]] void copy(const std::uint32_t* from,
                                                                               std::uint32_t* to,
                                                                               const std::uint32_t* end) {
  while (to < end) *to++ = *from++;
}
[[gnu::noinline, gnu::optimize("no-tree-loop-distribute-patterns")]] void fill(std::uint32_t* from,
                                                                               const std::uint32_t* end,
                                                                               std::uint32_t value) {
  while (from < end) *from++ = value;
}

}  // namespace

// The first access to each RAM after a reset may be treated as a read (errata ES0430, 2.2.7), so SRAM1, SRAM2 and CCM
// RAM of the STM32G4 are read once before anything is pushed; every chip has memory at these addresses.
[[gnu::naked]] void reset_handler() {
  asm volatile(
      "ldr r0, =0x20000000\n ldr r1, [r0]\n"
      "ldr r0, =0x20014000\n ldr r1, [r0]\n"
      "ldr r0, =0x10000000\n ldr r1, [r0]\n"
      "dsb\n b start_up\n .ltorg");
}

void start_up() {
  using namespace triskin::board;
  core_reg::kCpacr.set(core_reg::kFpuFull);  // The FPU is enabled before any code may use it (ARMv7-M, B1.4.7).
  asm volatile("dsb\n isb" ::: "memory");
  core_reg::kVtor.write(reinterpret_cast<std::uint32_t>(&triskin_vectors));
  copy(&triskin_code_load, &triskin_code_start, &triskin_code_end);
  if (&triskin_ram_vectors_start != &triskin_ram_vectors_end) {
    copy(reinterpret_cast<const std::uint32_t*>(&triskin_vectors), &triskin_ram_vectors_start,
         &triskin_ram_vectors_end);
    asm volatile("dsb\n isb" ::: "memory");
    core_reg::kVtor.write(reinterpret_cast<std::uint32_t>(&triskin_ram_vectors_start));
  }
  std::uint32_t* here = nullptr;
  asm volatile("mov %0, sp" : "=r"(here));
  fill(&triskin_stack_bottom, here - 16, kStackPaint);
  copy(&triskin_data_load, &triskin_data_start, &triskin_data_end);
  fill(&triskin_bss_start, &triskin_bss_end, 0);
  for (const Constructor* c = &triskin_constructors_start; c < &triskin_constructors_end; ++c) (*c)();
  asm volatile("cpsie i" ::: "memory");
  main();
  fail(triskin::wire::CrashCause::kProgram);
}

// Two events raise the NMI. One is a flash unit with two wrong bits, left behind by a power failure: its reader checks
// a CRC, so it is only counted and reading continues (RM0440 §3.3.9). The other is a crystal that stops: the core then
// runs from the internal oscillator at a tenth of its speed, and the loader starts the clocks again.
void nmi_handler() {
  using namespace triskin::board;
  if (rcc_reg::kCifr.any(rcc_reg::kCrystalFailed)) {
    rcc_reg::kCicr.write(rcc_reg::kCrystalFailed);
    fail(triskin::wire::CrashCause::kClock);
  }
  const std::uint32_t ecc = flash_reg::kEccr.read();
  flash_reg::kEccr.write(ecc & (flash_reg::kEccDetected | flash_reg::kEccDetectedHigh));
  if ((ecc & (flash_reg::kEccDetected | flash_reg::kEccDetectedHigh)) != 0) ++triskin_budget.ecc_faults;
  asm volatile("dsb" ::: "memory");  // The flag must be cleared before the handler returns, or it would run again.
}

// Runs on its own stack and passes the stack pointer of the fault as the argument.
[[gnu::naked]] void hard_fault_handler() {
  asm volatile(
      "mov r0, sp\n"
      "ldr r1, =triskin_fault_stack + 512\n"
      "msr msp, r1\n"
      "b note_fault\n .ltorg");
}
static_assert(sizeof triskin_fault_stack == 512);

void default_handler() {
  triskin::board::fail(triskin::wire::CrashCause::kInterrupt);
}
