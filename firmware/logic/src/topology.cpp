// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/topology.hpp"

namespace triskin::fw {
namespace {

constexpr int kMostPasses = 64;  // every pass but the last leaves one more port closed; 48 ports exist

constexpr bool has(std::uint16_t set, std::uint8_t k) { return ((set >> k) & 1U) != 0; }
constexpr std::uint16_t with(std::uint16_t set, std::uint8_t k) { return static_cast<std::uint16_t>(set | (1U << k)); }

}  // namespace

bool Topology::exclude(std::uint8_t module, std::uint8_t port) {
  bad_[module] = static_cast<std::uint8_t>(bad_[module] | (1U << port));
  ++shorts_;
  return false;
}

void Topology::join(JointEnd a, JointEnd b) {
  graph_.joint[a.module][a.port] = b;
  graph_.joint[b.module][b.port] = a;
}

Topology::Report Topology::discover() {
  Report report;
  bad_.fill(0);
  shorts_ = 0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    Pass result = explore();
    if (result == Pass::kDone) result = match();
    if (result == Pass::kAgain) continue;
    report.complete = result == Pass::kDone;
    break;
  }
  report.shorts = shorts_;
  return report;
}

Topology::Pass Topology::explore() {
  graph_ = {};
  input_.fill(kNoModule);
  parent_.fill({});
  for (auto& p : port_) p.fill(Port::kUnknown);
  if (!chain_.restart()) return Pass::kNobody;
  graph_.count = 1;
  std::array<std::uint8_t, layout::kMaxModules> next{};
  std::uint8_t m = 0;
  for (;;) {
    if (next[m] == 3) {
      if (input_[m] == kNoModule) return Pass::kAgain;  // something changed meanwhile
      if (m == 0) return Pass::kDone;
      m = parent_[m].module;
      continue;
    }
    const std::uint8_t port = next[m]++;
    if (const Pass result = probe(m, port); result != Pass::kDone) return result;
    if (port_[m][port] == Port::kChild) m = static_cast<std::uint8_t>(graph_.count - 1);
  }
}

Topology::Pass Topology::probe(std::uint8_t module, std::uint8_t port) {
  if (((bad_[module] >> port) & 1U) != 0) {
    port_[module][port] = Port::kBad;
    return Pass::kDone;
  }
  const bool full = graph_.count == layout::kMaxModules;
  const auto child = static_cast<std::uint8_t>(full ? layout::kMaxModules - 1 : graph_.count);
  // What brings no module in is asked until two answers agree: a flipped bit could have opened another port.
  ChainDriver::Answer answer = ChainDriver::Answer::kLost, before = answer;
  for (int k = 0; k < 4; ++k) {
    before = answer;
    answer = chain_.open(module, port, child);
    if (answer == ChainDriver::Answer::kModule) break;
    if (!chain_.close(module, port)) {
      exclude(module, port);
      return Pass::kAgain;
    }
    if (k > 0 && answer == before) break;
  }
  if (answer == ChainDriver::Answer::kModule) {
    // A module that holds a line down, or the seventeenth, stays outside.
    if (full || chain_.stuck_lines() != 0) {
      exclude(module, port);
      return Pass::kAgain;
    }
    port_[module][port] = Port::kChild;
    parent_[child] = {module, port};
    ++graph_.count;
    return Pass::kDone;
  }
  if (answer != before) answer = ChainDriver::Answer::kLost;
  // Only one port is the input; the enable of another one that does nothing is broken.
  if (answer == ChainDriver::Answer::kUnchanged && input_[module] != kNoModule) answer = ChainDriver::Answer::kLost;
  switch (answer) {
    case ChainDriver::Answer::kRefused: port_[module][port] = Port::kJoined; break;
    case ChainDriver::Answer::kNothing: port_[module][port] = Port::kNothing; break;
    case ChainDriver::Answer::kUnchanged:
      port_[module][port] = Port::kInput;
      input_[module] = port;
      if (module == 0) graph_.cable_port = port;
      else join(parent_[module], {module, port});
      break;
    default: port_[module][port] = Port::kBad;
  }
  return Pass::kDone;
}

bool Topology::below(std::uint8_t module, std::uint8_t top) const {
  for (std::uint8_t m = module; m != kNoModule; m = parent_[m].module) {
    if (m == top) return true;
  }
  return false;
}

bool Topology::open_end(std::uint8_t module, std::uint8_t port) const {
  return port_[module][port] == Port::kJoined && graph_.joint[module][port].module == kNoModule;
}

// Depth first, a joint that closes a cycle leads from a module to one above it. The upper end knows from its own side whether
// there is somebody below: with the branch below closed, its port brings a module in.
Topology::Pass Topology::match() {
  for (std::uint8_t m = graph_.count; m-- > 0;) {
    for (std::uint8_t p = 0; p < 3; ++p) {
      if (!open_end(m, p)) continue;
      if (const Pass result = match_end(m, p); result != Pass::kDone) return result;
    }
  }
  return Pass::kDone;
}

Topology::Pass Topology::match_end(std::uint8_t module, std::uint8_t port) {
  std::uint16_t candidates = 0;
  for (std::uint8_t d = 0; d < graph_.count; ++d) {
    if (d == module || !below(d, module)) continue;
    for (std::uint8_t q = 0; q < 3; ++q) {
      if (open_end(d, q)) candidates = with(candidates, d);
    }
  }
  if (candidates == 0) return Pass::kDone;
  const auto down = brings_module(module, port, kNoModule);
  if (!down) return Pass::kAgain;
  if (!*down) return Pass::kDone;
  // Lower modules first: the first branch without which the port brings a module in begins with the far end.
  std::uint16_t tested = 0;
  for (std::uint8_t d = graph_.count; d-- > 0;) {
    if (!has(candidates, d)) continue;
    // The far end may be a port whose enable is broken, which is no candidate; then no branch below a candidate may hold it.
    for (std::uint8_t c = 0; c < graph_.count; ++c) {
      if (parent_[c].module != d || has(tested, c)) continue;
      const auto lower = brings_module(module, port, c);
      if (!lower) return Pass::kAgain;
      if (*lower) return leave(module, port);
    }
    const auto here = brings_module(module, port, d);
    if (!here) return Pass::kAgain;
    tested = with(tested, d);
    if (!*here) continue;
    return join_here(module, port, d);
  }
  return leave(module, port);
}

Topology::Pass Topology::leave(std::uint8_t module, std::uint8_t port) {
  port_[module][port] = Port::kBad;
  return Pass::kDone;
}

// `far` has just come in through the port, under its own number: its input port is the one whose enable does nothing.
Topology::Pass Topology::join_here(std::uint8_t module, std::uint8_t port, std::uint8_t far) {
  std::uint8_t spare = 0;
  while (spare + 1U < layout::kMaxModules && has(chain_.members(), spare)) ++spare;
  for (std::uint8_t q = 0; q < 3; ++q) {
    if (!open_end(far, q)) continue;
    if (chain_.open(far, q, spare) == ChainDriver::Answer::kUnchanged) {
      join({module, port}, {far, q});
      return Pass::kDone;
    }
    if (!brings_module(module, port, far).value_or(false)) return Pass::kAgain;
  }
  return leave(module, port);
}

std::optional<bool> Topology::brings_module(std::uint8_t module, std::uint8_t port, std::uint8_t left_out) {
  // Numbers are in the order of the chain: all before this module stay, so that only the branch left out can come in.
  std::uint16_t wanted = 0;
  for (std::uint8_t m = 0; m <= module; ++m) wanted = with(wanted, m);
  std::uint8_t child = left_out;
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    if (m == module || !below(m, module)) continue;
    std::uint8_t top = m;
    while (parent_[top].module != module) top = parent_[top].module;
    // Branches of later ports lie behind the probed one in the chain: they stay closed.
    const bool before = parent_[top].port < port;
    if (left_out == kNoModule) child = child == kNoModule ? m : child;
    else if (before && !below(m, left_out)) wanted = with(wanted, m);
  }
  if (child == kNoModule || !rebuild(wanted, false)) return std::nullopt;
  const ChainDriver::Answer answer = chain_.open(module, port, child);
  if (answer == ChainDriver::Answer::kModule) return true;
  if (answer == ChainDriver::Answer::kRefused) return false;
  return std::nullopt;
}

// Opens the tree level by level, one latch a level.
bool Topology::rebuild(std::uint16_t wanted, bool set_slots) {
  if (!chain_.restart()) return false;
  if (set_slots) chain_.set_slot(0, slot_[0]);
  std::uint16_t in = 1;
  for (;;) {
    std::uint16_t added = 0;
    for (std::uint8_t m = 1; m < graph_.count; ++m) {
      if (!has(wanted, m) || has(in, m) || parent_[m].module == kNoModule || !has(in, parent_[m].module)) continue;
      chain_.attach(parent_[m].module, parent_[m].port, m);
      if (set_slots) chain_.set_slot(m, slot_[m]);
      added = with(added, m);
    }
    if (!chain_.write()) return false;
    if (added == 0) return chain_.settle() && chain_.check();
    if (!chain_.measured()) return false;
    in = static_cast<std::uint16_t>(in | added);
  }
}

Topology::Report Topology::heal(const PatchGraph& table, const std::array<Slot, layout::kMaxModules>& slots) {
  Report report = discover();
  if (!report.complete) return report;
  identify(table, report);
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    if (table_index_[m] != kNoModule) slot_[m] = slots[table_index_[m]];
  }
  report.complete = least_depth_tree(report);
  if (!report.complete) {
    (void)chain_.restart();  // nothing of a half-open tree may answer
    return report;
  }
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    if (has(chain_.members(), m) && table_index_[m] != kNoModule) report.alive = with(report.alive, table_index_[m]);
  }
  return report;
}

// Modules have no name: they are what lies behind the same ports as in the table.
void Topology::identify(const PatchGraph& table, Report& report) {
  table_index_.fill(kNoModule);
  if (table.count == 0 || graph_.cable_port != table.cable_port) {
    report.unknown = graph_.count;
    return;
  }
  std::uint16_t used = 1;
  table_index_[0] = 0;
  for (std::uint8_t m = 1; m < graph_.count; ++m) {
    const std::uint8_t above = table_index_[parent_[m].module];
    const JointEnd expected = above == kNoModule ? JointEnd{} : table.joint[above][parent_[m].port];
    if (expected.module >= table.count || expected.port != input_[m] || has(used, expected.module)) {
      ++report.unknown;
      continue;
    }
    table_index_[m] = expected.module;
    used = with(used, expected.module);
  }
}

bool Topology::least_depth_tree(Report& report) {
  const auto as_found = parent_;
  std::array<std::uint8_t, layout::kMaxModules> queue{}, depth{};
  std::size_t n = 0;
  std::uint16_t wanted = 0;
  if (table_index_[0] == kNoModule) return false;
  queue[n++] = 0;
  wanted = 1;
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint8_t m = queue[k];
    for (std::uint8_t p = 0; p < 3; ++p) {
      const std::uint8_t other = graph_.joint[m][p].module;
      if (other == kNoModule || has(wanted, other) || table_index_[other] == kNoModule) continue;
      wanted = with(wanted, other);
      parent_[other] = {m, p};
      depth[other] = static_cast<std::uint8_t>(depth[m] + 1);
      report.max_depth = depth[other];
      queue[n++] = other;
    }
  }
  if (rebuild(wanted, true) && chain_.stuck_lines() == 0) return true;
  parent_ = as_found;  // every one of these joints has just carried a module
  report.least_depth = false;
  return rebuild(wanted, true) && chain_.stuck_lines() == 0;
}

}  // namespace triskin::fw
