// SPDX-License-Identifier: GPL-3.0-or-later
// Updates firmware over CAN: the free slot is written, started and confirmed; an interrupted update leaves the old
// application.
#include "triskin/deploy/firmware_update.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <deque>
#include <fstream>

#include "device/deploy/firmware_file.hpp"
#include "support/device_fixture.hpp"
#include "support/faulty_link.hpp"
#include "triskin/link/forwarding_link.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/wire/loader_protocol.hpp"

namespace triskin::deploy {

using test::FaultyLink;
using test::Fixture;

namespace {

using test::make_firmware;
using test::package_bytes;

// Version 1.0 is newer than what the simulated application says it is.
FirmwarePackage make(std::uint32_t size, std::uint8_t fill) {
  return make_firmware({.size_bytes = size, .fill = fill, .version = 0x01000000});
}

wire::NodeClaim only(Fixture& fixture) {
  return fixture.bus().discover().at(0);
}

TEST(FirmwareUpdate, goes_to_one_slot_after_the_other_and_is_skipped_when_equal) {
  Fixture fixture(6);
  fixture.flash();
  const FirmwarePackage first = make(4096, 1), second = make(4096, 2);
  EXPECT_EQ(update_firmware(fixture.bus(), only(fixture), first).slot, 0);
  EXPECT_TRUE(update_firmware(fixture.bus(), only(fixture), first).equal);
  EXPECT_EQ(update_firmware(fixture.bus(), only(fixture), second).slot, 1);
  EXPECT_EQ(update_firmware(fixture.bus(), only(fixture), first).slot, 0);
  UpdateOptions dry;
  dry.dry_run = true;
  const auto planned = update_firmware(fixture.bus(), only(fixture), second, dry);
  EXPECT_FALSE(planned.equal);
  EXPECT_EQ(planned.bytes, 0U);
  EXPECT_TRUE(fixture.verify(false).findings.empty());  // The tables are unchanged.
  fixture.bus().listen(fixture.bus().now_us() + 2'100'000);
  EXPECT_TRUE(session::Controller(fixture.bus(), 1).image_state().value().confirmed);
}

TEST(FirmwareUpdate, power_cut_in_any_operation_leaves_a_controller_that_answers) {
  const FirmwarePackage old_one = make(1024, 1), new_one = make(1024, 2);
  constexpr std::uint64_t kErases = 120, kUnits = 1024 / 8 + 2;
  int old_runs = 0, new_runs = 0;
  for (std::uint64_t operation = 0; operation < kErases + kUnits; operation += operation < kErases ? 17 : 3) {
    Fixture fixture(6);
    fixture.flash();
    (void)update_firmware(fixture.bus(), only(fixture), old_one);
    fixture.bus().listen(fixture.bus().now_us() + 2'100'000);
    fixture.skin().slots(0).cut_power_after(operation, hardware::FlashMemory::Tear::kHalf);
    EXPECT_THROW((void)update_firmware(fixture.bus(), only(fixture), new_one), DeviceError) << operation;
    ASSERT_FALSE(fixture.skin().alive(0));
    fixture.skin().power_cycle(0);
    const auto state = session::Controller(fixture.bus(), 1).image_state();
    ASSERT_TRUE(state) << operation;
    const bool is_old = state->record_crc == layout::slot_crc(state->sequence, old_one.image(state->slot));
    const bool is_new = state->record_crc == layout::slot_crc(state->sequence, new_one.image(state->slot));
    ASSERT_TRUE(is_old != is_new) << operation;
    ++(is_old ? old_runs : new_runs);
    EXPECT_TRUE(fixture.verify(false).findings.empty()) << operation;
    const auto again = update_firmware(fixture.bus(), only(fixture), new_one);  // The work can be completed afterwards.
    EXPECT_TRUE(again.slot == 1 || again.equal) << operation;
  }
  EXPECT_GT(old_runs, 10);
}

TEST(FirmwareUpdate, unplugged_in_the_middle_the_controller_comes_back_by_itself) {
  const FirmwarePackage old_one = make(1024, 1), new_one = make(1024, 2);
  for (std::uint64_t frames = 0; frames < 160; frames += 9) {
    Fixture fixture(6);
    fixture.flash();
    (void)update_firmware(fixture.bus(), only(fixture), old_one);
    FaultyLink wire(fixture.bus().link(), false, {}, 1);
    wire.frames_left = frames;
    session::Bus bus(wire);
    const wire::NodeClaim claim = only(fixture);
    try {
      (void)update_firmware(bus, claim, new_one);
    } catch (const DeviceError&) {
    }
    fixture.bus().listen(fixture.bus().now_us() + 6'000'000);
    ASSERT_EQ(fixture.bus().discover().size(), 1U) << frames;
    EXPECT_EQ(session::Controller(fixture.bus(), 1).image_state().has_value(), true) << frames;
    wire.frames_left.reset();
    EXPECT_NE(update_firmware(bus, claim, new_one).slot, -1) << frames;
  }
}

// After the failure, whoever runs the command again at once must find the controller.
TEST(FirmwareUpdate, a_lost_frame_ends_the_update_and_the_controller_answers_at_once) {
  const FirmwarePackage old_one = make(1024, 1), new_one = make(1024, 2);
  int failed = 0;
  for (std::uint64_t frames = 0; frames < 160; frames += 9) {
    Fixture fixture(6);
    fixture.flash();
    (void)update_firmware(fixture.bus(), only(fixture), old_one);
    FaultyLink wire(fixture.bus().link(), false, {}, 1);
    session::Bus bus(wire);
    const wire::NodeClaim claim = only(fixture);
    wire.frames_left = frames;
    wire.after_send = [&] {
      if (wire.frames > frames) wire.frames_left.reset();
    };
    try {
      (void)update_firmware(bus, claim, new_one);
    } catch (const DeviceError&) {
      ++failed;
      EXPECT_EQ(fixture.bus().discover().size(), 1U) << frames;
      EXPECT_TRUE(session::Controller(fixture.bus(), 1).image_state()) << frames;
    }
    EXPECT_NE(update_firmware(bus, claim, new_one).slot, -1) << frames;
  }
  EXPECT_GT(failed, 10);
}

/// Before each answer of the loader come frames of others: short ones, replies to other commands, other identifiers.
class BusyLink final : public link::ForwardingLink {
 public:
  explicit BusyLink(link::Link& inner) : ForwardingLink(inner) {}
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    if (!waiting_.empty()) {
      const wire::CanFrame frame = waiting_.front();
      waiting_.pop_front();
      return frame;
    }
    const auto frame = ForwardingLink::receive(until_us);
    if (!frame || frame->id != wire::loader::kReplyId) return frame;
    ++replies;
    const auto other = [&](std::uint32_t id, std::uint8_t command, std::uint8_t size) {
      wire::CanFrame f = *frame;
      f.id = id;
      f.data[0] = command;
      f.data[1] = static_cast<std::uint8_t>(Status::kFlashFailed);
      f.size = size;
      return f;
    };
    const std::uint8_t command = frame->data[0];
    waiting_ = {other(wire::loader::kReplyId, static_cast<std::uint8_t>(command + 1), frame->size),
                other(0x18DAF105, command, frame->size), *frame};
    return other(wire::loader::kReplyId, command, 1);
  }
  int replies = 0;

 private:
  std::deque<wire::CanFrame> waiting_;
};

TEST(FirmwareUpdate, other_traffic_is_not_taken_for_the_loaders_reply) {
  Fixture fixture(6);
  fixture.flash();
  BusyLink busy(fixture.bus().link());
  session::Bus bus(busy);
  EXPECT_EQ(update_firmware(bus, bus.discover().at(0), make(4096, 1)).slot, 0);
  // Hello, select, erase, 4096 / 8 / 32 replies to data, commit.
  EXPECT_EQ(busy.replies, 3 + 16 + 1);
}

TEST(FirmwareUpdate, damaged_packages_are_refused_with_the_reason) {
  const std::string file = testing::TempDir() + "package" + std::to_string(::getpid()) + ".tsf";
  const auto write = [&](const std::vector<std::uint8_t>& bytes) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  auto bytes = package_bytes({.size_bytes = 1024, .fill = 7});
  write(bytes);
  EXPECT_EQ(read_firmware(file).head.size_bytes[1], 1024U);
  for (std::size_t at = 0; at < bytes.size(); at += at < 32 ? 1 : 97) {
    auto damaged = bytes;
    damaged[at] ^= 0x10;
    write(damaged);
    EXPECT_THROW((void)read_firmware(file), InputError) << at;
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{31}, std::size_t{32}, bytes.size() - 1}) {
    write({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_THROW((void)read_firmware(file), InputError) << size;
  }
  std::remove(file.c_str());
  EXPECT_THROW((void)read_firmware(file), InputError);
}

TEST(BusTime, a_hundred_kilobytes_of_firmware_take_less_than_four_seconds) {
  hardware::Scene scene;
  scene.design = test::strip(16);
  scene.effects.bus_bit_rate = 1'000'000;
  hardware::SimLink sim(std::move(scene));
  session::Bus bus(sim);
  const FirmwarePackage p = make(100 * 1024, 5);
  const std::uint64_t busy_us = sim.skin().bus_busy_us(), start_us = sim.now_us();
  EXPECT_EQ(update_firmware(bus, bus.discover().at(0), p).bytes, 100U * 1024);
  const double busy_s = static_cast<double>(sim.skin().bus_busy_us() - busy_us) * 1e-6,
               all_s = static_cast<double>(sim.now_us() - start_us) * 1e-6;
  EXPECT_LT(all_s, 4.0);
  std::printf("100 kB of firmware over 1 Mbit/s classic CAN: %.2f s of bus time, %.2f s in all\n", busy_s, all_s);
}

}  // namespace
}  // namespace triskin::deploy
