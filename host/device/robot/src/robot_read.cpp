// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/base/terminal_text.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/deploy/board_file.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;

constexpr const char* kFormat = "triskin-robot";
constexpr const char* kPage = "docs/robot.md";
constexpr double kMaxCable_mm = 1e6, kMaxPlace_mm = 1e5, kMaxAngle_rad = 100.0, kMaxRate_hz = 1000.0;
constexpr int kMaxBitRate = 10'000'000;

std::string name_in(const JsonValue& v) {
  std::string name = v.text();
  if (!is_name(name))
    v.fail("must be a name: a letter of any script, then letters, digits, \"_\" or \"-\", at most 64 bytes");
  return name;
}

std::string text_or(const JsonValue& v, const char* key, const std::string& otherwise) {
  return has(v, key) ? v[key].text() : otherwise;
}

double length_or_none(const JsonValue& v, const char* key) {
  return has(v, key) ? number_in(v[key], 0.0, kMaxCable_mm) : 0.0;
}

std::string serial_in(const JsonValue& v) {
  std::string serial = deploy::normal_serial(v.text());
  if (serial.empty()) v.fail("must have 24 hexadecimal digits, as triskin discover shows serial numbers");
  return serial;
}

BusEntry read_bus(const JsonValue& v) {
  only_keys(v, {"name", "link", "bit_rate", "data_bit_rate", "first_node", "last_node", "cable_mm"}, kPage);
  BusEntry bus;
  bus.name = name_in(v["name"]);
  bus.link = text_or(v, "link", bus.link);
  const auto rate = [&](const char* key, std::uint32_t otherwise) {
    return has(v, key) ? static_cast<std::uint32_t>(v[key].integer(10'000, kMaxBitRate)) : otherwise;
  };
  bus.rates = {rate("bit_rate", bus.rates.nominal), rate("data_bit_rate", bus.rates.data)};
  if (has(v, "first_node")) bus.first_node = v["first_node"].integer(layout::kFirstNode, layout::kLastNode);
  if (has(v, "last_node")) bus.last_node = v["last_node"].integer(bus.first_node, layout::kLastNode);
  bus.cable_mm = length_or_none(v, "cable_mm");
  return bus;
}

// Hand-written numbers are rounded, so the matrix is replaced by the nearest rotation.
Eigen::Isometry3d read_matrix(const JsonValue& v) {
  constexpr double kRounded = 1e-3;
  Eigen::Matrix4d m;
  v.require_size(4);
  for (int row = 0; row < 4; ++row) {
    const JsonValue r = v.at(static_cast<std::size_t>(row));
    r.require_size(4);
    for (int column = 0; column < 4; ++column)
      m(row, column) = number_in(r.at(static_cast<std::size_t>(column)), -kMaxPlace_mm, kMaxPlace_mm);
  }
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) v.at(3).fail("must be 0, 0, 0, 1");
  const Eigen::Matrix3d turn = m.topLeftCorner<3, 3>();
  if ((turn.transpose() * turn - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kRounded)
    v.fail("its first three columns must be unit vectors at right angles: a pose turns and moves, it does not scale");
  if (turn.determinant() < 0.0)
    v.fail("mirrors the cover (determinant -1): a pose only turns and moves; use the design of the other side");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  // A matrix that already is a rotation is kept exactly as it was written.
  if ((pose.linear() - turn).cwiseAbs().maxCoeff() < 1e-12) pose.linear() = turn;
  pose.translation() = m.topRightCorner<3, 1>();
  return pose;
}

void read_pose(const JsonValue& v, CoverEntry& cover) {
  if (has(v, "matrix")) {
    only_keys(v, {"matrix"}, kPage);
    cover.pose = read_matrix(v["matrix"]);
    return;
  }
  only_keys(v, {"xyz_mm", "rpy_rad"}, kPage);
  std::array<double, 6> numbers{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (has(v, "xyz_mm")) numbers[k] = number_in(v["xyz_mm"].at(k), -kMaxPlace_mm, kMaxPlace_mm);
    if (has(v, "rpy_rad")) numbers[3 + k] = number_in(v["rpy_rad"].at(k), -kMaxAngle_rad, kMaxAngle_rad);
  }
  for (const char* key : {"xyz_mm", "rpy_rad"}) {
    if (has(v, key)) v[key].require_size(3);
  }
  cover.xyz_rpy = numbers;
  cover.pose = pose_of(numbers);
}

ControllerEntry read_controller(const JsonValue& v) {
  only_keys(v, {"patch", "node", "serial", "bus", "cable_mm"}, kPage);
  ControllerEntry c;
  c.patch = layout::PatchIndex{v["patch"].integer(0, design::kMaxCount)};
  c.node = layout::NodeAddress{v["node"].integer(layout::kFirstNode, layout::kLastNode)};
  if (has(v, "serial")) c.serial = serial_in(v["serial"]);
  if (has(v, "bus")) c.bus = name_in(v["bus"]);
  c.cable_mm = length_or_none(v, "cable_mm");
  return c;
}

Measured read_measured(const JsonValue& v) {
  only_keys(v, {"points", "rms_mm"}, kPage);
  return {v["points"].integer(0, design::kMaxCount), number_in(v["rms_mm"], 0.0, kMaxPlace_mm)};
}

CoverEntry read_cover(const JsonValue& v) {
  only_keys(v, {"name", "design", "design_id", "bus", "frame", "pose", "measured", "rate_hz", "controllers"}, kPage);
  CoverEntry cover;
  cover.name = name_in(v["name"]);
  cover.design = v["design"].text();
  cover.design_id = design::hex64(v["design_id"]);
  cover.bus = name_in(v["bus"]);
  cover.frame = text_or(v, "frame", "");
  cover.has_pose = has(v, "pose");
  if (cover.has_pose) read_pose(v["pose"], cover);
  if (has(v, "measured")) cover.measured = read_measured(v["measured"]);
  if (has(v, "rate_hz")) cover.rate_hz = number_in(v["rate_hz"], 0.0, kMaxRate_hz);
  const JsonValue controllers = v["controllers"];
  for (std::size_t k = 0; k < controllers.size(); ++k) cover.controllers.push_back(read_controller(controllers.at(k)));
  return cover;
}

// Reads until the key "format" of the outermost object, wherever it is.
class FormatFinder final : public nlohmann::json::json_sax_t {
 public:
  [[nodiscard]] bool is_robot() const { return found_; }
  bool null() override { return next(); }
  bool boolean(bool) override { return next(); }
  bool number_integer(number_integer_t) override { return next(); }
  bool number_unsigned(number_unsigned_t) override { return next(); }
  bool number_float(number_float_t, const string_t&) override { return next(); }
  bool binary(binary_t&) override { return next(); }
  bool string(string_t& text) override {
    if (depth_ != 1 || !is_format_) return next();
    found_ = text == kFormat;
    return false;
  }
  bool start_object(std::size_t) override { return ++depth_ < kDeepest && next(); }
  bool end_object() override { return --depth_ > 0; }
  bool start_array(std::size_t) override { return ++depth_ < kDeepest && next(); }
  bool end_array() override { return --depth_ > 0; }
  bool key(string_t& name) override {
    is_format_ = depth_ == 1 && name == "format";
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  static constexpr int kDeepest = 64;
  bool next() {
    is_format_ = false;
    return true;
  }
  int depth_ = 0;
  bool is_format_ = false, found_ = false;
};

}  // namespace

bool is_name(const std::string& text) {
  constexpr std::size_t kMax_bytes = 64;
  constexpr unsigned char kFirstByteBeyondAscii = 0x80;
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0 || c >= kFirstByteBeyondAscii; };
  const auto allowed = [&](unsigned char c) { return is_letter(c) || std::isdigit(c) != 0 || c == '_' || c == '-'; };
  return !text.empty() && text.size() <= kMax_bytes && is_letter(static_cast<unsigned char>(text[0])) &&
         std::ranges::all_of(text, allowed) && for_terminal(text) == text;
}

bool is_frame_name(const std::string& text) {
  return !text.empty() && text.front() != '/' && text.find_first_of(" \t\n") == std::string::npos;
}

void require_reach(const Eigen::Vector3d& place_mm, const std::string& option, const std::string& question) {
  constexpr double kReach_mm = 10'000.0;  // as for the joints of a URDF
  if (!place_mm.allFinite()) throw InputError(option + ": x y z must be finite numbers");
  for (const double v_mm : place_mm) {
    if (std::abs(v_mm) > kReach_mm)
      throw InputError(fmt::format("{}: {:g} m from the parent is further than a robot reaches; {}", option,
                                   v_mm / 1000.0, question));
  }
}

Eigen::Isometry3d pose_of(const std::array<double, 6>& n) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  pose.linear() =
      (Eigen::AngleAxisd(n[5], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(n[4], Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(n[3], Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return pose;
}

Eigen::Isometry3d parse_pose(const std::string& text, const std::string& file) {
  const nlohmann::json document = design::parse_json(text, file);
  CoverEntry cover;
  read_pose(JsonValue(document, file), cover);
  return cover.pose;
}

std::pair<layout::PatchIndex, std::string> parse_serial(const std::string& text) {
  const std::size_t at = text.find('=');
  const std::string patch = text.substr(0, at);
  const std::string serial = at == std::string::npos ? "" : deploy::normal_serial(text.substr(at + 1));
  if (patch.empty() || patch.size() > 6 || patch.find_first_not_of("0123456789") != std::string::npos || serial.empty())
    throw InputError(fmt::format(
        "\"{}\": give PATCH=SERIAL, where SERIAL has 24 hexadecimal digits, as triskin discover shows them", text));
  return {layout::PatchIndex{std::stoi(patch)}, serial};
}

int bus_of(const Robot& robot, const CoverEntry& cover, const ControllerEntry& controller) {
  const std::string& name = controller.bus.empty() ? cover.bus : controller.bus;
  const auto found = std::ranges::find(robot.buses, name, &BusEntry::name);
  return found == robot.buses.end() ? -1 : static_cast<int>(found - robot.buses.begin());
}

bool is_robot_file(const std::filesystem::path& path) {
  FormatFinder finder;
  (void)nlohmann::json::sax_parse(read_text(path), &finder);
  return finder.is_robot();
}

Robot parse_robot(const std::string& text, const std::string& file) {
  const nlohmann::json document = design::parse_json(text, file);
  const JsonValue v(document, file);
  design::require_head(v, kFormat, Robot::kVersion, std::string(kPage) + " describes it");
  only_keys(v, {"format", "version", "name", "urdf", "buses", "covers"}, kPage);
  Robot robot;
  robot.name = name_in(v["name"]);
  robot.urdf = text_or(v, "urdf", "");
  const JsonValue buses = v["buses"], covers = v["covers"];
  for (std::size_t k = 0; k < buses.size(); ++k) robot.buses.push_back(read_bus(buses.at(k)));
  for (std::size_t k = 0; k < covers.size(); ++k) robot.covers.push_back(read_cover(covers.at(k)));
  return robot;
}

Robot read_robot(const std::filesystem::path& path) {
  return parse_robot(read_text(path), path.string());
}

}  // namespace triskin::robot
