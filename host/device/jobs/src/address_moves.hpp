// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>

#include "triskin/session/bus.hpp"

namespace triskin::device {

/// Gives controllers new node addresses, by unique id. Returns when each has said its own: two that share one would
/// both take the table of one patch, and none of them could be asked afterwards whose it is. Throws DeviceError when
/// one does not.
void assign_addresses(Bus& bus, std::map<wire::UniqueId, int> wanted);

}  // namespace triskin::device
