// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/touch_actuator.hpp"

#include "triskin/link/link.hpp"

namespace triskin::link {

TouchActuator* touch_actuator_of(Link& link) {
  return dynamic_cast<TouchActuator*>(&link);
}

}  // namespace triskin::link
