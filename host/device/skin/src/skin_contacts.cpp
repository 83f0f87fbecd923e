// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/skin_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "triskin/base/error.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/mechanics/pressure_contacts.hpp"

namespace triskin::skin {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
// The noise of a sample and the error of a rest value, which is the median of three samples, add up to this.
constexpr double kNoise_counts = 1.3 * layout::kNoise_counts;
// Modules whose middle is farther than this from every pressed taxel tell nothing about a contact.
constexpr double kSurroundings_mm = 45.0;

const mechanics::Footprint& default_footprint() {
  static const mechanics::Footprint footprint;
  return footprint;
}

bool is_near_any(const design::Vec3& place, std::span<const design::Vec3> pressed) {
  return std::ranges::any_of(pressed, [&](const design::Vec3& p) { return (p - place).norm() < kSurroundings_mm; });
}

// The fit takes only the pressure taxels of modules near the pressed ones.
struct FitTaxels {
  std::vector<std::size_t> taxel;  // The index refers to the frame.
  std::vector<Eigen::Vector3d> positions, normals;
  std::vector<double> values;
  std::vector<std::size_t> pressed;  // The indices refer to these lists.
  double largest_counts_per_unit = 1.0;
};

class FrameFit {
 public:
  explicit FrameFit(const ContactFrame& frame) : frame_(frame), is_calibrated_(!frame.counts_per_kpa.empty()) {}

  [[nodiscard]] std::vector<SkinContact> run() const {
    std::vector<SkinContact> contacts;
    const FitTaxels taxels = taxels_near_pressed();
    if (taxels.pressed.empty()) return contacts;
    mechanics::PressureOptions options;
    options.noise_kpa = kNoise_counts / taxels.largest_counts_per_unit;
    options.taxel_area_mm2 = frame_.taxel_area_mm2.at(taxels.taxel[taxels.pressed[0]] / layout::kTaxelsPerModule);
    for (const auto& found : mechanics::contacts_from_pressure(default_footprint(), taxels.positions, taxels.normals,
                                                               taxels.values, taxels.pressed, options))
      contacts.push_back(contact_of(found, taxels));
    std::ranges::stable_sort(contacts, std::ranges::greater{}, &SkinContact::change_counts);
    return contacts;
  }

 private:
  [[nodiscard]] bool is_pressed(std::size_t n) const {
    return layout::measures_pressure(n % layout::kTaxelsPerModule) &&
           frame_.change_counts[n] >= TouchMap::kPressed_counts;
  }
  // Values are kPa in a calibrated frame. There, a taxel without calibration counts only if it is pressed; it then gets
  // the largest sensitivity of all, so that its contact is seen.
  [[nodiscard]] double value_of(std::size_t n) const {
    if (!is_calibrated_) return frame_.change_counts[n];
    return frame_.counts_per_kpa[n] > 0.0 ? frame_.change_counts[n] / frame_.counts_per_kpa[n] : kNoValue;
  }
  [[nodiscard]] FitTaxels taxels_near_pressed() const {
    FitTaxels taxels;
    std::vector<design::Vec3> pressed;
    for (std::size_t n = 0; n < frame_.change_counts.size(); ++n) {
      if (is_pressed(n)) pressed.push_back(frame_.position_mm[n]);
    }
    if (pressed.empty()) return taxels;
    const double substitute = is_calibrated_ ? largest_sensitivity() : 1.0;
    taxels.largest_counts_per_unit = substitute;
    for (std::size_t n = 0; n < frame_.change_counts.size(); ++n) {
      if (!layout::measures_pressure(n % layout::kTaxelsPerModule) || !is_near_any(frame_.position_mm[n], pressed))
        continue;
      double value = value_of(n);
      if (is_pressed(n) && !std::isfinite(value)) value = frame_.change_counts[n] / substitute;
      if (is_pressed(n)) taxels.pressed.push_back(taxels.taxel.size());
      taxels.taxel.push_back(n);
      taxels.positions.push_back(frame_.position_mm[n]);
      taxels.normals.push_back(frame_.normal[n].normalized());
      taxels.values.push_back(value);
    }
    return taxels;
  }
  [[nodiscard]] double largest_sensitivity() const {
    const double largest = *std::ranges::max_element(frame_.counts_per_kpa);
    return largest > 0.0 ? largest : 1.0;
  }
  [[nodiscard]] SkinContact contact_of(const mechanics::PressureContact& found, const FitTaxels& taxels) const {
    const mechanics::SurfaceContact& c = found.contact;
    SkinContact out{.position_mm = c.position_mm,
                    .normal = c.normal,
                    .position_sd_mm = c.position_sd_mm,
                    .force_n = c.force_n,
                    .force_sd_n = c.force_sd_n,
                    .area_mm2 = c.area_mm2,
                    .change_counts = 0.0,
                    .taxels = {}};
    bool has_force = is_calibrated_;
    for (const std::size_t k : found.taxels) {
      const std::size_t n = taxels.taxel[k];
      has_force = has_force && frame_.counts_per_kpa[n] > 0.0;
      out.change_counts += frame_.change_counts[n];
      out.taxels.push_back({layout::ModuleId{n / layout::kTaxelsPerModule},
                            layout::TaxelIndex{n % layout::kTaxelsPerModule}, frame_.change_counts[n],
                            frame_.position_mm[n], frame_.normal[n]});
    }
    std::ranges::stable_sort(out.taxels, std::ranges::greater{}, &PressedTaxel::change_counts);
    if (!has_force) out.force_n = out.force_sd_n = kNoValue;
    return out;
  }

  const ContactFrame& frame_;
  bool is_calibrated_;
};

void require_lengths(const ContactFrame& f) {
  const std::size_t n = f.change_counts.size();
  const bool ok = n % layout::kTaxelsPerModule == 0 && f.position_mm.size() == n && f.normal.size() == n &&
                  (f.counts_per_kpa.empty() || f.counts_per_kpa.size() == n) &&
                  f.taxel_area_mm2.size() == n / layout::kTaxelsPerModule;
  if (!ok)
    throw InputError(
        fmt::format("contacts: {} changes, {} positions, {} normals, {} sensitivities and {} areas; give "
                    "twelve a module, and one area a module",
                    n, f.position_mm.size(), f.normal.size(), f.counts_per_kpa.size(), f.taxel_area_mm2.size()));
}

}  // namespace

std::vector<SkinContact> contacts_of(const ContactFrame& frame) {
  require_lengths(frame);
  return FrameFit(frame).run();
}

std::vector<SkinContact> contacts_of(const TouchMap& touches, const design::Design& design,
                                     const design::SkinCalibration& calibration) {
  if (touches.pressed().empty()) return {};
  const auto wiring = design::wiring_of(design);
  const double equal_share = design::module_area_mm2(design.layout.corner_cut_mm) / layout::kPressureTaxelsPerModule;
  ContactFrame frame;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const auto poses = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
    const auto change = touches.change(layout::ModuleId{m});
    for (std::size_t t = 0; t < poses.size(); ++t) {
      frame.position_mm.push_back(poses[t].position_mm);
      frame.normal.push_back(poses[t].normal);
      frame.change_counts.push_back(change[t]);
      if (calibration.complete())
        frame.counts_per_kpa.push_back(calibration.counts_per_kpa({layout::ModuleId{m}, layout::TaxelIndex{t}}));
    }
    const double area = calibration.complete() ? calibration.taxel_area_mm2(layout::ModuleId{m}) : equal_share;
    frame.taxel_area_mm2.push_back(area > 0.0 ? area : equal_share);
  }
  return contacts_of(frame);
}

NetForce net_force(std::span<const SkinContact> contacts) {
  std::vector<mechanics::SurfaceContact> forces;
  for (const SkinContact& c : contacts) {
    if (!std::isfinite(c.force_n)) continue;
    mechanics::SurfaceContact& f = forces.emplace_back();
    f.position_mm = c.position_mm;
    f.normal = c.normal;
    f.position_sd_mm = c.position_sd_mm;
    f.force_n = c.force_n;
    f.force_sd_n = c.force_sd_n;
  }
  const mechanics::Wrench net = mechanics::net_wrench(forces, Eigen::Vector3d::Zero());
  return {net.force_n, net.force_sd_n, net.torque_nmm, net.torque_sd_nmm};
}

}  // namespace triskin::skin
