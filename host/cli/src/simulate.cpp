// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "triskin/cli/command.hpp"
#include "triskin/host/interrupt.hpp"
#include "triskin/simlink/skin_server.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string scene;
  std::string listen;
  double seconds = -1.0;
  bool fresh = false, switched = false;
};

// Without a client time is only a number: as fast as the computer is.
void run_alone(scene::VirtualSkin& skin, double seconds, const ProgressSink& progress) {
  constexpr std::uint64_t kStep_us = 100'000;
  const auto end_us = static_cast<std::uint64_t>(seconds * 1e6);
  while (skin.now_us() < end_us && !interrupt_request()) {
    skin.run_until(std::min(end_us, skin.now_us() + kStep_us));
    report(progress, "simulating", static_cast<double>(skin.now_us()) / static_cast<double>(end_us));
  }
}

int run(const Options& options, Output& output) {
  scene::Scene scene = scene::read_scene(options.scene);
  scene.switched = scene.switched || options.switched;
  const auto folder = options.fresh ? std::filesystem::path{} : scene::state_folder_of(scene.design);
  const std::size_t modules = scene.design.layout.modules.size();
  scene::VirtualSkin skin(std::move(scene), folder);
  catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  if (options.listen.empty()) {
    run_alone(skin, options.seconds < 0.0 ? 1.0 : options.seconds, output.progress());
  } else {
    const auto server = device::open_server(skin, options.listen);
    output.say(fmt::format("{} controllers, {} modules on {}; end with Ctrl-C", skin.controllers(), modules,
                           server->link_name()));
    server->run(interrupt_request(), std::max(0.0, options.seconds));
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double virtual_s = static_cast<double>(skin.now_us()) * 1e-6;
  const double factor = wall_s > 0.0 ? virtual_s / wall_s : 0.0;
  output.result = {{"controllers", skin.controllers()}, {"modules", modules},     {"real_time_factor", factor},
                   {"switched", skin.scene().switched}, {"virtual_s", virtual_s}, {"seconds", wall_s},
                   {"bus_frames", skin.bus_frames()}};
  output.say(fmt::format("{} controllers, {} modules: {:.3f} s of virtual time in {:.3f} s, {:.1f} times real time",
                         skin.controllers(), modules, virtual_s, wall_s, factor));
  return 0;
}

const Registration kSimulate{{
    "simulate",
    "run virtual controllers and skin; with --listen other commands reach them by --link sim:HOST:PORT",
    "triskin simulate scene.json --listen 127.0.0.1:7000",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "scene file (docs/scene.md), or a design file")->required();
      app.add_option("--listen", options->listen,
                     "serve in real time: HOST:PORT (port 0 takes a free one and prints it), can:IFACE, or usb "
                     "(devices in vhci-hcd)");
      app.add_option("--seconds", options->seconds, "how long; default 1 s of virtual time, with --listen until Ctrl-C")
          ->check(CLI::Range(0.0, 1e7));
      app.add_flag("--switched", options->switched,
                   "switched modules, which the controllers route; a scene says it by its key \"hardware\"");
      app.add_flag("--fresh", options->fresh, "boards that were never flashed, kept in memory only");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
