// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/switched/neighbours.hpp"

#include <algorithm>

namespace triskin::fw {

bool Neighbours::any() const {
  return std::ranges::any_of(offers_, [](const Offer& o) { return o.node != 0; });
}

void Neighbours::receive(const wire::Reach& reach, std::uint8_t own_node, bool adopted_modules, std::uint64_t now_us) {
  auto offer = std::ranges::find(offers_, reach.node_address, &Offer::node);
  if (reach.out_of_reach == 0) {
    if (offer != offers_.end()) end(*offer, adopted_modules, now_us);
    return;
  }
  if (offer == offers_.end()) offer = std::ranges::find(offers_, std::uint8_t{0}, &Offer::node);
  if (offer == offers_.end()) return;
  const bool more = (reach.out_of_reach & ~offer->rows) != 0;
  *offer = {reach.node_address, reach.out_of_reach, now_us + kForget_us};
  if (!more) return;
  // Two controllers that search at the same time would take modules from each other, and both would find less.
  if (!adopted_modules) layers_ = 1;
  look_us_ = std::min(look_us_, std::max(now_us, away_until_us_) + kTurn_us * (1U + own_node % kTurns));
}

void Neighbours::tick(bool adopted_modules, std::uint64_t now_us) {
  for (Offer& o : offers_) {
    if (o.node != 0 && now_us >= o.until_us) end(o, adopted_modules, now_us);
  }
}

// This controller does not know who owns the adopted modules, so all are given back, and those that others still offer
// are searched again later.
void Neighbours::end(Offer& offer, bool adopted_modules, std::uint64_t now_us) {
  offer = {};
  away_until_us_ = now_us + kKeepAway_us;
  layers_ = 1;
  if (adopted_modules)
    look_us_ = now_us;
  else if (!any())
    look_us_ = kNever_us;
}

bool Neighbours::begin_look(std::uint64_t now_us) {
  const bool open = any() && now_us >= away_until_us_;
  look_us_ = any() && !open ? away_until_us_ : kNever_us;
  return open;
}

void Neighbours::look_further(std::uint64_t now_us) {
  layers_ = layout::kMaxModules;
  if (any()) look_us_ = now_us + kTurns * kTurn_us;
}

void Neighbours::look_again(std::uint64_t now_us) {
  if (any()) look_us_ = std::max(now_us, away_until_us_) + kTurn_us;
}

}  // namespace triskin::fw
