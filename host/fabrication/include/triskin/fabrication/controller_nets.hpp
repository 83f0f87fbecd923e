// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace triskin::fabrication {

/// One pin of a component and the net that it belongs to.
struct NetPin {
  std::string net;
  std::string component;  ///< It is its reference, such as U1.
  std::string value;      ///< It is what the component is, such as STM32G474RET6.
  std::string pin;        ///< It is the name in the component's data sheet, such as PA15, or the number in a connector.
};

/// The circuit of a patch controller that runs the firmware for NUCLEO-G474RE: microcontroller, CAN FD transceiver, the
/// cable to the skin, USB, pull-ups of the lines, program connector, light. A proposal: none was built. Supply,
/// protection and decoupling are not in it. Sorted by net, component and pin.
[[nodiscard]] std::vector<NetPin> controller_nets();

/// The circuit as CSV (RFC 4180): net,component,value,pin. Cost: constant.
[[nodiscard]] std::string controller_csv();

}  // namespace triskin::fabrication
