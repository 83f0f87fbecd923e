// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/vcd.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/base/files.hpp"

namespace triskin::machine {
namespace {

constexpr std::array<const char*, 11> kNames{"scl1", "scl2", "scl3",   "scl4",      "sda1", "sda2",
                                             "sda3", "sda4", "can_tx", "exception", "sleep"};

std::string value_line(int signal, std::uint32_t value) {
  const char id = static_cast<char>('!' + signal);
  return signal == 9 ? fmt::format("b{:b} {}\n", value, id) : fmt::format("{}{}\n", value, id);
}

}  // namespace

void VcdTrace::i2c_start(int line, Time at) {
  change(kSda + line, 0, at);
}

void VcdTrace::i2c_stop(int line, Time at) {
  change(kScl + line, 1, at);
  change(kSda + line, 1, at + 600'000);
}

// SDA changes while SCL is low; the ninth bit is the acknowledge.
void VcdTrace::i2c_byte(int line, std::uint8_t byte, bool acknowledged, Time end, Time period) {
  const Time begin = end - 9 * period;
  for (unsigned k = 0; k < 9; ++k) {
    const Time bit = begin + k * period;
    const std::uint32_t level = k < 8 ? byte >> (7 - k) & 1U : (acknowledged ? 0U : 1U);
    change(kScl + line, 0, bit);
    change(kSda + line, level, bit + period / 8);
    change(kScl + line, 1, bit + period * 5 / 8);
  }
  change(kScl + line, 0, end);
}

std::string VcdTrace::text() const {
  std::vector<Change> sorted = changes_;
  std::ranges::stable_sort(sorted, {}, &Change::at);
  std::string out = "$timescale 1 ns $end\n$scope module controller $end\n";
  for (int k = 0; k < kSignals; ++k) {
    out += fmt::format("$var wire {} {} {} $end\n", k == kException ? 9 : 1, static_cast<char>('!' + k),
                       kNames[static_cast<std::size_t>(k)]);
  }
  out += "$upscope $end\n$enddefinitions $end\n#0\n";
  for (int k = 0; k < kSignals; ++k) out += value_line(k, k < kCan ? 1 : 0);
  Time last = 0;
  for (const Change& c : sorted) {
    if (c.at / 1000 != last) out += fmt::format("#{}\n", last = c.at / 1000);
    out += value_line(c.signal, c.value);
  }
  return out;
}

void VcdTrace::write(const std::filesystem::path& path) const {
  write_file_atomically(path, text());
}

}  // namespace triskin::machine
