// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "triskin/base/files.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/wall_clock.hpp"
#include "triskin/base/writer_lock.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::skin {
namespace {

constexpr std::uint64_t kUsPerS = 1'000'000;
constexpr std::uint16_t kEndOfRange = 0xFFFF;  // Beyond its range the converter returns this or 0.
constexpr std::size_t kRampBins = 32;          // A ramp is reduced to this many means.

std::uint64_t us_of(double seconds) {
  return static_cast<std::uint64_t>(std::llround(seconds * static_cast<double>(kUsPerS)));
}

// Computes the mean reading of each taxel for each bin of pressure.
class TaxelMeans {
 public:
  explicit TaxelMeans(std::size_t modules) : modules_(modules), pads_(modules) {}

  void add(const session::ModuleSample& f, std::size_t bin, double pressure_kpa) {
    Module& module = modules_.at(static_cast<std::size_t>(f.module));
    const double warming_counts = warming_of(f);
    for (std::size_t t = 0; t < module.size(); ++t) {
      const std::uint16_t value = f.sample.value[t];
      if ((f.sample.valid >> t & 1) == 0 || value == 0 || value == kEndOfRange) continue;
      if (module[t].size() <= bin) module[t].resize(bin + 1);
      Sum& sum = module[t][bin];
      sum.samples += 1.0;
      sum.pressure_kpa += pressure_kpa;
      sum.value_counts += value + warming_counts;
    }
  }
  [[nodiscard]] std::vector<CalibrationPoint> points(layout::ModuleId module, std::size_t taxel) const {
    std::vector<CalibrationPoint> points;
    for (const Sum& sum : modules_.at(static_cast<std::size_t>(module)).at(taxel)) {
      if (sum.samples > 0.0)
        points.push_back({sum.pressure_kpa / sum.samples, sum.value_counts / sum.samples, sum.samples});
    }
    return points;
  }

 private:
  // Returns how far the temperature pads read below their first value, as in TouchMap.
  double warming_of(const session::ModuleSample& f) {
    auto& first = pads_.at(static_cast<std::size_t>(f.module));
    double sum = 0.0;
    int known = 0;
    for (std::size_t p = 0; p < first.size(); ++p) {
      const auto t = layout::kTemperaturePads[p];
      if ((f.sample.valid >> t & 1) == 0) continue;
      if (!first[p]) first[p] = f.sample.value[t];
      sum += *first[p] - f.sample.value[t];
      ++known;
    }
    return known > 0 ? sum / known : 0.0;
  }

  using Sum = CalibrationPoint;  // Here the point holds sums of samples instead of their mean.
  using Module = std::array<std::vector<Sum>, layout::kTaxelsPerModule>;
  std::vector<Module> modules_;
  std::vector<std::array<std::optional<double>, layout::kTemperaturePads.size()>> pads_;
};

class Fit {
 public:
  Fit(session::Bus& bus, const design::Design& design, const CalibrateOptions& options)
      : bus_(bus), design_(design), options_(options), means_(design.layout.modules.size()) {}

  [[nodiscard]] TaxelMeans& means() { return means_; }

  // `measured` is in ascending order.
  CalibrationOutcome finish(double max_kpa, std::vector<layout::ModuleId> measured) {
    outcome_.measured = std::move(measured);
    outcome_.rest.resize(design_.layout.modules.size());
    for (auto& module : outcome_.rest) module.fill(layout::kRestCounts);
    const auto claims = bus_.discover();
    for (const layout::PatchIndex patch : design::patches_here(design_)) {
      design::BoardCalibration board;
      board.serial = session::serial_at(claims, design::node_address_of(design_, patch));
      if (board.serial.empty())
        throw DeviceError(
            fmt::format("{}: the controller of patch {} has gone silent; nothing was kept", bus_.name(), patch));
      board.design_id = design_.design_id;
      board.patch = patch;
      board.method = options_.method;
      board.max_kpa = max_kpa;
      board.taxel_area_mm2 = design::module_area_mm2(design_.layout.corner_cut_mm) / layout::kPressureTaxelsPerModule;
      for (const design::RoutedModule& routed : design_.patches[static_cast<std::size_t>(patch)].modules) {
        design::PlaceCalibration place = fit(routed);
        if (is_measured(layout::ModuleId{routed.node})) board.places.push_back(place);
      }
      if (!board.places.empty()) outcome_.boards.push_back(std::move(board));
    }
    outcome_.quality = design::quality_of(outcome_.boards);
    return std::move(outcome_);
  }

 private:
  [[nodiscard]] bool is_measured(layout::ModuleId module) const {
    return std::ranges::binary_search(outcome_.measured, module);
  }
  // Modules that were not measured give their rest values alone.
  design::PlaceCalibration fit(const design::RoutedModule& routed) {
    const layout::ModuleId module{routed.node};
    design::PlaceCalibration place{routed.line, routed.address, {}};
    for (std::size_t t = 0; t < place.taxels.size(); ++t) {
      const auto points = means_.points(module, t);
      double& rest = outcome_.rest[static_cast<std::size_t>(routed.node)][t];
      if (!points.empty()) rest = points.front().value_counts;
      if (!layout::measures_pressure(t) || !is_measured(module)) continue;
      auto line = fit_sensitivity(points);
      if (line) line->sensitivity.error_percent += options_.gauge_percent;
      if (!line || line->sensitivity.error_percent > options_.max_error_percent) {
        outcome_.without.push_back({module, layout::TaxelIndex{t}});
        continue;
      }
      rest = line->rest_counts;
      place.taxels[t] = line->sensitivity;
    }
    return place;
  }

  session::Bus& bus_;
  const design::Design& design_;
  const CalibrateOptions& options_;
  TaxelMeans means_;
  CalibrationOutcome outcome_;
};

// Returns the modules of which all steps are among the first `held`. A step of the whole skin belongs to all modules.
std::vector<layout::ModuleId> measured_modules(std::vector<layout::ModuleId> wanted,
                                               std::span<const PressureStep> steps, std::size_t held) {
  const auto left = steps.subspan(held);
  std::erase_if(wanted, [&](layout::ModuleId module) {
    return std::ranges::any_of(left, [&](const PressureStep& s) { return s.module < 0 || s.module == module; });
  });
  return wanted;
}

// Holds one pressure and takes its samples.
void hold(session::Bus& bus, const design::Design& design, const PressureStep& step, std::size_t bin,
          const CalibrateOptions& options, Fit& fit) {
  std::uint64_t from_us = ~std::uint64_t{0};
  const auto take = [&](const session::ModuleSample& f) {
    if (step.module >= 0 && f.module != step.module) return;
    if (f.sampled.link_us >= from_us) fit.means().add(f, bin, step.pressure_kpa);
  };
  session::Stream stream(bus, design, take, options.stream);
  from_us = bus.now_us() + us_of(options.settle_s);
  const std::uint64_t until_us = from_us + us_of(options.hold_s);
  while (bus.now_us() < until_us) stream.run_until(std::min(until_us, bus.now_us() + kUsPerS / 2));
  stream.finish();
}

}  // namespace

std::vector<layout::ModuleId> wanted_modules(const design::Design& design, const CalibrateOptions& options) {
  if (!options.modules.empty()) return options.modules;
  std::vector<layout::ModuleId> all;
  for (const layout::PatchIndex patch : design::patches_here(design)) {
    for (const design::RoutedModule& m : design.patches[static_cast<std::size_t>(patch)].modules)
      all.emplace_back(m.node);
  }
  std::ranges::sort(all);
  return all;
}

CalibrationOutcome calibrate_by_steps(session::Bus& bus, const design::Design& design,
                                      std::span<const PressureStep> steps, const CalibrateOptions& options) {
  std::vector<double> pressures;
  for (const PressureStep& s : steps) pressures.push_back(s.pressure_kpa);
  std::ranges::sort(pressures);
  const auto doubles = std::ranges::unique(pressures);
  pressures.erase(doubles.begin(), doubles.end());
  if (pressures.size() < 3)
    throw InputError(
        "a calibration needs rest and two different pressures at least; five show how straight the line is");
  Fit fit(bus, design, options);
  std::size_t held = 0;
  try {
    for (; held < steps.size(); ++held) {
      report(options.progress, "calibrating", static_cast<double>(held) / static_cast<double>(steps.size()),
             fmt::format("step {} of {}", held + 1, steps.size()));
      if (options.apply) options.apply(steps[held]);
      hold(bus, design, steps[held], held, options, fit);
    }
  } catch (const Cancelled&) {
    if (measured_modules(wanted_modules(design, options), steps, held).empty())
      throw Cancelled("ended before the calibration was complete; nothing was kept");
  }
  const session::Bus::Uninterrupted guard(bus);  // What was measured must still be asked for its serial numbers.
  return fit.finish(pressures.back(), measured_modules(wanted_modules(design, options), steps, held));
}

CalibrationOutcome calibrate_by_ramp(session::Bus& bus, const design::Design& design, const PressureRamp& ramp,
                                     const CalibrateOptions& options) {
  const double shift_s = ramp.by_calendar() ? static_cast<double>(options.unix_minus_link_ns) * 1e-9 : 0.0;
  const auto time_s = [&](std::uint64_t link_us) { return shift_s + static_cast<double>(link_us) * 1e-6; };
  if (time_s(bus.now_us()) >= ramp.last_s())
    throw InputError(fmt::format("the ramp ended {:.1f} s ago; a ramp has to run while triskin calibrate does",
                                 time_s(bus.now_us()) - ramp.last_s()));
  const double max_kpa = ramp.max_kpa();
  Fit fit(bus, design, options);
  {
    const auto take = [&](const session::ModuleSample& f) {
      const auto kpa = ramp.kpa(time_s(f.sampled.link_us));
      if (!kpa) return;
      // Rest has its own bin, so that it stays exactly 0.
      const double share = max_kpa > 0.0 ? *kpa / max_kpa : 0.0;
      const auto bin = *kpa == 0.0 ? 0U : 1U + std::min(kRampBins - 1, static_cast<std::size_t>(share * kRampBins));
      fit.means().add(f, bin, *kpa);
    };
    session::Stream stream(bus, design, take, options.stream);
    while (time_s(bus.now_us()) < ramp.last_s())
      stream.run_until(bus.now_us() + std::min(kUsPerS / 2, us_of(ramp.last_s() - time_s(bus.now_us())) + 1));
    stream.finish();
  }
  return fit.finish(max_kpa, wanted_modules(design, options));
}

namespace {

constexpr std::chrono::milliseconds kLockPatience{2'000};  // Another writer needs only milliseconds.

}  // namespace

CalibrationStore::CalibrationStore(std::filesystem::path folder)
    : folder_(folder.empty() ? state_home() / "calibration" : std::move(folder)) {}

std::filesystem::path CalibrationStore::file_of(const std::string& serial) const {
  return folder_ / (serial + ".json");
}

std::optional<design::BoardCalibration> CalibrationStore::read(const std::string& serial) const {
  const std::filesystem::path file = file_of(serial);
  if (!std::filesystem::exists(file)) return std::nullopt;
  const auto boards = design::read_calibration(file);
  const auto board = std::ranges::find(boards, serial, &design::BoardCalibration::serial);
  if (board == boards.end())
    throw InputError(fmt::format("{}: holds no calibration of controller {}; remove the file and calibrate again",
                                 file.string(), serial));
  return *board;
}

void CalibrationStore::write(const design::BoardCalibration& board) const {
  const WriterLock lock(file_of(board.serial), kLockPatience);
  replace(board);
}

void CalibrationStore::replace(const design::BoardCalibration& board) const {
  std::error_code none;  // Errors are ignored here, because writing the file reports them.
  std::filesystem::create_directories(folder_, none);
  write_file_atomically(file_of(board.serial), design::calibration_text(std::span(&board, 1)));
}

design::BoardCalibration CalibrationStore::renew(design::BoardCalibration board, int before) const {
  // The lock keeps two programs from using the same revision.
  const WriterLock lock(file_of(board.serial), kLockPatience);
  const auto here = read(board.serial);
  board.revision = std::max(before, here ? here->revision : 0) + 1;
  board.made = utc_text(unix_ns() / 1'000'000'000U);
  replace(board);
  return board;
}

bool CalibrationStore::forget(const std::string& serial) const {
  std::error_code none;
  return std::filesystem::remove(file_of(serial), none);
}

FoundCalibration calibration_of(const design::Design& design, std::span<const wire::NodeClaim> claims,
                                std::span<const design::BoardCalibration> boards,
                                std::span<const design::BoardCalibration> kept, const CalibrationStore& store) {
  FoundCalibration found;
  std::vector<design::BoardCalibration> known;
  const auto serial_of = [&](layout::PatchIndex patch) {
    return session::serial_at(claims, design::node_address_of(design, patch));
  };
  for (const layout::PatchIndex patch : design::patches_here(design)) {
    const std::string serial = serial_of(patch);
    if (serial.empty()) continue;
    const auto given = std::ranges::find(boards, serial, &design::BoardCalibration::serial);
    if (given != boards.end()) {
      known.push_back(*given);
      continue;
    }
    const auto of_these = [&](const design::BoardCalibration& b) {
      return b.design_id == design.design_id && b.patch == patch;
    };
    auto here = store.read(serial);
    const auto own = std::ranges::find(kept, serial, &design::BoardCalibration::serial);
    if (own != kept.end() && of_these(*own)) {
      const bool the_same = here && session::to_wire(*here) == session::to_wire(*own);
      known.push_back(the_same ? std::move(*here) : *own);
      ++found.in_controllers;
    } else if (here && of_these(*here)) {
      known.push_back(std::move(*here));
    } else if (here) {
      found.of_others.push_back(std::move(*here));
    }
  }
  if (!known.empty()) found.skin = design::SkinCalibration(design, known, serial_of);
  return found;
}

}  // namespace triskin::skin
