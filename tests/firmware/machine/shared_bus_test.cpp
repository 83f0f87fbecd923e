// SPDX-License-Identifier: GPL-3.0-or-later
// Runs sixteen boards on one bus: some of them the image in the machine, from either slot, the others the same
// application on virtual ports. Each loses 1 % of the frames; one is dead, one loses its power, the image of one has no
// label.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <random>

#include "bench.hpp"
#include "device/deploy/firmware_file.hpp"
#include "machine_link.hpp"
#include "support/strip_design.hpp"
#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/hardware/virtual_skin.hpp"

namespace triskin::machine {
namespace {

constexpr std::size_t kBoards = 16;

// One board consists of flash, lines without chips, and the machine.
struct MachineBoard {
  FlashChip flash;
  std::array<SkinLine, layout::kLines> lines;
  std::unique_ptr<Machine> machine;
  std::vector<wire::CanFrame> frames;
  std::uint8_t number;
  bool alive = false;

  MachineBoard(std::uint8_t board_number, const std::filesystem::path& factory_file) : number(board_number) {
    flash.program_file(factory_file);
    flash.options = (flash.options & ~(1U << 26 | 7U << 8)) | 4U << 8;
    power_up();
  }
  void power_up() {
    flash.cut_at = ~std::uint64_t{0};
    MachineSetup setup;
    for (std::size_t k = 0; k < layout::kLines; ++k) setup.lines[k] = &lines[k];
    setup.flash = &flash;
    setup.unique_id = {0xA0, number, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    setup.on_can = [this](const wire::CanFrame& f, std::uint64_t) { frames.push_back(f); };
    machine = std::make_unique<Machine>(setup);
    alive = true;
  }
  void run_until(std::uint64_t us) {
    if (!alive) return;
    try {
      machine->run_until(us);
    } catch (const sim::PowerLost&) {
      alive = false;
    }
  }
};

/// Runs the machines and a simulated skin in step: frames of the host reach all, and frames of each reach the host.
/// Each has the bus for itself, so answers that would wait for each other arrive in parallel.
class SharedBus final : public link::Link {
 public:
  SharedBus(hardware::VirtualSkin& skin, std::deque<MachineBoard>& machines) : skin_(skin), machines_(machines) {
    skin_.on_frame([this](const wire::CanFrame& f, std::uint64_t) { inbox_.push_back(f); });
  }
  unsigned lost_percent = 0;
  std::mt19937 dice{1};

  void send(const wire::CanFrame& frame) override {
    while (full()) step(now_us() + kSlice_us);
    skin_.send(frame);
    for (MachineBoard& m : machines_) {
      if (m.alive && dice() % 100 >= lost_percent) m.machine->receive(frame);
    }
  }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    while (inbox_.empty() && now_us() < until_us) step(std::min(until_us, now_us() + kSlice_us));
    if (inbox_.empty()) return std::nullopt;
    const wire::CanFrame frame = inbox_.front();
    inbox_.pop_front();
    return frame;
  }
  [[nodiscard]] std::uint64_t now_us() const override { return skin_.now_us(); }
  [[nodiscard]] bool fd() const override { return false; }
  [[nodiscard]] std::uint64_t answer_us() const override { return 100'000; }
  [[nodiscard]] std::string name() const override { return "shared bus"; }

 private:
  static constexpr std::uint64_t kSlice_us = 200;
  static constexpr std::size_t kQueue = 10;
  [[nodiscard]] bool full() const {
    return skin_.host_frames_waiting() >= kQueue || std::ranges::any_of(machines_, [](const MachineBoard& m) {
             return m.alive && m.machine->frames_waiting() >= kQueue;
           });
  }
  void step(std::uint64_t until_us) {
    skin_.run_until(until_us);
    for (MachineBoard& m : machines_) {
      m.run_until(until_us);
      for (const wire::CanFrame& f : m.frames) {
        if (dice() % 100 >= lost_percent) inbox_.push_back(f);
      }
      m.frames.clear();
    }
  }
  hardware::VirtualSkin& skin_;
  std::deque<MachineBoard>& machines_;
  std::deque<wire::CanFrame> inbox_;
};

TEST(UpdateOfSixteenBoards, with_losses_one_dead_one_cut_one_old_reaches_all_others) {
  if (!std::filesystem::exists(firmware("triskin_app_a.elf")))
    GTEST_SKIP() << "no firmware image: install gcc-arm-none-eabi and build again";
  const char* wanted = std::getenv("TRISKIN_MACHINES");
  const std::size_t count = wanted != nullptr ? static_cast<std::size_t>(std::atoi(wanted)) : 4;
  ASSERT_GE(count, 2U);
  ASSERT_LE(count, kBoards - 2);
  const std::array images{read_elf(firmware("triskin_app_a.elf")), read_elf(firmware("triskin_app_b.elf"))};
  const std::array factory_files{firmware("triskin_factory.hex"), firmware("triskin_factory_b.hex")};
  const auto package = package_of(images[0], images[1]);

  hardware::Scene scene;
  scene.design = test::strip(static_cast<int>(kBoards - count), 1);
  scene.effects.bus_bit_rate = 1'000'000;
  hardware::VirtualSkin skin(std::move(scene));
  skin.use_fd(false);
  const std::size_t virtuals = skin.controllers(), dead = 0, old = 1;
  for (std::size_t p = 0; p < virtuals; ++p)
    test::install(skin, p, static_cast<int>(p % 2),
                  test::make_firmware(
                      {.size_bytes = 2048, .fill = 1, .labelled = p != old, .version = package.head.firmware_version}));
  std::deque<MachineBoard> machines;
  for (std::size_t k = 0; k < count; ++k) machines.emplace_back(static_cast<std::uint8_t>(k), factory_files[k % 2]);
  SharedBus bus_link(skin, machines);
  session::Bus bus(bus_link);
  bus.listen(100'000);
  const auto claims = bus.discover();
  ASSERT_EQ(claims.size(), kBoards);

  constexpr unsigned kSeed = 22;
  std::mt19937 random(kSeed);
  MachineBoard& cut = machines.back();
  cut.flash.cut_power_after(random() % (package.image(0).size() / 8));
  bus_link.lost_percent = 1;
  skin.on_delivery([dice = std::mt19937(kSeed)](std::size_t p, const wire::CanFrame&) mutable {
    return p != dead && dice() % 100 != 0;
  });
  const auto result = deploy::broadcast_firmware(std::array{deploy::UpdateBus{&bus, claims}}, package, {.force = true});
  const auto number = [&](deploy::UpdateOutcome o) {
    return std::ranges::count(result.boards, o, &deploy::BoardUpdate::outcome);
  };
  EXPECT_EQ(number(deploy::UpdateOutcome::kUpdated), static_cast<long>(kBoards) - 3) << "seed " << kSeed;
  EXPECT_EQ(number(deploy::UpdateOutcome::kGivenUp), 2);
  EXPECT_EQ(number(deploy::UpdateOutcome::kByLoader), 1);
  EXPECT_FALSE(cut.alive);
  EXPECT_LE(result.link_s, 2 * 4.0 * static_cast<double>(package.image(0).size()) / 100'000);
  for (std::size_t k = 0; k + 1 < count; ++k) {
    EXPECT_EQ(machines[k].machine->vector_table(), k % 2 == 0 ? 0x08040000U : 0x08004000U) << k;
    EXPECT_TRUE(machines[k].machine->violations().empty()) << k;
  }
  cut.power_up();  // The board starts from the state that the cut left.
  cut.run_until(100'000);
  EXPECT_EQ(cut.machine->vector_table(), (count - 1) % 2 == 0 ? 0x08004000U : 0x08040000U);
  std::printf(
      "%zu machines and %zu virtual boards: %zu bytes for each slot in %.2f s of bus time, %d rounds, %zu of %zu "
      "data frames sent again\n",
      count, virtuals, package.image(0).size(), result.link_s, result.rounds, result.again, result.frames);
}

}  // namespace
}  // namespace triskin::machine
