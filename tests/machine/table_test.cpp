// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "bench.hpp"
#include "triskin/sim/flash_model.hpp"

namespace triskin::machine {
namespace {

class Table : public Bench {
 protected:
  std::vector<std::uint8_t> encoded(const layout::PatchImage& image) const {
    std::vector<std::uint8_t> out(layout::kMaxImageBytes);
    out.resize(layout::encode(image, out).value());
    return out;
  }
  // Downloads and activates; true: the controller said that it is active.
  bool flash_table(const layout::PatchImage& image) {
    const std::vector<std::uint8_t> bytes = encoded(image);
    if (request({0x10, 0x03}).empty()) return false;
    const auto seed = request({0x27, 0x01});
    if (seed.size() != 6) return false;
    std::uint32_t s = 0;
    for (std::size_t k = 2; k < 6; ++k) s = s << 8 | seed[k];
    const std::uint32_t key = wire::security_key(s);
    (void)request({0x27, 0x02, static_cast<std::uint8_t>(key >> 24), static_cast<std::uint8_t>(key >> 16),
                   static_cast<std::uint8_t>(key >> 8), static_cast<std::uint8_t>(key)});
    const auto size = static_cast<std::uint8_t>(bytes.size());
    if (request({0x34, 0x00, 0x44, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, size}).at(0) != 0x74) return false;
    std::uint8_t block = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 64) {
      std::vector<std::uint8_t> transfer{0x36, ++block};
      for (std::size_t k = at; k < std::min(at + 64, bytes.size()); ++k) transfer.push_back(bytes[k]);
      if (request(transfer).at(0) != 0x76) return false;
    }
    if (request({0x37}).at(0) != 0x77) return false;
    const auto activated = request({0x31, 0x01, 0x02, 0x05});
    return activated.size() >= 5 && activated[0] == 0x71 && activated[4] == 0;
  }
  // Modules of the active table; 0: none.
  int modules() {
    const auto reply = request({0x22, 0xFD, 0x02});
    return reply.size() >= 21 ? reply[3 + 1 + 4 + 8 + 4] : 0;
  }
};

TEST_F(Table, ActivatedTableIsActiveAfterAPowerCycle) {
  power_up();
  run_for(100'000);
  ASSERT_TRUE(flash_table(patch(5)));
  EXPECT_EQ(modules(), 5);
  power_up();
  run_for(100'000);
  EXPECT_EQ(modules(), 5);
  expect_no_violation();
}

TEST_F(Table, PowerCutInEachFlashOperationLeavesTheOldOrTheNewTable) {
  store_table(patch(4));
  const FlashChip before = flash;
  power_up();
  run_for(500'000);  // all four are found: no fault is written in between
  flash.operations = 0;
  const std::uint64_t first = flash.operations;
  ASSERT_TRUE(flash_table(patch(8)));
  const std::uint64_t operations = flash.operations - first;
  EXPECT_EQ(operations, 1U + (32 + 8 * 12) / 8 + 2);  // erase, image, commit record
  for (std::uint64_t cut = 0; cut < operations; ++cut) {
    flash = before;
    flash.operations = 0;
    power_up();
    run_for(500'000);
    flash.cut_power_after(cut);
    EXPECT_THROW((void)flash_table(patch(8)), sim::PowerLost) << cut;
    flash.cut_at = ~std::uint64_t{0};
    power_up();
    run_for(100'000);
    EXPECT_EQ(modules(), 4) << "cut in operation " << cut;             // the last one, too, is torn: its CRC is wrong
    ASSERT_TRUE(flash_table(patch(6))) << "cut in operation " << cut;  // and the slot can be used again
    EXPECT_EQ(modules(), 6) << cut;
    expect_no_violation();
  }
}

}  // namespace
}  // namespace triskin::machine
