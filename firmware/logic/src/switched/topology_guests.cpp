// SPDX-License-Identifier: Apache-2.0
// Modules of other patches on the tree of this one.
#include <bit>

#include "triskin/logic/switched/topology.hpp"

namespace triskin::fw {

// Every module of the table is in the tree, and nothing else.
bool Topology::may_adopt(const Table& table, const Report& report) const {
  if (!report.complete || report.unknown > 0 || graph_.count != table.graph.count) return false;
  return chain_.members() == (1U << graph_.count) - 1U;
}

// Onto the active tree, layer by layer: one after the other finds the own modules and the guests before it held, so
// what comes in is new. Each gets an address that no row of the table has: a module of the table that comes back must
// find its own free. False: the tree is not up any more, and there are no guests.
bool Topology::adopt(const Table& table, std::uint8_t layers, Report& report) {
  std::uint16_t taken = 0;
  const auto take = [&taken](int place) { taken = static_cast<std::uint16_t>(taken | 1U << place); };
  for (std::uint8_t row = 0; row < table.graph.count; ++row) {
    const LineAddress a = table.addresses[row];
    take(a.line * layout::kAddressesPerLine + a.address);
  }
  const std::uint8_t own = graph_.count;
  std::uint8_t layer_end = own;
  bool up = true;
  for (std::uint8_t m = 0; up && m < graph_.count; ++m) {
    if (m == layer_end) {
      layer_end = graph_.count;
      --layers;
    }
    for (std::uint8_t p = 0; up && p < layout::kPorts; ++p) {
      if (port_[m][p] != Port::kBeyond || graph_.count == layout::kMaxModules) continue;
      if (layers == 0) {
        report.more_guests = true;
        continue;
      }
      const auto place = static_cast<std::uint8_t>(std::countr_one(taken));
      up = take_in(m, p, place);
      if (port_[m][p] == Port::kChild) take(place);
    }
  }
  guest_count_ = static_cast<std::uint8_t>(graph_.count - own);
  if (up && (guest_count_ == 0 || (chain_.settle() && chain_.check() && lines_free()))) return true;
  release_guests();
  return false;
}

void Topology::release_guests() {
  graph_.count = static_cast<std::uint8_t>(graph_.count - guest_count_);
  guest_count_ = 0;
  for (auto& ends : graph_.joint) {
    for (JointEnd& e : ends) {
      if (e.module >= graph_.count) e = {};
    }
  }
}

// False: the tree is not up any more.
bool Topology::take_in(std::uint8_t module, std::uint8_t port, std::uint8_t place) {
  const std::uint8_t guest = graph_.count;
  if (chain_.open(module, port, guest) != ChainDriver::Answer::kModule) {  // it came in elsewhere
    port_[module][port] = Port::kNothing;
    return rebuild_all();
  }
  ++graph_.count;
  parent_[guest] = {module, port};
  input_[guest] = kNoModule;
  address_[guest] = {static_cast<std::uint8_t>(place / layout::kAddressesPerLine),
                     static_cast<std::uint8_t>(place % layout::kAddressesPerLine)};
  table_index_[guest] = guest;  // every row of the table is in: guests are the rows behind them
  chain_.set_address(guest, address_[guest]);
  bool up = lines_free();
  for (std::uint8_t p = 0; up && p < layout::kPorts; ++p) up = ask(guest, p);
  if (up && input_[guest] != kNoModule) {
    join({module, port}, {guest, input_[guest]});
    port_[module][port] = Port::kChild;
    return true;
  }
  parent_[guest] = {};
  table_index_[guest] = kNoModule;
  --graph_.count;
  port_[module][port] = Port::kBad;
  return rebuild_all();
}

// What a port of a guest leads to. It lies anywhere in the chain: where nothing comes in the chain is broken there, and
// what the registers behind it have must not be latched. False: the tree is not up any more.
bool Topology::ask(std::uint8_t guest, std::uint8_t port) {
  const auto answer = chain_.open(guest, port, graph_.count);
  port_[guest][port] = Port::kNothing;
  if (answer == ChainDriver::Answer::kModule) {
    port_[guest][port] = Port::kBeyond;
  } else if (answer == ChainDriver::Answer::kUnchanged) {
    port_[guest][port] = Port::kInput;
    if (input_[guest] == kNoModule) input_[guest] = port;
  } else {
    return rebuild_all();
  }
  return chain_.shut(guest, port) || rebuild_all();
}

wire::Guest Topology::guest(std::uint8_t k) const {
  const auto module = static_cast<std::uint8_t>(graph_.count - guest_count_ + k);
  const auto [above, port] = parent_[module];
  const LineAddress a = address_[module];
  return {table_index_[above], port, input_[module],
          static_cast<std::uint8_t>(a.line * layout::kAddressesPerLine + a.address)};
}

}  // namespace triskin::fw
