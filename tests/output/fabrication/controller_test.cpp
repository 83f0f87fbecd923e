// SPDX-License-Identifier: GPL-3.0-or-later
// The controller's transceiver against the bit rate of the firmware, its supply, and its pins that must not be high.
// The figures are those of the data sheets TI SLLSEQ7E and Microchip DS20005284A.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "output/fabrication/src/controller_nets.hpp"
#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::fabrication {
namespace {

struct Transceiver {
  double max_bit_hz;
  std::map<std::string, std::pair<double, double>> supplies_v;  // pin: least and largest voltage
  std::set<std::string> low;                                    // high on these pins is standby or shutdown
};
const std::map<std::string, Transceiver> kTransceivers{
    {"TCAN334", {1e6, {{"VCC", {3.0, 3.6}}}, {"STB", "SHDN"}}},
    {"TCAN334G", {5e6, {{"VCC", {3.0, 3.6}}}, {"STB", "SHDN"}}},
    {"MCP2562FD", {8e6, {{"VDD", {4.5, 5.5}}, {"VIO", {1.8, 5.5}}}, {"STBY"}}},
};
const std::map<std::string, double> kNets_v{{"VDD", 3.3}, {"USB_VBUS", 5.0}, {"GND", 0.0}};

double data_bit_hz() {
  const std::string text =
      read_file(std::filesystem::path(test::source_folder()) / "firmware/board/stm32g474/src/can.cpp");
  std::smatch rate;
  EXPECT_TRUE(std::regex_search(text, rate, std::regex(R"(kData\{([\d']+),)")));
  return std::stod(std::regex_replace(rate[1].str(), std::regex("'"), ""));
}

TEST(Controller, TransceiverStandsTheBitRateAndItsSupply) {
  std::map<std::string, std::string> net_of;
  std::string part;
  for (const NetPin& p : controller_nets()) {
    if (p.component != "U2") continue;
    net_of[p.pin] = p.net;
    part = p.value;
  }
  ASSERT_TRUE(kTransceivers.contains(part)) << part;
  const Transceiver& t = kTransceivers.at(part);
  EXPECT_GE(t.max_bit_hz, data_bit_hz()) << part;
  for (const auto& [pin, range] : t.supplies_v) {
    ASSERT_TRUE(net_of.contains(pin)) << pin;
    const double v = kNets_v.at(net_of.at(pin));
    EXPECT_GE(v, range.first) << pin;
    EXPECT_LE(v, range.second) << pin;
  }
  for (const std::string& pin : t.low) EXPECT_EQ(net_of[pin], "GND") << pin << " is open: standby or shutdown";
}

// A line of a full patch of switched modules has 60 pF/m · 0.5 m + 15 · 2 pF + 4 · 10 pF + 12 · 6 pF = 172 pF
// (docs/routing.md): 300 ns from 30 to 70 % ask for 300 ns / (0.8473 · 172 pF) = 2,059 Ω or less. The least is 967:
// 3 mA at 0.4 V (UM10204, table 10). What the AD7147's SDA sinks is not known to us; at 1 mA at 0.4 V it would be a
// switch of 400 Ω, which has to leave a tenth of the supply below the STM32's 0.3 VDD (UM10204, table 10: V_nL).
TEST(Controller, PullUpsChargeAFullPatchAndLeaveAConverterItsLevel) {
  std::map<std::string, double> pull_up_ohm;
  for (const NetPin& p : controller_nets()) {
    std::smatch value;
    if (std::regex_match(p.value, value, std::regex(R"(([\d.]+)k)")) &&
        (p.net.starts_with("SDA") || p.net.starts_with("SCL")))
      pull_up_ohm[p.net] = 1000.0 * std::stod(value[1]);
  }
  ASSERT_EQ(pull_up_ohm.size(), 8U);
  for (const auto& [net, ohm] : pull_up_ohm) {
    EXPECT_LE(0.8473 * ohm * 172e-12, 300e-9) << net;
    EXPECT_GE(ohm, (3.3 - 0.4) / 3e-3) << net;
    EXPECT_LE(3.3 * 400.0 / (ohm + 400.0), (0.3 - 0.1) * 3.3) << net;
  }
}

// Each row of the page's table of transceivers: rate and supply of the data sheet, and where its pins go.
TEST(Controller, TransceiversOfThePageAreSpecifiedForTheBus) {
  const std::string page = read_file(std::filesystem::path(test::source_folder()) / "docs/program_board.md");
  const std::regex row(R"(\n\| ([\w*]+) \| (\d+) Mbit/s \| ([^|]*) \| ([^|]*) to ground \|)");
  int rows = 0;
  for (std::sregex_iterator r(page.begin(), page.end(), row), end; r != end; ++r, ++rows) {
    const std::string part = std::regex_replace((*r)[1].str(), std::regex(R"(\*)"), "");
    ASSERT_TRUE(kTransceivers.contains(part)) << part;
    const Transceiver& t = kTransceivers.at(part);
    EXPECT_EQ(std::stod((*r)[2]) * 1e6, t.max_bit_hz) << part;
    EXPECT_GE(t.max_bit_hz, data_bit_hz()) << part;
    for (const auto& [pin, range] : t.supplies_v) {
      const std::string supply = (*r)[3];
      std::smatch volts;
      ASSERT_TRUE(std::regex_search(supply, volts, std::regex(pin + R"( \**([\d.]+) V)"))) << part << " " << pin;
      EXPECT_GE(std::stod(volts[1]), range.first) << part << " " << pin;
      EXPECT_LE(std::stod(volts[1]), range.second) << part << " " << pin;
    }
    for (const std::string& pin : t.low) EXPECT_NE((*r)[4].str().find(pin), std::string::npos) << part << " " << pin;
  }
  EXPECT_EQ(rows, 2);
}

}  // namespace
}  // namespace triskin::fabrication
