// SPDX-License-Identifier: GPL-3.0-or-later
// USB of an STM32L452 is dead until PWR_CR2.USV connects its supply (RM0394, power control).
#include "bench.hpp"
#include "usb_host.hpp"

namespace triskin::machine {
namespace {

class UsbSupply : public Bench {
 protected:
  void SetUp() override {
    board = l452_usb_board();
    running_slot = 0;
    Bench::SetUp();
  }
  static constexpr std::uint32_t kPwrCr2 = 0x40007004, kUsv = 1U << 10;
};

TEST_F(UsbSupply, EnumeratesOnceTheSupplyIsValid) {
  power_up();
  UsbHost host(*machine);
  ASSERT_TRUE(host.connect(9));
  EXPECT_EQ(machine->read_register(kPwrCr2) & kUsv, kUsv);
  const auto device = host.control({0x80, 6, 0x0100, 0, 18});
  ASSERT_TRUE(device.has_value());
  EXPECT_EQ(device->size(), 18U);
  expect_no_violation();
}

TEST_F(UsbSupply, WithoutTheBitNoHostSeesTheDevice) {
  power_up();
  run_for(200'000);
  machine->write_register(kPwrCr2, machine->read_register(kPwrCr2) & ~kUsv);
  UsbHost host(*machine);
  EXPECT_FALSE(host.connect(9));
}

}  // namespace
}  // namespace triskin::machine
