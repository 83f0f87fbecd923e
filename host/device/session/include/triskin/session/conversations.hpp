// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <vector>

#include "triskin/session/bus.hpp"

namespace triskin::device {

/// Requests and answers with one controller, as ordinary code that waits.
struct Conversation {
  std::uint8_t node = 0;           ///< whose answers it hears
  std::function<void(Bus&)> talk;  ///< its Bus is its own
};

/// Holds several conversations over one link: while one waits for an answer, another goes on. They run one at a time
/// and in an order that depends on the link only, so the link needs no locks and a simulated one stays deterministic.
/// Conversations on one wire of the link (Link::wire_of) take turns, `per_wire` of them at once. Returns what each one
/// threw, null: nothing. Link and conversations outlive the call.
[[nodiscard]] std::vector<std::exception_ptr> converse(Link& link, std::span<const Conversation> conversations,
                                                       int per_wire = 1);

}  // namespace triskin::device
