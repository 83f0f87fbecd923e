// SPDX-License-Identifier: GPL-3.0-or-later
// Replaces dds_fast.cpp if Fast DDS was not installed when the program was built.
#include "triskin/base/error.hpp"
#include "triskin/bridge/dds.hpp"

namespace triskin::bridge {

bool dds_available() {
  return false;
}

std::unique_ptr<Domain> join_domain(std::uint32_t /*id*/, const RosDiscovery& /*discovery*/, const RosNode& /*node*/) {
  throw InputError(
      "bridge: this program was built without DDS; install libfastrtps-dev, then configure and build it again");
}

}  // namespace triskin::bridge
