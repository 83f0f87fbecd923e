// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "receive.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/base/wall_clock.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/session/patch_offsets.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::skin {
namespace {

constexpr std::uint64_t kTareSlice_us = 200'000;
constexpr std::chrono::seconds kRetryAfter{1};

}  // namespace

LiveBus::LiveBus(const robot::Site& site, std::size_t bus, connect::LinkOptions link)
    : site_(site), index_(bus), config_(site.buses.at(bus)), link_options_(std::move(link)) {}

LiveBus::~LiveBus() = default;

void LiveBus::open() {
  close();
  link_ = connect::open_bus(site_, index_, link_options_);
  bus_ = std::make_unique<session::Bus>(*link_);
  opened_us_ = link_->now_us();
  opened_unix_ns_ = triskin::unix_ns();
  for (const robot::CoverConfig& cover : config_.covers) {
    if (cover.chosen) covers_.emplace_back(cover, link::touch_actuator_of(*link_));
  }
}

void LiveBus::close() {
  forget_stream();
  covers_.clear();
  claims_.clear();
  discovered_ = false;
  bus_.reset();
  link_.reset();
}

std::uint64_t LiveBus::unix_ns(std::uint64_t link_us) const {
  // A sample may be older than the opening of the link; the unsigned difference then wraps around, and so does the sum.
  return opened_unix_ns_ + (link_us - opened_us_) * 1000;
}

void LiveBus::find_controllers(RestSource rest) {
  claims_ = bus_->discover();
  session::wait_for_set_up(*bus_, claims_);
  for (LiveCover& cover : covers_) {
    cover.set_rest(claims_, rest);
    if (rest != RestSource::kPresent && cover.kept_rest().empty())
      cover.settle(session::settled_rest(*bus_, cover.design(), claims_));
  }
  discovered_ = discovered_ || rest != RestSource::kPresent;
}

void LiveBus::require_flashed() const {
  const auto fresh = std::ranges::count(claims_, false, &wire::NodeClaim::has_table);
  if (fresh == 0) return;
  for (const LiveCover& cover : covers_) {
    for (const layout::PatchIndex patch : design::patches_here(cover.design())) {
      const auto node = static_cast<std::uint8_t>(design::node_address_of(cover.design(), patch));
      if (std::ranges::any_of(claims_, [&](const auto& c) { return c.has_table && c.node_address == node; })) continue;
      const std::string& name = cover.config().name;
      throw DeviceError(fmt::format(
          "{}: no controller has the table of {}patch {}, and {} here {} none yet; run triskin "
          "flash first",
          bus_->name(), name.empty() ? "" : name + ", ", patch, counted(static_cast<std::size_t>(fresh), "controller"),
          agreeing(static_cast<std::size_t>(fresh), "has", "have")));
    }
  }
}

FoundCalibration LiveBus::find_calibration(const LiveCover& cover, std::span<const design::BoardCalibration> boards) {
  const auto kept = session::kept_in_controllers(*bus_, cover.design(), claims_);
  return calibration_of(cover.design(), claims_, boards, kept, CalibrationStore());
}

void LiveBus::take(const session::ModuleSample& sample, const OnSample& on_sample) {
  const LiveSample live =
      covers_[static_cast<std::size_t>(sample.cover)].take(sample, sample.cover, unix_ns(sample.sampled.link_us));
  if (on_sample) on_sample(live);
}

void LiveBus::start(const session::StreamOptions& options, OnSample on_sample) {
  if (!discovered_) find_controllers();
  require_flashed();
  forget_stream();
  std::vector<const design::Design*> designs;
  for (const LiveCover& cover : covers_) designs.push_back(&cover.design());
  stream_ = std::make_unique<session::Stream>(
      *bus_, designs, [this, on_sample = std::move(on_sample)](const session::ModuleSample& s) { take(s, on_sample); },
      robot::stream_options(config_, designs, options));
}

void LiveBus::run(const LiveRun& run) {
  const auto receive = [this](std::uint64_t until_us) {
    stream_->run_until(until_us);
    for (LiveCover& cover : covers_) cover.step_tare(now_us());
  };
  try {
    receive_slices(run, [this] { return now_us(); }, receive);
  } catch (...) {
    // The stream must end here, because the objects that `on_sample` refers to may not outlive this call.
    forget_stream();
    throw;
  }
}

void LiveBus::tare() {
  for (LiveCover& cover : covers_) cover.begin_tare(now_us());
  const auto running = [&] {
    return std::ranges::any_of(covers_, [](const LiveCover& c) { return c.tare().state() == Tare::State::kRunning; });
  };
  run({now_us() + Tare::kLimit_us, kTareSlice_us, {}, running});
  if (std::ranges::all_of(covers_, [](const LiveCover& c) { return c.tare().state() == Tare::State::kNoSample; }))
    throw DeviceError(bus_->name() + ": no sample came, so there is nothing to tare");
}

void LiveBus::finish() {
  if (!stream_) return;
  stream_->finish();
  forget_stream();
}

void LiveBus::forget_stream() {
  if (!stream_) return;
  before_ = totals();
  last_report_ = stream_->report();
  last_reports_.clear();
  for (std::size_t c = 0; c < covers_.size(); ++c) last_reports_.push_back(stream_->report(layout::CoverIndex{c}));
  stream_.reset();
}

void LiveBus::follow(const session::StreamOptions& options, const OnSample& on_sample, const LiveRun& run,
                     const std::function<void(const std::string&)>& on_cut) {
  while (!interrupt_request()) {
    try {
      open();
      start(options, on_sample);
      this->run(run);
      break;
    } catch (const Cancelled&) {
      break;
    } catch (const DeviceError& e) {
      on_cut(e.what());
      (void)sleep_until(std::chrono::steady_clock::now() + kRetryAfter);
    }
  }
  close();
}

session::StreamReport LiveBus::report() const {
  return stream_ ? stream_->report() : last_report_;
}

session::StreamReport LiveBus::report(std::size_t cover) const {
  return stream_ ? stream_->report(layout::CoverIndex{cover}) : last_reports_.at(cover);
}

LiveTotals LiveBus::totals() const {
  if (!stream_) return before_;
  return {before_.frames + stream_->frames(), before_.lost + stream_->lost()};
}

}  // namespace triskin::skin
