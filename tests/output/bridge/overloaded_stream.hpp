// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/bridge/bridge.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::bridge {

/// Streams every sample for `us` into the bridge, including those that the bus cannot carry, and flushes it; the link's
/// time 0 is `start_ns`. Returns the report of the stream.
inline session::StreamReport stream_overloaded(session::Bus& bus, const design::Design& design, Bridge& bridge,
                                               std::uint64_t us, std::uint64_t start_ns) {
  session::StreamOptions overload;
  overload.every = 1;
  overload.overload = true;
  session::Stream stream(
      bus, design,
      [&](const session::ModuleSample& f) {
        bridge.add({f.module, f.link_time_us, f.sample, start_ns + f.sampled.link_us * 1000, f.sampled.error_us});
      },
      overload);
  stream.run_until(bus.now_us() + us);
  stream.finish();
  bridge.flush();
  return stream.report();
}

}  // namespace triskin::bridge
