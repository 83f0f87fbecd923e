// SPDX-License-Identifier: Apache-2.0
// Handles modules of other patches on the tree of this one.
#include <bit>

#include "triskin/logic/switched/topology.hpp"

namespace triskin::fw {

// Returns true if the tree contains every module of the table and nothing else.
bool Topology::may_adopt(const Table& table, const Report& report) const {
  if (!report.complete || report.unknown > 0 || graph_.count != table.graph.count) return false;
  return chain_.members() == (1U << graph_.count) - 1U;
}

// Extends the active tree layer by layer. The own modules and the earlier adopted ones are already held, so a module
// that comes in is new. Each gets an address that no row of the table has, because a module of the table that comes
// back must find its own free. Returns false if the tree is no longer active, and then there are no adopted modules.
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
        report.more_adopted = true;
        continue;
      }
      const auto place = static_cast<std::uint8_t>(std::countr_one(taken));
      up = take_in(m, p, place);
      if (port_[m][p] == Port::kChild) take(place);
    }
  }
  adopted_count_ = static_cast<std::uint8_t>(graph_.count - own);
  if (up && (adopted_count_ == 0 || (chain_.settle() && chain_.check() && lines_free()))) return true;
  release_adopted();
  return false;
}

void Topology::release_adopted() {
  graph_.count = static_cast<std::uint8_t>(graph_.count - adopted_count_);
  adopted_count_ = 0;
  for (auto& ends : graph_.joint) {
    for (JointEnd& e : ends) {
      if (e.module >= graph_.count) e = {};
    }
  }
}

// Returns false if the tree is no longer active.
bool Topology::take_in(std::uint8_t module, std::uint8_t port, std::uint8_t place) {
  const std::uint8_t adopted_module = graph_.count;
  if (chain_.open(module, port, adopted_module) != ChainDriver::Answer::kModule) {  // The module came in elsewhere.
    port_[module][port] = Port::kNothing;
    return rebuild_all();
  }
  ++graph_.count;
  parent_[adopted_module] = {module, port};
  input_[adopted_module] = kNoModule;
  address_[adopted_module] = {static_cast<std::uint8_t>(place / layout::kAddressesPerLine),
                              static_cast<std::uint8_t>(place % layout::kAddressesPerLine)};
  // All rows of the table are in use, and adopted modules follow them.
  table_index_[adopted_module] = adopted_module;
  chain_.set_address(adopted_module, address_[adopted_module]);
  bool up = lines_free();
  for (std::uint8_t p = 0; up && p < layout::kPorts; ++p) up = ask(adopted_module, p);
  if (up && input_[adopted_module] != kNoModule) {
    join({module, port}, {adopted_module, input_[adopted_module]});
    port_[module][port] = Port::kChild;
    return true;
  }
  parent_[adopted_module] = {};
  table_index_[adopted_module] = kNoModule;
  --graph_.count;
  port_[module][port] = Port::kBad;
  return rebuild_all();
}

// Finds out what a port of an adopted module leads to. The module lies anywhere in the chain; if nothing comes in, the
// chain is broken there, and the registers behind it must not be latched. Returns false if the tree is no longer
// active.
bool Topology::ask(std::uint8_t adopted_module, std::uint8_t port) {
  const auto answer = chain_.open(adopted_module, port, graph_.count);
  port_[adopted_module][port] = Port::kNothing;
  if (answer == ChainDriver::Answer::kModule) {
    port_[adopted_module][port] = Port::kBeyond;
  } else if (answer == ChainDriver::Answer::kUnchanged) {
    port_[adopted_module][port] = Port::kInput;
    if (input_[adopted_module] == kNoModule) input_[adopted_module] = port;
  } else {
    return rebuild_all();
  }
  return chain_.shut(adopted_module, port) || rebuild_all();
}

wire::AdoptedModule Topology::adopted_module(std::uint8_t k) const {
  const auto module = static_cast<std::uint8_t>(graph_.count - adopted_count_ + k);
  const auto [above, port] = parent_[module];
  const LineAddress a = address_[module];
  return {table_index_[above], port, input_[module],
          static_cast<std::uint8_t>(a.line * layout::kAddressesPerLine + a.address)};
}

}  // namespace triskin::fw
