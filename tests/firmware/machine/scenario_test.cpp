// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the same script against the image in the machine and against board/posix: frames and fault memory must be equal.
#include <algorithm>
#include <fstream>
#include <sstream>

#include "sampling_bench.hpp"
#include "support/places.hpp"

namespace triskin::machine {
namespace {

struct Event {
  std::uint64_t at_us = 0;
  std::vector<std::string> words;
};

std::vector<Event> read_script(const std::filesystem::path& path) {
  std::vector<Event> events;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Event e;
    std::string first;
    std::uint64_t ms = 0;
    if (!(words >> first) || first[0] == '#') continue;
    words >> ms;
    e.at_us = ms * 1000;
    for (std::string w; words >> w;) e.words.push_back(w);
    EXPECT_TRUE(first == "end" || (first == "at" && e.words.size() >= 3)) << path << ": " << line;
    events.push_back(std::move(e));
  }
  EXPECT_FALSE(events.empty()) << path;
  return events;
}

/// Consecutive frames of a module that differ only in number and time.
struct Stretch {
  wire::TaxelFrame first;
  std::size_t count = 0;
  [[nodiscard]] bool says_as(const wire::TaxelFrame& t) const {
    return first.state == t.state && first.valid == t.valid && first.value == t.value;
  }
};

struct Outcome {
  std::array<std::vector<Stretch>, 16> modules;
  std::vector<std::uint8_t> faults;
};

// The converters have no noise here: the microseconds that code takes decide into which sequence a reading falls, and
// so its noise.
class Scenario : public Sampling, public ::testing::WithParamInterface<const char*> {
 protected:
  void hush() {
    for (int m = 0; m < layout::kMaxModules; ++m) module_at(m).chip->set_noise(0);
  }
  void obey(const Event& e) {
    const int n = std::stoi(e.words[1]);
    const std::string& verb = e.words[2];
    const std::string argument = e.words.size() > 3 ? e.words[3] : "";
    const int number = e.words.size() > 4 ? std::stoi(e.words[4]) : 0;
    if (e.words[0] == "line") return obey_line(lines[static_cast<std::size_t>(n)], verb, argument, number);
    SkinModule& m = module_at(n);
    if (verb == "absent")
      m.present = false;
    else if (verb == "present")
      m.present = true;
    else if (verb == "id")
      SkinLine::exchange(m, static_cast<std::uint16_t>(std::stoi(argument, nullptr, 16)), n), hush();
    else if (verb == "dip")
      line_of(n).dip(m, now_us());
    else if (verb == "saturate")
      m.source.level[std::stoul(argument)] += 60'000;
    else if (verb == "relax")
      m.source.level[std::stoul(argument)] -= 60'000;
    else if (verb == "touch")
      m.source.level[std::stoul(argument)] = 8000.0 - 97.0 * n - 31.0 * std::stod(argument) + number;
    else
      ADD_FAILURE() << "no such verb: " << verb;
  }
  static void obey_line(SkinLine& line, const std::string& wire, const std::string& level, int pulses) {
    bool& held = wire == "sda" ? line.sda_held : line.scl_held;
    held = level == "low";
    line.frees_after_pulses = pulses == 0 ? 0 : line.pulses + pulses;
  }

  Outcome play(bool posix_board) {
    on_posix = posix_board;
    hush();
    for (auto& line : lines) line.first_start_us = 0;
    frames.clear();
    store_table(patch(16));
    power_up();
    while (lines[0].first_start_us == 0) run_for(100);
    const std::uint64_t origin_us = lines[0].first_start_us;
    run_to(origin_us + 100'000);
    unlock();
    EXPECT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
    run_to(origin_us + 2'500'000);
    frames.clear();
    for (const Event& e :
         read_script(std::filesystem::path(test::source_folder()) / "tests/firmware/machine/scenarios" / GetParam())) {
      run_to(origin_us + e.at_us);
      if (!e.words.empty()) obey(e);
    }
    Outcome outcome;
    for (const auto& [m, list] : samples()) {
      std::vector<Stretch>& runs = outcome.modules[static_cast<std::size_t>(m)];
      for (const auto& t : list) {
        if (runs.empty() || !runs.back().says_as(t)) runs.push_back({t, 0});
        ++runs.back().count;
      }
    }
    outcome.faults = request({0x19, 0x02, 0xFF});
    return outcome;
  }
  void run_to(std::uint64_t us) { run_for(us - now_us()); }
};

TEST_P(Scenario, GivesEqualFramesAndFaultsOnBothBoards) {
  const FlashChip fresh = flash;
  const Outcome image = play(false);
  expect_no_violation();
  flash = fresh;
  for (auto& line : lines) line.modules.clear();
  for (int k = 0; k < layout::kMaxModules; ++k)
    lines[static_cast<std::size_t>(k % layout::kLines)].add(static_cast<std::uint8_t>(k / layout::kLines), k);
  const Outcome posix_board = play(true);
  EXPECT_EQ(image.faults, posix_board.faults);
  EXPECT_GT(image.faults.size(), 3U);
  std::size_t compared = 0;
  for (std::size_t m = 0; m < layout::kMaxModules; ++m) {
    const auto& a = image.modules[m];
    const auto& b = posix_board.modules[m];
    ASSERT_EQ(a.size(), b.size()) << "module " << m << " said other things";
    for (std::size_t r = 0; r < a.size(); ++r) {
      EXPECT_TRUE(a[r].says_as(b[r].first)) << "module " << m << ", state " << static_cast<int>(a[r].first.state)
                                            << " and " << static_cast<int>(b[r].first.state);
      const std::size_t na = a[r].count, nb = b[r].count;
      // An event falls between two readings.
      EXPECT_LE(na > nb ? na - nb : nb - na, 1U) << "module " << m << ", state " << static_cast<int>(a[r].first.state);
      compared += std::min(na, nb);
    }
  }
  EXPECT_GE(compared, 16U * 200);
}

INSTANTIATE_TEST_SUITE_P(Scripts, Scenario, ::testing::Values("faults.txt", "touches.txt"), [](const auto& tested) {
  const std::string name = tested.param;
  return name.substr(0, name.find('.'));
});

}  // namespace
}  // namespace triskin::machine
