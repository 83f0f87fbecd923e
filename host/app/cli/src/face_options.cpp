// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_options.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "triskin/base/error.hpp"

namespace triskin::cli {
namespace {

design::Vec3 point_of(const std::string& text) {
  std::array<double, 3> values{};
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [rest, error] = std::from_chars(at, end, values[k]);
    const bool is_separated = k == 2 ? rest == end : rest != end && *rest == ',';
    if (error != std::errc{} || !std::isfinite(values[k]) || !is_separated)
      throw InputError(fmt::format("--face-from {}: wanted x,y,z in mm", text));
    at = rest + 1;
  }
  return {values[0], values[1], values[2]};
}

}  // namespace

void FaceOptions::add_to(CLI::App& app) {
  const std::string kGroup = "Faces of a STEP or IGES file (see triskin faces)";
  const auto add = [&](CLI::Option* option) { return option->group(kGroup); };
  add(app.add_option("--face", faces_, "by index; several with commas"))->delimiter(',');
  add(app.add_option("--face-name", chosen_.names, "by name; may be repeated"))->expected(1)->take_all();
  add(app.add_option("--face-color", chosen_.colours, "by colour, #rrggbb or a name such as red; may be repeated"))
      ->expected(1)
      ->take_all();
  add(app.add_option("--face-kind", kinds_, "by kind of surface: " + cad::kSurfaceKindNames.list()))->delimiter(',');
  add(app.add_option("--face-min-cm2", min_area_cm2_, "no smaller ones"))->check(CLI::Range(0.0, 1e6));
  add(app.add_option("--face-max-cm2", max_area_cm2_, "no larger ones"))->check(CLI::Range(0.0, 1e6));
  add(app.add_option("--face-from", point_, "x,y,z in mm: the face nearest to it and what continues it smoothly"));
  add(app.add_option("--face-smooth-deg", chosen_.smooth_deg, "edges that turn less than this are smooth"))
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  add(app.add_flag("--face-outward", chosen_.only_outward, "only those that look outward"));
  add(app.add_option("--face-no-holes-mm", chosen_.without_holes_mm, "no walls of round holes up to this diameter"))
      ->check(CLI::Range(0.0, 1e4));
  add(app.add_option("--body", chosen_.bodies, "only of this body, by index, name or path; may be repeated"))
      ->expected(1)
      ->take_all();
  add(app.add_option("--no-body", chosen_.without_bodies, "not of this body; may be repeated"))
      ->expected(1)
      ->take_all();
}

cad::FaceSelection FaceOptions::selection() const {
  cad::FaceSelection selection = chosen_;
  for (const int face : faces_) selection.indices.emplace_back(face);
  for (const std::string& name : kinds_) {
    const auto kind = cad::kSurfaceKindNames.value(name);
    if (!kind) throw InputError(fmt::format("--face-kind {}: wanted {}", name, cad::kSurfaceKindNames.list()));
    selection.kinds.push_back(*kind);
  }
  if (min_area_cm2_ > 0.0) selection.min_area_cm2 = min_area_cm2_;
  if (max_area_cm2_ > 0.0) selection.max_area_cm2 = max_area_cm2_;
  if (!point_.empty()) selection.from_point_mm = point_of(point_);
  return selection;
}

}  // namespace triskin::cli
