// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/contact.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "triskin/geometry/segment.hpp"

namespace triskin::hardware {
namespace {

ContactState between(const Keyframe& a, const Keyframe& b, double part) {
  return {a.position_mm + part * (b.position_mm - a.position_mm), a.radius_mm + part * (b.radius_mm - a.radius_mm),
          a.force_n + part * (b.force_n - a.force_n)};
}

ContactState on_path(const std::vector<Keyframe>& path, std::uint64_t after_us) {
  const auto next = std::ranges::upper_bound(path, after_us, {}, &Keyframe::after_us);
  if (next == path.begin()) return between(*next, *next, 0.0);
  const Keyframe& last = *std::prev(next);
  if (next == path.end()) return between(last, last, 0.0);
  return between(last, *next,
                 static_cast<double>(after_us - last.after_us) / static_cast<double>(next->after_us - last.after_us));
}

ContactState on_line(const Contact& c, std::uint64_t after_us, std::uint64_t pass_us) {
  ContactState state{c.position_mm, c.radius_mm, c.force_n};
  if (c.to_mm)
    state.position_mm += (*c.to_mm - c.position_mm) * (static_cast<double>(after_us) / static_cast<double>(pass_us));
  if (after_us < c.rise_us) state.force_n *= static_cast<double>(after_us) / static_cast<double>(c.rise_us);
  if (pass_us - after_us < c.fall_us)
    state.force_n *= static_cast<double>(pass_us - after_us) / static_cast<double>(c.fall_us);
  return state;
}

// Calls `visit` with both ends of each straight segment of the path and the largest radius on it.
template <class Visit>
void each_part(const Contact& c, const Visit& visit) {
  if (c.keyframes.empty()) return visit(c.position_mm, c.to_mm.value_or(c.position_mm), c.radius_mm);
  for (std::size_t k = 0; k < c.keyframes.size(); ++k) {
    const Keyframe &a = c.keyframes[k], &b = c.keyframes[std::min(k + 1, c.keyframes.size() - 1)];
    visit(a.position_mm, b.position_mm, std::max(a.radius_mm, b.radius_mm));
  }
}

}  // namespace

std::optional<ContactState> state_of(const Contact& contact, std::uint64_t at_us) {
  if (at_us < contact.from_us) return std::nullopt;
  std::uint64_t after_us = at_us - contact.from_us;
  if (contact.every_us != 0) {
    const std::uint64_t pass = after_us / contact.every_us;
    if (contact.passes != 0 && pass >= static_cast<std::uint64_t>(contact.passes)) return std::nullopt;
    after_us -= pass * contact.every_us;
  }
  const std::uint64_t pass_us = contact.until_us == kForever ? kForever : contact.until_us - contact.from_us;
  if (after_us >= pass_us) return std::nullopt;
  return contact.keyframes.empty() ? on_line(contact, after_us, pass_us) : on_path(contact.keyframes, after_us);
}

std::uint64_t end_of(const Contact& contact) {
  if (contact.until_us == kForever || contact.every_us == 0) return contact.until_us;
  if (contact.passes == 0) return kForever;
  return contact.until_us + static_cast<std::uint64_t>(contact.passes - 1) * contact.every_us;
}

double distance_mm(const Contact& contact, const design::Vec3& point_mm) {
  double nearest_mm = std::numeric_limits<double>::infinity();
  each_part(contact, [&](const design::Vec3& from, const design::Vec3& to, double) {
    nearest_mm = std::min(nearest_mm, geometry::distance_to_segment(point_mm, from, to));
  });
  return nearest_mm;
}

bool reaches(const Contact& contact, const design::Vec3& point_mm) {
  bool reached = false;
  each_part(contact, [&](const design::Vec3& from, const design::Vec3& to, double radius_mm) {
    reached = reached || geometry::distance_to_segment(point_mm, from, to) < radius_mm;
  });
  return reached;
}

double max_radius_mm(const Contact& contact) {
  double radius_mm = 0.0;
  each_part(contact, [&](const design::Vec3&, const design::Vec3&, double r) { radius_mm = std::max(radius_mm, r); });
  return radius_mm;
}

}  // namespace triskin::hardware
