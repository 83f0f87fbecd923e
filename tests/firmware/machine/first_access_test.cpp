// SPDX-License-Identifier: GPL-3.0-or-later
// The chip may take the first access to a RAM after a reset for a read (errata ES0430, 2.2.7), so it must be one.
#include <gtest/gtest.h>
#include <unicorn/unicorn.h>

#include <array>
#include <filesystem>

#include "bench.hpp"
#include "triskin/machine/flash_chip.hpp"

namespace triskin::machine {
namespace {

struct Ram {
  std::uint32_t base, bytes;
  uc_mem_type first = UC_MEM_FETCH;  ///< No access has happened so far.
};

class FirstAccess : public ::testing::TestWithParam<const char*> {};

TEST_P(FirstAccess, ToEachRamAfterAResetIsARead) {
  const std::filesystem::path path = firmware(GetParam());
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no firmware image: install gcc-arm-none-eabi and build again";
  const ElfImage image = read_elf(path);
  FlashChip flash;
  flash.store(image);
  std::array rams{Ram{0x20000000, 80 * 1024}, Ram{0x20014000, 16 * 1024}, Ram{0x10000000, 32 * 1024}};
  uc_engine* uc = nullptr;
  ASSERT_EQ(uc_open(UC_ARCH_ARM, static_cast<uc_mode>(UC_MODE_THUMB | UC_MODE_MCLASS), &uc), UC_ERR_OK);
  ASSERT_EQ(uc_ctl_set_cpu_model(uc, UC_CPU_ARM_CORTEX_M4), UC_ERR_OK);
  uc_mem_map_ptr(uc, FlashChip::kBase, FlashChip::kBytes, UC_PROT_READ | UC_PROT_EXEC, flash.bytes.data());
  uc_mem_map(uc, 0xE000E000, 0x1000, UC_PROT_ALL);
  const auto note = +[](uc_engine*, uc_mem_type type, std::uint64_t, int, std::int64_t, void* ram) {
    if (auto& first = static_cast<Ram*>(ram)->first; first == UC_MEM_FETCH) first = type;
  };
  for (Ram& r : rams) {
    uc_mem_map(uc, r.base, r.bytes, UC_PROT_ALL);
    uc_hook hook = 0;
    uc_hook_add(uc, &hook, UC_HOOK_MEM_READ | UC_HOOK_MEM_WRITE, reinterpret_cast<void*>(note), &r, r.base,
                r.base + r.bytes - 1);
  }
  const auto vector = [&](std::uint32_t at) {
    std::uint32_t v = 0;
    uc_mem_read(uc, image.origin() + at, &v, 4);
    return v;
  };
  const std::uint32_t stack = vector(0);
  uc_reg_write(uc, UC_ARM_REG_SP, &stack);
  constexpr std::size_t kInstructions = 3'000;  // The stores of the start-up code are within this range.
  uc_emu_start(uc, vector(4) | 1U, 0xFFFFFFFE, 0, kInstructions);
  for (const Ram& r : rams) EXPECT_EQ(r.first, UC_MEM_READ) << std::hex << r.base;
  uc_close(uc);
}

INSTANTIATE_TEST_SUITE_P(Images, FirstAccess,
                         ::testing::Values("triskin_loader.elf", "triskin_app_a.elf", "triskin_app_b.elf"));

}  // namespace
}  // namespace triskin::machine
