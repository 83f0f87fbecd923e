// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the USB device: descriptors that a host can walk, requests through HID and bulk, DFU, and malformed input of
// every kind.
#include <gtest/gtest.h>

#include <random>

#include "bench.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/wire/usb_packet.hpp"

namespace triskin::test {
namespace {

using wire::UsbSetup;

class Usb : public testing::Test {
 protected:
  void SetUp() override {
    controller_ = make();
    ASSERT_TRUE(usb().control({0x00, 9, 1, 0, 0}, {}));
  }
  std::unique_ptr<sim::VirtualController> make() {
    auto c = sim::make_virtual_controller({{&lines_[0], &lines_[1], &lines_[2], &lines_[3]},
                                           &flash_,
                                           {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12},
                                           [](const wire::CanFrame&) {},
                                           true,
                                           nullptr,
                                           &slots_});
    c->run_until(now_us_);
    return c;
  }
  wire::UsbFunction& usb() { return controller_->usb(); }
  void run(std::uint64_t us) { controller_->run_until(now_us_ += us); }
  Message get(std::uint8_t type, std::uint8_t request, int value, int index) {
    const auto answer =
        usb().control({type, request, static_cast<std::uint16_t>(value), static_cast<std::uint16_t>(index), 1024}, {});
    return answer ? Message(answer->begin(), answer->end()) : Message{};
  }
  // Sends one request through an interface and returns its answer.
  Message ask(std::uint8_t out, std::uint8_t in, const Message& request) {
    wire::IsoTp link(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1),
                     wire::kUsbFrameBytes);
    EXPECT_EQ(link.send(request, now_us_), Status::kOk);
    for (int k = 0; k < 200; ++k) {
      while (const auto f = link.transmit(now_us_)) {
        const auto packet = wire::to_usb(*f).value();
        usb().out(out, packet.used());
      }
      run(500);
      for (Bytes p = usb().in(in); !p.empty(); p = usb().in(in)) {
        if (const auto f = wire::from_usb(p); f && link.receive(*f, now_us_) == wire::IsoTp::Event::kReceived)
          return {link.message().begin(), link.message().end()};
      }
    }
    return {};
  }
  Message status() { return get(0xA1, 3, 0, 0); }

  std::array<LineDouble, layout::kLines> lines_;
  FlashDouble<sim::FlashModel> flash_;
  class Slots final : public sim::FlashModel {
   public:
    [[nodiscard]] std::size_t size_bytes() const override { return bytes_.size(); }
    [[nodiscard]] std::size_t page_bytes() const override { return 2048; }
    [[nodiscard]] std::size_t program_bytes() const override { return 8; }
    bool erase_page(std::size_t at) override {
      std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), 2048, std::uint8_t{0xFF});
      return true;
    }
    bool program(std::size_t at, std::span<const std::uint8_t> b) override {
      std::copy(b.begin(), b.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
      return true;
    }
    [[nodiscard]] std::span<const std::uint8_t> bytes() const override { return bytes_; }

   private:
    std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(sim::kSlotsBytes, 0xFF);
  } slots_;
  std::unique_ptr<sim::VirtualController> controller_;
  std::uint64_t now_us_ = 0;
};

TEST_F(Usb, DescriptorsAreWalkable) {
  const Message device = get(0x80, 6, 0x0100, 0), config = get(0x80, 6, 0x0200, 0), bos = get(0x80, 6, 0x0F00, 0);
  ASSERT_EQ(device.size(), 18U);
  EXPECT_GE(device[2] | device[3] << 8, 0x0210);
  ASSERT_EQ(config.size(), static_cast<std::size_t>(config[2] | config[3] << 8));
  int interfaces = 0, endpoints = 0;
  for (std::size_t at = 0; at < config.size(); at += config[at]) {
    ASSERT_GE(config[at], 2U);
    ASSERT_LE(at + config[at], config.size());
    interfaces += config[at + 1] == 4 ? 1 : 0;
    endpoints += config[at + 1] == 5 ? 1 : 0;
  }
  EXPECT_EQ(interfaces, config[4]);
  EXPECT_EQ(endpoints, 4);
  // The platform capability names the length and the code of the Microsoft set, whose actual length must agree.
  ASSERT_EQ(bos.size(), 33U);
  const Message set = get(0xC0, bos[31], 0, 7);
  ASSERT_EQ(set.size(), static_cast<std::size_t>(bos[29] | bos[30] << 8));
  EXPECT_EQ(set[8] | set[9] << 8, static_cast<int>(set.size()));
  std::size_t at = 10 + 8;  // The set header and the configuration subset come first.
  EXPECT_EQ(set[10 + 6] | set[10 + 7] << 8, static_cast<int>(set.size() - 10));
  for (int function = 0; function < 2; ++function) at += static_cast<std::size_t>(set[at + 6] | set[at + 7] << 8);
  EXPECT_EQ(at, set.size());
  EXPECT_EQ(get(0x80, 6, 0x0300 | device[16], 0x0409).size(), 2U + 2 * 24);
  EXPECT_EQ(get(0x81, 6, 0x2200, 0).size(), static_cast<std::size_t>(config[18 + 7]));
  EXPECT_TRUE(get(0x80, 6, 0x0600, 0).empty());
}

TEST_F(Usb, RequestsThroughHidAndBulk) {
  const Message answer{0x62, 0xF1, 0x90, 'T', 'R', 'I', 'S', 'K', 'I', 'N', '1'};
  EXPECT_EQ(ask(wire::kHidOut, wire::kHidIn, {0x22, 0xF1, 0x90}), answer);
  EXPECT_EQ(ask(wire::kBulkOut, wire::kBulkIn, {0x22, 0xF1, 0x90}), answer);
  EXPECT_EQ(ask(wire::kBulkOut, wire::kBulkIn, {0x22, 0xFD, 0x00, 0xFD, 0x04, 0xFD, 0x06, 0xF1, 0x8C}).size(),
            1 + 4 * 2 + 23 + 16 + 20 + 12U);
  EXPECT_TRUE(usb().in(wire::kHidIn).empty());
}

TEST_F(Usb, WorkedBytesOfTheProtocolPage) {
  wire::CanFrame f;
  f.id = 0x18DA01F1;
  f.extended = true;
  f.size = 8;
  f.data = {3, 0x22, 0xF1, 0x90, 0xCC, 0xCC, 0xCC, 0xCC};
  const auto packet = wire::to_usb(f).value();
  EXPECT_EQ(Message(packet.used().begin(), packet.used().end()),
            (Message{0x09, 0xF1, 0x01, 0xDA, 0x98, 3, 0x22, 0xF1, 0x90, 0xCC, 0xCC, 0xCC, 0xCC}));
  EXPECT_EQ(wire::from_usb(packet.used()), f);
}

TEST_F(Usb, DfuRefusesWhatIsNoPackageAndComesBack) {
  ASSERT_TRUE(usb().control({0x21, 0, 1000, wire::kDfuInterface, 0}, {}));
  const int before = controller_->usb_session();
  run(1000);
  ASSERT_NE(controller_->usb_session(), before);
  EXPECT_EQ(get(0x80, 6, 0x0100, 0)[10], 2);  // The product is that of DFU mode.
  EXPECT_EQ(status()[4], 2);
  EXPECT_FALSE(usb().control({0x21, 1, 0, 0, 64}, Message(64, 0x55)));
  EXPECT_EQ(status()[0], 2);  // The status is errFILE.
  EXPECT_EQ(status()[4], 10);
  ASSERT_TRUE(usb().control({0x21, 4, 0, 0, 0}, {}));
  EXPECT_EQ(status()[4], 2);
  run(1000);
  run(15'100'000);
  EXPECT_EQ(get(0x80, 6, 0x0100, 0)[10], 1);
}

// Every request type with random fields and random packets on every end point are sent in both modes: the device stays
// alive and answers.
TEST_F(Usb, NonsenseNeverStopsIt) {
  std::mt19937 random(21);
  constexpr std::array<std::uint8_t, 8> kTypes{0x00, 0x01, 0x21, 0x80, 0x81, 0xA1, 0xC0, 0x02};
  for (int round = 0; round < 40; ++round) {
    for (int k = 0; k < 500; ++k) {
      Message data(random() % 80);
      for (auto& b : data) b = static_cast<std::uint8_t>(random());
      const UsbSetup setup{kTypes[random() % kTypes.size()], static_cast<std::uint8_t>(random() % 14),
                           static_cast<std::uint16_t>(random() % 4 == 0 ? random() : random() % 3 << 8),
                           static_cast<std::uint16_t>(random() % 4),
                           static_cast<std::uint16_t>(random() % 2 == 0 ? data.size() : random() % 2048)};
      (void)usb().control(setup, data);
      usb().out(static_cast<std::uint8_t>(random() % 4), data);
      (void)usb().in(static_cast<std::uint8_t>(0x80 | random() % 4));
      (void)wire::from_usb(data);
      (void)layout::decode_package_head(data);
    }
    run(10'000);
  }
  run(15'100'000);  // The device leaves DFU mode if it was in it.
  ASSERT_TRUE(usb().control({0x00, 9, 1, 0, 0}, {}));
  EXPECT_EQ(ask(wire::kHidOut, wire::kHidIn, {0x3E, 0x00}), (Message{0x7E, 0x00}));
}

}  // namespace
}  // namespace triskin::test
