// SPDX-License-Identifier: GPL-3.0-or-later
#include "view_feed.hpp"

#include <chrono>
#include <mutex>
#include <optional>
#include <vector>

#include "shown_contact.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/skin/skin_contacts.hpp"

namespace triskin::cli {
namespace {

using std::chrono::microseconds;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kSlice_us = 10'000;
constexpr microseconds kHealthEvery{250'000};

// Returns where a point of a cover lies on the page. The module may be any of the cover, because covers are rigid.
design::Vec3 moved(const design::Vec3& point_mm, const design::PlacedModule& on_cover,
                   const design::PlacedModule& on_page) {
  const auto axes = [](const design::PlacedModule& m) {
    Eigen::Matrix3d basis;
    basis.col(0) = (m.corner_mm[1] - m.corner_mm[0]).normalized();
    basis.col(2) = (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
    basis.col(1) = basis.col(2).cross(basis.col(0));
    return basis;
  };
  return on_page.corner_mm[0] + axes(on_page) * axes(on_cover).transpose() * (point_mm - on_cover.corner_mm[0]);
}

// Combines the health of all links for the page, because trouble on one bus affects the whole page.
class Health {
 public:
  Health(std::string link, std::size_t buses, view::LatestSamples& live)
      : link_(std::move(link)), live_(live), buses_(buses) {}
  struct Bus {
    bool is_live = false;
    std::string trouble;
    skin::LiveTotals totals;
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
  Feed(skin::LiveBus& bus, const ShownSkin& shown, view::LatestSamples& live, Health& health, CommandQueue& commands)
      : bus_(bus), shown_(shown), live_(live), health_(health), commands_(commands) {}

  // Streams until the process is asked to end; a failed link is opened again.
  void run(const session::StreamOptions& options) {
    state(false, "waiting for the first sample");
    const skin::LiveRun slices{UINT64_MAX, kSlice_us, [this] { obey(); }, [this] { return slice(); }};
    bus_.follow(
        options, [this](const skin::LiveSample& s) { show(s); }, slices,
        [this](const std::string& trouble) {
          pace_.reset();
          taring_.clear();
          state(false, trouble);
        });
  }

 private:
  // Returns the number of a cover's first module on the page.
  [[nodiscard]] layout::SkinModule first_module(const skin::LiveCover& cover) const {
    return shown_.offsets[static_cast<std::size_t>(cover.config().cover)].module;
  }
  Pace& pace() {
    if (!pace_) pace_.emplace(bus_.now_us());
    return *pace_;
  }
  void state(bool is_live, const std::string& trouble) {
    health_.state(bus_.index(), {is_live, trouble, bus_.totals()});
  }
  void show(const skin::LiveSample& s) {
    const layout::SkinModule module{first_module(bus_.covers()[static_cast<std::size_t>(s.cover)]) + s.module};
    live_.add(module, {s.raw.sample.state, s.valid, s.change_counts}, pace().unix_us(s.raw.link_time_us));
  }
  // `index`: of the cover on its bus.
  void show_contacts(const skin::LiveCover& cover, std::size_t index) {
    const layout::SkinModule first = first_module(cover);
    const design::SkinCalibration calibration =
        shown_.calibrations.empty() ? design::SkinCalibration() : shown_.calibrations.at(bus_.index()).at(index);
    std::vector<view::LatestSamples::Contact> contacts;
    for (const skin::SkinContact& c : skin::contacts_of(cover.touches(), cover.design(), calibration)) {
      const auto module = static_cast<std::size_t>(c.taxels.front().module);
      contacts.push_back(shown_contact(c, first));
      contacts.back().position_mm = moved(c.position_mm, cover.design().layout.modules[module],
                                          shown_.design.layout.modules[static_cast<std::size_t>(first) + module]);
    }
    // A cover may have parts on several buses, and each bus knows only its own contacts.
    const int group = static_cast<int>(bus_.index() * shown_.offsets.size()) + cover.config().cover;
    live_.set_contacts(group, std::move(contacts));
  }
  bool slice() {
    std::erase_if(taring_, keep_rest);
    pace().hold(bus_.now_us());
    if (Clock::now() >= next_contacts_) {
      next_contacts_ = Clock::now() + view::LatestSamples::kContactsEvery;
      for (std::size_t c = 0; c < bus_.covers().size(); ++c) show_contacts(bus_.covers()[c], c);
    }
    if (Clock::now() < next_health_) return true;
    next_health_ = Clock::now() + kHealthEvery;
    state(true, bus_.link().trouble());
    return true;
  }
  // The page asks for new rest values when nothing touches the skin; they are stored like those of `live --tare`.
  // Returns false while they are not complete.
  static bool keep_rest(skin::LiveCover* cover) {
    if (cover->tare().state() == skin::Tare::State::kDone) (void)cover->keep_rest();
    return cover->tare().state() != skin::Tare::State::kRunning;
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
    for (skin::LiveCover& cover : bus_.covers()) {
      cover.begin_tare(bus_.now_us());
      taring_.push_back(&cover);
    }
  }
  void lift() {
    if (link::TouchActuator* actuator = bus_.covers().front().actuator()) actuator->lift();
  }
  void press(const view::Command& command) {
    for (skin::LiveCover& cover : bus_.covers()) {
      const layout::ModuleId own{command.module - first_module(cover)};
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

  skin::LiveBus& bus_;
  const ShownSkin& shown_;
  view::LatestSamples& live_;
  Health& health_;
  CommandQueue& commands_;
  std::optional<Pace> pace_;  // The pace is set while samples arrive.
  Clock::time_point next_health_{}, next_contacts_{};
  std::vector<skin::LiveCover*> taring_;  // New rest values of these covers will be stored.
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

skin::LiveTotals feed(skin::LiveSkin& skin, const std::string& link, const session::StreamOptions& stream,
                      const ShownSkin& shown, view::LatestSamples& live, CommandQueue& commands) {
  Health health(link, skin.buses().size(), live);
  skin.on_each_bus([&](skin::LiveBus& bus) { Feed(bus, shown, live, health, commands).run(stream); });
  skin::LiveTotals sum;
  for (const auto& bus : skin.buses()) sum += bus->totals();
  return sum;
}

}  // namespace triskin::cli
