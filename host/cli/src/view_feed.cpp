// SPDX-License-Identifier: GPL-3.0-or-later
#include "view_feed.hpp"

#include <chrono>
#include <mutex>
#include <optional>
#include <vector>

#include "triskin/base/pace.hpp"

namespace triskin::cli {
namespace {

using std::chrono::microseconds;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kSlice_us = 10'000;
constexpr microseconds kHealthEvery{250'000};

// Combines the health of all links for the page, because trouble on one bus affects the whole page.
class Health {
 public:
  Health(std::string link, std::size_t buses, view::LatestSamples& live)
      : link_(std::move(link)), live_(live), buses_(buses) {}
  struct Bus {
    bool is_live = false;
    std::string trouble;
    device::LiveTotals totals;
  };
  void state(std::size_t bus, Bus now) {
    const std::lock_guard lock(mutex_);
    buses_[bus] = std::move(now);
    Bus all{true, "", {}};
    for (const Bus& b : buses_) {
      all.is_live = all.is_live && b.is_live;
      if (all.trouble.empty()) all.trouble = b.trouble;
      all.totals += b.totals;
    }
    live_.set_health({link_, all.is_live, all.trouble, all.totals.frames, all.totals.lost});
  }

 private:
  std::mutex mutex_;
  std::string link_;
  view::LatestSamples& live_;
  std::vector<Bus> buses_;
};

// Feeds one bus; if there are several, each runs in its own thread.
class Feed {
 public:
  Feed(device::LiveBus& bus, const std::vector<design::CoverOffset>& offsets, view::LatestSamples& live, Health& health,
       CommandQueue& commands)
      : bus_(bus), offsets_(offsets), live_(live), health_(health), commands_(commands) {}

  // Streams until the process is asked to end; a failed link is opened again.
  void run(const device::StreamOptions& options) {
    state(false, "waiting for the first sample");
    const device::LiveRun slices{UINT64_MAX, kSlice_us, [this] { obey(); }, [this] { return slice(); }};
    bus_.follow(
        options, [this](const device::LiveSample& s) { show(s); }, slices,
        [this](const std::string& trouble) {
          pace_.reset();
          taring_.clear();
          state(false, trouble);
        });
  }

 private:
  // Returns the number of a cover's first module on the page.
  [[nodiscard]] int first_module(const device::LiveCover& cover) const {
    return offsets_[static_cast<std::size_t>(cover.config().cover)].module;
  }
  Pace& pace() {
    if (!pace_) pace_.emplace(bus_.now_us());
    return *pace_;
  }
  void state(bool is_live, const std::string& trouble) {
    health_.state(bus_.index(), {is_live, trouble, bus_.totals()});
  }
  void show(const device::LiveSample& s) {
    const int module = first_module(bus_.covers()[static_cast<std::size_t>(s.cover)]) + s.module;
    live_.add(module, {s.raw.sample.state, s.valid, s.change_counts}, pace().unix_us(s.raw.link_time_us));
  }
  bool slice() {
    std::erase_if(taring_, keep_rest);
    pace().hold(bus_.now_us());
    if (Clock::now() < next_health_) return true;
    next_health_ = Clock::now() + kHealthEvery;
    state(true, bus_.link().trouble());
    return true;
  }
  // The page asks for new rest values when nothing touches the skin; they are stored like those of `live --tare`.
  // Returns false while they are not complete.
  static bool keep_rest(device::LiveCover* cover) {
    if (cover->tare().state() == device::Tare::State::kDone) (void)cover->keep_rest();
    return cover->tare().state() != device::Tare::State::kRunning;
  }
  // A command goes to the bus that has the module; each bus ignores presses of the others' modules.
  void obey() {
    while (const auto command = commands_.pop(static_cast<int>(bus_.index()))) {
      if (command->kind == view::Command::Kind::kRest) begin_tare();
      if (command->kind == view::Command::Kind::kLift) lift();
      if (command->kind == view::Command::Kind::kPress) press(*command);
    }
  }
  void begin_tare() {
    taring_.clear();
    for (device::LiveCover& cover : bus_.covers()) {
      cover.begin_tare(bus_.now_us());
      taring_.push_back(&cover);
    }
  }
  void lift() {
    if (device::TouchActuator* actuator = bus_.covers().front().actuator()) actuator->lift();
  }
  void press(const view::Command& command) {
    for (device::LiveCover& cover : bus_.covers()) {
      const int own = command.module - first_module(cover);
      if (own < 0 || own >= static_cast<int>(cover.design().layout.modules.size())) continue;
      if (cover.actuator() == nullptr) return;
      if (command.taxel < 0)
        cover.actuator()->press(own);
      else
        cover.actuator()->press({own, command.taxel});
      return;
    }
    lift();  // The page now presses on another bus.
  }

  device::LiveBus& bus_;
  const std::vector<design::CoverOffset>& offsets_;
  view::LatestSamples& live_;
  Health& health_;
  CommandQueue& commands_;
  std::optional<Pace> pace_;  // The pace is set while samples arrive.
  Clock::time_point next_health_{};
  std::vector<device::LiveCover*> taring_;  // New rest values of these covers will be stored.
};

}  // namespace

void CommandQueue::push(const view::Command& command) {
  const std::lock_guard lock(mutex_);
  for (auto& commands : commands_) {
    if (commands.size() == kMaxWaiting) commands.pop_front();
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

device::LiveTotals feed(device::LiveSkin& skin, const std::string& link, const device::StreamOptions& stream,
                        const std::vector<design::CoverOffset>& offsets, view::LatestSamples& live,
                        CommandQueue& commands) {
  Health health(link, skin.buses().size(), live);
  skin.on_each_bus([&](device::LiveBus& bus) { Feed(bus, offsets, live, health, commands).run(stream); });
  device::LiveTotals sum;
  for (const auto& bus : skin.buses()) sum += bus->totals();
  return sum;
}

}  // namespace triskin::cli
