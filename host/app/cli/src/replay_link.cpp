// SPDX-License-Identifier: GPL-3.0-or-later
#include "replay_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "expose_option.hpp"
#include "recorded_track.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/deploy/board_file.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/hardware/skin_server.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_offsets.hpp"
#include "triskin/skin/touch_map.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::cli {
namespace {

constexpr double kReplaySlice_us = 10'000;

struct ReplayEnded {};  // The exception is thrown when a person ends the replay.

// Takes from a recording which modules have a sample; the others do not exist. Finds where the taxels rested as live
// did at its start: by the rest values, what the controllers said, and the first valid values of each taxel.
class Beginning {
 public:
  // Reads the whole file.
  Beginning(const std::string& file, const RecordedSkin& recorded)
      : touches_(recorded.design, recorded.rest), seen_(recorded.design.layout.modules.size()) {
    (void)recording::read_recording(file, [&](const recording::ModuleSample& s) { add(s); });
    if (std::ranges::find(seen_, true, &Module::heard) == seen_.end())
      throw InputError(file + ": holds no sample, so there is nothing to play");
  }
  [[nodiscard]] bool has(layout::ModuleId m) const { return seen_[static_cast<std::size_t>(m)].heard; }
  [[nodiscard]] design::RestValues rest() const { return touches_.rest(); }

 private:
  struct Module {
    bool heard = false;
    std::array<std::size_t, layout::kTaxelsPerModule> valid{};
  };
  void add(const recording::ModuleSample& s) {
    if (static_cast<std::size_t>(s.module) >= seen_.size()) return;
    Module& module = seen_[static_cast<std::size_t>(s.module)];
    module.heard = true;
    wire::TaxelFrame first = s.sample;
    for (std::size_t t = 0; t < module.valid.size(); ++t) {
      const unsigned bit = 1U << t;
      if ((first.valid & bit) != 0 && ++module.valid[t] > skin::TouchMap::kRestSamples)
        first.valid = static_cast<std::uint16_t>(first.valid & ~bit);
    }
    if (first.valid != 0) touches_.add({s.module, s.link_time_us, first});
  }

  skin::TouchMap touches_;
  std::vector<Module> seen_;
};

// Returns the boards of the recording, if it has the serial number of each.
std::vector<wire::UniqueId> recorded_boards(const RecordedSkin& recorded) {
  std::vector<wire::UniqueId> boards;
  for (const std::string& text : recorded.serials) {
    const std::string serial = deploy::normal_serial(text);
    if (serial.empty()) return {};
    boards.push_back(session::to_unique_id(serial));
  }
  return boards;
}

hardware::Scene replay_scene(const RecordedSkin& recorded, const Beginning& beginning) {
  const design::Design& design = recorded.design;
  hardware::Scene scene;
  scene.design = design;
  scene.effects.converters.drawn = false;  // The chips of the recording have left their marks in its values.
  scene.boards = recorded_boards(recorded);
  for (layout::ModuleId m; m < static_cast<int>(design.layout.modules.size()); ++m) {
    if (beginning.has(m)) continue;
    hardware::Fault& absent = scene.faults.emplace_back();
    absent.kind = hardware::FaultKind::kRemovedChip;
    absent.module = m;
  }
  return scene;
}

// A controller keeps an offset only while its taxel rests in the middle third of the range. A taxel that rested beyond
// is played with its values shifted by this, so that it rests in the middle.
double shift_counts(double rest) {
  return rest >= wire::kRestLeast && rest <= wire::kRestMost ? 0.0 : layout::kRestCounts - rest;
}

// Plays samples into a served skin at the pace at which they arrived.
class LinkPlayer {
 public:
  // `rest`: where the taxels of the recording rested.
  LinkPlayer(const ReplayLinkOptions& options, design::RestValues rest, hardware::SimLink& link)
      : options_(options),
        rest_(std::move(rest)),
        skin_(link.skin()),
        server_(hardware::open_server(link.skin(), options.listen, reach_of(options.expose))) {}

  [[nodiscard]] std::string link_name() const { return server_->link_name(); }
  [[nodiscard]] bool is_exposed() const { return server_->is_exposed(); }
  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  void wait_for_client() {
    const std::uint64_t before = skin_.bus_frames();
    while (skin_.bus_frames() == before) run_us(kReplaySlice_us);
  }
  void play() {
    bool started = false;
    std::uint64_t shown_us = 0;
    (void)recording::read_recording(options_.file, [&](const recording::ModuleSample& s) {
      if (!started) shown_us = s.link_time_us;
      started = true;
      if (s.link_time_us > shown_us) {
        due_us_ += static_cast<double>(s.link_time_us - shown_us) / options_.speed;
        shown_us = s.link_time_us;
      }
      if (due_us_ >= kReplaySlice_us) run_us(std::exchange(due_us_, 0.0));
      show(s);
    });
    run_us(std::exchange(due_us_, 0.0) + kReplaySlice_us);
  }

 private:
  void show(const recording::ModuleSample& s) {
    ++samples_;
    if (static_cast<std::size_t>(s.module) >= skin_.scene().design.layout.modules.size() || s.sample.valid == 0) return;
    constexpr double kMaxCounts = 65'535.0;
    std::array<double, layout::kTaxelsPerModule> counts{};
    for (std::size_t t = 0; t < counts.size(); ++t)
      counts[t] =
          std::clamp(s.sample.value[t] + shift_counts(rest_[static_cast<std::size_t>(s.module)][t]), 0.0, kMaxCounts);
    skin_.skin().show(s.module, counts);
  }
  void run_us(double span_us) {
    constexpr double kSecondsPerUs = 1e-6;
    server_->run(interrupt_request(), span_us * kSecondsPerUs);
    if (interrupt_request()) throw ReplayEnded{};
  }

  const ReplayLinkOptions& options_;
  design::RestValues rest_;
  hardware::VirtualSkin& skin_;
  std::unique_ptr<hardware::SkinServer> server_;
  double due_us_ = 0.0;
  std::uint64_t samples_ = 0;
};

// `rest`: where the taxels of the recording rested.
void prepare_boards(const design::Design& design, const design::RestValues& rest, hardware::SimLink& link) {
  // The offsets are found with every taxel in the middle of its range, so that playback gives the recorded values.
  std::array<double, layout::kTaxelsPerModule> middle{};
  middle.fill(layout::kRestCounts);
  for (layout::ModuleId m; m < static_cast<int>(rest.size()); ++m) link.skin().skin().show(m, middle);
  session::Bus bus(link);
  deploy::FlashOptions flash;
  // New boards are in the order of the patches, or have the serial numbers of the recording.
  flash.recognise = false;
  for (const layout::PatchIndex p : design::patches_of(design))
    flash.assign.push_back({p, session::to_text(hardware::unique_id_of(link.skin().scene(), p))});
  (void)deploy::flash(bus, design, flash);
  session::wait_for_set_up(bus);
  // With power again they keep the offsets and take for rest what they read: what the skin did at rest.
  for (layout::ModuleId m; m < static_cast<int>(rest.size()); ++m) {
    auto shown = rest[static_cast<std::size_t>(m)];
    for (double& counts : shown) counts += shift_counts(counts);
    link.skin().skin().show(m, shown);
  }
  for (std::size_t p = 0; p < link.skin().controllers(); ++p) link.skin().power_cycle(p);
  session::wait_for_set_up(bus);
}

}  // namespace

int replay_into_link(const ReplayLinkOptions& options, Output& output) {
  catch_interrupts();
  const RecordedSkin recorded = recorded_skin(options.file);
  const Beginning beginning(options.file, recorded);
  hardware::SimLink link(replay_scene(recorded, beginning));
  prepare_boards(recorded.design, beginning.rest(), link);
  LinkPlayer player(options, beginning.rest(), link);
  if (player.is_exposed()) warn_exposed(player.link_name());
  output.say(fmt::format("{} on {}; it begins when a client asks; end with Ctrl-C", options.file, player.link_name()));
  std::fflush(stdout);
  try {
    player.wait_for_client();
    do {
      player.play();
    } while (options.loop);
  } catch (const ReplayEnded&) {
    // Ctrl-C is the usual way to end a loop.
  }
  output.result = {{"samples", player.samples()}, {"link", player.link_name()}};
  output.say(fmt::format("{} {} played", counted(player.samples(), "module sample"),
                         agreeing(player.samples(), "was", "were")));
  return 0;
}

}  // namespace triskin::cli
