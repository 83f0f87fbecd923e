// SPDX-License-Identifier: GPL-3.0-or-later
#include "view_feed.hpp"

#include <chrono>
#include <thread>

#include "triskin/host/interrupt.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::cli {
namespace {

using std::chrono::microseconds;
using Clock = std::chrono::system_clock;

constexpr std::uint64_t kSlice_us = 10'000;
constexpr microseconds kHealthEvery{250'000}, kRetryAfter{1'000'000}, kPoll{50'000};
constexpr std::int64_t kMostBehind_us = 200'000;

std::int64_t wall_us() {
  return std::chrono::duration_cast<microseconds>(Clock::now().time_since_epoch()).count();
}

// Time of the link against the clock on the wall. A simulation in this process is as fast as the computer: it waits.
// One that is slower than real time falls behind, and the difference is taken as it is.
class Pace {
 public:
  explicit Pace(std::uint64_t link_us) { anchor(link_us); }
  [[nodiscard]] std::int64_t wall_of(std::uint64_t link_us) const {
    return wall_start_us_ + static_cast<std::int64_t>(link_us - link_start_us_);
  }
  void hold(std::uint64_t link_us) {
    const std::int64_t ahead_us = wall_of(link_us) - wall_us();
    if (ahead_us > 0) std::this_thread::sleep_for(microseconds(ahead_us));
    if (ahead_us < -kMostBehind_us) anchor(link_us);
  }

 private:
  void anchor(std::uint64_t link_us) {
    link_start_us_ = link_us;
    wall_start_us_ = wall_us();
  }
  std::uint64_t link_start_us_ = 0;
  std::int64_t wall_start_us_ = 0;
};

class Feed {
 public:
  Feed(const device::LinkOptions& options, const design::Design& design, view::LiveSkin& live, CommandQueue& commands)
      : options_(options), design_(design), live_(live), commands_(commands) {}

  // Streams until the link fails or the process is asked to end.
  void stream() {
    const auto link = device::open_link(options_, &design_);
    device::Bus bus(*link);
    Pace pace(bus.now_us());
    device::Stream stream(bus, design_, [&](const device::ModuleFrame& f) {
      live_.add(f.module, f.sample, pace.wall_of(f.link_time_us));
    });
    std::int64_t next_health_us = 0;
    while (!interrupt_request()) {
      obey(link->finger());
      stream.run_until(bus.now_us() + kSlice_us);
      pace.hold(bus.now_us());
      if (wall_us() < next_health_us) continue;
      next_health_us = wall_us() + kHealthEvery.count();
      state(true, link->trouble(), stream.frames(), stream.lost());
    }
    before_.frames += stream.frames();
    before_.lost += stream.lost();
  }

  void state(bool is_live, const std::string& trouble, std::uint64_t frames = 0, std::uint64_t lost = 0) {
    live_.set_health({options_.link, is_live, trouble, before_.frames + frames, before_.lost + lost});
  }
  [[nodiscard]] FeedTotals totals() const { return before_; }

 private:
  void obey(device::Finger* finger) {
    const int modules = static_cast<int>(design_.layout.modules.size());
    while (const auto command = commands_.pop()) {
      if (command->kind == view::Command::Kind::kRest) live_.rest_anew();
      if (finger == nullptr) continue;
      if (command->kind == view::Command::Kind::kLift) finger->lift();
      if (command->kind == view::Command::Kind::kPress && command->module < modules)
        finger->press(command->module, command->taxel);
    }
  }

  const device::LinkOptions& options_;
  const design::Design& design_;
  view::LiveSkin& live_;
  CommandQueue& commands_;
  FeedTotals before_;
};

void wait_for_retry() {
  for (microseconds waited{0}; waited < kRetryAfter && !interrupt_request(); waited += kPoll)
    std::this_thread::sleep_for(kPoll);
}

}  // namespace

void CommandQueue::push(const view::Command& command) {
  const std::lock_guard lock(mutex_);
  if (commands_.size() == kMost) commands_.pop_front();
  commands_.push_back(command);
}

std::optional<view::Command> CommandQueue::pop() {
  const std::lock_guard lock(mutex_);
  if (commands_.empty()) return std::nullopt;
  const view::Command command = commands_.front();
  commands_.pop_front();
  return command;
}

FeedTotals feed(const device::LinkOptions& options, const design::Design& design, view::LiveSkin& live,
                CommandQueue& commands) {
  Feed feed(options, design, live, commands);
  feed.state(false, "waiting for the first sample");
  while (!interrupt_request()) {
    try {
      feed.stream();
    } catch (const Cancelled&) {
      break;  // Ctrl-C is the usual end
    } catch (const DeviceError& e) {
      feed.state(false, e.what());
      wait_for_retry();
    }
  }
  return feed.totals();
}

}  // namespace triskin::cli
