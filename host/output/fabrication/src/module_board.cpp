// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_board.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "triskin/design/outline.hpp"

namespace triskin::fabrication {

using design::Vec2;

namespace {

constexpr double kInradius_mm = design::kHeight_mm / 3.0;
constexpr double kThird_rad = 2.0 * std::numbers::pi / 3.0;

Vec2 turned(const Vec2& p, double angle_rad) {
  return Eigen::Rotation2Dd(angle_rad) * p;
}
double port_angle_rad(std::size_t port) {
  return kThird_rad * static_cast<double>(port);
}

// Converts a place given along the side of port A and from it to the module frame.
Vec2 beside_port_a(double along_mm, double inset_mm) {
  return {along_mm, inset_mm - kInradius_mm};
}

void add_contacts(std::vector<ModulePad>& pads) {
  for (std::size_t port = 0; port < layout::kPorts; ++port) {
    for (std::size_t net = 0; net < kBusNets; ++net) {
      for (const int sign : {-1, 1}) {
        pads.push_back({fmt::format("{}{}", "ABC"[port], net + 1), PadLayer::kThrough, contact_at(port, net, sign),
                        Vec2::Constant(kContactPad_mm), 0.0});
      }
    }
  }
}

void add_taxels(std::vector<ModulePad>& pads) {
  design::PlacedModule flat;
  for (int k = 0; k < 3; ++k) {
    const Vec2 corner = turned({-design::kSide_mm / 2.0, -kInradius_mm}, kThird_rad * k);
    flat.corner_mm[static_cast<std::size_t>(k)] = {corner.x(), corner.y(), 0.0};
  }
  const auto taxels = design::taxels_of(flat, 0);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const double diameter_mm = layout::measures_pressure(t) ? kPressurePad_mm : kTemperaturePad_mm;
    pads.push_back(
        {fmt::format("T{}", t), PadLayer::kTouch, taxels[t].position_mm.head<2>(), Vec2::Constant(diameter_mm), 0.0});
  }
}

// Pins of the chip run clockwise as seen from the touch side, as the taxels do. Pins 1 … 6 are on the left.
void add_chip(std::vector<ModulePad>& pads) {
  constexpr double kFromMiddle_mm = 1.95, kFirst_mm = 1.25, kPitch_mm = 0.5;
  for (int pin = 0; pin < 24; ++pin) {
    const int side = pin / 6;
    const Vec2 on_left(-kFromMiddle_mm, -kFirst_mm + kPitch_mm * (pin % 6));
    const double angle_rad = -side * std::numbers::pi / 2.0;
    pads.push_back(
        {fmt::format("U1.{}", pin + 1), PadLayer::kBack, turned(on_left, angle_rad), {0.7, 0.25}, angle_rad});
  }
  pads.push_back({"U1.25", PadLayer::kBack, {0, 0}, {2.3, 2.3}, 0.0});
}

// C1 (100 nF) beside VCC, less than 2 mm away, and C3 (10 nF) beside BIAS, both along the chip's upper side; C2 (1 µF)
// next to the straps.
void add_capacitors(std::vector<ModulePad>& pads) {
  constexpr double kHalfPitch_mm = 0.48;
  for (const ModulePart& part : module_parts()) {
    if (part.designator[0] != 'C') continue;
    // Pad 1 lies left as seen from the back, thus right as seen from the touch side, if the angle is 0.
    const double first_mm = part.angle_rad == 0.0 ? kHalfPitch_mm : -kHalfPitch_mm;
    for (const int end : {0, 1}) {
      const Vec2 at = part.at_mm + Vec2(end == 0 ? first_mm : -first_mm, 0.0);
      pads.push_back({fmt::format("{}.{}", part.designator, end + 1), PadLayer::kBack, at, {0.56, 0.62}, 0.0});
    }
  }
}

constexpr double kStrapPadLength_mm = 0.55, kStrapPadWidth_mm = 0.5;

// Six straps lie in three rows towards corner 2 (SDA and ADD0) and corner 1 (SCL and ADD1); the third corner is left to
// the sensor tracks.
Strap strap_at(std::string name, std::size_t corner, std::size_t place) {
  constexpr double kFirstRow_mm = 4.7, kRowPitch_mm = 1.0, kBesideMiddle_mm = 0.8, kHalfPitch_mm = 0.4;
  const double from_middle_mm = kFirstRow_mm + kRowPitch_mm * static_cast<double>(place / 2);
  // The pads of the chip's net lie inside, those of the bus outside, where its tracks arrive.
  const double side = place % 2 == 0 ? -1.0 : 1.0;
  const double angle_rad = 7.0 * std::numbers::pi / 6.0 + port_angle_rad(corner);
  return {std::move(name),
          {turned({from_middle_mm, side * (kBesideMiddle_mm + kHalfPitch_mm)}, angle_rad),
           turned({from_middle_mm, side * (kBesideMiddle_mm - kHalfPitch_mm)}, angle_rad)}};
}

std::vector<Strap> made_straps() {
  std::vector<Strap> all;
  constexpr std::size_t kUpper = 2, kLowerRight = 1;
  const auto add_corner = [&](std::size_t corner, const char* wire, const char* address) {
    std::size_t place = 0;
    for (const char* level : {"L", "H"}) all.push_back(strap_at(fmt::format("{}{}", address, level), corner, place++));
    for (int line = 0; line < layout::kLines; ++line)
      all.push_back(strap_at(fmt::format("{}{}", wire, line), corner, place++));
  };
  add_corner(kUpper, "SDA", "ADD0");
  add_corner(kLowerRight, "SCL", "ADD1");
  return all;
}

void add_straps(std::vector<ModulePad>& pads) {
  for (std::size_t k = 0; k < straps().size(); ++k) {
    const Strap& strap = straps()[k];
    const Vec2 across = strap.at_mm[1] - strap.at_mm[0];
    for (const std::size_t end : {0U, 1U}) {
      pads.push_back({fmt::format("{}.{}", strap.name, end + 1),
                      PadLayer::kBack,
                      strap.at_mm[end],
                      {kStrapPadWidth_mm, kStrapPadLength_mm},
                      std::atan2(across.y(), across.x())});
    }
  }
}

std::vector<ModulePad> made_pads() {
  std::vector<ModulePad> pads;
  add_contacts(pads);
  add_taxels(pads);
  add_chip(pads);
  add_capacitors(pads);
  add_straps(pads);
  return pads;
}

std::string own_net(const ModuleSetting& setting, std::string_view name) {
  return fmt::format("M{}_{}", setting.number, name);
}

// Returns the net of the chip's data or clock pin: that of its line if a strap is closed.
std::string line_net(const ModuleSetting& setting, std::size_t clock) {
  if (!setting.line) return own_net(setting, clock == 0 ? "SDA" : "SCL");
  return bus_net_name(setting, data_net(*setting.line) + clock);
}

// Returns the net of an address pin: bit `bit` of the address, GND for 0.
std::string address_net(const ModuleSetting& setting, int bit) {
  if (!setting.address) return own_net(setting, bit == 0 ? "ADD0" : "ADD1");
  return bus_net_name(setting, static_cast<std::size_t>((*setting.address >> bit) & 1));
}

std::string net_of_pin(std::string_view pin, const ModuleSetting& setting) {
  if (pin == "GND") return bus_net_name(setting, 0);
  if (pin == "VCC" || pin == "VDRIVE") return bus_net_name(setting, 1);
  if (pin == "SDA") return line_net(setting, 0);
  if (pin == "SCLK") return line_net(setting, 1);
  if (pin == "ADD0") return address_net(setting, 0);
  if (pin == "ADD1") return address_net(setting, 1);
  if (pin == "BIAS" || pin == "ACSHIELD") return own_net(setting, pin);
  if (pin.starts_with("CIN") && pin != "CIN12") return own_net(setting, pin);
  return "";  // CIN12, INT and GPIO are open.
}

std::string net_of_capacitor(const std::string& name, const ModuleSetting& setting) {
  if (name.ends_with(".2")) return bus_net_name(setting, 0);
  return name == "C3.1" ? own_net(setting, "BIAS") : bus_net_name(setting, 1);
}

std::string net_of_strap(const std::string& name, const ModuleSetting& setting) {
  const bool is_address = name.starts_with("ADD");
  if (name.ends_with(".2"))
    return is_address ? address_net(setting, name[3] - '0') : line_net(setting, name.starts_with("SCL") ? 1 : 0);
  if (is_address) return bus_net_name(setting, name[4] == 'L' ? 0 : 1);
  return bus_net_name(setting, data_net(name[3] - '0') + (name.starts_with("SCL") ? 1 : 0));
}

}  // namespace

const std::array<std::string_view, 24>& chip_pins() {
  static constexpr std::array<std::string_view, 24> kPins{
      "CIN6", "CIN7", "CIN8", "CIN9", "CIN10", "CIN11", "CIN12", "ACSHIELD", "BIAS", "GND",  "VCC",  "VDRIVE",
      "SDA",  "ADD0", "SCLK", "ADD1", "INT",   "GPIO",  "CIN0",  "CIN1",     "CIN2", "CIN3", "CIN4", "CIN5"};
  return kPins;
}

const std::vector<ModulePad>& paste_windows() {
  static const std::vector<ModulePad> kAll = [] {
    constexpr double kFromMiddle_mm = 0.575, kSide_mm = 0.85;
    std::vector<ModulePad> windows;
    for (const double x_mm : {-kFromMiddle_mm, kFromMiddle_mm}) {
      for (const double y_mm : {-kFromMiddle_mm, kFromMiddle_mm})
        windows.push_back({"", PadLayer::kBack, {x_mm, y_mm}, Vec2::Constant(kSide_mm), 0.0});
    }
    return windows;
  }();
  return kAll;
}

const std::array<ModulePart, 4>& module_parts() {
  constexpr double kHalfTurn_rad = std::numbers::pi;
  static const std::array<ModulePart, 4> kParts{
      {{"U1",
        "AD7147-1",
        "LFCSP-24 4 x 4 mm",
        "Analog Devices",
        "AD7147ACPZ-1500RL7",
        {0, 0},
        kHalfTurn_rad,
        {2.55, 2.55}},
       {"C1", "100 nF 16 V X7R", "0402", "Murata", "GRM155R71C104KA88D", {0.93, 3.1}, kHalfTurn_rad, {0.91, 0.46}},
       {"C2", "1 uF 10 V X5R", "0402", "Murata", "GRM155R61A105KE15D", {-2.3, 4.02}, 0.0, {0.91, 0.46}},
       {"C3", "10 nF 50 V X7R", "0402", "Murata", "GRM155R71H103KA88D", {-1.03, 3.07}, 0.0, {0.91, 0.46}}}};
  return kParts;
}

const std::vector<SilkLine>& module_silk() {
  static const std::vector<SilkLine> kAll = [] {
    // A short bar at the corner between pins 1 and 24, and both other free corners of the body.
    constexpr double kBody_mm = 2.15, kEnd_mm = 1.6;
    std::vector<SilkLine> lines{{{-2.5, -2.1}, {-2.1, -2.5}}, {{-2.4, -2.0}, {-2.0, -2.4}}};
    for (const double x : {-kBody_mm, kBody_mm}) {
      lines.push_back({{x, kBody_mm}, {std::copysign(kEnd_mm, x), kBody_mm}});
      lines.push_back({{x, kBody_mm}, {x, kEnd_mm}});
    }
    return lines;
  }();
  return kAll;
}

const std::vector<Strap>& straps() {
  static const std::vector<Strap> kAll = made_straps();
  return kAll;
}

const std::vector<ModulePad>& module_pads() {
  static const std::vector<ModulePad> kAll = made_pads();
  return kAll;
}

ModuleSetting setting_of(const design::Design& design, const std::vector<design::ModuleWiring>& wiring,
                         layout::ModuleId id) {
  const design::ModuleNumber number = design::number_of(design, id);
  const design::ModuleWiring& wired = wiring.at(static_cast<std::size_t>(id));
  if (wired.patch < 0) return {number, layout::PatchIndex::none(), std::nullopt, std::nullopt};
  return {number, wired.patch, wired.routed.line, wired.routed.address};
}

bool is_closed(const Strap& strap, const ModuleSetting& setting) {
  if (!setting.line || !setting.address) return false;
  const std::string& name = strap.name;
  if (!name.starts_with("ADD")) return name[3] - '0' == *setting.line;
  const bool is_high = ((*setting.address >> (name[3] - '0')) & 1) != 0;
  return (name[4] == 'H') == is_high;
}

std::string bus_net_name(const ModuleSetting& setting, std::size_t net) {
  const std::string_view name = kBusNetNames.at(net);
  return setting.patch < 0 ? own_net(setting, fmt::format("BUS_{}", name)) : fmt::format("P{}_{}", setting.patch, name);
}

std::string net_of(const ModulePad& pad, const ModuleSetting& setting) {
  const std::string& name = pad.name;
  if (pad.layer == PadLayer::kThrough) return bus_net_name(setting, std::stoul(name.substr(1)) - 1);
  if (pad.layer == PadLayer::kTouch) return own_net(setting, "CIN" + name.substr(1));
  if (name == "U1.25") return bus_net_name(setting, 0);
  if (name.starts_with("U1.")) return net_of_pin(chip_pins().at(std::stoul(name.substr(3)) - 1), setting);
  if (name.starts_with("C")) return net_of_capacitor(name, setting);
  return net_of_strap(name, setting);
}

Vec2 contact_at(std::size_t port, std::size_t net, int sign) {
  const Contact& contact = kContacts.at(net);
  return turned(beside_port_a(sign * contact.along_mm, contact.inset_mm), port_angle_rad(port));
}

std::vector<Vec2> ring_of(std::size_t net, double corner_cut_mm) {
  const Contact& contact = kContacts.at(net);
  const double d = contact.inset_mm;
  // The short side of the ring is as far from the cut as the ring from a side; this is its distance from the corner,
  // along the bisector.
  const double short_side_mm = std::max(2.0 * d, design::cut_height_mm(corner_cut_mm) + d);
  const double half_mm = design::kSide_mm / 2.0 - (short_side_mm - d / 2.0) / std::cos(std::numbers::pi / 6.0);
  // If the cut does not reach that far, both ends of the short side are the corner of the ring, which then has one
  // point there.
  constexpr double kSame_mm = 1e-6;
  std::vector<Vec2> ring;
  for (std::size_t port = 0; port < layout::kPorts; ++port) {
    for (const double along_mm : {-half_mm, -contact.along_mm, contact.along_mm, half_mm}) {
      const Vec2 point = turned(beside_port_a(along_mm, d), port_angle_rad(port));
      if (ring.empty() || (point - ring.back()).norm() > kSame_mm) ring.push_back(point);
    }
  }
  if ((ring.back() - ring.front()).norm() <= kSame_mm) ring.pop_back();
  return ring;
}

Vec2 cable_pad_at(std::size_t pin) {
  return beside_port_a(kCablePitch_mm * (static_cast<double>(pin) - 4.5), kCableInset_mm);
}

// The three outer pins of each end leave outwards and run along the side, the innermost pin nearest to it, so that no
// two cross and every contact stays open towards the middle. The four middle pins run straight to their contacts.
std::vector<Vec2> cable_track(std::size_t pin) {
  constexpr double kFirstLane_mm = 0.8, kLanePitch_mm = 0.2;
  const std::size_t net = kCablePinNets.at(pin);
  const Contact& contact = kContacts.at(net);
  const Vec2 pad = cable_pad_at(pin);
  const bool is_left = pin < kBusNets / 2;
  const double along_mm = is_left ? -contact.along_mm : contact.along_mm;
  const std::size_t from_end = is_left ? pin : kBusNets - 1 - pin;
  if (from_end < 3) {
    const double lane_mm = kFirstLane_mm - kLanePitch_mm * static_cast<double>(from_end);
    return {pad, beside_port_a(pad.x(), lane_mm), beside_port_a(along_mm, lane_mm),
            beside_port_a(along_mm, contact.inset_mm)};
  }
  constexpr double kBeside_mm = 0.2;  // The last middle pin passes its neighbours at this distance before it turns in.
  const double straight_mm = pin == 6 ? contact.along_mm + kBeside_mm : along_mm;
  return {pad,
          {straight_mm, pad.y()},
          beside_port_a(straight_mm, contact.inset_mm - kBeside_mm),
          beside_port_a(along_mm, contact.inset_mm)};
}

}  // namespace triskin::fabrication
