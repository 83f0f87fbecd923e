// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/contact_stream.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "triskin/design/calibration.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/hardware/skin_place.hpp"
#include "triskin/mechanics/layer.hpp"

namespace triskin::scenario {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;
using design::Vec3;
using nlohmann::json;

constexpr const char* kPage = "docs/simulation.md";
constexpr const char* kCover = "cover";
constexpr double kMaxLength_mm = 1e5;
constexpr double kMaxForce_n = 1e4;
constexpr double kForceRadius_mm = 6.0, kTipRadius_mm = 10.0;
// Another simulator touches its own shape of the body, which differs from the surface of the skin by a few millimetres.
constexpr double kMaxOffset_mm = 30.0;

double seconds(std::uint64_t time_us) {
  return static_cast<double>(time_us) * 1e-6;
}

// Returns in millimetres a length that is given as NAME_mm or NAME_m; empty if neither is present.
std::optional<std::pair<JsonValue, double>> field_in_mm(const JsonValue& v, const std::string& name) {
  const std::string in_mm = name + "_mm", in_m = name + "_m";
  if (has(v, in_mm.c_str()) && has(v, in_m.c_str()))
    v.fail_at_key(in_m, fmt::format("has {} and {}; leave one out", in_mm, in_m));
  if (has(v, in_mm.c_str())) return std::pair{v[in_mm.c_str()], 1.0};
  if (has(v, in_m.c_str())) return std::pair{v[in_m.c_str()], 1000.0};
  return std::nullopt;
}

double length_mm(const JsonValue& v, const std::string& name, double low_mm, double high_mm, double otherwise_mm) {
  const auto field = field_in_mm(v, name);
  if (!field) return otherwise_mm;
  return number_in(field->first, low_mm / field->second, high_mm / field->second) * field->second;
}

Vec3 point_mm(const JsonValue& v) {
  const auto field = field_in_mm(v, "point");
  if (!field) v.fail("needs \"point_m\" or \"point_mm\": where it is, in the frame of the mesh");
  field->first.require_size(3);
  Vec3 point;
  for (std::size_t k = 0; k < 3; ++k)
    point[static_cast<Eigen::Index>(k)] =
        number_in(field->first.at(k), -kMaxLength_mm / field->second, kMaxLength_mm / field->second) * field->second;
  return point;
}

// Computes force and radius of a sphere that sinks into the dielectric, by the elastic foundation (docs/mechanics.md).
void press_in(hardware::Contact& c, double depth_mm, double tip_radius_mm) {
  const mechanics::Layer layer;
  c.force_n = design::kNewtonPerKpaMm2 * std::numbers::pi * tip_radius_mm * depth_mm * depth_mm *
              mechanics::confined_modulus_kpa(layer) / layer.thickness_mm;
  c.radius_mm = std::sqrt(2.0 * tip_radius_mm * depth_mm);
}

std::optional<hardware::SkinPlace> on_skin(const design::Design& design, const JsonValue& v, const Vec3& point) {
  if (has(v, "normal")) {
    const Vec3 normal = design::vec3(v["normal"]);
    if (!(normal.norm() > 0.0)) v["normal"].fail("has no length; give the direction away from the body");
    const auto hit = hardware::place_on_ray(design, point + kMaxOffset_mm * normal.normalized(), -normal);
    if (hit && (hit->position_mm - point).norm() <= kMaxOffset_mm) return hit;
  }
  auto nearest = hardware::nearest_place(design, point);
  if (nearest && nearest->distance_mm > kMaxOffset_mm) nearest.reset();
  return nearest;
}

struct Step {
  std::uint64_t until_us = 0;
  std::vector<hardware::Contact> contacts;
  int elsewhere = 0, unfelt = 0;
};

// Reads force and radius, which a file may also give as the depth of a tip.
hardware::Contact read_press(const JsonValue& v) {
  hardware::Contact c;
  const bool by_force = has(v, "force_n"), by_depth = field_in_mm(v, "depth").has_value();
  if (by_force == by_depth) v.fail("needs either \"force_n\" or \"depth_m\" (\"depth_mm\")");
  c.radius_mm = length_mm(v, "radius", 0.1, 1000.0, kForceRadius_mm);
  if (by_force) c.force_n = number_in(v["force_n"], 0.0, kMaxForce_n);
  constexpr double kMaxDepthShare = 0.99;
  if (by_depth)
    press_in(c, length_mm(v, "depth", 0.0, kMaxDepthShare * mechanics::Layer{}.thickness_mm, 0.0),
             length_mm(v, "tip_radius", 0.1, 1000.0, kTipRadius_mm));
  return c;
}

void read_contact(const design::Design& design, const JsonValue& v, Step& step) {
  design::only_keys(v,
                    {"body", "point_m", "point_mm", "normal", "force_n", "radius_m", "radius_mm", "depth_m", "depth_mm",
                     "tip_radius_m", "tip_radius_mm"},
                    kPage);
  if (has(v, "body") && v["body"].text() != kCover && v["body"].text() != design.name) {
    ++step.elsewhere;
    return;
  }
  const Vec3 point = point_mm(v);
  hardware::Contact c = read_press(v);
  const auto place = on_skin(design, v, point);
  if (!place) {
    ++step.unfelt;
    return;
  }
  c.position_mm = place->position_mm;
  if (c.force_n > 0.0) step.contacts.push_back(c);
}

Step read_step(const design::Design& design, const std::string& line, std::uint64_t now_us) {
  const std::string name = "contacts";
  const json document = design::parse_json(line, name);
  const JsonValue v(document, name);
  design::only_keys(v, {"time_s", "contacts"}, kPage);
  Step step;
  const double time_s = number_in(v["time_s"], 0.0, 1e7);
  if (time_s < seconds(now_us))
    v["time_s"].fail(fmt::format("is before the time of the skin, {:g} s", seconds(now_us)));
  if (time_s > seconds(now_us) + ContactStream::kMaxStep_s)
    v["time_s"].fail(fmt::format("is more than {:g} s ahead; make smaller steps", ContactStream::kMaxStep_s));
  step.until_us = static_cast<std::uint64_t>(std::llround(time_s * 1e6));
  const JsonValue list = v["contacts"];
  if (list.size() > ContactStream::kMaxContacts)
    list.fail(fmt::format("has {} contacts, at most {} are taken", list.size(), ContactStream::kMaxContacts));
  for (std::size_t k = 0; k < list.size(); ++k) read_contact(design, list.at(k), step);
  return step;
}

json frame_json(const wire::CanFrame& frame, std::uint64_t at_us) {
  return {{"at_s", seconds(at_us)},
          {"id", frame.id},
          {"extended", frame.extended},
          {"fd", frame.fd},
          {"data", fmt::format("{:02X}", fmt::join(frame.payload(), ""))}};
}

// Returns true if a taxel of the module lies in the contact.
bool is_felt(const hardware::VirtualSkin& hardware, const hardware::Contact& contact) {
  const design::Design& design = hardware.scene().design;
  const auto wiring = design::wiring_of(design);
  for (std::size_t m = 0; m < wiring.size(); ++m) {
    const auto taxels = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      if (layout::measures_pressure(t) && hardware::reaches(contact, taxels[t].position_mm)) return true;
    }
  }
  return false;
}

}  // namespace

struct ContactStream::Answer {
  json frames = json::array(), samples = json::array();
  std::vector<int> numbers;  // by module
  const design::RestValues* rest = nullptr;
};

ContactStream::ContactStream(hardware::Scene scene) : answer_(std::make_unique<Answer>()) {
  Answer* answer = answer_.get();
  answer->numbers = design::all_numbers(scene.design.layout);
  skin_ = std::make_unique<RunningSkin>(
      std::move(scene),
      [answer](const session::ModuleSample& s) {
        if (answer->rest == nullptr) return;
        answer->samples.push_back({{"module", answer->numbers.at(static_cast<std::size_t>(s.module))},
                                   {"at_s", seconds(s.sampled.link_us)},
                                   {"state", hardware::kModuleStateNames.name(s.sample.state)},
                                   {"change_counts", changes_of(s, *answer->rest)}});
      },
      [answer](const wire::CanFrame& frame, std::uint64_t at_us) {
        if (answer->rest != nullptr) answer->frames.push_back(frame_json(frame, at_us));
      });
  // While the controllers search the offsets of their converters, a touch would become the rest value.
  constexpr std::uint64_t kStarted_us = 1'000'000;
  skin_->run_until(kStarted_us);
  answer_->rest = &skin_->rest();
}

ContactStream::~ContactStream() = default;

double ContactStream::time_s() const {
  return seconds(skin_->now_us());
}

std::string ContactStream::greeting() const {
  const design::Design& design = skin_->hardware().scene().design;
  return json{{"format", "triskin-contacts"},
              {"version", 1},
              {"design", fmt::format("{:016x}", design.design_id)},
              {"modules", design.layout.modules.size()},
              {"counts_per_kpa", hardware::kCountsPerKpa},
              {"taxel_area_mm2", taxel_area_mm2(design.layout.corner_cut_mm)},
              {"time_s", time_s()}}
      .dump();
}

std::string ContactStream::take(const std::string& line) {
  Step step = read_step(skin_->hardware().scene().design, line, skin_->now_us());
  for (const int id : touches_) skin_->hardware().skin().release(id, skin_->now_us());
  touches_.clear();
  for (hardware::Contact& c : step.contacts) {
    c.from_us = skin_->now_us();
    if (!is_felt(skin_->hardware(), c)) ++step.unfelt;
    touches_.push_back(skin_->hardware().skin().press(c));
  }
  answer_->frames = json::array();
  answer_->samples = json::array();
  skin_->run_until(step.until_us);
  return json{
      {"time_s", time_s()},          {"frames", std::move(answer_->frames)}, {"samples", std::move(answer_->samples)},
      {"contacts", touches_.size()}, {"elsewhere", step.elsewhere},          {"unfelt", step.unfelt}}
      .dump();
}

}  // namespace triskin::scenario
