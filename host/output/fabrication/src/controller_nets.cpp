// SPDX-License-Identifier: GPL-3.0-or-later
#include "controller_nets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "module_board.hpp"
#include "triskin/base/csv_field.hpp"

namespace triskin::fabrication {
namespace {

constexpr const char* kMicrocontroller = "STM32G474RET6";
// docs/routing.md says why: between what a line of a full patch needs and what a converter surely holds low.
constexpr const char* kPullUp = "1.8k";

// Each net has one pin of the microcontroller. The firmware's board header for NUCLEO-G474RE has the same pins, and a
// test compares the two.
struct ControllerPin {
  const char* net;
  const char* pin;
};
constexpr std::array<ControllerPin, 23> kControllerPins{
    {{"SCL0", "PA15"},          {"SDA0", "PB7"},         {"SCL1", "PA9"},       {"SDA1", "PA8"},
     {"SCL2", "PC8"},           {"SDA2", "PC9"},         {"SCL3", "PC6"},       {"SDA3", "PC7"},
     {"CAN_RX", "PB8"},         {"CAN_TX", "PB9"},       {"USB_DM", "PA11"},    {"USB_DP", "PA12"},
     {"SWDIO", "PA13"},         {"SWCLK", "PA14"},       {"LOG_TX", "PA2"},     {"LIGHT", "PA5"},
     {"CHAIN_CLOCK", "PB13"},   {"CHAIN_IN", "PB14"},    {"CHAIN_OUT", "PB15"}, {"CHAIN_ENABLE", "PB12"},
     {"CHAIN_ENABLE2", "PB10"}, {"CHAIN_LATCH", "PB11"}, {"NRST", "NRST"}}};

class Circuit {
 public:
  void add(const std::string& net, const std::string& component, const std::string& value, const std::string& pin) {
    pins_.push_back({net, component, value, pin});
  }

  void add_microcontroller() {
    for (const ControllerPin& p : kControllerPins) add(p.net, "U1", kMicrocontroller, p.pin);
    for (const char* pin : {"VDD", "VDDA", "VBAT", "VREF+"}) add("VDD", "U1", kMicrocontroller, pin);
    for (const char* pin : {"VSS", "VSSA"}) add("GND", "U1", kMicrocontroller, pin);
  }

  void add_transceiver() {
    // The G parts are specified beyond 1 Mbit/s (SLLSEQ7E); STB and SHDN are high active.
    constexpr const char* kTransceiver = "TCAN334G";
    constexpr std::array<ControllerPin, 8> kPins{{{"CAN_TX", "TXD"},
                                                  {"CAN_RX", "RXD"},
                                                  {"VDD", "VCC"},
                                                  {"GND", "GND"},
                                                  {"GND", "STB"},
                                                  {"GND", "SHDN"},
                                                  {"CANH", "CANH"},
                                                  {"CANL", "CANL"}}};
    for (const ControllerPin& p : kPins) add(p.net, "U2", kTransceiver, p.pin);
    add_connector("J3", "CAN", {"CANH", "CANL", "GND"});
  }

  void add_connector(const char* name, const char* value, const std::vector<std::string>& nets) {
    for (std::size_t k = 0; k < nets.size(); ++k) add(nets[k], name, value, fmt::format("{}", k + 1));
  }

  void add_lines() {
    std::vector<std::string> cable;
    for (const std::size_t net : kCablePinNets) cable.emplace_back(kBusNetNames[net]);
    add_connector("J1", "skin, flat cable of 10 ways, 1.0 mm", cable);
    for (std::size_t net = 2; net < kBusNets; ++net) {
      const std::string resistor = fmt::format("R{}", net - 1);
      add(std::string(kBusNetNames[net]), resistor, kPullUp, "1");
      add("VDD", resistor, kPullUp, "2");
    }
  }

  void add_light() {
    add("LIGHT", "R9", "1k", "1");
    add("LIGHT_ANODE", "R9", "1k", "2");
    add("LIGHT_ANODE", "D1", "LED", "A");
    add("GND", "D1", "LED", "K");
  }

  std::vector<NetPin> sorted() {
    std::ranges::sort(pins_, {}, [](const NetPin& p) { return std::tie(p.net, p.component, p.pin); });
    return std::move(pins_);
  }

 private:
  std::vector<NetPin> pins_;
};

}  // namespace

std::vector<NetPin> controller_nets() {
  Circuit circuit;
  circuit.add_microcontroller();
  circuit.add_transceiver();
  circuit.add_lines();
  circuit.add_light();
  circuit.add_connector("J2", "USB", {"USB_VBUS", "USB_DM", "USB_DP", "GND"});
  circuit.add_connector("J4", "program", {"VDD", "SWDIO", "SWCLK", "NRST", "GND", "LOG_TX"});
  circuit.add_connector("J5", "switches",
                        {"CHAIN_CLOCK", "CHAIN_IN", "CHAIN_OUT", "CHAIN_ENABLE", "CHAIN_ENABLE2", "CHAIN_LATCH"});
  return circuit.sorted();
}

std::string controller_csv() {
  std::string text = "net,component,value,pin\r\n";
  for (const NetPin& p : controller_nets())
    text += fmt::format("{},{},{},{}\r\n", p.net, p.component, csv_field(p.value), p.pin);
  return text;
}

}  // namespace triskin::fabrication
