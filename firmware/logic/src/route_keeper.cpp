// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/route_keeper.hpp"

#include <algorithm>

namespace triskin::fw {

void RouteKeeper::begin(const layout::PatchImage* table) {
  table_ = table == nullptr ? Topology::Table{} : Topology::table_of(*table);
  const std::uint32_t heals = route_.heals, repairs = route_.repairs;
  route_ = {};
  route_.heals = heals;
  route_.repairs = repairs;
  request();
}

void RouteKeeper::request() {
  if (!present_) return;
  heal_at_us_ = 0;
  pause_us_ = kFirstPause_us;
  route_.busy = true;
}

void RouteKeeper::line_state(std::uint8_t line, bool held) {
  const auto bit = static_cast<std::uint8_t>(1U << line);
  if (!held) held_lines_ = static_cast<std::uint8_t>(held_lines_ & ~bit);
  if (!held || !switched() || (held_lines_ & bit) != 0) return;
  held_lines_ = static_cast<std::uint8_t>(held_lines_ | bit);
  heal_at_us_ = 0;
  route_.busy = true;
}

void RouteKeeper::nothing_answers(std::uint64_t now_us) {
  if (!present_ || switched() || heal_at_us_ != UINT64_MAX) return;
  heal_at_us_ = now_us + pause_us_;
  pause_us_ = std::min(2 * pause_us_, kLongestPause_us);
}

void RouteKeeper::heal(const Clock& clock) {
  const std::uint64_t start_us = clock.now_us();
  const std::uint32_t heals = route_.heals + 1, repairs = route_.repairs;
  const bool was_switched = route_.switched;
  const bool has_table = table_.graph.count > 0;
  const Topology::Report report = has_table ? topology_.heal(table_) : topology_.discover();
  route_ = {};
  route_.heals = heals;
  route_.repairs = repairs;
  route_.switched =
      topology_.graph().count > 0 || was_switched;  // a patch that has gone silent is still a switched one
  complete_discovery_ = report.complete;
  if (has_table) note(report);
  route_.last_us = static_cast<std::uint32_t>(clock.now_us() - start_us);
  plan_next(clock.now_us());
}

void RouteKeeper::note(const Topology::Report& report) {
  route_.complete = report.complete;
  route_.as_table = report.as_table;
  route_.least_depth = report.least_depth;
  route_.second_cable = report.second_cable;
  route_.shorts = report.shorts;
  route_.unknown = report.unknown;
  route_.max_depth = report.max_depth;
  route_.alive = report.alive;
  route_.parent.fill(wire::kNoRow);
  route_.parent_port.fill(layout::kCable);
  for (std::uint8_t m = 0; m < topology_.graph().count; ++m) {
    const TableRow row = topology_.row_of(m);
    const JointEnd above = topology_.parent_of(m);
    if (row == kNoTableRow || above.module == kNoModule) continue;
    route_.parent[index_of(row)] = static_cast<std::uint8_t>(topology_.row_of(above.module));
    route_.parent_port[index_of(row)] = above.port;
  }
}

// A missing module may come back: the next healing, each time after twice the pause.
void RouteKeeper::plan_next(std::uint64_t now_us) {
  check_at_us_ = now_us + kCheckEvery_us;
  heal_at_us_ = UINT64_MAX;
  const auto all = static_cast<std::uint16_t>((1U << table_.graph.count) - 1U);
  if (!route_.switched || table_.graph.count == 0) return;
  if (route_.alive == all) {
    pause_us_ = kFirstPause_us;
    return;
  }
  heal_at_us_ = now_us + pause_us_;
  pause_us_ = std::min(2 * pause_us_, kLongestPause_us);
}

bool RouteKeeper::check(std::uint64_t now_us) {
  check_at_us_ = now_us + kCheckEvery_us;
  if (!route_.complete) return true;  // strapped, or EN is low and no module is reached
  if (topology_.intact()) return true;
  // A flipped bit, or a leaf that was reset alone, needs no new tree.
  if (topology_.refresh()) {
    ++route_.repairs;
  } else {
    heal_at_us_ = 0;
    route_.busy = true;
  }
  return false;
}

std::uint64_t RouteKeeper::next_event_us() const {
  if (!present_) return UINT64_MAX;
  return std::min(heal_at_us_, switched() && table_.graph.count > 0 ? check_at_us_ : UINT64_MAX);
}

wire::FoundTopology RouteKeeper::found() const {
  wire::FoundTopology t;
  const PatchGraph& g = topology_.graph();
  t.switched = route_.switched;
  t.complete = complete_discovery_;
  t.second_cable = topology_.second_cable();
  t.count = g.count;
  t.cable_port = g.cable_port;
  for (std::uint8_t m = 0; m < g.count; ++m) {
    t.row[m] = table_.graph.count > 0 ? static_cast<std::uint8_t>(topology_.row_of(m)) : wire::kNoRow;
    for (std::size_t p = 0; p < layout::kPorts; ++p) {
      t.joints[m][p] = layout::joint_to(g.joint[m][p]);
    }
  }
  return t;
}

}  // namespace triskin::fw
