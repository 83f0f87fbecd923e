// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/switched/topology.hpp"

namespace triskin::fw {
namespace {

constexpr int kMaxPasses = 64;  // Every pass but the last leaves one more port closed, and there are 48 ports.

constexpr bool has(std::uint16_t set, std::uint8_t k) {
  return ((set >> k) & 1U) != 0;
}
constexpr std::uint16_t with(std::uint16_t set, std::uint8_t k) {
  return static_cast<std::uint16_t>(set | (1U << k));
}

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

Topology::Report Topology::discover(const Table* table, Look look) {
  Report report;
  expected_table_ = table;
  look_ = table == nullptr ? Look::kBeyond : look;
  bad_.fill(0);
  shorts_ = 0;
  bool asked_again = false;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    Pass result = explore();
    if (result == Pass::kDone) result = match();
    if (result == Pass::kAgain) continue;
    // An end without a partner means a broken enable, or a flipped bit.
    if (result == Pass::kDone && !asked_again && (ends_left_ > 0 || open_ends() > 1)) {
      asked_again = true;
      continue;
    }
    report.complete = result == Pass::kDone;
    break;
  }
  report.shorts = shorts_;
  report.second_cable = second_cable();
  return report;
}

Topology::Pass Topology::explore() {
  graph_ = {};
  ends_left_ = 0;
  input_.fill(kNoModule);
  inputs_.fill(0);
  parent_.fill({});
  for (auto& p : port_) p.fill(Port::kUnknown);
  cable_ = first_tried_;
  entry_held_ = false;
  if (!chain_.restart(cable_)) {
    entry_held_ = cable_ == 0 && chain_.refused();
    cable_ ^= 1U;
    if (!chain_.restart(cable_)) return Pass::kNobody;
  }
  held_lines_ = chain_.stuck_lines();  // Excluding ports could not free these lines.
  graph_.count = 1;
  expected_[0] = expected_cable().module;
  std::array<std::uint8_t, layout::kMaxModules> next{};
  std::uint8_t m = 0;
  for (;;) {
    if (next[m] == layout::kPorts) {
      if (input_[m] == kNoModule) {  // Either something has changed, or the module is turned compared to the table.
        if (look_ == Look::kOwn) look_ = Look::kBeyond;
        return Pass::kAgain;
      }
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
  const bool beyond = look_ != Look::kBeyond && expected_[module] != kNoModule && !within_table(module, port);
  if (beyond && look_ == Look::kOwn) {
    port_[module][port] = Port::kNothing;
    return Pass::kDone;
  }
  const bool full = graph_.count == layout::kMaxModules;
  const std::uint8_t child = graph_.count;
  // A port that brings no module in is asked until two answers agree, because a flipped bit could have opened another
  // port.
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
    if (!lines_free()) {  // A module that holds a line low stays outside.
      exclude(module, port);
      return Pass::kAgain;
    }
    // A seventeenth module also stays outside and is released at once, because a joined patch has such a module behind
    // every port of its border. Only when all own modules are in the chain is it known to be none of them.
    if (full || beyond) {
      port_[module][port] = Port::kBeyond;
      return chain_.shut(module, port) ? Pass::kDone : Pass::kAgain;
    }
    port_[module][port] = Port::kChild;
    parent_[child] = {module, port};
    expect(child);
    ++graph_.count;
    return Pass::kDone;
  }
  note_answer(module, port, answer == before ? answer : ChainDriver::Answer::kLost, beyond);
  return Pass::kDone;
}

// Records what a port leads to if it brings no module in. `beyond` says that the table has no joint there.
void Topology::note_answer(std::uint8_t module, std::uint8_t port, ChainDriver::Answer answer, bool beyond) {
  switch (answer) {
    case ChainDriver::Answer::kRefused:
      port_[module][port] = beyond ? Port::kNothing : Port::kJoined;  // The module's own controller holds it.
      break;
    case ChainDriver::Answer::kNothing:
      port_[module][port] = Port::kNothing;
      break;
    case ChainDriver::Answer::kUnchanged:
      note_input(module, port);
      break;
    default:
      port_[module][port] = Port::kBad;
  }
}

// Returns row and port of the cable through which explore() entered.
JointEnd Topology::expected_cable() const {
  if (expected_table_ == nullptr) return {};
  return cable_ == 1 ? expected_table_->second_entry : JointEnd{0, expected_table_->graph.cable_port};
}

// Returns true if the table has a joint, or the cable, at this port of a module whose row is expected.
bool Topology::within_table(std::uint8_t module, std::uint8_t port) const {
  if (expected_[module] == kNoModule) return false;
  return (module == 0 && port == expected_cable().port) ||
         expected_table_->graph.joint[expected_[module]][port].module != kNoModule;
}

void Topology::expect(std::uint8_t child) {
  const auto [module, port] = parent_[child];
  expected_[child] =
      expected_[module] == kNoModule ? kNoModule : expected_table_->graph.joint[expected_[module]][port].module;
}

// Only one port is the input. If a second one does nothing when enabled, one of the two is broken, but it is not
// visible which. The joint to the parent stays out of the graph until the table resolves it.
void Topology::note_input(std::uint8_t module, std::uint8_t port) {
  inputs_[module] = static_cast<std::uint8_t>(inputs_[module] | (1U << port));
  if (input_[module] == kNoModule) {
    port_[module][port] = Port::kInput;
    input_[module] = port;
    if (module == 0)
      graph_.cable_port = port;
    else
      join(parent_[module], {module, port});
    return;
  }
  port_[module][port] = Port::kBad;
  if (module == 0) return;
  graph_.joint[module][input_[module]] = {};
  graph_.joint[parent_[module].module][parent_[module].port] = {};
}

// Resolves modules below a known one: behind its port is the module of the table, if one of the possible input ports
// fits.
void Topology::resolve_inputs(const PatchGraph& table, std::uint8_t module) {
  for (std::uint8_t c = 1; c < graph_.count; ++c) {
    const std::uint8_t port = parent_[c].port;
    if (parent_[c].module != module || graph_.joint[module][port].module != kNoModule) continue;
    const JointEnd expected = table.joint[table_index_[module]][port];
    if (expected.module < table.count && has(inputs_[c], expected.port)) join({module, port}, {c, expected.port});
  }
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

int Topology::open_ends() const {
  int ends = 0;
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    for (std::uint8_t p = 0; p < layout::kPorts; ++p) ends += open_end(m, p) ? 1 : 0;
  }
  return ends;
}

// The search is depth first, so a joint that closes a cycle leads from a module to one above it. The upper end can find
// out whether there is a module below: with the branch below closed, its port brings a module in.
Topology::Pass Topology::match() {
  for (std::uint8_t m = graph_.count; m-- > 0;) {
    for (std::uint8_t p = 0; p < layout::kPorts; ++p) {
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
    for (std::uint8_t q = 0; q < layout::kPorts; ++q) {
      if (open_end(d, q)) candidates = with(candidates, d);
    }
  }
  if (candidates == 0) return Pass::kDone;
  const auto down = brings_module(module, port, kNoModule);
  if (!down) return Pass::kAgain;
  if (!*down) return Pass::kDone;
  // Lower modules are tested first: the first branch without which the port brings a module in begins with the far end.
  std::uint16_t tested = 0;
  for (std::uint8_t d = graph_.count; d-- > 0;) {
    if (!has(candidates, d)) continue;
    // The far end may be a port with a broken enable, which is no candidate; then no branch below a candidate may
    // contain it.
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
  ++ends_left_;
  port_[module][port] = Port::kBad;
  return Pass::kDone;
}

// `far` has just come in through the port, under its own number; its input port is the one that does nothing when
// enabled.
Topology::Pass Topology::join_here(std::uint8_t module, std::uint8_t port, std::uint8_t far) {
  std::uint8_t spare = 0;
  while (spare + 1U < layout::kMaxModules && has(chain_.members(), spare)) ++spare;
  for (std::uint8_t q = 0; q < layout::kPorts; ++q) {
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
  // Numbers follow the order of the chain. All modules before this one stay, so that only the omitted branch can come
  // in.
  std::uint16_t wanted = 0;
  for (std::uint8_t m = 0; m <= module; ++m) wanted = with(wanted, m);
  std::uint8_t child = left_out;
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    if (m == module || !below(m, module)) continue;
    std::uint8_t top = m;
    while (parent_[top].module != module) top = parent_[top].module;
    // Branches of later ports are behind the probed one in the chain, so they stay closed.
    const bool before = parent_[top].port < port;
    if (left_out == kNoModule)
      child = child == kNoModule ? m : child;
    else if (before && !below(m, left_out))
      wanted = with(wanted, m);
  }
  if (child == kNoModule || !rebuild(wanted, false)) return std::nullopt;
  const ChainDriver::Answer answer = chain_.open(module, port, child);
  if (answer == ChainDriver::Answer::kModule) return true;
  if (answer == ChainDriver::Answer::kRefused) return false;
  return std::nullopt;
}

// Opens the tree level by level, with one latch per level.
bool Topology::rebuild(std::uint16_t wanted, bool set_addresses) {
  if (!chain_.restart(cable_)) return false;
  if (set_addresses) chain_.set_address(0, address_[0]);
  std::uint16_t in = 1;
  for (;;) {
    std::uint16_t added = 0;
    for (std::uint8_t m = 1; m < graph_.count; ++m) {
      if (!has(wanted, m) || has(in, m) || parent_[m].module == kNoModule || !has(in, parent_[m].module)) continue;
      chain_.attach(parent_[m].module, parent_[m].port, m);
      if (set_addresses) chain_.set_address(m, address_[m]);
      added = with(added, m);
    }
    if (!chain_.write()) return false;
    if (added == 0) return chain_.settle() && chain_.check();
    if (!chain_.measured()) return false;
    in = static_cast<std::uint16_t>(in | added);
  }
}

Topology::Table Topology::table_of(const layout::PatchImage& image) {
  Table table;
  table.graph.count = image.module_count;
  if (image.second_entry != 0) table.second_entry = layout::joint_end(image.second_entry);
  const bool given = layout::has_joints(image);
  const auto row = [](std::uint8_t k) { return static_cast<std::size_t>(k); };
  for (std::uint8_t k = 0; k < image.module_count; ++k) {
    const layout::ModuleRow& m = image.modules[k];
    table.addresses[k] = {m.line, m.address};
    for (std::uint8_t p = 0; p < layout::kPorts && given; ++p) {
      if (m.joints[p] != 0) table.graph.joint[k][p] = layout::joint_end(m.joints[p]);
    }
    if (k == 0) continue;
    table.parent[k] = {m.parent, m.parent_port};
    if (given) continue;
    table.graph.joint[k][0] = table.parent[k];
    table.graph.joint[row(m.parent)][m.parent_port] = {k, 0};
  }
  return table;
}

Topology::Report Topology::reroute(const Table& table, Look look, std::uint8_t layers) {
  adopted_count_ = 0;
  if (look == Look::kAdopt && table.graph.count == layout::kMaxModules) look = Look::kOwn;  // No address is free.
  Report report = find(table, look);
  if (more_behind_second(table, report)) {
    const std::uint8_t unknown = report.unknown, count = graph_.count;
    first_tried_ = 1;
    report = find(table, look);
    first_tried_ = 0;
    if (graph_.count - report.unknown < count - unknown) report = find(table, look);
  }
  report.held = held_rows(table);
  if (report.complete) {
    for (std::uint8_t m = 0; m < graph_.count; ++m) {
      if (table_index_[m] != kNoModule) address_[m] = table.addresses[table_index_[m]];
    }
    report.complete = activate(table, report);
    // Another controller took one, or it broke; the own modules have priority.
    if (look == Look::kAdopt && may_adopt(table, report) && !adopt(table, layers, report))
      report.complete = activate(table, report);
  }
  if (!report.complete) {
    chain_.silence();  // A half-open tree must not answer.
    return report;
  }
  for (std::uint8_t m = 0; m < graph_.count - adopted_count_; ++m) {
    if (!has(chain_.members(), m))
      parent_[m] = {};
    else if (table_index_[m] != kNoModule)
      report.alive = with(report.alive, table_index_[m]);
  }
  report.max_depth = depth();
  return report;
}

Topology::Report Topology::find(const Table& table, Look look) {
  Report report = discover(&table, look);
  table_index_.fill(kNoModule);
  if (report.complete) identify(table, report);
  return report;
}

// A port refuses where the table has a joint to a module that is not in the tree: the module works and is held by
// another controller.
std::uint16_t Topology::held_rows(const Table& table) const {
  std::uint16_t found = 0, held = entry_held_ ? 1 : 0;
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    const std::uint8_t row = table_index_[m];
    if (row == kNoModule) continue;
    found = with(found, row);
    for (std::uint8_t p = 0; p < layout::kPorts; ++p) {
      const std::uint8_t other = table.graph.joint[row][p].module;
      if (other < table.graph.count && open_end(m, p)) held = with(held, other);
    }
  }
  return static_cast<std::uint16_t>(held & ~found);
}

bool Topology::more_behind_second(const Table& table, const Report& report) const {
  if (!report.complete || report.second_cable || table.second_entry.module >= table.graph.count) return false;
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    if (table_index_[m] == table.second_entry.module) return false;
  }
  return 2 * (graph_.count - report.unknown) < table.graph.count;
}

bool Topology::in_table(const PatchGraph& table, std::uint8_t module, std::uint8_t port) const {
  const JointEnd found = graph_.joint[module][port];
  if (found.module == kNoModule || table_index_[module] == kNoModule) return false;
  const JointEnd expected = table.joint[table_index_[module]][port];
  return expected.module < table.count && expected.port == found.port && table_index_[found.module] == expected.module;
}

// Modules have no names; they are identified by lying behind the same ports as in the table.
void Topology::identify(const Table& whole, Report& report) {
  const PatchGraph& table = whole.graph;
  const JointEnd cable = report.second_cable ? whole.second_entry : JointEnd{0, table.cable_port};
  report.unknown = graph_.count;
  if (cable.module >= table.count || !has(inputs_[0], cable.port)) return;
  graph_.cable_port = cable.port;
  std::array<std::uint8_t, layout::kMaxModules> queue{};
  std::size_t n = 0;
  auto used = with(0, cable.module);
  table_index_[0] = cable.module;
  queue[n++] = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint8_t m = queue[k];
    resolve_inputs(table, m);
    for (std::uint8_t p = 0; p < layout::kPorts; ++p) {
      const JointEnd found = graph_.joint[m][p], expected = table.joint[table_index_[m]][p];
      if (found.module == kNoModule || table_index_[found.module] != kNoModule) continue;
      if (expected.module >= table.count || expected.port != found.port || has(used, expected.module)) continue;
      table_index_[found.module] = expected.module;
      used = with(used, expected.module);
      queue[n++] = found.module;
    }
  }
  report.unknown = static_cast<std::uint8_t>(graph_.count - n);
}

// Returns false if a module or a joint of the table's tree is missing.
bool Topology::table_tree(const Table& table) {
  if (cable_ != 0) return false;
  std::array<std::uint8_t, layout::kMaxModules> number{};
  number.fill(kNoModule);
  for (std::uint8_t m = 0; m < graph_.count; ++m) {
    if (table_index_[m] != kNoModule) number[table_index_[m]] = m;
  }
  for (std::uint8_t row = 1; row < table.graph.count; ++row) {
    const JointEnd above = table.parent[row];
    if (above.module >= table.graph.count || number[row] == kNoModule || number[above.module] == kNoModule)
      return false;
    if (graph_.joint[number[above.module]][above.port].module != number[row]) return false;
    parent_[number[row]] = {number[above.module], above.port};
  }
  return number[0] != kNoModule;
}

// Returns false if no module of the table exists.
bool Topology::min_depth_tree(const Table& table) {
  std::array<std::uint8_t, layout::kMaxModules> queue{};
  std::size_t n = 0;
  if (table_index_[0] == kNoModule) return false;
  std::uint16_t wanted = 1;
  queue[n++] = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint8_t m = queue[k];
    for (std::uint8_t p = 0; p < layout::kPorts; ++p) {
      const std::uint8_t other = graph_.joint[m][p].module;
      if (!in_table(table.graph, m, p) || has(wanted, other)) continue;
      wanted = with(wanted, other);
      parent_[other] = {m, p};
      queue[n++] = other;
    }
  }
  for (std::uint8_t m = 1; m < graph_.count; ++m) {
    if (!has(wanted, m)) parent_[m] = {};
  }
  return true;
}

bool Topology::activate(const Table& table, Report& report) {
  const auto as_found = parent_;
  const auto up = [&] {
    for (std::uint8_t m = 1; m < graph_.count; ++m) {
      if (table_index_[m] == kNoModule) parent_[m] = {};
    }
    return rebuild_all() && lines_free();
  };
  if (!min_depth_tree(table)) return false;
  const std::uint8_t least = depth();
  const auto shallow = parent_;
  if (table_tree(table) && up()) {
    report.as_table = true;
    report.min_depth = depth() == least;
    return true;
  }
  parent_ = shallow;
  if (up()) {
    report.min_depth = true;
    return true;
  }
  parent_ = as_found;  // Each of these joints has just carried a module.
  return up();
}

// Returns the depth of the tree in parent_.
std::uint8_t Topology::depth() const {
  std::uint8_t deepest = 0;
  for (std::uint8_t m = 1; m < graph_.count; ++m) {
    std::uint8_t d = 0;
    std::uint8_t at = m;
    while (at != 0 && at != kNoModule && d < layout::kMaxModules) {
      at = parent_[at].module;
      ++d;
    }
    if (at == 0) deepest = d > deepest ? d : deepest;
  }
  return deepest;
}

}  // namespace triskin::fw
