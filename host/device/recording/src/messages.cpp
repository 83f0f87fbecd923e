// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/messages.hpp"

#include <algorithm>

#include "triskin/design/module_number.hpp"
#include "triskin/recording/cdr.hpp"

namespace triskin::recording {
namespace {

constexpr double kMetre_mm = 1000.0;
constexpr std::uint64_t kSecond_ns = 1'000'000'000;

std::vector<std::uint8_t> bytes_of(const CdrWriter& w) {
  return {w.message().begin(), w.message().end()};
}

void put_point(CdrWriter& w, const design::Vec3& v, double scale) {
  for (int axis = 0; axis < 3; ++axis) w.f32(static_cast<float>(v[axis] / scale));
}

// Writes a sequence with one element for each item, which `put` encodes.
template <class Items, class Put>
void put_each(CdrWriter& w, const Items& items, std::size_t per_item, Put put) {
  w.count(items.size() * per_item);
  for (const auto& item : items) put(item);
}

// The message has the time of the first module; the controller's clock tells how the others differ: by a few ms, in
// which its drift does not matter.
void take_times(CdrReader& r, std::vector<ModuleSample>& samples) {
  const std::uint64_t first_ns = r.u64();
  const std::uint32_t error_us = r.u32();
  for (ModuleSample& s : samples) {
    // The difference is taken modulo 2⁶⁴.
    const std::uint64_t later_us = s.sample.device_time_us - samples.front().sample.device_time_us;
    s.sampled_ns = first_ns == 0 ? 0 : first_ns + later_us * 1000;
    s.error_us = error_us;
  }
}

}  // namespace

void put_header(CdrWriter& w, std::uint64_t stamp_ns, std::string_view frame_id) {
  w.u32(static_cast<std::uint32_t>(stamp_ns / kSecond_ns));
  w.u32(static_cast<std::uint32_t>(stamp_ns % kSecond_ns));
  w.text(frame_id);
}

namespace {

std::uint32_t number_of(layout::ModuleId module, std::span<const int> numbers) {
  return static_cast<std::uint32_t>(numbers.empty() ? module.value() : numbers[static_cast<std::size_t>(module)]);
}

layout::ModuleId module_with(std::uint32_t number, std::span<const int> numbers) {
  const auto value = static_cast<int>(number & 0x7FFFFFFFU);
  if (numbers.empty()) return layout::ModuleId{value};
  const auto found = std::ranges::lower_bound(numbers, value);
  return found == numbers.end() || *found != value ? layout::ModuleId::none()
                                                   : layout::ModuleId{found - numbers.begin()};
}

}  // namespace

std::vector<std::uint8_t> encode_raw(std::span<const ModuleSample> samples, std::span<const int> numbers) {
  CdrWriter w;
  const ModuleSample& first = samples.front();
  w.u8(first.sample.node_address);
  w.u32(first.sample.sample);
  w.u64(first.sample.device_time_us);
  w.u64(first.link_time_us);
  put_each(w, samples, 1, [&](const ModuleSample& s) { w.u32(number_of(s.module, numbers)); });
  put_each(w, samples, 1, [&](const ModuleSample& s) { w.u8(s.sample.module); });
  put_each(w, samples, 1, [&](const ModuleSample& s) { w.u16(s.sample.valid); });
  put_each(w, samples, 1, [&](const ModuleSample& s) { w.u8(wire::wire_number(s.sample.state)); });
  put_each(w, samples, 1,
           [&](const ModuleSample& s) { w.u32(static_cast<std::uint32_t>(s.link_time_us - first.link_time_us)); });
  put_each(w, samples, 1, [&](const ModuleSample& s) {
    w.u32(static_cast<std::uint32_t>(s.sample.device_time_us - first.sample.device_time_us));
  });
  put_each(w, samples, layout::kTaxelsPerModule, [&](const ModuleSample& s) {
    for (const std::uint16_t v : s.sample.value) w.u16(v);
  });
  w.u64(first.sampled_ns);
  w.u32(first.error_us);
  return bytes_of(w);
}

std::optional<std::vector<ModuleSample>> decode_raw(Bytes message, std::span<const int> numbers) {
  CdrReader r(message);
  ModuleSample common;
  common.sample.node_address = r.u8();
  common.sample.sample = r.u32();
  common.sample.device_time_us = r.u64();
  common.link_time_us = r.u64();
  const std::size_t n = r.count(sizeof(std::uint32_t));
  std::vector<ModuleSample> samples(n, common);
  bool ok = true;
  const auto each = [&](std::size_t per_item, auto take) {
    ok = r.count(1) == n * per_item && ok;
    for (std::size_t k = 0; k < n && ok && r.ok(); ++k) take(samples[k]);
  };
  for (ModuleSample& s : samples) s.module = module_with(r.u32(), numbers);
  each(1, [&](ModuleSample& s) { s.sample.module = r.u8(); });
  each(1, [&](ModuleSample& s) { s.sample.valid = r.u16(); });
  each(1, [&](ModuleSample& s) {
    const auto state = wire::to_module_state(r.u8());
    ok = ok && state.has_value();
    if (ok) s.sample.state = *state;
  });
  each(1, [&](ModuleSample& s) { s.link_time_us += r.u32(); });
  each(1, [&](ModuleSample& s) {
    s.sample.device_time_us += static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(r.u32())});
  });
  each(layout::kTaxelsPerModule, [&](ModuleSample& s) {
    for (std::uint16_t& v : s.sample.value) v = r.u16();
  });
  if (ok) take_times(r, samples);
  if (!ok || !r.ok()) return std::nullopt;
  return samples;
}

std::vector<std::uint8_t> encode_layout(const design::Design& design, std::uint64_t stamp_ns,
                                        std::string_view frame_id) {
  const auto& modules = design.layout.modules;
  const auto wiring = design::wiring_of(design);
  std::vector<std::array<design::TaxelPose, layout::kTaxelsPerModule>> taxels;
  for (std::size_t m = 0; m < modules.size(); ++m)
    taxels.push_back(design::taxels_of(modules[m], wiring[m].routed.rotation));
  CdrWriter w;
  put_header(w, stamp_ns, frame_id);
  w.text(design.name);
  w.u64(design.design_id);
  put_each(w, modules, 9, [&](const design::PlacedModule& m) {
    for (const auto& corner : m.corner_mm) put_point(w, corner, kMetre_mm);
  });
  put_each(w, taxels, 3 * static_cast<std::size_t>(layout::kTaxelsPerModule), [&](const auto& of_module) {
    for (const auto& pose : of_module) put_point(w, pose.position_mm, kMetre_mm);
  });
  put_each(w, taxels, 3, [&](const auto& of_module) { put_point(w, of_module[0].normal, 1.0); });
  put_each(w, wiring, 1, [&](const design::ModuleWiring& m) { w.u32(static_cast<std::uint32_t>(m.patch)); });
  put_each(w, design::all_numbers(design.layout), 1, [&](int number) { w.u32(static_cast<std::uint32_t>(number)); });
  return bytes_of(w);
}

std::vector<std::uint8_t> encode_contacts(std::span<const Contact> contacts, std::uint64_t stamp_ns,
                                          std::string_view frame_id, const Calibration& calibration,
                                          std::span<const int> numbers) {
  const bool calibrated = calibration.by_taxel || calibration.newton_per_count > 0.0;
  const auto force = [&](const Contact& c) {
    if (calibration.by_taxel) return c.force_n;
    return c.change_counts * (calibrated ? calibration.newton_per_count : 1.0);
  };
  CdrWriter w;
  put_header(w, stamp_ns, frame_id);
  w.text(calibrated ? "N" : "counts");
  w.count(contacts.size());
  for (const Contact& c : contacts) {
    for (int axis = 0; axis < 3; ++axis) w.f64(c.position_mm[axis] / kMetre_mm);
    for (int axis = 0; axis < 3; ++axis) w.f64(c.normal[axis]);
    w.f64(force(c));
    w.f64(c.area_mm2 / (kMetre_mm * kMetre_mm));
    put_each(w, c.taxels, 1, [&](const PressedTaxel& t) { w.u32(number_of(t.module, numbers)); });
    put_each(w, c.taxels, 1, [&](const PressedTaxel& t) { w.u8(static_cast<std::uint8_t>(t.taxel)); });
    put_each(w, c.taxels, 1, [&](const PressedTaxel& t) { w.f32(static_cast<float>(t.change_counts)); });
    put_each(w, c.taxels, 3, [&](const PressedTaxel& t) { put_point(w, t.position_mm, kMetre_mm); });
    put_each(w, c.taxels, 3, [&](const PressedTaxel& t) { put_point(w, t.normal, 1.0); });
  }
  return bytes_of(w);
}

std::vector<std::uint8_t> encode_transform(std::string_view parent, std::string_view child, const Pose& pose,
                                           std::uint64_t stamp_ns) {
  CdrWriter w;
  w.count(1);
  put_header(w, stamp_ns, parent);
  w.text(child);
  for (const double v : pose.translation_m) w.f64(v);
  for (const double v : pose.rotation) w.f64(v);
  return bytes_of(w);
}

namespace {

// Describes a point as sensor_msgs/PointField does: offsets in bytes, types by the numbers of that message.
struct PointField {
  const char* name;
  std::uint32_t offset;
  std::uint8_t type;
};
constexpr std::uint8_t kUint8 = 2, kUint16 = 4, kUint32 = 6, kFloat32 = 7;
constexpr std::array<PointField, 10> kPointFields{{{"x", 0, kFloat32},
                                                   {"y", 4, kFloat32},
                                                   {"z", 8, kFloat32},
                                                   {"normal_x", 12, kFloat32},
                                                   {"normal_y", 16, kFloat32},
                                                   {"normal_z", 20, kFloat32},
                                                   {"module", 24, kUint32},
                                                   {"value", 28, kUint16},
                                                   {"valid", 30, kUint8},
                                                   {"taxel", 31, kUint8}}};
constexpr std::uint32_t kPointBytes = 32;

}  // namespace

PointCloud::PointCloud(const design::Design& design)
    : points_(design.layout.modules.size()), is_heard_(points_.size()), numbers_(design::all_numbers(design.layout)) {
  const auto wiring = design::wiring_of(design);
  for (std::size_t m = 0; m < points_.size(); ++m) {
    const auto taxels = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
    for (std::size_t t = 0; t < taxels.size(); ++t) points_[m][t] = {taxels[t].position_mm, taxels[t].normal, 0, false};
  }
}

void PointCloud::add(const ModuleSample& sample) {
  if (sample.module < 0 || static_cast<std::size_t>(sample.module) >= points_.size()) return;
  const auto module = static_cast<std::size_t>(sample.module);
  heard_ += is_heard_[module] ? 0 : 1;
  is_heard_[module] = true;
  auto& points = points_[module];
  for (std::size_t t = 0; t < points.size(); ++t) {
    points[t].value = sample.sample.value[t];
    points[t].valid = (sample.sample.valid >> t & 1U) != 0;
  }
}

std::vector<std::uint8_t> PointCloud::encode(std::uint64_t stamp_ns, std::string_view frame_id) const {
  const auto n = static_cast<std::uint32_t>(points_.size() * layout::kTaxelsPerModule);
  CdrWriter w;
  put_header(w, stamp_ns, frame_id);
  w.u32(1);
  w.u32(n);
  put_each(w, kPointFields, 1, [&](const PointField& f) {
    w.text(f.name);
    w.u32(f.offset);
    w.u8(f.type);
    w.u32(1);
  });
  w.u8(0);
  w.u32(kPointBytes);
  w.u32(kPointBytes * n);
  w.count(kPointBytes * n);
  // A point starts at a multiple of 4 bytes in the message, so that its fields are aligned as CDR requires.
  for (std::size_t m = 0; m < points_.size(); ++m) {
    for (std::size_t t = 0; t < points_[m].size(); ++t) {
      const Point& p = points_[m][t];
      put_point(w, p.position_mm, kMetre_mm);
      put_point(w, p.normal, 1.0);
      w.u32(static_cast<std::uint32_t>(numbers_[m]));
      w.u16(p.value);
      w.u8(p.valid ? 1 : 0);
      w.u8(static_cast<std::uint8_t>(t));
    }
  }
  w.u8(1);
  return bytes_of(w);
}

}  // namespace triskin::recording
