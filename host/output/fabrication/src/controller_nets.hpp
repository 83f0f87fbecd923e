// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace triskin::fabrication {

/// A pin connects one component to exactly one net.
struct NetPin {
  std::string net;
  std::string component;  ///< The reference designator names the component, such as U1.
  std::string value;      ///< The value names the part type, such as STM32G474RET6.
  std::string pin;        ///< The pin has its data sheet name, such as PA15, or its number in a connector.
};

/// Returns the circuit of a patch controller that runs the NUCLEO-G474RE firmware: microcontroller, CAN FD transceiver,
/// skin cable, USB, pull-ups, program connector and light. The circuit is a proposal that nobody has built; it leaves
/// out supply, protection and decoupling. The pins are sorted by net, component and pin.
[[nodiscard]] std::vector<NetPin> controller_nets();

/// Writes the circuit as CSV (RFC 4180) with the columns net,component,value,pin. Cost: constant.
[[nodiscard]] std::string controller_csv();

}  // namespace triskin::fabrication
