// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unicorn/unicorn.h>

#include <random>
#include <set>

#include "spi_controller.hpp"
#include "triskin/machine/bxcan.hpp"
#include "triskin/machine/dma.hpp"
#include "triskin/machine/fdcan.hpp"
#include "triskin/machine/flash_controller.hpp"
#include "triskin/machine/gpio.hpp"
#include "triskin/machine/i2c_controller.hpp"
#include "triskin/machine/machine.hpp"
#include "triskin/machine/nvic.hpp"
#include "triskin/machine/system_blocks.hpp"
#include "usart.hpp"
#include "usb_controller.hpp"

namespace triskin::machine {

/// Joins the Cortex-M4 in Unicorn, the bus with its peripherals, and the loop that couples execution and virtual time.
class Machine::Core final : public Surroundings {
 public:
  explicit Core(const MachineSetup& setup);
  ~Core() override;

  void run_until(Time until);
  void power_cycle(const FlashChip& cells);
  void press_reset();
  void hold(bool held);
  void write_register(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] Gpio& gpio() { return gpio_; }
  [[nodiscard]] const std::string& serial_text() const { return usart_.text(); }
  void receive(const wire::CanFrame& frame) { can_->from_bus(frame); }
  [[nodiscard]] std::size_t frames_waiting() const { return can_->waiting(); }
  bool disturb(std::size_t line, Trouble trouble, Time stretch);
  void fail_can_ram();
  [[nodiscard]] UsbWire& usb() { return usb_; }
  [[nodiscard]] std::uint32_t load(std::uint32_t address);
  void overwrite(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] std::uint32_t peek(std::uint32_t address);

  Scheduler& time() override { return time_; }
  void set_irq(int irq, bool level) override { nvic_.set_level(irq, level); }
  void violation(std::string what) override;
  [[nodiscard]] std::uint64_t sysclk_hz() const override { return rcc_->sysclk_hz(); }
  void request_reset(std::uint32_t cause) override;
  void raise_nmi() override;
  [[nodiscard]] bool core_runs() const override { return !held_ && !in_rom_loader_; }

  const MachineSetup setup_;
  std::vector<Violation> violations_;
  std::vector<Incident> incidents_;
  MachineCounts counts_;
  [[nodiscard]] bool in_rom_loader() const { return in_rom_loader_; }
  [[nodiscard]] std::uint32_t image() const { return nvic_.image(); }
  [[nodiscard]] Time i2c_busy(std::size_t k) const { return i2c_[k]->busy_time(); }

 private:
  friend struct Hooks;
  struct Block {
    std::uint32_t size = 0, instructions = 0;
    bool floating_point = false;
    bool ends_in_wait = false;  ///< True if its last instruction is WFI.
  };
  struct Window {
    Peripheral* block;
    std::uint32_t base, size;
    std::uint32_t enable_offset;  ///< The offset is in RCC; 0 means that there is no clock gate.
    unsigned enable_bit;
    const char* name;
  };
  struct CellWrite {
    std::uint32_t address, value, old;
    unsigned size;
  };

  /// The interrupts of an I²C block.
  struct I2cIrqs {
    int event = 0, error = 0;
  };
  using LineIrqs = std::array<I2cIrqs, 4>;
  void open_i2c(const LineIrqs& irqs, const std::array<Dma*, 4>& channels);
  void open_shared_windows();
  void open_lines();
  [[nodiscard]] static std::unique_ptr<ClockControl> clock_of(Surroundings& around, const MachineSetup& setup);
  void open_g474();
  void open_l452();
  [[nodiscard]] Dma::Memory dma_memory();
  void map_memory();
  void add_hooks();
  void watch_flawed_units();
  void cells_changed(std::uint32_t address, std::uint32_t size);
  void reset_core();
  [[nodiscard]] bool boots_from_rom() const;
  std::uint32_t bus_read(std::uint32_t address, unsigned size);
  void bus_write(std::uint32_t address, std::uint32_t value, unsigned size);
  Window* window_of(std::uint32_t address);
  bool gate_open(const Window& w);

  void note_jump(std::uint32_t from, std::uint32_t to);
  void execute(Time until);
  [[nodiscard]] double per_hour(Trouble trouble) const;
  void book(Trouble trouble);
  void make(Trouble trouble);
  [[nodiscard]] bool disturb_any(Trouble trouble);
  [[nodiscard]] bool spoil_frame();
  void wait_for_flash(Time until);
  void finish_it_block();
  void after_execution(uc_err error);
  void note_fault(uc_err error, std::uint32_t pc);
  void apply_flash_writes();
  void take_exception();
  void enter_exception(int exception);
  void leave_exception(std::uint32_t code);
  bool push_frame(bool extended);
  [[nodiscard]] bool in_memory(std::uint32_t address, std::uint32_t bytes) const;
  [[nodiscard]] int mask_priority() const;
  const Block& block_at(std::uint32_t address, std::uint32_t size);
  [[nodiscard]] Block decode_block(std::uint32_t address, std::uint32_t size) const;

  [[nodiscard]] std::uint32_t reg(int id) const;
  void reg(int id, std::uint32_t value);
  void store(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] std::uint8_t* memory_at(std::uint32_t address);

  uc_engine* uc_ = nullptr;
  std::vector<uc_hook> ecc_hooks_;
  Scheduler time_;
  Nvic nvic_;
  std::unique_ptr<ClockControl> rcc_;
  Pwr pwr_;
  Tim2 tim2_;
  Tim16 tim16_;
  Iwdg iwdg_;
  DebugUnit debug_;
  FlashController flash_;
  RouteChainPins chain_;
  Gpio gpio_;
  SpiController spi_;
  Usart usart_;
  Dma dma_;
  DmaMux dma_mux_;
  SelectingDma l4_dma1_, l4_dma2_;
  std::array<std::unique_ptr<I2cController>, 4> i2c_;
  UsbController usb_;
  UsbMemory usb_memory_;
  Crs crs_;
  std::unique_ptr<CanNode> can_;
  std::unique_ptr<FdcanRam> can_ram_;  ///< Null on a chip whose CAN block has no memory of its own.
  std::vector<Window> windows_;
  std::vector<std::uint8_t> ram_, code_ram_;
  std::vector<Block> blocks_, code_ram_blocks_;  ///< The index is a half-word; code elsewhere is not remembered.
  Block elsewhere_;
  std::vector<CellWrite> cell_writes_;
  std::mt19937_64 random_{setup_.disturbances.seed};
  std::vector<Time> exception_entry_;
  Time slice_end_ = 0, cycle_ = 0;
  bool held_ = false, in_rom_loader_ = false, stalled_ = false, stopped_before_block_ = false, one_block_ = false,
       block_begun_ = false, waits_behind_mask_ = false, sleeping_ = false, reset_wanted_ = false, fp_active_ = false,
       nmi_ = false;
  std::uint32_t interrupt_code_ = ~0U, last_block_pc_ = 0, fault_address_ = 0;
  // The address behind the WFI at the end of the last block of this run; 0 if there was none.
  std::uint32_t wait_end_ = 0;
};

}  // namespace triskin::machine
