// SPDX-License-Identifier: GPL-3.0-or-later
// Messages for people and controllers that want one arrow or one number: visualization_msgs and geometry_msgs.
#include <Eigen/Geometry>
#include <algorithm>

#include "triskin/bridge/ros_types.hpp"
#include "triskin/recording/cdr.hpp"

namespace triskin::bridge {
namespace {

using recording::CdrWriter;

constexpr double kMetre_mm = 1000.0;

std::vector<std::uint8_t> bytes_of(const CdrWriter& w) {
  return {w.message().begin(), w.message().end()};
}
void put_vector(CdrWriter& w, const Eigen::Vector3d& v) {
  for (int axis = 0; axis < 3; ++axis) w.f64(v[axis]);
}

struct Color {
  float r, g, b, a;
};
void put_color(CdrWriter& w, const Color& c) {
  for (const float part : {c.r, c.g, c.b, c.a}) w.f32(part);
}

// visualization_msgs/msg/Marker
enum : std::int32_t { kArrow = 0, kTriangleList = 11 };
enum : std::int32_t { kAdd = 0, kDelete = 2 };
struct Marker {
  std::string_view space;
  std::int32_t id = 0, type = kArrow, action = kAdd;
  Eigen::Vector3d scale{1.0, 1.0, 1.0};
  Color color{1.0F, 1.0F, 1.0F, 1.0F};
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Color> colors;  // one a point
};

void put(CdrWriter& w, const Marker& m, std::uint64_t stamp_ns, std::string_view frame_id) {
  recording::put_header(w, stamp_ns, frame_id);
  w.text(m.space);
  for (const std::int32_t number : {m.id, m.type, m.action}) w.u32(static_cast<std::uint32_t>(number));
  put_vector(w, Eigen::Vector3d::Zero());
  for (const double q : {0.0, 0.0, 0.0, 1.0}) w.f64(q);
  put_vector(w, m.scale);
  put_color(w, m.color);
  w.u32(0);  // lifetime: until it is replaced
  w.u32(0);
  w.u8(0);
  w.count(m.points_m.size());
  for (const Eigen::Vector3d& p : m.points_m) put_vector(w, p);
  w.count(m.colors.size());
  for (const Color& c : m.colors) put_color(w, c);
  w.text("");  // no texture
  recording::put_header(w, 0, "");
  w.text("");
  w.count(0);
  w.count(0);
  w.text("");  // no text, no mesh
  w.text("");
  w.text("");
  w.count(0);
  w.u8(0);
}

// Grey at rest, then yellow to red.
Color color_of(double change_counts) {
  constexpr double kFull_counts = 20'000.0;
  if (change_counts <= 0.0) return {0.45F, 0.45F, 0.5F, 1.0F};
  const double t = std::clamp(change_counts / kFull_counts, 0.0, 1.0);
  return {1.0F, static_cast<float>(0.85 * (1.0 - t)), 0.1F, 1.0F};
}

Marker modules_of(const design::Design& design, std::span<const recording::Contact> contacts) {
  std::vector<double> change(design.layout.modules.size(), 0.0);
  for (const recording::Contact& c : contacts)
    for (const recording::PressedTaxel& t : c.taxels)
      change.at(static_cast<std::size_t>(t.module.value())) += t.change_counts;
  Marker marker;
  marker.space = "modules";
  marker.type = kTriangleList;
  std::size_t m = 0;
  for (const auto& module : design.layout.modules) {
    const Color color = color_of(change[m++]);
    for (const auto& corner_mm : module.corner_mm) {
      marker.points_m.emplace_back(corner_mm / kMetre_mm);
      marker.colors.push_back(color);
    }
  }
  return marker;
}

// From outside onto the skin; the length says how strong it is.
Marker arrow_of(const recording::Contact& contact, std::size_t id) {
  constexpr double kMetrePerCount = 0.03 / 10'000.0, kMaxLength_m = 0.1, kMinLength_m = 0.01;
  const Eigen::Vector3d at_m = contact.position_mm / kMetre_mm;
  const double length_m = std::clamp(kMetrePerCount * contact.change_counts, kMinLength_m, kMaxLength_m);
  Marker marker;
  marker.space = "contacts";
  marker.id = static_cast<std::int32_t>(id);
  marker.scale = {0.003, 0.006, 0.008};  // shaft, head, length of the head
  marker.color = {0.9F, 0.2F, 0.1F, 1.0F};
  marker.points_m = {at_m + length_m * contact.normal, at_m};
  return marker;
}

}  // namespace

Wrench wrench_of(std::span<const recording::Contact> contacts, double newton_per_count, const Pose& pose) {
  const Eigen::Quaterniond turn(pose.rotation[3], pose.rotation[0], pose.rotation[1], pose.rotation[2]);
  const Eigen::Vector3d shift_m(pose.translation_m[0], pose.translation_m[1], pose.translation_m[2]);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  for (const recording::Contact& c : contacts) {
    const double newton = newton_per_count > 0.0 ? newton_per_count * c.change_counts : c.force_n;
    const Eigen::Vector3d f = -newton * (turn * c.normal);
    force += f;
    torque += (shift_m + turn * (c.position_mm / kMetre_mm)).cross(f);
  }
  return {{force.x(), force.y(), force.z()}, {torque.x(), torque.y(), torque.z()}};
}

std::vector<std::uint8_t> encode_wrench(const Wrench& wrench, std::uint64_t stamp_ns, std::string_view frame_id) {
  CdrWriter w;
  recording::put_header(w, stamp_ns, frame_id);
  for (const double f : wrench.force_n) w.f64(f);
  for (const double t : wrench.torque_nm) w.f64(t);
  return bytes_of(w);
}

std::vector<std::uint8_t> encode_markers(const design::Design& design, std::span<const recording::Contact> contacts,
                                         std::size_t arrows_before, std::uint64_t stamp_ns, std::string_view frame_id) {
  const std::size_t gone = arrows_before > contacts.size() ? arrows_before - contacts.size() : 0;
  CdrWriter w;
  w.count(1 + contacts.size() + gone);
  put(w, modules_of(design, contacts), stamp_ns, frame_id);
  for (std::size_t k = 0; k < contacts.size(); ++k) put(w, arrow_of(contacts[k], k), stamp_ns, frame_id);
  for (std::size_t k = 0; k < gone; ++k) {
    Marker marker;
    marker.space = "contacts";
    marker.id = static_cast<std::int32_t>(contacts.size() + k);
    marker.action = kDelete;
    put(w, marker, stamp_ns, frame_id);
  }
  return bytes_of(w);
}

}  // namespace triskin::bridge
