// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/services.hpp"

namespace triskin::bridge {
namespace {

using recording::CdrWriter;

template <class Items, class Put>
void put_all(CdrWriter& w, const Items& items, Put put) {
  w.count(items.size());
  for (const auto& item : items) put(item);
}
void put_numbers(CdrWriter& w, const std::vector<std::int32_t>& numbers) {
  put_all(w, numbers, [&](std::int32_t v) { w.u32(static_cast<std::uint32_t>(v)); });
}
void put_texts(CdrWriter& w, const std::vector<std::string>& texts) {
  put_all(w, texts, [&](const std::string& t) { w.text(t); });
}
void put_outcome(CdrWriter& w, bool success, const std::string& message) {
  w.u8(success ? 1 : 0);
  w.text(message);
}

}  // namespace

// The definitions are equal to the files in host/output/bridge/ros/triskin_msgs/srv, which tests/output/bridge checks.
const std::string_view Tare::kDefinition =
    "# Takes the present values of the taxels for those of a skin that nobody touches\n"
    "---\n"
    "bool success\n"
    "string message           # what failed, and the remedy\n"
    "uint32 taxels            # that have a value at rest now\n";

const std::string_view Reroute::kDefinition =
    "# Lets controllers find modules and joints anew and open a tree; sampling rests up to 80 ms meanwhile\n"
    "int32 patch              # -1: all of the cover\n"
    "---\n"
    "bool success\n"
    "string message           # what failed, and the remedy\n"
    "int32[] patch            # that were asked\n"
    "int32[] modules          # in the tree of each, -1: its modules have no switches\n";

const std::string_view Identify::kDefinition =
    "# Which controllers serve the cover, as they say themselves\n"
    "---\n"
    "bool success\n"
    "string message           # what failed, and the remedy\n"
    "uint64 design_id         # of the design that is published\n"
    "int32[] patch            # of each controller that answered\n"
    "uint8[] node             # its address\n"
    "string[] serial          # its unique id\n"
    "string[] firmware        # its version\n"
    "uint64[] table_id        # design of the table that it holds, 0: none\n";

void Tare::Answer::write(CdrWriter& w) const {
  put_outcome(w, success, message);
  w.u32(taxels);
}

void Reroute::Answer::write(CdrWriter& w) const {
  put_outcome(w, success, message);
  put_numbers(w, patch);
  put_numbers(w, modules);
}

void Identify::Answer::write(CdrWriter& w) const {
  put_outcome(w, success, message);
  w.u64(design_id);
  put_numbers(w, patch);
  put_all(w, node, [&](std::uint8_t v) { w.u8(v); });
  put_texts(w, serial);
  put_texts(w, firmware);
  put_all(w, table_id, [&](std::uint64_t v) { w.u64(v); });
}

}  // namespace triskin::bridge
