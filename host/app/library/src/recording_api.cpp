// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "guarded.hpp"
#include "sample.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/recording/recorded_skin.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/skin/touch_map.hpp"

// The C interface declares this handle without its contents.
struct triskin_recording {
  triskin::recording::RecordedSkin skin;
  std::string name;
  std::vector<triskin_sample> samples;
  std::vector<double> change_counts;  // Each sample has 12 values.
};

namespace triskin::library {
namespace {

triskin_sample recorded_sample(const recording::ModuleSample& s, std::uint64_t unix_start_ns,
                               std::uint64_t link_start_us) {
  constexpr double kNanos = 1e9, kMicros = 1e6;
  // A sample that was taken before its time was known has only that of its arrival.
  const double time_s = s.sampled_ns != 0 ? static_cast<double>(s.sampled_ns) / kNanos
                                          : static_cast<double>(unix_start_ns) / kNanos +
                                                static_cast<double>(s.link_time_us - link_start_us) / kMicros;
  const double error_s =
      s.error_us == recording::ModuleSample::kNoBound ? std::numeric_limits<double>::infinity() : s.error_us / kMicros;
  return sample_of(s.sample, s.module, time_s, error_s);
}

// Returns 0 if the recording does not contain the fact.
std::uint64_t number_fact(const recording::RecordedSkin& skin, const char* key) {
  const auto found = skin.facts.find(key);
  return found == skin.facts.end() ? 0 : std::strtoull(found->second.c_str(), nullptr, 10);
}

void read_samples(triskin_recording& r, const std::string& file) {
  const std::uint64_t unix_start_ns = number_fact(r.skin, "unix_start_ns");
  const std::uint64_t link_start_us = number_fact(r.skin, "link_start_us");
  const std::size_t modules = r.skin.design.layout.modules.size();
  skin::TouchMap touches(r.skin.design, r.skin.rest);
  (void)recording::read_recording(file, [&](const recording::ModuleSample& s) {
    if (s.module < 0 || static_cast<std::size_t>(s.module) >= modules)
      throw InputError(fmt::format("{}: a sample is of a module that its design does not have", file));
    touches.add({s.module, s.link_time_us, s.sample});
    r.samples.push_back(recorded_sample(s, unix_start_ns, link_start_us));
    std::ranges::copy(touches.change(s.module), std::back_inserter(r.change_counts));
  });
}

}  // namespace
}  // namespace triskin::library

using triskin::library::guarded;
using triskin::library::require;
using triskin::library::require_size;

triskin_status triskin_recording_open(const char* file, triskin_recording** recording) {
  return guarded([&] {
    require(recording != nullptr && file != nullptr, "triskin_recording_open: an argument is NULL");
    *recording = nullptr;
    auto read = std::make_unique<triskin_recording>();
    read->skin = triskin::recording::recorded_skin(file);
    const auto cover = read->skin.facts.find("cover");
    read->name = cover == read->skin.facts.end() ? read->skin.design.name : cover->second;
    triskin::library::read_samples(*read, file);
    *recording = read.release();
    return TRISKIN_OK;
  });
}

void triskin_recording_close(triskin_recording* recording) {
  delete recording;
}

size_t triskin_recording_module_count(const triskin_recording* recording) {
  return recording->skin.design.layout.modules.size();
}

size_t triskin_recording_sample_count(const triskin_recording* recording) {
  return recording->samples.size();
}

const char* triskin_recording_name(const triskin_recording* recording) {
  return recording->name.c_str();
}

int triskin_recording_is_simulated(const triskin_recording* recording) {
  return recording->skin.facts.contains("simulated") ? 1 : 0;
}

triskin_status triskin_recording_geometry(const triskin_recording* recording, double* xyz_mm, double* normals,
                                          int32_t* patches, size_t n) {
  return guarded([&] {
    const triskin::design::Design& design = recording->skin.design;
    require_size("triskin_recording_geometry", n, design.layout.modules.size() * 3 * TRISKIN_TAXELS);
    if (xyz_mm != nullptr)
      triskin::library::write_poses(design, xyz_mm, [](const auto& pose) { return pose.position_mm; });
    if (normals != nullptr)
      triskin::library::write_poses(design, normals, [](const auto& pose) { return pose.normal; });
    if (patches == nullptr) return TRISKIN_OK;
    for (const auto& m : triskin::design::wiring_of(design)) *patches++ = m.patch;
    return TRISKIN_OK;
  });
}

triskin_status triskin_recording_module_numbers(const triskin_recording* recording, int32_t* numbers, size_t n) {
  return guarded([&] {
    const triskin::design::ModuleLayout& layout = recording->skin.design.layout;
    require_size("triskin_recording_module_numbers", n, layout.modules.size());
    std::ranges::copy(triskin::design::all_numbers(layout), numbers);
    return TRISKIN_OK;
  });
}

triskin_status triskin_recording_samples(const triskin_recording* recording, triskin_sample* samples,
                                         double* change_counts, size_t n) {
  return guarded([&] {
    require(samples != nullptr, "triskin_recording_samples: samples is NULL");
    require_size("triskin_recording_samples", n, recording->samples.size());
    std::ranges::copy(recording->samples, samples);
    if (change_counts != nullptr) std::ranges::copy(recording->change_counts, change_counts);
    return TRISKIN_OK;
  });
}

triskin_status triskin_recording_calibration(const triskin_recording* recording, double* counts_per_kpa,
                                             double* taxel_area_mm2, size_t n) {
  return guarded([&] {
    const std::size_t modules = recording->skin.design.layout.modules.size();
    require(counts_per_kpa != nullptr, "triskin_recording_calibration: counts_per_kpa is NULL");
    require_size("triskin_recording_calibration", n, modules * TRISKIN_TAXELS);
    const triskin::design::SkinCalibration& skin = recording->skin.calibration;
    for (std::size_t m = 0; m < modules; ++m) {
      const triskin::layout::ModuleId module{m};
      for (triskin::layout::TaxelIndex t; t < TRISKIN_TAXELS; ++t)
        *counts_per_kpa++ = skin.complete() ? skin.counts_per_kpa({module, t}) : 0.0;
      if (taxel_area_mm2 != nullptr) *taxel_area_mm2++ = skin.complete() ? skin.taxel_area_mm2(module) : 0.0;
    }
    if (skin.complete()) return TRISKIN_OK;
    return triskin::library::failed(TRISKIN_BAD_ANSWER, "the recording holds no calibration of all its modules");
  });
}
