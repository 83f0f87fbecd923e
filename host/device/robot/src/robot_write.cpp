// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/base/terminal_text.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {
namespace {

std::string quoted(const std::string& text) {
  try {
    return nlohmann::json(text).dump();
  } catch (const nlohmann::json::type_error&) {
    throw InputError(fmt::format("{}: is no UTF-8, so a robot file cannot name it; rename it", for_terminal(text)));
  }
}

std::string optional_text(const char* key, const std::string& text) {
  return text.empty() ? "" : fmt::format(",\"{}\":{}", key, quoted(text));
}

std::string optional_length(double cable_mm) {
  return cable_mm > 0.0 ? fmt::format(",\"cable_mm\":{}", cable_mm) : "";
}

std::string bus_line(const BusEntry& b) {
  return fmt::format(
      "{{\"name\":{},\"link\":{},\"bit_rate\":{},\"data_bit_rate\":{},\"first_node\":{},\"last_node\":{}{}}}",
      quoted(b.name), quoted(b.link), b.rates.nominal, b.rates.data, b.first_node, b.last_node,
      optional_length(b.cable_mm));
}

std::string pose_text(const CoverEntry& c) {
  if (c.xyz_rpy) {
    const auto& n = *c.xyz_rpy;
    return fmt::format("{{\"xyz_mm\":[{},{},{}],\"rpy_rad\":[{},{},{}]}}", n[0], n[1], n[2], n[3], n[4], n[5]);
  }
  std::string rows;
  for (int row = 0; row < 4; ++row) {
    const auto m = c.pose.matrix().row(row);
    rows += fmt::format("{}[{},{},{},{}]", row == 0 ? "" : ",", m[0], m[1], m[2], m[3]);
  }
  return fmt::format("{{\"matrix\":[{}]}}", rows);
}

std::string controller_line(const ControllerEntry& c) {
  return fmt::format("    {{\"patch\":{},\"node\":{}{}{}{}}}", c.patch, c.node, optional_text("serial", c.serial),
                     optional_text("bus", c.bus), optional_length(c.cable_mm));
}

std::string cover_text(const CoverEntry& c) {
  std::vector<std::string> controllers;
  for (const ControllerEntry& e : c.controllers) controllers.push_back(controller_line(e));
  return fmt::format(
      "{{\"name\":{},\"design\":{},\"design_id\":\"{:016x}\",\"bus\":{}{}{}{}{},\n"
      "   \"controllers\":[\n{}]}}",
      quoted(c.name), quoted(c.design), c.design_id, quoted(c.bus), optional_text("frame", c.frame),
      c.rate_hz > 0.0 ? fmt::format(",\"rate_hz\":{}", c.rate_hz) : "",
      c.has_pose ? ",\n   \"pose\":" + pose_text(c) : "",
      c.measured ? fmt::format(",\"measured\":{{\"points\":{},\"rms_mm\":{}}}", c.measured->points, c.measured->rms_mm)
                 : "",
      fmt::join(controllers, ",\n"));
}

template <class Entries, class Text>
std::string list(const Entries& entries, Text text) {
  std::vector<std::string> rows;
  for (const auto& entry : entries) rows.push_back("  " + text(entry));
  return fmt::format("[\n{}]", fmt::join(rows, ",\n"));
}

}  // namespace

std::string robot_text(const Robot& robot) {
  return fmt::format("{{\"format\":\"triskin-robot\",\"version\":{},\"name\":{}{},\n \"buses\":{},\n \"covers\":{}}}\n",
                     Robot::kVersion, quoted(robot.name), optional_text("urdf", robot.urdf),
                     list(robot.buses, bus_line), list(robot.covers, cover_text));
}

}  // namespace triskin::robot
