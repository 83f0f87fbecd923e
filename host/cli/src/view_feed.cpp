// SPDX-License-Identifier: GPL-3.0-or-later
#include "view_feed.hpp"

#include <chrono>
#include <mutex>
#include <span>

#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/robot/bus_threads.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/skin/rest_store.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::cli {
namespace {

using std::chrono::microseconds;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kSlice_us = 10'000;
constexpr microseconds kHealthEvery{250'000}, kRetryAfter{1'000'000};

// Health of all links for the page: trouble on one bus is trouble of the page.
class Health {
 public:
  Health(std::string link, std::size_t buses, view::LiveSkin& live)
      : link_(std::move(link)), live_(live), buses_(buses) {}
  struct Bus {
    bool is_live = false;
    std::string trouble;
    FeedTotals totals;
  };
  void state(std::size_t bus, Bus now) {
    const std::lock_guard lock(mutex_);
    buses_[bus] = std::move(now);
    Bus all{true, "", {}};
    for (const Bus& b : buses_) {
      all.is_live = all.is_live && b.is_live;
      if (all.trouble.empty()) all.trouble = b.trouble;
      all.totals.frames += b.totals.frames;
      all.totals.lost += b.totals.lost;
    }
    live_.set_health({link_, all.is_live, all.trouble, all.totals.frames, all.totals.lost});
  }

 private:
  std::mutex mutex_;
  std::string link_;
  view::LiveSkin& live_;
  std::vector<Bus> buses_;
};

// What presses a cover. The page asks for rest values anew when nothing touches the skin; they are kept, as those of
// `live --tare`.
class CoverTouches {
 public:
  CoverTouches(const design::Design& design, std::span<const wire::NodeClaim> claims)
      : store_(design, claims), touches_(design, store_.read()) {}

  view::PressureSample take(const device::ModuleSample& f) {
    touches_.add(f);
    return {f.sample.state, f.sample.valid, touches_.change(f.module)};
  }
  void tare(std::uint64_t now_us) {
    touches_.tare();
    keep_us_ = now_us + kTare_us;
  }
  void keep_rest(std::uint64_t now_us) {
    if (keep_us_ == 0 || now_us < keep_us_ || !touches_.tared()) return;
    store_.write(touches_.rest());
    keep_us_ = 0;
  }

 private:
  static constexpr std::uint64_t kTare_us = 500'000;  // A controller that is silent this long is reported as silent.
  device::RestStore store_;
  device::TouchMap touches_;
  std::uint64_t keep_us_ = 0;  // Time at which the running tare is to be stored; 0: none is running.
};

// Keeps the counts of a stream when its link fails.
class KeptTotals {
 public:
  KeptTotals(const device::Stream& stream, FeedTotals& totals) : stream_(stream), totals_(totals) {}
  KeptTotals(const KeptTotals&) = delete;
  KeptTotals& operator=(const KeptTotals&) = delete;
  ~KeptTotals() {
    totals_.frames += stream_.frames();
    totals_.lost += stream_.lost();
  }

 private:
  const device::Stream& stream_;
  FeedTotals& totals_;
};

// One bus; runs in a thread of its own where there are several.
class Feed {
 public:
  Feed(const device::LinkOptions& options, const device::StreamOptions& stream, const robot::Site& site,
       std::size_t bus, const std::vector<design::CoverOffset>& offsets, view::LiveSkin& live, Health& health,
       CommandQueue& commands)
      : options_(options),
        stream_options_(stream),
        site_(site),
        bus_(bus),
        live_(live),
        health_(health),
        commands_(commands) {
    for (const robot::CoverConfig& cover : site.buses[bus].covers) {
      if (!cover.chosen) continue;
      covers_.push_back(&cover);
      designs_.push_back(&cover.design);
      first_.push_back(offsets[static_cast<std::size_t>(cover.cover)].module);
    }
  }

  // Streams until the link fails or the process is asked to end.
  void stream() {
    const auto link = device::open_bus(site_, bus_, options_);
    device::Bus bus(*link);
    const auto claims = bus.discover();
    touches_.clear();
    for (const design::Design* design : designs_) touches_.emplace_back(*design, claims);
    Pace pace(bus.now_us());
    const auto stream_options = robot::stream_options(site_.buses[bus_], designs_, stream_options_);
    device::Stream stream(
        bus, designs_,
        [&](const device::ModuleSample& f) {
          const auto cover = static_cast<std::size_t>(f.cover);
          live_.add(first_[cover] + f.module, touches_[cover].take(f), pace.unix_us(f.link_time_us));
        },
        stream_options);
    const KeptTotals kept(stream, before_);
    Clock::time_point next_health{};
    while (!interrupt_request()) {
      obey(link->finger(), bus.now_us());
      stream.run_until(bus.now_us() + kSlice_us);
      for (CoverTouches& cover : touches_) cover.keep_rest(bus.now_us());
      pace.hold(bus.now_us());
      if (Clock::now() < next_health) continue;
      next_health = Clock::now() + kHealthEvery;
      state(true, link->trouble(), stream.frames(), stream.lost());
    }
  }

  void state(bool is_live, const std::string& trouble, std::uint64_t frames = 0, std::uint64_t lost = 0) {
    health_.state(bus_, {is_live, trouble, {before_.frames + frames, before_.lost + lost}});
  }
  [[nodiscard]] FeedTotals totals() const { return before_; }

 private:
  // A command is for the bus that has the module; presses of others are left to them.
  void obey(device::Finger* finger, std::uint64_t now_us) {
    while (const auto command = commands_.pop(static_cast<int>(bus_))) {
      if (command->kind == view::Command::Kind::kRest) {
        for (CoverTouches& cover : touches_) cover.tare(now_us);
      }
      if (finger == nullptr) continue;
      if (command->kind == view::Command::Kind::kLift) finger->lift();
      if (command->kind == view::Command::Kind::kPress) press(*finger, command->module, command->taxel);
    }
  }
  void press(device::Finger& finger, int module, int taxel) const {
    for (std::size_t c = 0; c < covers_.size(); ++c) {
      const int own = module - first_[c];
      if (own < 0 || own >= static_cast<int>(covers_[c]->design.layout.modules.size())) continue;
      return finger.press(covers_[c]->first_module + own, taxel);
    }
    finger.lift();  // The finger is on another bus now.
  }

  const device::LinkOptions& options_;
  const device::StreamOptions& stream_options_;
  const robot::Site& site_;
  std::size_t bus_;
  std::vector<const robot::CoverConfig*> covers_;
  std::vector<const design::Design*> designs_;
  std::vector<int> first_;             // Position of each cover's first module on the page.
  std::vector<CoverTouches> touches_;  // Indexed by cover; filled while the link is open.
  view::LiveSkin& live_;
  Health& health_;
  CommandQueue& commands_;
  FeedTotals before_;
};

}  // namespace

void CommandQueue::push(const view::Command& command) {
  const std::lock_guard lock(mutex_);
  for (auto& commands : commands_) {
    if (commands.size() == kMost) commands.pop_front();
    commands.push_back(command);
  }
}

std::optional<view::Command> CommandQueue::pop(int reader) {
  const std::lock_guard lock(mutex_);
  auto& commands = commands_.at(static_cast<std::size_t>(reader));
  if (commands.empty()) return std::nullopt;
  const view::Command command = commands.front();
  commands.pop_front();
  return command;
}

FeedTotals feed(const device::LinkOptions& options, const device::StreamOptions& stream, const robot::Site& site,
                const std::vector<design::CoverOffset>& offsets, view::LiveSkin& live, CommandQueue& commands) {
  std::vector<std::string> names;
  for (const robot::BusConfig& bus : site.buses) names.push_back(bus.name);
  const bool by_file = site.is_robot && !options.chosen;
  Health health(by_file ? site.name : options.link, names.size(), live);
  std::vector<FeedTotals> totals(names.size());
  robot::on_each_bus(names, [&](std::size_t b) {
    Feed feed(options, stream, site, b, offsets, live, health, commands);
    feed.state(false, "waiting for the first sample");
    while (!interrupt_request()) {
      try {
        feed.stream();
      } catch (const Cancelled&) {
        break;  // Ctrl-C is the usual end
      } catch (const DeviceError& e) {
        feed.state(false, e.what());
        (void)sleep_until(Clock::now() + kRetryAfter);
      }
    }
    totals[b] = feed.totals();
  });
  FeedTotals sum;
  for (const FeedTotals& t : totals) {
    sum.frames += t.frames;
    sum.lost += t.lost;
  }
  return sum;
}

}  // namespace triskin::cli
