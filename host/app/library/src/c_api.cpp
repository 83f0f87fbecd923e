// SPDX-License-Identifier: GPL-3.0-or-later
// Implements the functions of triskin.h; no exception leaves them.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "guarded.hpp"
#include "skin.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"

// The C interface declares this handle without its contents.
struct triskin_skin {
  triskin::library::Skin skin;
  std::string report;
};

namespace triskin::library {
namespace {

// The options of an older caller end earlier, so the other fields keep their defaults.
triskin_options complete(const triskin_options* given) {
  triskin_options options = TRISKIN_OPTIONS_INIT;
  if (given == nullptr) return options;
  require(given->size >= sizeof(std::size_t), "options: size is not set; begin with TRISKIN_OPTIONS_INIT");
  std::memcpy(&options, given, std::min(given->size, sizeof options));
  options.size = sizeof options;
  return options;
}

}  // namespace
}  // namespace triskin::library

using triskin::library::guarded;
using triskin::library::require;
using triskin::library::require_size;

const char* triskin_version(void) {
  return TRISKIN_VERSION;
}

const char* triskin_error(void) {
  return triskin::library::last_error().c_str();
}

triskin_status triskin_open(const char* file, const triskin_options* options, triskin_skin** skin) {
  return guarded([&] {
    require(skin != nullptr && file != nullptr, "triskin_open: an argument is NULL");
    *skin = nullptr;
    const triskin_options all = triskin::library::complete(options);
    *skin = new triskin_skin{{triskin::library::read_source(file, all), all}, {}};
    return TRISKIN_OK;
  });
}

void triskin_close(triskin_skin* skin) {
  delete skin;
}

size_t triskin_module_count(const triskin_skin* skin) {
  return skin->skin.source().design.layout.modules.size();
}

triskin_status triskin_positions_mm(const triskin_skin* skin, double* xyz_mm, size_t n) {
  return guarded([&] {
    require_size("triskin_positions_mm", n, triskin_module_count(skin) * 3 * TRISKIN_TAXELS);
    triskin::library::write_poses(skin->skin.source().design, xyz_mm,
                                  [](const auto& pose) { return pose.position_mm; });
    return TRISKIN_OK;
  });
}

triskin_status triskin_normals(const triskin_skin* skin, double* normals, size_t n) {
  return guarded([&] {
    require_size("triskin_normals", n, triskin_module_count(skin) * 3 * TRISKIN_TAXELS);
    triskin::library::write_poses(skin->skin.source().design, normals, [](const auto& pose) { return pose.normal; });
    return TRISKIN_OK;
  });
}

triskin_status triskin_patches(const triskin_skin* skin, int32_t* patches, size_t n) {
  return guarded([&] {
    require_size("triskin_patches", n, triskin_module_count(skin));
    for (const auto& m : triskin::design::wiring_of(skin->skin.source().design)) *patches++ = m.patch;
    return TRISKIN_OK;
  });
}

triskin_status triskin_module_numbers(const triskin_skin* skin, int32_t* numbers, size_t n) {
  return guarded([&] {
    require_size("triskin_module_numbers", n, triskin_module_count(skin));
    std::ranges::copy(triskin::design::all_numbers(skin->skin.source().design.layout), numbers);
    return TRISKIN_OK;
  });
}

size_t triskin_cover_count(const triskin_skin* skin) {
  return skin->skin.source().covers.size();
}

const char* triskin_cover_name(const triskin_skin* skin, size_t cover) {
  const auto& names = skin->skin.source().covers;
  return cover < names.size() ? names[cover].c_str() : "";
}

triskin_status triskin_covers(const triskin_skin* skin, int32_t* covers, size_t n) {
  return guarded([&] {
    require_size("triskin_covers", n, triskin_module_count(skin));
    const auto& offsets = skin->skin.source().offsets;
    for (std::size_t m = 0, cover = 0; m < n; ++m) {
      while (cover + 1 < offsets.size() && static_cast<std::size_t>(offsets[cover + 1].module) <= m) ++cover;
      covers[m] = static_cast<std::int32_t>(cover);
    }
    return TRISKIN_OK;
  });
}

triskin_status triskin_start(triskin_skin* skin) {
  return guarded([&] {
    skin->skin.start();
    return TRISKIN_OK;
  });
}

triskin_status triskin_read(triskin_skin* skin, double timeout_s, triskin_sample* samples, size_t capacity,
                            size_t* count) {
  return guarded([&] {
    require(samples != nullptr && count != nullptr, "triskin_read: an argument is NULL");
    *count = 0;
    *count = skin->skin.read(timeout_s, samples, capacity);
    return TRISKIN_OK;
  });
}

double triskin_now_s(const triskin_skin* skin) {
  return skin->skin.now_s();
}

triskin_status triskin_get_counts(triskin_skin* skin, triskin_counts* counts) {
  return guarded([&] {
    if (counts != nullptr) *counts = skin->skin.counts();
    return TRISKIN_OK;
  });
}

triskin_status triskin_stop(triskin_skin* skin) {
  return guarded([&] {
    skin->skin.stop();
    return TRISKIN_OK;
  });
}

triskin_status triskin_tare(triskin_skin* skin) {
  return guarded([&] {
    skin->skin.tare();
    return TRISKIN_OK;
  });
}

triskin_status triskin_change_counts(triskin_skin* skin, double* change_counts, size_t n) {
  return guarded([&] {
    const std::size_t modules = triskin_module_count(skin);
    require_size("triskin_change_counts", n, modules * TRISKIN_TAXELS);
    for (std::size_t m = 0; m < modules; ++m)
      change_counts = std::ranges::copy(skin->skin.change_counts(triskin::layout::SkinModule{m}), change_counts).out;
    return TRISKIN_OK;
  });
}

triskin_status triskin_calibration(triskin_skin* skin, double* counts_per_kpa, double* taxel_area_mm2, size_t n) {
  return guarded([&] {
    require_size("triskin_calibration", n, triskin_module_count(skin) * TRISKIN_TAXELS);
    std::size_t unknown = 0;
    for (const auto& module : skin->skin.calibration()) {
      counts_per_kpa = std::ranges::copy(module.counts_per_kpa, counts_per_kpa).out;
      if (taxel_area_mm2 != nullptr) *taxel_area_mm2++ = module.taxel_area_mm2;
      unknown += module.known ? 0 : 1;
    }
    if (unknown == 0) return TRISKIN_OK;
    const std::string text =
        fmt::format("{} {} no calibration; run triskin calibrate", triskin::counted(unknown, "module"),
                    triskin::agreeing(unknown, "has", "have"));
    return triskin::library::failed(TRISKIN_BAD_ANSWER, text.c_str());
  });
}

triskin_status triskin_verify(triskin_skin* skin, const char** report) {
  return guarded([&] {
    auto [text, found] = skin->skin.verify();
    skin->report = std::move(text);
    if (report != nullptr) *report = skin->report.c_str();
    return found ? triskin::library::failed(TRISKIN_BAD_ANSWER, skin->report.c_str()) : TRISKIN_OK;
  });
}
