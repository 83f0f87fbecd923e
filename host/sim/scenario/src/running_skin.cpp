// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/running_skin.hpp"

#include <algorithm>

#include "tapped_link.hpp"
#include "temporary_folder.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::scenario {
namespace {

constexpr std::uint64_t kRenew_us = 250'000;
// Controllers find the offsets of their converters in the first second, so only later samples count.
constexpr std::uint64_t kSettle_us = 1'500'000, kRest_us = 500'000;

hardware::Scene untouched(hardware::Scene scene) {
  scene.contacts.clear();
  scene.pressure = {};
  std::erase_if(scene.faults,
                [](const hardware::Fault& f) { return f.from_us != 0 || f.until_us != hardware::kForever; });
  return scene;
}

void stream_until(session::Stream& stream, const link::Link& link, std::uint64_t until_us) {
  while (link.now_us() < until_us) stream.run_until(std::min(until_us, link.now_us() + kRenew_us));
}

// Computes the means of the valid values of each taxel.
class RestMeans {
 public:
  explicit RestMeans(std::size_t modules) : sums_(modules), counts_(modules) {}
  void add(const session::ModuleSample& s) {
    const auto m = static_cast<std::size_t>(s.module);
    for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
      if ((s.sample.valid >> t & 1U) == 0) continue;
      sums_[m][t] += s.sample.value[t];
      ++counts_[m][t];
    }
  }
  [[nodiscard]] design::RestValues means() const {
    design::RestValues means(sums_.size());
    for (std::size_t m = 0; m < sums_.size(); ++m) {
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t)
        means[m][t] = counts_[m][t] > 0 ? sums_[m][t] / counts_[m][t] : static_cast<double>(layout::kRestCounts);
    }
    return means;
  }

 private:
  std::vector<std::array<double, layout::kTaxelsPerModule>> sums_;
  std::vector<std::array<int, layout::kTaxelsPerModule>> counts_;
};

// Boards of a robot have given serial numbers, in any order.
deploy::FlashOptions assignments_of(const hardware::Scene& scene) {
  deploy::FlashOptions options;
  for (std::size_t p = 0; p < scene.boards.size(); ++p)
    options.assign.push_back({layout::PatchIndex{p}, session::to_text(scene.boards[p])});
  return options;
}

// Flashes the boards in `folder` and takes the rest values.
design::RestValues prepare(const hardware::Scene& scene, const std::filesystem::path& folder) {
  hardware::SimLink link(untouched(scene), folder);
  session::Bus bus(link);
  (void)deploy::flash(bus, scene.design, assignments_of(scene));
  RestMeans rest(scene.design.layout.modules.size());
  std::uint64_t from_us = hardware::kForever;
  session::Stream stream(bus, scene.design, [&](const session::ModuleSample& s) {
    if (link.now_us() >= from_us) rest.add(s);
  });
  from_us = link.now_us() + kSettle_us;
  stream_until(stream, link, from_us + kRest_us);
  stream.finish();
  return rest.means();
}

}  // namespace

struct RunningSkin::Bench {
  TemporaryFolder folder;
  std::unique_ptr<TappedLink> link;
  std::unique_ptr<session::Bus> bus;
  std::unique_ptr<session::Stream> stream;
};

RunningSkin::RunningSkin(hardware::Scene scene, OnSample on_sample, OnFrame on_frame)
    : bench_(std::make_unique<Bench>()) {
  scene.board_seed.reset();  // The boards get the patches in the order of their serial numbers.
  rest_ = prepare(scene, bench_->folder.path());
  bench_->link = std::make_unique<TappedLink>(std::move(scene), bench_->folder.path(), std::move(on_frame));
  bench_->bus = std::make_unique<session::Bus>(*bench_->link);
  bench_->stream = std::make_unique<session::Stream>(*bench_->bus, hardware().scene().design,
                                                     [handler = std::move(on_sample)](const session::ModuleSample& s) {
                                                       if (handler) handler(s);
                                                     });
}

RunningSkin::~RunningSkin() = default;

void RunningSkin::run_until(std::uint64_t until_us) {
  stream_until(*bench_->stream, *bench_->link, until_us);
}

std::uint64_t RunningSkin::now_us() const {
  return bench_->link->now_us();
}

hardware::VirtualSkin& RunningSkin::hardware() {
  return bench_->link->skin();
}

std::array<double, layout::kTaxelsPerModule> changes_of(const session::ModuleSample& sample,
                                                        const design::RestValues& rest) {
  std::array<double, layout::kTaxelsPerModule> changes{};
  const auto& rests = rest.at(static_cast<std::size_t>(sample.module));
  const double warming = skin::warming_counts(sample.sample, rests).value_or(0.0);
  for (std::size_t t = 0; t < changes.size(); ++t) {
    if ((sample.sample.valid >> t & 1U) != 0 && layout::measures_pressure(t))
      changes[t] = std::max(0.0, rests[t] - sample.sample.value[t] - warming);
  }
  return changes;
}

double taxel_area_mm2(double corner_cut_mm) {
  return design::module_area_mm2(corner_cut_mm) / layout::kPressureTaxelsPerModule;
}

double force_n(const std::array<double, layout::kTaxelsPerModule>& change_counts, double corner_cut_mm,
               layout::TaxelIndex taxel) {
  double kpa = 0.0;
  for (std::size_t t = 0; t < change_counts.size(); ++t) {
    if (taxel >= 0 && static_cast<std::size_t>(taxel) != t) continue;
    if (change_counts[t] >= skin::TouchMap::kPressed_counts) kpa += change_counts[t] / hardware::kCountsPerKpa;
  }
  return kpa * taxel_area_mm2(corner_cut_mm) * design::kNewtonPerKpaMm2;
}

}  // namespace triskin::scenario
