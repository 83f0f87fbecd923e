// SPDX-License-Identifier: Apache-2.0
// Connects the application with this board: ports, the loop, the measurements.
#include <algorithm>

#include "can.hpp"
#include "chain.hpp"
#include "flash_area.hpp"
#include "health.hpp"
#include "light.hpp"
#include "line.hpp"
#include "serial.hpp"
#include "triskin/app/application.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"
#include "triskin/boot/image_receiver.hpp"
#include "triskin/drivers/shared_clock.hpp"
#include "triskin/layout/image_label.hpp"
#include "triskin/logic/usb/usb_device.hpp"
#include "usb.hpp"

namespace triskin::board {
namespace {

// The watchdog is fed at least this often, and no step of the light's pattern (100 ms) is missed.
constexpr std::uint64_t kLongestSleep_us = 50'000;
// The light, the uptime and the milestones need divisions and a look at every module, so not each pass does them.
constexpr std::uint64_t kSlowWork_us = 10'000;
constexpr std::uint64_t kSupplyStands_us = 2'000'000;  // The supply counts as stable this long after power-up.
constexpr std::uint64_t kWorksWell_us = 60'000'000;    // Crashes within this time after a start count as consecutive.

class Stm32Clock final : public fw::Clock {
 public:
  [[nodiscard]] std::uint64_t now_us() const override { return microseconds(); }
};

class Stm32Restart final : public fw::Restart {
 public:
  void restart() override {
    survivor().running = 0;
    core_reg::reset();
  }
  void confirm() override {
    if (const int slot = running_slot(); slot >= 0) application_slots.confirm(slot);
  }
  std::optional<wire::ImageState> image_state() override {
    const int slot = running_slot();
    if (slot < 0) return std::nullopt;
    return boot::image_state_of(slot, application_slots.inspect(slot));
  }
};

Stm32Clock system_clock;
Stm32Restart stm32_restart;

// layout/image_label.hpp reads this label of the image.
struct Label {
  std::array<std::uint8_t, 4> magic = layout::kLabelMagic;
  std::uint8_t version = layout::kLabelVersion;
  std::array<std::uint8_t, 3> zeros{};
  std::array<std::uint8_t, 8> hardware = wire::kPartNumber;
  std::uint32_t firmware_version = fw::kFirmwareVersion;
  const void* origin;
};
static_assert(sizeof(Label) == layout::kLabelBytes);
extern "C" const char triskin_vectors;
[[gnu::section(".label"), gnu::used]] constinit const Label label{.origin = &triskin_vectors};

// This application's step() contains the running erase.
fw::Application* sampling = nullptr;
constexpr BusyWork kSampling{[] {
                               sampling->step_during_flash();
                               if constexpr (config::kUsb) usb.stream();
                             },
                             [] {
                               if (std::ranges::any_of(lines, [](const Stm32I2cLine& l) { return l.finished(); }))
                                 return std::uint64_t{0};
                               std::uint64_t next = sampling->next_during_flash_us();
                               for (const Stm32I2cLine& line : lines) next = std::min(next, line.deadline_us());
                               const std::uint64_t look_us = config::kUsb ? usb.stream_again_us() : UINT64_MAX;
                               return look_us == UINT64_MAX ? next : std::min(next, microseconds() + look_us);
                             }};

bool work_waits(const fw::Application& application) {
  return can.frame_waits() || (config::kUsb && usb.work_waits()) || application.frames_wait() ||
         std::ranges::any_of(lines, [](const Stm32I2cLine& l) { return l.finished(); });
}

// Sleeps until there is work; interrupts that only move data do not end the sleep. Interrupts stay disabled between the
// decision and WFI, which wakes anyway, so that none is missed.
void sleep_until(std::uint64_t at_us, const fw::Application& application) {
  bool armed = false;
  for (;;) {
    asm volatile("cpsid i" ::: "memory");
    const std::uint64_t before = microseconds();
    const bool sleep = !work_waits(application) && before < at_us;
    if (sleep) {
      if (!armed) wake_at(at_us);
      armed = true;
      asm volatile("dsb\n wfi" ::: "memory");
      triskin_budget.idle_us += microseconds() - before;
    }
    asm volatile("cpsie i\n isb" ::: "memory");
    if (!sleep) return;
  }
}

// The loader continues as a DFU device.
[[noreturn]] void enter_dfu() {
  usb.close();
  request_dfu();
  core_reg::reset();
}

// Some actions happen only once: option bytes are set when the supply is stable, and crashes after a minute of work do
// not count as a loop.
class Milestones {
 public:
  void look(std::uint64_t now_us) {
    if (!options_set_ && now_us > kSupplyStands_us) {
      options_set_ = true;
      if ((triskin_budget.findings & kMendable) != 0 && survivor().options_written == 0)
        survivor().options_written = set_options_of_a_board() ? 1 : 0;
    }
    if (!counted_ && now_us > kWorksWell_us) {
      survivor().crashes_in_row = 0;
      counted_ = true;
    }
    if (now_us > kDoubleReset_us) end_double_reset();
    survivor().uptime_ms = static_cast<std::uint32_t>(now_us / 1000);
  }

 private:
  static constexpr std::uint32_t kMendable = finding::kBootByPin | finding::kLowBrownOut;
  static constexpr std::uint64_t kDoubleReset_us = 500'000;
  bool options_set_ = false, counted_ = false;
};

// Returns each line directly, or with mutual exclusion if they share a clock wire.
std::array<fw::I2cLine*, layout::kLines> application_lines() {
  if constexpr (config::kOneScl) {
    static fw::SharedClock<Stm32I2cLine> shared{std::span(lines)};
    return {&shared.line(0), &shared.line(1), &shared.line(2), &shared.line(3)};
  } else {
    return {&lines[0], &lines[1], &lines[2], &lines[3]};
  }
}

Light light_of(fw::Application::Condition condition) {
  using enum fw::Application::Condition;
  switch (condition) {
    case kNoTable:
      return Light::kNoTable;
    case kSampling:
      return Light::kSampling;
    case kStreaming:
      return Light::kStreaming;
    case kFault:
      break;
  }
  return Light::kFault;
}

[[noreturn]] void run(fw::Application& application, fw::UsbDevice& device) {
  Milestones milestones;
  std::uint64_t slow_work_us = 0;
  for (;;) {
    const std::uint64_t start = microseconds();
    if constexpr (config::kUsb) usb.serve();
    can.step(start);
    application.step();
    if constexpr (config::kUsb) {
      usb.send();
      if (device.wants_to_reconnect() && usb.idle()) enter_dfu();
    }
    feed_watchdog();
    if (start >= slow_work_us) {
      slow_work_us = start + kSlowWork_us;
      milestones.look(start);
      show(light_of(application.condition()), start);
    }
    std::uint64_t next = std::min({application.next_event_us(), start + kLongestSleep_us, can.next_event_us()});
    for (const Stm32I2cLine& line : lines) next = std::min(next, line.deadline_us());
    ++triskin_budget.loops;
    if (triskin_budget.loops % 1024 == 0) measure_stack();
    triskin_budget.worst_loop_us =
        std::max(triskin_budget.worst_loop_us, static_cast<std::uint32_t>(microseconds() - start));
    sleep_until(next, application);
  }
}

}  // namespace
}  // namespace triskin::board

int main() {
  using namespace triskin::board;
  open_survivor();
  triskin_budget.reset_cause = survivor().reset_flags;
  start_clocks();
  start_microseconds();
  start_watchdog();
  triskin_budget.findings = inspect_board();
  open_light();
  open_lines();
  can.open(CanFilters::kApplication);
  triskin::fw::RouteChain* chain = nullptr;
  if constexpr (triskin::fw::kSwitchedModules) {
    route_chain.open();
    chain = &route_chain;
  }
  serial.open();
  static triskin::fw::UsbDevice device(unique_id());
  if constexpr (config::kUsb) usb.open(device, true);
  static triskin::boot::ImageReceiver receiver(application_slots, stm32_restart,
                                               {unique_id(), running_slot(), triskin::fw::kFirmwareVersion});
  static triskin::fw::Application application({application_lines(), &system_clock, &can, &table_flash, unique_id(),
                                               config::kUsb ? &device : nullptr, chain, &stm32_restart,
                                               running_slot() >= 0 ? &receiver : nullptr, &monitor, &serial});
  sampling = &application;
  do_while_erasing(&kSampling);
  run(application, device);
}
