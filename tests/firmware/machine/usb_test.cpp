// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the image as a USB device: enumeration, requests and stream over HID and bulk, firmware update over DFU.
#include <algorithm>
#include <fstream>
#include <iterator>

#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/usb_packet.hpp"
#include "usb_host.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kSlotB = 0x08040000;
constexpr std::uint8_t kDevice = 1, kConfiguration = 2, kString = 3, kBos = 15, kReport = 0x22;

class Usb : public Sampling {
 protected:
  void plug_in() {
    power_up();
    host.emplace(*machine);
    ASSERT_TRUE(host->connect(9));
  }
  void configure() { ASSERT_TRUE(host->control({0x00, 9, 1, 0, 0})); }
  std::vector<std::uint8_t> descriptor(std::uint8_t kind, std::uint8_t index, std::uint16_t length,
                                       std::uint8_t type = 0x80) {
    return host->control({type, 6, static_cast<std::uint16_t>(kind << 8 | index), 0, length})
        .value_or(std::vector<std::uint8_t>{});
  }
  std::string text(std::uint8_t index) {
    const auto d = descriptor(kString, index, 255);
    std::string out;
    for (std::size_t k = 2; k + 1 < d.size(); k += 2) out += static_cast<char>(d[k]);
    return out;
  }
  void send_frame(bool hid, const wire::CanFrame& frame) {
    const wire::UsbPacket p = wire::to_usb(frame).value();
    ASSERT_TRUE(host->out(hid ? wire::kHidOut : wire::kBulkOut, hid ? Bytes(p.bytes) : p.used()));
  }
  // Sends one request over ISO-TP and returns its answer, empty after 200 ms. Frames of the stream go into `frames`.
  std::vector<std::uint8_t> ask(bool hid, const std::vector<std::uint8_t>& bytes) {
    wire::IsoTp tester(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1),
                       wire::kUsbFrameBytes);
    EXPECT_EQ(tester.send(bytes, now_us()), Status::kOk);
    for (const std::uint64_t until = now_us() + 200'000; now_us() < until;) {
      (void)tester.tick(now_us());
      while (const auto f = tester.transmit(now_us())) send_frame(hid, *f);
      const auto frame = wire::from_usb(host->in(hid ? wire::kHidIn : wire::kBulkIn, 500));
      if (!frame) continue;
      if (tester.receive(*frame, now_us()) != wire::IsoTp::Event::kReceived) {
        frames.push_back(*frame);
        continue;
      }
      const Bytes m = tester.message();
      return {m.begin(), m.end()};
    }
    return {};
  }
  void finish() {
    EXPECT_EQ(host->toggle_errors, 0);
    expect_no_violation();
  }
  std::optional<UsbHost> host;
};

TEST_F(Usb, EnumeratesAsHidBulkAndDfu) {
  plug_in();
  const auto first = descriptor(kDevice, 0, 8);
  ASSERT_EQ(first.size(), 8U);
  const auto device = descriptor(kDevice, 0, 18);
  ASSERT_EQ(device.size(), 18U);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), device.begin()));
  EXPECT_EQ(device[8] | device[9] << 8, wire::kUsbVendor);
  EXPECT_EQ(device[10] | device[11] << 8, wire::kUsbProduct);
  EXPECT_EQ(text(device[15]), "Triskin patch controller");
  EXPECT_EQ(text(device[16]), "101112131415161718191A1B");  // This is the unique id of the bench.
  const auto configuration = descriptor(kConfiguration, 0, 255);
  ASSERT_GT(configuration.size(), 64U) << "longer than one packet";
  EXPECT_EQ(configuration.size(), configuration[2] | configuration[3] << 8);
  EXPECT_EQ(configuration[4], 3) << "interfaces";
  EXPECT_EQ(configuration[7], 0xC0) << "self-powered: the board takes nothing from the bus";
  EXPECT_EQ(descriptor(kReport, 0, 255, 0x81).size(), 34U);
  const auto bos = descriptor(kBos, 0, 255);
  EXPECT_EQ(bos.size(), 33U);
  const std::uint16_t set_bytes = static_cast<std::uint16_t>(bos.at(29) | bos.at(30) << 8);
  EXPECT_EQ(host->control({0xC0, bos.at(31), 0, 7, set_bytes}).value().size(), set_bytes);
  EXPECT_FALSE(host->control({0x80, 6, 0x0600, 0, 10})) << "no qualifier at full speed";
  configure();
  EXPECT_EQ(host->control({0x80, 8, 0, 0, 1}).value(), std::vector<std::uint8_t>{1});
  finish();
}

TEST_F(Usb, ReadsAnIdentifierOverHidAndOverBulk) {
  store_table(patch(16));
  plug_in();
  EXPECT_FALSE(host->out(wire::kBulkOut, std::array<std::uint8_t, 1>{}) && !ask(false, {0x22, 0xFD, 0x00}).empty())
      << "not configured yet";
  configure();
  const auto hid = ask(true, {0x22, 0xFD, 0x00}), bulk = ask(false, {0x22, 0xFD, 0x00});
  EXPECT_EQ(hid, request({0x22, 0xFD, 0x00})) << "over CAN";
  EXPECT_EQ(hid, bulk);
  ASSERT_GT(bulk.size(), 20U);
  const auto live = ask(false, {0x22, 0xFD, 0x10});
  EXPECT_EQ(live.size(), 3U + 12 + 16 * 26) << "in many packets";
  EXPECT_EQ(ask(true, {0x22, 0xFD, 0x10}).size(), live.size());
  finish();
}

// The host missed an acknowledgement and repeats its packet, which must not count twice.
TEST_F(Usb, RepeatedPacketCountsOnce) {
  plug_in();
  configure();
  wire::IsoTp tester(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1),
                     wire::kUsbFrameBytes);
  ASSERT_EQ(tester.send(std::array<std::uint8_t, 3>{0x22, 0xFD, 0x01}, now_us()), Status::kOk);
  const wire::UsbPacket packet = wire::to_usb(tester.transmit(now_us()).value()).value();
  ASSERT_TRUE(host->out(wire::kBulkOut, packet.used()));
  ASSERT_TRUE(host->repeat_out(wire::kBulkOut, packet.used()));
  EXPECT_FALSE(host->in(wire::kBulkIn, 20'000).empty());
  EXPECT_TRUE(host->in(wire::kBulkIn, 50'000).empty());
  finish();
}

TEST_F(Usb, SurvivesBusResetSuspendAndNonsense) {
  plug_in();
  configure();
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(host->out(wire::kBulkOut, std::vector<std::uint8_t>(64, static_cast<std::uint8_t>(0x55 + round))));
    ASSERT_TRUE(host->out(wire::kHidOut, std::vector<std::uint8_t>(64, 0xFF)));
    EXPECT_FALSE(host->control({0x41, 0x77, 1, 2, 6}, std::array<std::uint8_t, 6>{}));
    EXPECT_FALSE(host->control({0x21, 1, 0, 2, 2000}, std::vector<std::uint8_t>(2000, 1)))
        << "longer than any data stage";
    host->wire().bus_suspend(true);
    run_for(20'000);
    host->wire().bus_suspend(false);
    run_for(1'000);
    EXPECT_FALSE(ask(round % 2 == 0, {0x22, 0xFD, 0x00}).empty());
    ASSERT_TRUE(host->connect(static_cast<std::uint8_t>(20 + round)));
    configure();
  }
  EXPECT_FALSE(ask(false, {0x22, 0xFD, 0x00}).empty());
  finish();
}

// Sixteen modules at their short sequence fill the stream; a reader must find no gap.
TEST_F(Usb, FullStreamOverBulkLosesNothing) {
  store_table(patch(16));
  plug_in();
  configure();
  ASSERT_EQ(ask(false, {0x10, 0x03}).at(0), 0x50);
  const auto seed = ask(false, {0x27, 0x01});
  ASSERT_EQ(seed.size(), 6U);
  const std::uint32_t key = wire::security_key(ByteReader(Bytes(seed).subspan(2)).be32());
  ASSERT_EQ(ask(false, {0x27, 0x02, static_cast<std::uint8_t>(key >> 24), static_cast<std::uint8_t>(key >> 16),
                        static_cast<std::uint8_t>(key >> 8), static_cast<std::uint8_t>(key)})
                .at(0),
            0x67);
  ASSERT_EQ(ask(false, {0x2E, 0xFD, 0x0A, static_cast<std::uint8_t>(wire::Decimation::k64), 1, 0}).at(0), 0x6E);
  ASSERT_EQ(ask(false, {0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
  const auto listen = [&](std::uint64_t us) {
    for (const std::uint64_t until = now_us() + us; now_us() < until;) {
      if (const auto frame = wire::from_usb(host->in(wire::kBulkIn, 1'000))) frames.push_back(*frame);
    }
  };
  listen(700'000);
  frames.clear();
  listen(1'000'000);
  const auto by_module = samples();
  ASSERT_EQ(by_module.size(), 16U);
  for (const auto& [m, list] : by_module) {
    EXPECT_GE(list.size(), 106U) << m;
    for (std::size_t k = 1; k < list.size(); ++k) EXPECT_EQ(list[k].sample, list[k - 1].sample + 1) << m;
  }
  EXPECT_LE(budget(offsetof(board::Budget, worst_interrupt_us)), 25U);
  EXPECT_LE(budget(offsetof(board::Budget, worst_loop_us)), 500U);
  finish();
}

class Dfu : public Usb {
 protected:
  void SetUp() override {
    running_slot = 0;  // The update is written to B.
    Usb::SetUp();
  }
  static constexpr std::uint8_t kIdle = 2, kDownloadIdle = 5;
  // Asks the run-time device to detach; it returns as a DFU device.
  void enter_dfu() {
    plug_in();
    configure();
    ASSERT_TRUE(host->control({0x21, 0, 1000, wire::kDfuInterface, 0}));
    run_for(50'000);
    ASSERT_TRUE(host->connect(11));
    const auto device = descriptor(kDevice, 0, 18);
    ASSERT_EQ(device.size(), 18U);
    ASSERT_EQ(device[10] | device[11] << 8, wire::kUsbDfuProduct);
    configure();
  }
  std::array<int, 2> status() {  // The numbers are error and state.
    const auto s = host->control({0xA1, 3, 0, 0, 6});
    return s && s->size() == 6 ? std::array<int, 2>{s->at(0), s->at(4)} : std::array<int, 2>{-1, -1};
  }
  bool download(Bytes file) {
    for (std::size_t at = 0, block = 0; at < file.size(); at += 1024, ++block) {
      const Bytes part = file.subspan(at, std::min<std::size_t>(1024, file.size() - at));
      const std::uint64_t begin_us = now_us();
      if (!host->control({0x21, 1, static_cast<std::uint16_t>(block), 0, static_cast<std::uint16_t>(part.size())},
                         part))
        return false;
      blocks_us.push_back(now_us() - begin_us);
      if (status() != std::array<int, 2>{0, kDownloadIdle}) return false;
    }
    return host->control({0x21, 1, 0, 0, 0}).has_value();
  }
  static std::vector<std::uint8_t> package() {
    std::ifstream in(firmware("triskin_firmware.tsf"), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void leave_dfu() {
    ASSERT_TRUE(host->control({0x21, 0, 1000, 0, 0}));
    run_for(100'000);
  }
  // Checks that the host waited for no block much longer than the device lets it wait between two of them. Only the
  // block that the image begins in may erase two pages, its first one and that of the slot's records.
  void expect_short_answers() {
    const auto s = host->control({0xA1, 3, 0, 0, 6});
    ASSERT_TRUE(s && s->size() == 6);
    const std::uint64_t poll_us = 1000ULL * s->at(1);
    EXPECT_GE(poll_us, 1'000U) << "bwPollTimeout";
    ASSERT_GT(blocks_us.size(), 100U);
    std::ranges::sort(blocks_us, std::greater{});
    EXPECT_LE(blocks_us[0], poll_us + kPageErase_us) << "us for the block that took longest";
    EXPECT_LE(blocks_us[1], poll_us) << "us for the block that took second longest";
    // Every second block of the image begins a page, so that their erases cannot have been hidden elsewhere.
    const std::size_t image_pages = application.flat().size() / FlashChip::kPage;
    EXPECT_GE(
        static_cast<std::size_t>(std::ranges::count_if(blocks_us, [](std::uint64_t us) { return us > kPageErase_us; })),
        image_pages);
  }
  static constexpr std::uint64_t kPageErase_us = 22'000;
  std::vector<std::uint64_t> blocks_us;  // Each download transfer took this long, from its set-up to its handshake.
};

TEST_F(Dfu, NewApplicationIsDownloadedAndStarted) {
  enter_dfu();
  ASSERT_TRUE(download(package()));
  EXPECT_EQ(status(), (std::array<int, 2>{0, kIdle}));
  expect_short_answers();
  leave_dfu();
  EXPECT_EQ(machine->vector_table(), kSlotB);
  ASSERT_TRUE(host->connect(12));
  configure();
  const auto state = ask(true, {0x22, 0xFD, 0x09});
  ASSERT_GE(state.size(), 5U);
  EXPECT_EQ(state[3], 1) << "slot";
  EXPECT_EQ(machine->counts().resets, 1);
  finish();
}

TEST_F(Dfu, DamagedPackageIsRefusedAndTheOldApplicationGoesOn) {
  enter_dfu();
  auto file = package();
  file[file.size() - 100] ^= 4;
  ASSERT_TRUE(download(file));
  EXPECT_NE(status()[0], 0);
  ASSERT_TRUE(host->control({0x21, 4, 0, 0, 0}));  // This request clears the status.
  EXPECT_FALSE(download(std::vector<std::uint8_t>(3000, 0x5A)));
  leave_dfu();
  EXPECT_EQ(machine->vector_table(), 0x08004000U);
  ASSERT_TRUE(host->connect(12));
  finish();
}

TEST_F(Dfu, ControllerWithoutApplicationWaitsAsDfuDevice) {
  std::fill(flash.bytes.begin() + 0x4000, flash.bytes.end(), std::uint8_t{0xFF});
  std::fill(flash.used.begin() + 0x4000 / 8, flash.used.end(), false);
  power_up();
  host.emplace(*machine);
  ASSERT_TRUE(host->connect(3));
  EXPECT_EQ(descriptor(kDevice, 0, 18).at(10), wire::kUsbDfuProduct);
  configure();
  ASSERT_TRUE(download(package()));
  EXPECT_EQ(status(), (std::array<int, 2>{0, kIdle}));
  expect_short_answers();
  leave_dfu();
  EXPECT_NE(machine->vector_table(), 0x08000000U);
  finish();
}

}  // namespace
}  // namespace triskin::machine
