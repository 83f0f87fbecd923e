// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/icub_skin.hpp"

#include "receive.hpp"

namespace triskin::skin {

IcubSkin::IcubSkin(const connect::LinkOptions& link, const design::Design* design)
    : link_(connect::open_link(link, design)),
      bus_(*link_),
      stream_(bus_, [this](const wire::IcubTaxels& t) { triangles_[{t.board, t.module}] = t; }) {}

void IcubSkin::run(const LiveRun& run) {
  receive_slices(run, [this] { return now_us(); }, [this](std::uint64_t until_us) { stream_.run_until(until_us); });
}

}  // namespace triskin::skin
