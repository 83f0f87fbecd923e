// SPDX-License-Identifier: GPL-3.0-or-later
// The sample points of the documented lines for Linux, against those that the image sets in the CAN block.
#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <regex>

#include "bench.hpp"
#include "support/places.hpp"

namespace triskin::machine {
namespace {

struct Phase {
  double bit_hz = 0, sample_point = 0;
};

// Linux' choice when a line names no sample point (can_calc_bittiming, for CAN and CAN FD).
double choice_of_linux(double bit_hz) {
  return bit_hz > 800'000 ? 0.75 : bit_hz > 500'000 ? 0.8 : 0.875;
}

std::optional<double> value_of(const std::string& line, const std::string& key) {
  std::smatch found;
  if (!std::regex_search(line, found, std::regex(" " + key + R"( ([\d.]+))"))) return std::nullopt;
  return std::stod(found[1]);
}

std::optional<Phase> phase_of(const std::string& line, const std::string& prefix) {
  const auto bit_hz = value_of(line, prefix + "bitrate");
  if (!bit_hz) return std::nullopt;
  return Phase{*bit_hz, value_of(line, prefix + "sample-point").value_or(choice_of_linux(*bit_hz))};
}

class CanLines : public Bench {
 protected:
  // RM0440, 44.4: NBTP has prescaler, TSEG1 and TSEG2 at bits 16, 8 and 0, DBTP at bits 16, 8 and 4, each less one; the
  // sample point follows the first quantum and TSEG1.
  [[nodiscard]] Phase nominal() const {
    const std::uint32_t r = machine->read_register(0x40006400 + 0x1C);
    return phase((r >> 16 & 0x1FF) + 1, (r >> 8 & 0xFF) + 1, (r & 0x7F) + 1);
  }
  [[nodiscard]] Phase data() const {
    const std::uint32_t r = machine->read_register(0x40006400 + 0x0C);
    return phase((r >> 16 & 0x1F) + 1, (r >> 8 & 0x1F) + 1, (r >> 4 & 0xF) + 1);
  }
  [[nodiscard]] Phase phase(std::uint32_t prescaler, std::uint32_t before, std::uint32_t after) const {
    const double quanta = 1 + before + after;
    return {static_cast<double>(machine->sysclk_hz()) / (prescaler * quanta), (1 + before) / quanta};
  }
};

TEST_F(CanLines, OfThePagesHaveTheSamplePointsOfTheFirmware) {
  power_up();
  run_for(200'000);
  int checked = 0, with_data = 0;
  for (const char* page : {"docs/bring_up.md", "docs/connect.md", "docs/start.md"}) {
    std::ifstream in(std::filesystem::path(test::source_folder()) / page);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    static const std::regex kLine(R"(ip link set can0 up type can( [^`#\n]*))");
    for (std::sregex_iterator m(text.begin(), text.end(), kLine), end; m != end; ++m, ++checked) {
      const std::string line = (*m)[1];
      SCOPED_TRACE(fmt::format("{}:{}", page, line));
      const auto slow = phase_of(line, ""), fast = phase_of(line, "d");
      ASSERT_TRUE(slow.has_value());
      EXPECT_EQ(slow->bit_hz, nominal().bit_hz);
      EXPECT_EQ(slow->sample_point, nominal().sample_point);
      EXPECT_NE(line.find(" berr-reporting on"), std::string::npos);
      if (!fast) continue;
      ++with_data;
      EXPECT_EQ(fast->bit_hz, data().bit_hz);
      EXPECT_EQ(fast->sample_point, data().sample_point);
    }
  }
  EXPECT_EQ(checked, 4);
  EXPECT_EQ(with_data, 3);
}

}  // namespace
}  // namespace triskin::machine
