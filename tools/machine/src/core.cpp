// SPDX-License-Identifier: GPL-3.0-or-later
#include "core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "triskin/base/error.hpp"
#include "triskin/machine/map.hpp"
#include "triskin/machine/map_l452.hpp"
#include "triskin/sim/flash_model.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kRamBase = map::kRam, kRamBytes = map::kRamBytes, kSystemMemory = 0x1FFF7000,
                        kNoMansLand = 0xD0000000, kNoMansLandBytes = 8U << 20;
constexpr std::uint32_t kPeripherals = 0x40000000, kPeripheralBytes = 0x80000, kGpioBase = map::kGpioA,
                        kGpioBytes = 0x2000, kScs = 0xE000E000, kScsBytes = 0x1000;

constexpr std::uint32_t kBankBytes = FlashChip::kBytes / 2;

void check(uc_err error, const char* what) {
  if (error != UC_ERR_OK) throw DeviceError(fmt::format("modelled machine: {}: {}", what, uc_strerror(error)));
}

}  // namespace

/// Callbacks of Unicorn only note what happened, because the core's state may change only between two runs.
struct Hooks {
  static Machine::Core& core(void* user) { return *static_cast<Machine::Core*>(user); }

  static void block(uc_engine* uc, std::uint64_t address, std::uint32_t size, void* user) {
    Machine::Core& c = core(user);
    // An interrupt that waits behind PRIMASK is taken as soon as PRIMASK is cleared.
    const bool unmasked = c.waits_behind_mask_ && (c.reg(UC_ARM_REG_PRIMASK) & 1) == 0;
    const bool stalls = c.flash_.busy_at(static_cast<std::uint32_t>(address));
    const bool stop = c.one_block_
                          ? std::exchange(c.block_begun_, true)
                          : (unmasked || stalls || c.nvic_.poked || c.reset_wanted_ || c.nmi_ ||
                             !c.cell_writes_.empty() || c.time_.take_changed() || c.time_.now() >= c.slice_end_);
    if (stop) {
      c.stalled_ = c.stalled_ || stalls;
      c.stopped_before_block_ = true;
      uc_emu_stop(uc);
      return;
    }
    const auto& b = c.block_at(static_cast<std::uint32_t>(address), size);
    if (b.floating_point) {
      if (!c.nvic_.fpu_on()) c.violation(fmt::format("floating point at {:#x} before CPACR allows it", address));
      c.fp_active_ = true;
    }
    c.counts_.instructions += b.instructions;
    if (c.setup_.profile != nullptr) c.setup_.profile->add(static_cast<std::uint32_t>(address), b.instructions);
    c.time_.advance(b.instructions * c.cycle_);
    if (((address ^ c.last_block_pc_) & kBankBytes) != 0)
      c.note_jump(c.last_block_pc_, static_cast<std::uint32_t>(address));
    c.last_block_pc_ = static_cast<std::uint32_t>(address);
    c.wait_end_ = b.ends_in_wait ? c.last_block_pc_ + size : 0;
  }
  static void interrupt(uc_engine* uc, std::uint32_t number, void* user) {
    core(user).interrupt_code_ = number;
    uc_emu_stop(uc);
  }
  static bool flash_write(uc_engine*, uc_mem_type, std::uint64_t address, int size, std::int64_t value, void* user) {
    Machine::Core& c = core(user);
    std::uint32_t old = 0;
    std::memcpy(&old, c.setup_.flash->bytes.data() + (address - FlashChip::kBase), static_cast<std::size_t>(size));
    c.cell_writes_.push_back(
        {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(value), old, static_cast<unsigned>(size)});
    return true;
  }
  static void watched_read(uc_engine*, uc_mem_type, std::uint64_t, int, std::int64_t, void*) {}
  // The value arrives when the operation is over. Events that fall due meanwhile are late.
  static void flash_read(uc_engine*, uc_mem_type, std::uint64_t address, int, std::int64_t, void* user) {
    Machine::Core& c = core(user);
    if (!c.flash_.busy_at(static_cast<std::uint32_t>(address))) return;
    const Time begin = c.time_.now();
    c.time_.advance_to(c.flash_.busy_until());
    c.counts_.flash_stall += c.time_.now() - begin;
    ++c.counts_.flash_read_stalls;
  }
  static bool unmapped(uc_engine*, uc_mem_type, std::uint64_t address, int, std::int64_t, void* user) {
    core(user).fault_address_ = static_cast<std::uint32_t>(address);
    return false;
  }
  static void flawed_read(uc_engine*, uc_mem_type, std::uint64_t address, int, std::int64_t, void* user) {
    core(user).flash_.flawed_read(static_cast<std::uint32_t>((address - FlashChip::kBase) / FlashChip::kUnit));
  }
  static std::uint64_t read(uc_engine*, std::uint64_t offset, unsigned size, void* user) {
    return core(user).bus_read(kPeripherals + static_cast<std::uint32_t>(offset), size);
  }
  static void write(uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* user) {
    core(user).bus_write(kPeripherals + static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(value), size);
  }
  static std::uint64_t read_gpio(uc_engine*, std::uint64_t offset, unsigned size, void* user) {
    return core(user).gpio_.read(static_cast<std::uint32_t>(offset), size);
  }
  static void write_gpio(uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* user) {
    core(user).gpio_.write(static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(value), size);
  }
  static std::uint64_t read_debug(uc_engine*, std::uint64_t offset, unsigned size, void* user) {
    return core(user).debug_.read(static_cast<std::uint32_t>(offset), size);
  }
  static void write_debug(uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* user) {
    core(user).debug_.write(static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(value), size);
  }
  static std::uint64_t read_scs(uc_engine*, std::uint64_t offset, unsigned size, void* user) {
    return core(user).nvic_.read(static_cast<std::uint32_t>(offset), size);
  }
  static void write_scs(uc_engine*, std::uint64_t offset, unsigned size, std::uint64_t value, void* user) {
    core(user).nvic_.write(static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(value), size);
  }
};

Machine::Core::Core(const MachineSetup& setup)
    : setup_(setup),
      nvic_(*this),
      rcc_(clock_of(*this, setup)),
      pwr_(*this, *rcc_),
      tim2_(*this),
      tim16_(*this, *rcc_),
      iwdg_(*this, setup.spread.watchdog_error),
      debug_(*this),
      flash_(
          *this, *setup.flash, *rcc_,
          [this](std::uint32_t address, std::uint32_t size) { cells_changed(address, size); },
          setup.chip == Chip::kStm32l452, setup.spread.flash_factor),
      chain_(setup.chain),
      gpio_(*this, *rcc_, setup.lines, chain_, setup.pins),
      spi_(
          *this, [this](std::uint8_t byte) { return chain_.exchange(byte); }, [this] { return gpio_.chain_ready(); }),
      usart_(*this, setup.chip == Chip::kStm32g474, [this] { return gpio_.log_ready(); }),
      dma_(*this, dma_memory()),
      dma_mux_(*this, dma_),
      l4_dma1_(*this, dma_memory(), 1),
      l4_dma2_(*this, dma_memory(), 2),
      usb_(
          *this, setup.chip == Chip::kStm32l452 ? map::l452::kUsbIrq : map::kUsbIrq,
          [this] { return rcc_->clock_48_ready(); },
          [this] { return setup_.chip != Chip::kStm32l452 || pwr_.usb_supply_valid(); }),
      usb_memory_(*this, usb_),
      crs_(*this),
      ram_(kRamBytes, 0xA5),
      code_ram_(map::kCodeRamBytes, 0xA5),
      blocks_(FlashChip::kBytes / 2),
      code_ram_blocks_(map::kCodeRamBytes / 2) {
  setup.chip == Chip::kStm32l452 ? open_l452() : open_g474();
  open_lines();
  check(uc_open(UC_ARCH_ARM, static_cast<uc_mode>(UC_MODE_THUMB | UC_MODE_MCLASS), &uc_), "open");
  check(uc_ctl_set_cpu_model(uc_, UC_CPU_ARM_CORTEX_M4), "Cortex-M4");
  map_memory();
  add_hooks();
  reset_core();
}

Machine::Core::~Core() {
  if (uc_ != nullptr) uc_close(uc_);
}

void Machine::Core::map_memory() {
  check(
      uc_mem_map_ptr(uc_, FlashChip::kBase, FlashChip::kBytes, UC_PROT_READ | UC_PROT_EXEC, setup_.flash->bytes.data()),
      "map flash");
  // At each store Unicorn 2.0 searches the translated code of the memory around it, some MB in the order of mapping.
  // Inaccessible memory keeps the RAM out of the flash's surroundings, which makes a store a third cheaper.
  check(uc_mem_map(uc_, kNoMansLand, kNoMansLandBytes, UC_PROT_NONE), "map no man's land");
  check(uc_mem_map_ptr(uc_, kRamBase, kRamBytes, UC_PROT_READ | UC_PROT_WRITE, ram_.data()), "map RAM");
  check(uc_mem_map(uc_, kNoMansLand + kNoMansLandBytes, kNoMansLandBytes, UC_PROT_NONE), "map more of it");
  // The alias behind SRAM2 is left out, because the images use only one of the two addresses.
  check(uc_mem_map_ptr(uc_, map::kCodeRam, map::kCodeRamBytes, UC_PROT_ALL, code_ram_.data()), "map CCM RAM");
  check(uc_mem_map(uc_, kSystemMemory, 0x1000, UC_PROT_READ), "map system memory");
  check(uc_mem_write(uc_, map::kUniqueId, setup_.unique_id.data(), setup_.unique_id.size()), "unique id");
  check(uc_mmio_map(uc_, kPeripherals, kPeripheralBytes, Hooks::read, this, Hooks::write, this), "map peripherals");
  check(uc_mmio_map(uc_, kGpioBase, kGpioBytes, Hooks::read_gpio, this, Hooks::write_gpio, this), "map GPIO");
  check(uc_mmio_map(uc_, map::kDebug, 0x1000, Hooks::read_debug, this, Hooks::write_debug, this), "map DBGMCU");
  check(uc_mmio_map(uc_, kScs, kScsBytes, Hooks::read_scs, this, Hooks::write_scs, this), "map SCS");
}

// A hook on all stores would slow down every one of them. The flash is not writable to Unicorn, so Unicorn asks.
void Machine::Core::add_hooks() {
  uc_hook h = 0;
  check(uc_hook_add(uc_, &h, UC_HOOK_BLOCK, reinterpret_cast<void*>(&Hooks::block), this, 1, 0), "block hook");
  check(uc_hook_add(uc_, &h, UC_HOOK_INTR, reinterpret_cast<void*>(&Hooks::interrupt), this, 1, 0), "interrupt hook");
  check(uc_hook_add(uc_, &h, UC_HOOK_MEM_WRITE_PROT, reinterpret_cast<void*>(&Hooks::flash_write), this,
                    FlashChip::kBase, FlashChip::kBase + FlashChip::kBytes - 1),
        "flash hook");
  if (setup_.watch_reads)
    check(uc_hook_add(uc_, &h, UC_HOOK_MEM_READ, reinterpret_cast<void*>(&Hooks::flash_read), this, FlashChip::kBase,
                      FlashChip::kBase + FlashChip::kBytes - 1),
          "flash read hook");
  // Code that was translated without any such hook would never call one.
  if (setup_.will_be_cut)
    check(uc_hook_add(uc_, &h, UC_HOOK_MEM_READ, reinterpret_cast<void*>(&Hooks::watched_read), this, kSystemMemory,
                      kSystemMemory),
          "read hook");
  check(uc_hook_add(uc_, &h, UC_HOOK_MEM_UNMAPPED, reinterpret_cast<void*>(&Hooks::unmapped), this, 1, 0),
        "unmapped hook");
  watch_flawed_units();
}

void Machine::Core::watch_flawed_units() {
  for (const uc_hook h : ecc_hooks_) check(uc_hook_del(uc_, h), "ECC hook");
  ecc_hooks_.clear();
  std::set<std::uint32_t> flawed = setup_.flash->torn;
  flawed.insert(setup_.flash->weak.begin(), setup_.flash->weak.end());
  for (const std::uint32_t unit : std::set(flawed)) flawed.insert(unit ^ 1U);  // Both are read at once with one bank.
  for (const std::uint32_t unit : flawed) {
    const std::uint64_t first = FlashChip::kBase + unit * FlashChip::kUnit;
    uc_hook h = 0;
    check(uc_hook_add(uc_, &h, UC_HOOK_MEM_READ, reinterpret_cast<void*>(&Hooks::flawed_read), this, first,
                      first + FlashChip::kUnit - 1),
          "ECC hook");
    ecc_hooks_.push_back(h);
  }
}

// Unicorn drops its translation of memory that is written through it.
void Machine::Core::cells_changed(std::uint32_t address, std::uint32_t size) {
  const auto first = setup_.flash->bytes.begin() + (address - FlashChip::kBase);
  const std::vector<std::uint8_t> cells(first, first + size);
  check(uc_mem_write(uc_, address, cells.data(), size), "flash cells");
  std::fill_n(blocks_.begin() + (address - FlashChip::kBase) / 2, size / 2, Block{});
}

void Machine::Core::power_cycle(const FlashChip& cells) {
  FlashChip& chip = *setup_.flash;
  for (std::uint32_t at = 0; at < FlashChip::kBytes; at += FlashChip::kPage) {
    if (std::equal(cells.bytes.begin() + at, cells.bytes.begin() + at + FlashChip::kPage, chip.bytes.begin() + at))
      continue;
    std::copy_n(cells.bytes.begin() + at, FlashChip::kPage, chip.bytes.begin() + at);
    cells_changed(FlashChip::kBase + at, FlashChip::kPage);
  }
  chip.used = cells.used;
  chip.torn = cells.torn;
  watch_flawed_units();
  std::ranges::fill(ram_, std::uint8_t{0xA5});
  const std::vector<std::uint8_t> lost(code_ram_.size(), 0xA5);
  check(uc_mem_write(uc_, map::kCodeRam, lost.data(), lost.size()), "CCM RAM");
  rcc_->note_reset(3U << 26);
  flash_.load_options();
  debug_.reset();
  reset_core();
}

void Machine::Core::press_reset() {
  request_reset(1U << 26);
}

void Machine::Core::hold(bool held) {
  held_ = held;
  tim2_.stand(held && debug_.timer_stands());
  iwdg_.stand(held && debug_.watchdog_stands());
}

void Machine::Core::write_register(std::uint32_t address, std::uint32_t value) {
  if (address >= map::kDebug && address < map::kDebug + 0x1000) return debug_.write(address - map::kDebug, value, 4);
  bus_write(address, value, 4);
}

// Follows RM0440 table 5. Boot from RAM (nBOOT1 = 0) is not modelled.
bool Machine::Core::boots_from_rom() const {
  const std::uint32_t options = flash_.loaded_options();
  const bool by_pin = (options >> 26 & 1) != 0;
  return by_pin ? setup_.boot_pin_high : (options >> 27 & 1) == 0;
}

// RAM keeps its content; everything else starts anew.
void Machine::Core::reset_core() {
  time_.clear();
  nvic_.reset();
  // The start-up code of another image may fill it anew.
  std::ranges::fill(code_ram_blocks_, Block{});
  for (const Window& w : windows_) w.block->reset();
  gpio_.reset();
  gpio_.set_boot_pin(setup_.boot_pin_high);
  cell_writes_.clear();
  exception_entry_.clear();
  for (const Trouble t :
       {Trouble::kBusError, Trouble::kArbitrationLoss, Trouble::kStretch, Trouble::kCanError, Trouble::kNoAcknowledge})
    book(t);
  sleeping_ = fp_active_ = nmi_ = reset_wanted_ = stalled_ = false;
  in_rom_loader_ = boots_from_rom();
  // The loader waits for a host on UART, I²C, SPI, USB or CAN, which does not exist here.
  sleeping_ = in_rom_loader_;
  reg(UC_ARM_REG_IPSR, 0);
  reg(UC_ARM_REG_CONTROL, 0);
  reg(UC_ARM_REG_PRIMASK, 0);
  reg(UC_ARM_REG_BASEPRI, 0);
  reg(UC_ARM_REG_SP, load(nvic_.vtor()));
  reg(UC_ARM_REG_PC, load(nvic_.vtor() + 4));
}

std::uint32_t Machine::Core::reg(int id) const {
  std::uint32_t value = 0;
  uc_reg_read(uc_, id, &value);
  return value;
}
void Machine::Core::reg(int id, std::uint32_t value) {
  uc_reg_write(uc_, id, &value);
}

// RAM and flash are memory of ours that Unicorn maps, so we avoid its slow access functions.
std::uint8_t* Machine::Core::memory_at(std::uint32_t address) {
  if (address >= kRamBase && address + 4 <= kRamBase + kRamBytes) return &ram_[address - kRamBase];
  if (address >= FlashChip::kBase && address + 4 <= FlashChip::kBase + FlashChip::kBytes)
    return &setup_.flash->bytes[address - FlashChip::kBase];
  if (address >= map::kCodeRam && address + 4 <= map::kCodeRam + map::kCodeRamBytes)
    return &code_ram_[address - map::kCodeRam];
  throw DeviceError(fmt::format("modelled machine: stack or vector at {:#x}, where no memory is", address));
}

std::uint32_t Machine::Core::load(std::uint32_t address) {
  std::uint32_t value = 0;
  std::memcpy(&value, memory_at(address), sizeof value);
  return value;
}
void Machine::Core::store(std::uint32_t address, std::uint32_t value) {
  std::memcpy(memory_at(address), &value, sizeof value);
}

// Unicorn keeps translated code of writable memory until it is told to drop it.
void Machine::Core::overwrite(std::uint32_t address, std::uint32_t value) {
  store(address, value);
  check(uc_ctl_remove_cache(uc_, address, address + 4), "translated code");
  std::ranges::fill(code_ram_blocks_, Block{});
}

void Machine::Core::violation(std::string what) {
  violations_.push_back({time_.now_us(), fmt::format("{} (code near {:#x})", what, last_block_pc_)});
}

void Machine::Core::request_reset(std::uint32_t cause) {
  // The chip pulls its own reset pin low.
  rcc_->note_reset(cause | 1U << 26);
  reset_wanted_ = true;
}

void Machine::Core::raise_nmi() {
  nmi_ = true;
}

Machine::Core::Window* Machine::Core::window_of(std::uint32_t address) {
  for (Window& w : windows_) {
    if (address >= w.base && address < w.base + w.size) return &w;
  }
  violation(fmt::format("access to {:#x}, where nothing is modelled", address));
  return nullptr;
}

bool Machine::Core::gate_open(const Window& w) {
  if (w.enable_offset == 0 || rcc_->enabled(w.enable_offset, w.enable_bit)) return true;
  violation(fmt::format("{} used without its clock", w.name));
  return false;
}

std::uint32_t Machine::Core::peek(std::uint32_t address) {
  if (address >= kGpioBase && address < kGpioBase + kGpioBytes) return gpio_.read(address - kGpioBase, 4);
  if (address >= kScs && address < kScs + kScsBytes) return nvic_.read(address - kScs, 4);
  const Window* w = window_of(address);
  return w != nullptr ? w->block->read(address - w->base, 4) : 0;
}

std::uint32_t Machine::Core::bus_read(std::uint32_t address, unsigned size) {
  Window* w = window_of(address);
  return w != nullptr && gate_open(*w) ? w->block->read(address - w->base, size) : 0;
}

void Machine::Core::bus_write(std::uint32_t address, std::uint32_t value, unsigned size) {
  Window* w = window_of(address);
  if (w == nullptr || !gate_open(*w)) return;
  w->block->write(address - w->base, value, size);
  if (w->block == rcc_.get()) cycle_ = kSecond / rcc_->sysclk_hz();
  if (w->block == rcc_.get() && address - w->base == map::kApb1Reset) {
    for (Window& o : windows_) {
      if (o.enable_offset == map::kApb1 && (value >> o.enable_bit & 1) != 0) o.block->reset();
    }
  }
}

// Thumb-2: a first half-word of 0b11101…, 0b11110… or 0b11111… begins a 32-bit instruction.
Machine::Core::Block Machine::Core::decode_block(std::uint32_t address, std::uint32_t size) const {
  Block b;
  std::vector<std::uint8_t> code(size);
  check(uc_mem_read(uc_, address, code.data(), size), "code");
  for (std::uint32_t k = 0; k + 1 < size; ++b.instructions) {
    const unsigned half = code[k] | static_cast<unsigned>(code[k + 1]) << 8;
    const bool wide = half >> 11 >= 0x1D;
    // The test compares a whole instruction, because the second half of a wide one may look the same.
    b.ends_in_wait = half == 0xBF30;
    if (wide && k + 3 < size) {
      const unsigned second = code[k + 2] | static_cast<unsigned>(code[k + 3]) << 8;
      // Coprocessors 10 and 11 are the floating-point unit.
      b.floating_point = b.floating_point || ((half & 0xEC00) == 0xEC00 && (second >> 9 & 7) == 5);
    }
    k += wide ? 4 : 2;
  }
  b.instructions = std::max(b.instructions, 1U);
  b.size = size;
  return b;
}

const Machine::Core::Block& Machine::Core::block_at(std::uint32_t address, std::uint32_t size) {
  const bool in_flash = address >= FlashChip::kBase && address < FlashChip::kBase + FlashChip::kBytes;
  const bool in_code_ram = address >= map::kCodeRam && address < map::kCodeRam + map::kCodeRamBytes;
  Block& b = in_flash      ? blocks_[(address - FlashChip::kBase) / 2]
             : in_code_ram ? code_ram_blocks_[(address - map::kCodeRam) / 2]
                           : elsewhere_;
  if (!(in_flash || in_code_ram) || b.size != size) b = decode_block(address, size);
  return b;
}

void Machine::Core::run_until(Time until) {
  while (time_.now() < until) {
    time_.run_due();
    if (flash_.power_lost()) throw sim::PowerLost("power lost in a flash operation");
    if (reset_wanted_) {
      ++counts_.resets;
      reset_core();
    }
    if (held_ || rcc_->stopped()) {
      time_.advance_to(std::min(time_.next(), until));
      continue;
    }
    if (std::exchange(stalled_, false)) {
      wait_for_flash(until);
      continue;
    }
    if (std::exchange(nmi_, false)) nvic_.pend(Nvic::kNmi);
    nvic_.poked = false;
    finish_it_block();
    take_exception();
    const Time next = std::min(time_.next(), until);
    if (sleeping_) {
      if (next > time_.now()) counts_.idle_us += (next - time_.now()) / kMicrosecond;
      time_.advance_to(next);
      continue;
    }
    execute(next);
  }
}

// What was fetched ahead from one bank may be taken for the other's code (errata ES0548 2.2.10, of a sister chip).
void Machine::Core::note_jump(std::uint32_t from, std::uint32_t to) {
  const auto in_flash = [](std::uint32_t a) {
    return a >= FlashChip::kBase && a < FlashChip::kBase + FlashChip::kBytes;
  };
  if (setup_.chip == Chip::kStm32g474 && in_flash(from) && in_flash(to) && flash_.prefetches())
    violation(fmt::format("jump to {:#x}, in the other bank, with the prefetch on", to));
}

double Machine::Core::per_hour(Trouble trouble) const {
  const Disturbances& d = setup_.disturbances;
  switch (trouble) {
    case Trouble::kBusError:
      return d.bus_errors;
    case Trouble::kArbitrationLoss:
      return d.arbitration_losses;
    case Trouble::kStretch:
      return d.clock_stretches;
    case Trouble::kNoAcknowledge:
      return d.no_acknowledges;
    case Trouble::kCanError:
      break;
  }
  return d.can_errors;
}

// Books the next one; the times between two are exponentially distributed.
void Machine::Core::book(Trouble trouble) {
  if (per_hour(trouble) <= 0) return;
  const double mean_s = 3600 / per_hour(trouble);
  const double wait_s = std::exponential_distribution<double>(1 / mean_s)(random_);
  time_.after(static_cast<Time>(wait_s * static_cast<double>(kSecond)), [this, trouble] { make(trouble); });
}

// If nothing is under way it waits for the next transfer or frame.
void Machine::Core::make(Trouble trouble) {
  if (disturb_any(trouble)) return book(trouble);
  time_.after(17 * kMicrosecond, [this, trouble] { make(trouble); });
}

// Disturbs whichever line is busy.
bool Machine::Core::disturb_any(Trouble trouble) {
  if (trouble == Trouble::kCanError) return spoil_frame();
  const std::size_t first = random_() % i2c_.size();
  const Time stretch = (60 + random_() % 340) * kMicrosecond;
  for (std::size_t k = 0; k < i2c_.size(); ++k) {
    if (disturb((first + k) % i2c_.size(), trouble, stretch)) return true;
  }
  return false;
}

bool Machine::Core::disturb(std::size_t line, Trouble trouble, Time stretch) {
  if (trouble == Trouble::kCanError) return spoil_frame();
  I2cController& i2c = *i2c_.at(line);
  const auto count = [](bool done, std::uint64_t& of) { return done && ++of > 0; };
  const auto happens = [&] {
    switch (trouble) {
      case Trouble::kBusError:
        return count(i2c.spurious_bus_error(), counts_.spurious_bus_errors);
      case Trouble::kArbitrationLoss:
        return count(i2c.lose_arbitration(), counts_.arbitration_losses);
      case Trouble::kStretch:
        return count(i2c.stretch(stretch), counts_.clock_stretches);
      case Trouble::kNoAcknowledge:
        return count(i2c.spoil_acknowledge(), counts_.no_acknowledges);
      case Trouble::kCanError:
        break;
    }
    return false;
  };
  if (!happens()) return false;
  incidents_.push_back({time_.now_us(), trouble, line});
  return true;
}

void Machine::Core::fail_can_ram() {
  can_->fail_ram();
}

bool Machine::Core::spoil_frame() {
  const bool spoilt = can_->spoil_frame();
  counts_.bus_offs = can_->bus_offs();
  if (!spoilt) return false;
  ++counts_.can_errors;
  incidents_.push_back({time_.now_us(), Trouble::kCanError, 0});
  return true;
}

// The core waits for an instruction from the bank that is being written (RM0440 §3.3.5): nothing else happens, and no
// exception is taken. The peripherals continue.
void Machine::Core::wait_for_flash(Time until) {
  const Time begin = time_.now();
  while (flash_.busy() && time_.now() < until) {
    time_.advance_to(std::min(time_.next(), until));
    time_.run_due();
  }
  counts_.flash_stall += time_.now() - begin;
  stalled_ = flash_.busy();
}

// A translated block ends at each kilobyte, also inside an IT block. Unicorn cannot save and restore ITSTATE, so an
// exception there is taken only after the next block: a delay of some instructions.
void Machine::Core::finish_it_block() {
  constexpr std::uint32_t kItState = 0x0600FC00;
  while (!sleeping_ && (reg(UC_ARM_REG_XPSR) & kItState) != 0) {
    one_block_ = true;
    block_begun_ = false;
    execute(kNever);
    one_block_ = false;
  }
}

void Machine::Core::execute(Time until) {
  slice_end_ = until;
  cycle_ = kSecond / rcc_->sysclk_hz();
  stopped_before_block_ = false;
  interrupt_code_ = ~0U;
  wait_end_ = 0;
  (void)time_.take_changed();
  const uc_err error = uc_emu_start(uc_, reg(UC_ARM_REG_PC) | 1, 0xFFFFFFFE, 0, 0);
  after_execution(error);
}

// Finds out why execution ended: an exception return, a WFI, a fault, or a stop that we asked for.
void Machine::Core::after_execution(uc_err error) {
  apply_flash_writes();
  const std::uint32_t pc = reg(UC_ARM_REG_PC);
  if ((pc & 0xFFFFFFE0) == 0xFFFFFFE0 && nvic_.running() != 0) {
    leave_exception(pc | 1);
    return;
  }
  if (error != UC_ERR_OK || interrupt_code_ != ~0U) {
    violation(error != UC_ERR_OK ? fmt::format("fault at {:#x}: {}", pc, uc_strerror(error))
                                 : fmt::format("exception {} at {:#x}", interrupt_code_, pc));
    if (nvic_.running_priority() <= -1) throw DeviceError(fmt::format("modelled machine: lock-up at {:#x}", pc));
    note_fault(error, pc);
    nvic_.pend(Nvic::kHardFault);
    return;
  }
  const bool waits = wait_end_ != 0 && (pc & ~1U) == wait_end_;
  if (!stopped_before_block_ || waits) {
    sleeping_ = waits;
    if (sleeping_ && setup_.trace != nullptr) setup_.trace->sleeping(true, time_.now());
  }
}

// Sets precise fault status (ARMv7-M B3.2.15); each fault escalates to a hard fault.
void Machine::Core::note_fault(uc_err error, std::uint32_t pc) {
  constexpr std::uint32_t kPrecise = 1U << 9 | 1U << 15, kFetch = 1U << 8, kUndefined = 1U << 16;
  const bool access = error == UC_ERR_READ_UNMAPPED || error == UC_ERR_WRITE_UNMAPPED || error == UC_ERR_READ_PROT ||
                      error == UC_ERR_WRITE_PROT;
  const bool fetch = error == UC_ERR_FETCH_UNMAPPED || error == UC_ERR_FETCH_PROT;
  (void)pc;
  nvic_.note_fault(access ? kPrecise : fetch ? kFetch : kUndefined, access ? fault_address_ : 0);
}

// Undoes the effect of the stores on the memory, then lets the controller decide.
void Machine::Core::apply_flash_writes() {
  if (cell_writes_.empty()) return;
  const std::vector<CellWrite> writes = std::exchange(cell_writes_, {});
  for (auto w = writes.rbegin(); w != writes.rend(); ++w)
    check(uc_mem_write(uc_, w->address, &w->old, w->size), "flash restore");
  for (const CellWrite& w : writes) flash_.cell_write(w.address, w.value, w.size);
}

}  // namespace triskin::machine
