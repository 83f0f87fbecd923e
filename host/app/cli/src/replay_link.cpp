// SPDX-License-Identifier: GPL-3.0-or-later
#include "replay_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <utility>

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

namespace triskin::cli {
namespace {

constexpr double kReplaySlice_us = 10'000;
constexpr std::uint64_t kReplayOffsets_us = 2'500'000;  // Controllers find their offsets within this time.

struct ReplayEnded {};  // The exception is thrown when a person ends the replay.

// Returns the modules with a sample in the recording; the others do not exist. Reads the whole file.
std::set<layout::ModuleId> heard_modules(const std::string& file) {
  std::set<layout::ModuleId> heard;
  (void)recording::read_recording(file, [&](const recording::ModuleSample& s) { heard.insert(s.module); });
  return heard;
}

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

hardware::Scene replay_scene(const std::string& file, const RecordedSkin& recorded) {
  const design::Design& design = recorded.design;
  hardware::Scene scene;
  scene.design = design;
  scene.boards = recorded_boards(recorded);
  const std::set<layout::ModuleId> heard = heard_modules(file);
  if (heard.empty()) throw InputError(file + ": holds no sample, so there is nothing to play");
  for (layout::ModuleId m; m < static_cast<int>(design.layout.modules.size()); ++m) {
    if (heard.contains(m)) continue;
    hardware::Fault& absent = scene.faults.emplace_back();
    absent.kind = hardware::FaultKind::kRemovedChip;
    absent.module = m;
  }
  return scene;
}

// Plays samples into a served skin at the pace at which they arrived.
class LinkPlayer {
 public:
  LinkPlayer(const ReplayLinkOptions& options, hardware::SimLink& link)
      : options_(options),
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
    std::array<double, layout::kTaxelsPerModule> counts{};
    std::ranges::copy(s.sample.value, counts.begin());
    skin_.skin().show(s.module, counts);
  }
  void run_us(double span_us) {
    constexpr double kSecondsPerUs = 1e-6;
    server_->run(interrupt_request(), span_us * kSecondsPerUs);
    if (interrupt_request()) throw ReplayEnded{};
  }

  const ReplayLinkOptions& options_;
  hardware::VirtualSkin& skin_;
  std::unique_ptr<hardware::SkinServer> server_;
  double due_us_ = 0.0;
  std::uint64_t samples_ = 0;
};

void prepare_boards(const design::Design& design, hardware::SimLink& link) {
  // The offsets are found with every taxel at rest, so that playback gives the recorded values.
  std::array<double, layout::kTaxelsPerModule> rest{};
  rest.fill(layout::kRestCounts);
  for (layout::ModuleId m; m < static_cast<int>(design.layout.modules.size()); ++m) link.skin().skin().show(m, rest);
  session::Bus bus(link);
  deploy::FlashOptions flash;
  // New boards are in the order of the patches, or have the serial numbers of the recording.
  flash.recognise = false;
  for (layout::PatchIndex p; p < static_cast<int>(design.patches.size()); ++p)
    flash.assign.push_back({p, session::to_text(hardware::unique_id_of(link.skin().scene(), p))});
  (void)deploy::flash(bus, design, flash);
  bus.listen(bus.now_us() + kReplayOffsets_us);
}

}  // namespace

int replay_into_link(const ReplayLinkOptions& options, Output& output) {
  catch_interrupts();
  const RecordedSkin recorded = recorded_skin(options.file);
  hardware::SimLink link(replay_scene(options.file, recorded));
  prepare_boards(recorded.design, link);
  LinkPlayer player(options, link);
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
