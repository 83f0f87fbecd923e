// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the whole controller on switched modules: samples around a failure, found through the frames that it sends.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "support/random_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_offsets.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::test {
namespace {

using hardware::FaultKind;

hardware::Scene switched_scene(const design::Design& design) {
  hardware::Scene s;
  s.design = design;
  s.switched = true;
  s.effects.taxel_spread_counts = 3000;  // Every taxel of every module has another rest value.
  s.effects.converters.drawn = false;    // Exact values tell the modules apart.
  return s;
}

// The skin is flashed and streams, and the fixture knows what every taxel must read.
class Fixture {
 public:
  explicit Fixture(const design::Design& design) : Fixture(switched_scene(design)) {}
  explicit Fixture(const hardware::Scene& s)
      : link_(s), bus_(link_), controller_(bus_, 1), rows_(s.design.patches[0].modules.size()) {
    deploy::flash(bus_, link_.skin().scene().design);
    bus_.listen(bus_.now_us() + 400'000);
    session::wait_for_set_up(bus_, bus_.discover());
    const wire::LiveTaxels sample = controller_.taxels();
    for (const wire::ModuleTaxels& m : sample.rows()) {
      EXPECT_EQ(m.valid, layout::kAllTaxels);
      expected_.push_back(m.value);
    }
    controller_.set_stream(wire::StreamMode::kFull);
    bus_.on_stream([this](const wire::CanFrame& f) { frame(f); });
  }

  void listen_us(std::uint64_t us) { bus_.listen(bus_.now_us() + us); }
  /// Starts the measurement of times.
  void mark() { from_us_ = bus_.now_us(); }
  /// Returns the time after mark() until the newest samples of all modules, each taken since, were valid for exactly
  /// these; −1 if that did not happen.
  std::int64_t until_exactly(std::uint32_t rows, std::uint64_t limit_us) {
    wanted_ = rows;
    reached_us_ = 0;
    valid_ = seen_ = 0;
    const std::uint64_t end = bus_.now_us() + limit_us;
    while (reached_us_ == 0 && bus_.now_us() < end) bus_.listen(std::min(end, bus_.now_us() + 1000));
    return reached_us_ == 0 ? -1 : static_cast<std::int64_t>(reached_us_ - from_us_);
  }
  [[nodiscard]] hardware::SwitchedPatch& hardware() { return link_.skin().switched().patch(layout::PatchIndex{0}); }
  [[nodiscard]] session::Controller& controller() { return controller_; }
  [[nodiscard]] std::uint32_t all() const { return (1U << rows_) - 1; }
  int wrong = 0;

 private:
  void frame(const wire::CanFrame& f) {
    const auto sample = wire::decode_full(f);
    if (!sample || sample->module >= rows_) return;
    for (std::size_t t = 0; t < sample->value.size(); ++t) {
      if ((sample->valid >> t & 1) != 0 && sample->value[t] != expected_[sample->module][t]) ++wrong;
    }
    if (sample->device_time_us <= from_us_) return;
    const std::uint32_t bit = 1U << sample->module;
    seen_ |= bit;
    valid_ = sample->valid == layout::kAllTaxels ? valid_ | bit : valid_ & ~bit;
    if (seen_ == all() && valid_ == wanted_ && reached_us_ == 0) reached_us_ = sample->device_time_us;
  }

  hardware::SimLink link_;
  session::Bus bus_;
  session::Controller controller_;
  std::size_t rows_;
  std::vector<std::array<std::uint16_t, layout::kTaxelsPerModule>> expected_;
  std::uint64_t from_us_ = 0, reached_us_ = 0;
  std::uint32_t valid_ = 0, seen_ = 0, wanted_ = ~0U;  // Bit r stands for row r.
};

struct Failure {
  int row = -1, line = -1;        // The module is dead, or holds a line.
  int a = -1, port = -1, b = -1;  // The joint is broken.
  bool shorted = false;
  void apply(hardware::SwitchedPatch& p, bool on) const {
    using Joint = hardware::SwitchedPatch::JointFault;
    if (row >= 0 && line >= 0)
      p.set_stuck_line(layout::TableRow{row}, on ? line : -1);
    else if (row >= 0)
      p.set_dead(layout::TableRow{row}, on);
    else
      p.set_joint({layout::TableRow{a}, port}, !on ? Joint::kNone : shorted ? Joint::kShort : Joint::kOpen);
  }
};

std::vector<Failure> failures_of(const design::Design& design) {
  std::vector<Failure> list;
  const auto ends = design::joints_of(design, layout::PatchIndex{0});
  for (int m = 0; m < static_cast<int>(ends.size()); ++m) {
    list.push_back({.row = m});
    if (m > 0) list.push_back({.row = m, .line = design.patches[0].modules[static_cast<std::size_t>(m)].line});
    for (int p = 0; p < 3; ++p) {
      const int b = ends[static_cast<std::size_t>(m)][static_cast<std::size_t>(p)].row;
      if (b <= m) continue;
      list.push_back({.a = m, .port = p, .b = b});
      list.push_back({.a = m, .port = p, .b = b, .shorted = true});
    }
  }
  return list;
}

std::uint32_t best(const design::Design& design, const std::vector<Failure>& failures) {
  Broken broken;
  for (const Failure& f : failures) {
    if (f.row >= 0)
      broken.dead.push_back(f.row);
    else
      broken.cut.emplace_back(f.a, f.b);
  }
  return rows_that_survive(design, broken);
}

TEST(Application, every_single_failure_leaves_the_best_set_within_100_ms_and_no_wrong_value) {
  std::mt19937_64 random(21);
  std::int64_t slowest_us = 0;
  int failures = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const design::Design design = random_design(2 + trial % 15, random);
    Fixture fixture(design);
    for (const Failure& f : failures_of(design)) {
      fixture.listen_us(7'000 + random() % 37'000);  // The failure may happen at any moment of a cycle.
      fixture.mark();
      f.apply(fixture.hardware(), true);
      const std::uint32_t wanted = best(design, {f});
      if (wanted != 0) {
        const std::int64_t took_us = fixture.until_exactly(wanted, 400'000);
        ASSERT_GE(took_us, 0) << "trial " << trial << " row " << f.row << " line " << f.line << " joint " << f.a << '-'
                              << f.b << " short " << f.shorted;
        if (took_us > 100'000)
          ADD_FAILURE() << took_us << " us: trial " << trial << " row " << f.row << " line " << f.line << " joint "
                        << f.a << '-' << f.b << " short " << f.shorted;
        slowest_us = std::max(slowest_us, took_us);
      } else {
        fixture.listen_us(150'000);
        EXPECT_EQ(fixture.controller().route().alive, 0);
      }
      ++failures;
      f.apply(fixture.hardware(), false);
      fixture.controller().reroute();  // The tree returns on command.
      fixture.mark();
      ASSERT_GE(fixture.until_exactly(fixture.all(), 400'000), 0) << "after repair, trial " << trial;
      ASSERT_EQ(fixture.wrong, 0) << "trial " << trial << " row " << f.row << " joint " << f.a << '-' << f.b;
    }
  }
  EXPECT_LE(slowest_us, 100'000);
  std::printf("%d failures, slowest return of samples: %.1f ms of virtual time\n", failures,
              static_cast<double>(slowest_us) / 1000);
}

TEST(Application, two_failures_at_once_end_honestly) {
  std::mt19937_64 random(22);
  for (int trial = 0; trial < 20; ++trial) {
    const design::Design design = random_design(4 + trial % 13, random);
    const auto list = failures_of(design);
    Fixture fixture(design);
    for (int pair = 0; pair < 60; ++pair) {
      const Failure a = list[random() % list.size()], b = list[random() % list.size()];
      // A module at a cable that holds a line cannot be left out: then its line is silent, which single failures cover.
      const auto holds_at_cable = [&](const Failure& f) { return f.line >= 0 && f.row == second_entry_row(design); };
      if (holds_at_cable(a) || holds_at_cable(b)) continue;
      if ((a.row >= 0 && a.row == b.row) || (a.row < 0 && b.row < 0 && a.a == b.a && a.b == b.b)) continue;
      fixture.listen_us(random() % 40'000);
      a.apply(fixture.hardware(), true);
      b.apply(fixture.hardware(), true);
      fixture.listen_us(400'000);
      const wire::ActiveRoute route = fixture.controller().route();
      EXPECT_EQ(route.alive, best(design, {a, b})) << trial << ' ' << pair;
      const wire::LiveTaxels s = fixture.controller().taxels();
      for (std::size_t m = 0; m < s.count; ++m)
        EXPECT_EQ(s.modules[m].valid == layout::kAllTaxels, (route.alive >> m & 1) != 0)
            << trial << ' ' << pair << ' ' << m;
      a.apply(fixture.hardware(), false);
      b.apply(fixture.hardware(), false);
      fixture.controller().reroute();
      fixture.listen_us(600'000);  // The next pair meets chips that are set up: that takes some 350 ms.
      ASSERT_EQ(fixture.controller().route().alive, fixture.all());
    }
    EXPECT_EQ(fixture.wrong, 0);
  }
}

TEST(Application, a_module_that_resets_alone_and_a_marginal_clock_give_no_wrong_value) {
  std::mt19937_64 random(23);
  const design::Design design = random_design(14, random);
  Fixture fixture(design);
  for (int k = 0; k < 40; ++k) {
    fixture.listen_us(random() % 60'000);
    fixture.hardware().reset_alone(layout::TableRow{random() % 14});
    fixture.mark();
    ASSERT_GE(fixture.until_exactly(fixture.all(), 400'000), 0) << k;
  }
  fixture.hardware().set_bit_error_rate(1e-5);
  fixture.listen_us(3'000'000);
  fixture.hardware().set_bit_error_rate(0);
  fixture.controller().reroute();
  fixture.mark();
  EXPECT_GE(fixture.until_exactly(fixture.all(), 400'000), 0);
  EXPECT_EQ(fixture.wrong, 0);
}

TEST(Application, what_comes_back_is_taken_back_by_itself) {
  std::mt19937_64 random(24);
  Fixture fixture(random_design(8, random));
  fixture.hardware().set_dead(layout::TableRow{5}, true);
  fixture.listen_us(200'000);
  fixture.hardware().set_dead(layout::TableRow{5}, false);
  fixture.mark();
  const std::int64_t took_us = fixture.until_exactly(fixture.all(), 5'000'000);
  EXPECT_GE(took_us, 0);
  EXPECT_LE(took_us, 2'200'000);
}

// The same tables are used on strapped modules, with and without a chain port on the board.
TEST(Application, strapped_modules_are_read_as_before) {
  std::mt19937_64 random(25);
  const design::Design design = random_design(16, random);
  hardware::Scene strapped = switched_scene(design);
  strapped.switched = false;
  Fixture fixture(strapped);
  fixture.mark();
  EXPECT_GE(fixture.until_exactly(fixture.all(), 100'000), 0);
  EXPECT_FALSE(fixture.controller().route().switched);
  EXPECT_EQ(fixture.controller().topology().count, 0);

  // There are two boards: one without a chain, one with a chain on which nobody answers.
  hardware::SwitchedPatch nobody(design::PortEnds(1), 0, 1);
  nobody.set_dead(layout::TableRow{0}, true);
  std::array<std::vector<wire::CanFrame>, 2> frames;
  for (std::size_t k = 0; k < 2; ++k) {
    hardware::Skin skin(strapped);
    hardware::FlashMemory flash(std::size_t{64} * 1024);
    sim::VirtualBoard board;
    for (int l = 0; l < layout::kLines; ++l)
      board.lines[static_cast<std::size_t>(l)] = &skin.line(layout::PatchIndex{0}, l);
    board.flash = &flash;
    board.send = [&, k](const wire::CanFrame& f) { frames[k].push_back(f); };
    if (k == 1) board.chain = &nobody;
    const auto controller = sim::make_virtual_controller(board);
    wire::CanFrame ask;
    ask.extended = true;
    ask.id = wire::kWhoIsThereId;
    controller->receive(ask);
    controller->run_until(1'000'000);
  }
  EXPECT_EQ(frames[0].size(), frames[1].size());
  EXPECT_FALSE(frames[0].empty());
}

}  // namespace
}  // namespace triskin::test
