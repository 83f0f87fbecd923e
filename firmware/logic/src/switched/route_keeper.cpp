// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/switched/route_keeper.hpp"

#include <algorithm>

namespace triskin::fw {

void RouteKeeper::begin(const layout::PatchImage* table) {
  table_ = table == nullptr ? Topology::Table{} : Topology::table_of(*table);
  const std::uint32_t reroutes = route_.reroutes, repairs = route_.repairs;
  route_ = {};
  route_.reroutes = reroutes;
  route_.repairs = repairs;
  adoption_.rows = table_.graph.count;
  if (adoption_.count > 0 || adoption_.out_of_reach != 0) tell_at_us_ = 0;
  adoption_.count = 0;
  adoption_.out_of_reach = 0;
  request();
  beyond_ = false;  // This is the state after power-up, when the neighbours may be in the middle of their searches.
}

void RouteKeeper::request() {
  if (!present_) return;
  reroute_at_us_ = 0;
  pause_us_ = kFirstPause_us;
  route_.busy = true;
  beyond_ = true;
}

void RouteKeeper::line_state(std::uint8_t line, bool held) {
  const auto bit = static_cast<std::uint8_t>(1U << line);
  if (!held) held_lines_ = static_cast<std::uint8_t>(held_lines_ & ~bit);
  if (!held || !switched() || (held_lines_ & bit) != 0) return;
  held_lines_ = static_cast<std::uint8_t>(held_lines_ | bit);
  reroute_at_us_ = 0;
  route_.busy = true;
}

void RouteKeeper::nothing_answers(std::uint64_t now_us) {
  if (!present_ || switched() || reroute_at_us_ != UINT64_MAX) return;
  reroute_at_us_ = now_us + pause_us_;
  pause_us_ = std::min(2 * pause_us_, kLongestPause_us);
}

void RouteKeeper::reroute(const Clock& clock) {
  const std::uint64_t start_us = clock.now_us();
  const std::uint32_t reroutes = route_.reroutes + 1, repairs = route_.repairs;
  const bool was_switched = route_.switched;
  const bool has_table = table_.graph.count > 0;
  const bool was_whole = whole();
  const auto look = neighbours_.begin_look(start_us) && was_whole ? Topology::Look::kAdopt
                    : beyond_                                     ? Topology::Look::kBeyond
                                                                  : Topology::Look::kOwn;
  beyond_ = false;
  const Topology::Report report =
      has_table ? topology_.reroute(table_, look, neighbours_.layers()) : topology_.discover();
  route_ = {};
  route_.reroutes = reroutes;
  route_.repairs = repairs;
  route_.switched =
      topology_.graph().count > 0 || was_switched;  // A patch that has become silent is still a switched one.
  complete_discovery_ = report.complete;
  if (has_table)
    note(report);
  else
    topology_.let_go();  // Joints lead into other patches, whose controllers would not find modules held here.
  route_.last_us = static_cast<std::uint32_t>(clock.now_us() - start_us);
  plan_next(clock.now_us());
  if (has_table && route_.switched) offer(report, clock.now_us());
  if (has_table) note_adopted();
  if (report.more_adopted) neighbours_.look_further(clock.now_us());
  if (!was_whole && whole()) neighbours_.look_again(clock.now_us());
}

// Only a complete patch adopts modules, because one at the wrong cable has a table of other modules. When it is
// complete again, it searches for the modules that are then offered.
bool RouteKeeper::whole() const {
  return table_.graph.count > 0 && route_.alive == (1U << table_.graph.count) - 1U;
}

// A module that exists but does not come in is held by a neighbour. The neighbour is first asked to give it back, then
// the module is searched.
void RouteKeeper::offer(const Topology::Report& report, std::uint64_t now_us) {
  const auto all = static_cast<std::uint16_t>((1U << table_.graph.count) - 1U);
  returned_ = report.held != 0 && !returned_;
  const auto missing = static_cast<std::uint16_t>(all & ~route_.alive);
  if (returned_) {
    reroute_at_us_ = now_us + Neighbours::kHandBack_us;
    pause_us_ = std::max(pause_us_ / 2, kFirstPause_us);  // This search and the next one count as one attempt.
    route_.busy = true;
    // The state is sent even without an offer, because after a restart the neighbours know more than this controller.
    tell_at_us_ = 0;
  }
  set_offered(returned_ ? std::uint16_t{0} : missing);
}

void RouteKeeper::set_offered(std::uint16_t rows) {
  if (rows != adoption_.out_of_reach) tell_at_us_ = 0;
  adoption_.out_of_reach = rows;
}

// An unchanged list keeps its number. The samples of adopted modules at the front of both lists continue.
void RouteKeeper::note_adopted() {
  const std::uint8_t adopted_modules = topology_.adopted_count();
  kept_adopted_ = 0;
  for (std::uint8_t k = 0; k < adopted_modules; ++k) {
    const wire::AdoptedModule adopted_module = topology_.adopted_module(k);
    if (k == kept_adopted_ && k < adoption_.count && adoption_.adopted_modules[k] == adopted_module) ++kept_adopted_;
    adoption_.adopted_modules[k] = adopted_module;
  }
  if (adopted_modules == adoption_.count && adopted_modules == kept_adopted_) return;
  adoption_.count = adopted_modules;
  adoption_.list = static_cast<std::uint8_t>(adoption_.list == 255 ? 1 : adoption_.list + 1);
  tell_at_us_ = 0;
}

bool RouteKeeper::receive(const wire::CanFrame& frame, std::uint8_t own_node, std::uint64_t now_us) {
  const auto reach = wire::decode_reach(frame);
  if (reach && reach->node_address != own_node) neighbours_.receive(*reach, own_node, adoption_.count > 0, now_us);
  return reach.has_value();
}

void RouteKeeper::send_status(CanPort& port, std::uint8_t own_node, std::uint64_t now_us) {
  if (now_us < tell_at_us_) return;
  constexpr std::uint64_t kNoRoom_us = 1'000;
  const bool quiet = adoption_.out_of_reach == 0 && adoption_.count == 0;
  if (!port.send(wire::encode_reach({own_node, adoption_.out_of_reach, adoption_.count, adoption_.list})))
    tell_at_us_ = now_us + kNoRoom_us;
  else
    tell_at_us_ = quiet ? UINT64_MAX : now_us + Neighbours::kRepeat_us;
}

void RouteKeeper::note(const Topology::Report& report) {
  route_.complete = report.complete;
  route_.as_table = report.as_table;
  route_.min_depth = report.min_depth;
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

// A missing module may come back, so a reroute is planned, each time after twice the pause.
void RouteKeeper::plan_next(std::uint64_t now_us) {
  check_at_us_ = now_us + kCheckEvery_us;
  reroute_at_us_ = UINT64_MAX;
  const auto all = static_cast<std::uint16_t>((1U << table_.graph.count) - 1U);
  if (!route_.switched || table_.graph.count == 0) return;
  if (route_.alive == all) {
    pause_us_ = kFirstPause_us;
    return;
  }
  reroute_at_us_ = now_us + pause_us_;
  pause_us_ = std::min(2 * pause_us_, kLongestPause_us);
}

bool RouteKeeper::check(std::uint64_t now_us) {
  neighbours_.tick(adoption_.count > 0, now_us);
  check_at_us_ = now_us + kCheckEvery_us;
  if (!route_.complete) return true;  // The modules are strapped, or EN is low and no module is reached.
  if (topology_.intact()) return true;
  // A flipped bit, or a leaf module that was reset alone, needs no new tree.
  if (topology_.refresh()) {
    ++route_.repairs;
  } else {
    reroute_at_us_ = 0;
    route_.busy = true;
  }
  return false;
}

std::uint64_t RouteKeeper::next_event_us() const {
  if (!present_) return UINT64_MAX;
  const std::uint64_t next_us = std::min(reroute_at_us_, tell_at_us_);
  if (!switched() || table_.graph.count == 0) return next_us;
  return std::min(next_us, std::min(check_at_us_, look_because_of_others_us()));
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
