// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/cad/select_faces.hpp"

namespace triskin::cad {
namespace {

using nlohmann::json;

template <class Value>
void put_list(json& out, const char* key, const std::vector<Value>& values) {
  if (!values.empty()) out[key] = values;
}
template <class Value>
void take(const json& from, const char* key, Value& value) {
  if (from.contains(key)) from.at(key).get_to(value);
}
void take_area(const json& from, const char* key, std::optional<double>& area) {
  if (from.contains(key)) area = from.at(key).get<double>();
}

}  // namespace

std::string selection_text(const FaceSelection& s) {
  json out = json::object();
  put_list(out, "indices", s.indices);
  put_list(out, "names", s.names);
  put_list(out, "colours", s.colours);
  for (const SurfaceKind kind : s.kinds) out["kinds"].push_back(kSurfaceKindNames.name(kind));
  put_list(out, "bodies", s.bodies);
  put_list(out, "without_bodies", s.without_bodies);
  if (s.min_area_cm2) out["min_area_cm2"] = *s.min_area_cm2;
  if (s.max_area_cm2) out["max_area_cm2"] = *s.max_area_cm2;
  if (s.from_point_mm) {
    out["from_point_mm"] = {s.from_point_mm->x(), s.from_point_mm->y(), s.from_point_mm->z()};
    out["smooth_deg"] = s.smooth_deg;
  }
  if (s.only_outward) out["only_outward"] = true;
  if (s.without_holes_mm > 0.0) out["without_holes_mm"] = s.without_holes_mm;
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

FaceSelection parse_selection(const std::string& text) {
  FaceSelection s;
  try {
    const json from = json::parse(text);
    std::vector<int> indices;
    take(from, "indices", indices);
    for (const int f : indices) s.indices.emplace_back(f);
    take(from, "names", s.names);
    take(from, "colours", s.colours);
    for (const json& kind : from.value("kinds", json::array()))
      s.kinds.push_back(kSurfaceKindNames.value(kind.get<std::string>()).value());
    take(from, "bodies", s.bodies);
    take(from, "without_bodies", s.without_bodies);
    take_area(from, "min_area_cm2", s.min_area_cm2);
    take_area(from, "max_area_cm2", s.max_area_cm2);
    take(from, "smooth_deg", s.smooth_deg);
    take(from, "only_outward", s.only_outward);
    take(from, "without_holes_mm", s.without_holes_mm);
    if (from.contains("from_point_mm")) {
      const auto p = from.at("from_point_mm").get<std::array<double, 3>>();
      s.from_point_mm = design::Vec3(p[0], p[1], p[2]);
    }
  } catch (const json::exception&) {
    throw InputError("the selection of faces is damaged; choose the faces again");
  } catch (const std::bad_optional_access&) {
    throw InputError("the selection of faces names an unknown kind of surface; choose the faces again");
  }
  return s;
}

}  // namespace triskin::cad
