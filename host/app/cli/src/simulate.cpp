// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>

#include "command.hpp"
#include "expose_option.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/connect/open_bus.hpp"
#include "triskin/hardware/sim_server.hpp"
#include "triskin/hardware/skin_server.hpp"
#include "triskin/robot/bus_threads.hpp"
#include "triskin/scenario/contact_stream.hpp"
#include "triskin/scenario/scene_check.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli::simulate_command {
namespace {

struct Options {
  std::string scene;
  std::string listen, contacts;
  double seconds = -1.0;
  bool fresh = false, switched = false, expose = false, check = false;
  std::optional<std::uint64_t> board_seed;
};

// Without a client, nothing depends on real time, so the simulation runs as fast as the computer can.
void run_alone(hardware::VirtualSkin& skin, double seconds, const ProgressSink& progress) {
  constexpr std::uint64_t kStep_us = 100'000;
  const auto end_us = static_cast<std::uint64_t>(seconds * 1e6);
  while (skin.now_us() < end_us && !interrupt_request()) {
    skin.run_until(std::min(end_us, skin.now_us() + kStep_us));
    report(progress, "simulating", static_cast<double>(skin.now_us()) / static_cast<double>(end_us));
  }
}

struct SimulatedBus {
  std::string name;  // A design has one bus without a name.
  std::unique_ptr<hardware::VirtualSkin> skin;
  std::unique_ptr<hardware::SkinServer> server;
};

SimulatedBus one_bus(const Options& options) {
  hardware::Scene scene = hardware::read_scene(options.scene);
  scene.switched = scene.switched || options.switched;
  scene.board_seed = connect::board_seed_of(options.board_seed, scene.seed);
  const auto folder = options.fresh ? std::filesystem::path{} : hardware::state_folder_of(scene.design);
  return {"", std::make_unique<hardware::VirtualSkin>(std::move(scene), folder), nullptr};
}

bool is_of_robot(const Options& options) {
  return robot::is_robot_file(options.scene) || hardware::is_robot_scene(options.scene);
}

// Reads a robot file or a scene of a robot.
struct SimulatedRobot {
  explicit SimulatedRobot(const Options& options) {
    if (hardware::is_robot_scene(options.scene)) scene = connect::read_robot_scene(options.scene);
    site = robot::read_site(scene ? scene->robot : std::filesystem::path(options.scene));
    for (const robot::BusConfig& bus : site.buses)
      buses.push_back(connect::scene_of(bus, scene ? &*scene : nullptr, options.switched, options.board_seed));
  }
  std::optional<hardware::RobotScene> scene;
  robot::Site site;
  std::vector<hardware::JointScene> buses;
};

std::vector<SimulatedBus> buses_of(const Options& options) {
  std::vector<SimulatedBus> buses;
  if (!is_of_robot(options)) {
    buses.push_back(one_bus(options));
    return buses;
  }
  SimulatedRobot robot(options);
  for (std::size_t b = 0; b < robot.buses.size(); ++b) {
    const robot::BusConfig& bus = robot.site.buses[b];
    const auto folder = options.fresh ? std::filesystem::path{} : connect::state_folder_of(robot.site, bus);
    buses.push_back(
        {bus.name, std::make_unique<hardware::VirtualSkin>(std::move(robot.buses[b].scene), folder), nullptr});
  }
  return buses;
}

// Buses of a robot get consecutive ports, so that one --link names all of them.
// Opens a server for each bus on consecutive ports; port 0 stands for a free one.
void open_in_turn(std::vector<SimulatedBus>& buses, const hardware::HostPort& first, hardware::Reach reach) {
  int port = first.port;
  for (SimulatedBus& bus : buses) {
    auto server = std::make_unique<hardware::SimServer>(
        *bus.skin, hardware::HostPort{first.host, static_cast<std::uint16_t>(port)}, reach);
    port = server->port() + 1;
    bus.server = std::move(server);
  }
}

void listen(std::vector<SimulatedBus>& buses, const std::string& at, hardware::Reach reach) {
  if (buses.size() == 1) {
    buses[0].server = hardware::open_server(*buses[0].skin, at, reach);
    return;
  }
  const hardware::HostPort first = hardware::parse_host_port(at);
  constexpr int kTries = 20;  // The port after a free one may be in use.
  for (int attempt = 0;; ++attempt) {
    try {
      return open_in_turn(buses, first, reach);
    } catch (const DeviceError&) {
      for (SimulatedBus& bus : buses) bus.server.reset();
      if (first.port != 0 || attempt == kTries) throw;
    }
  }
}

// Reports which board reads which patch, which a person at a real robot could not see.
void tell_boards(const std::vector<SimulatedBus>& buses, Output& output) {
  nlohmann::json boards = nlohmann::json::array();
  for (const SimulatedBus& bus : buses) {
    const hardware::Scene& scene = bus.skin->scene();
    for (const layout::PatchIndex p : design::patches_of(scene.design)) {
      boards.push_back({{"patch", p}, {"serial", session::to_text(hardware::unique_id_of(scene, p))}});
      if (!bus.name.empty()) boards.back()["bus"] = bus.name;
      if (bus.name.empty())
        output.say(fmt::format("patch {:3}  controller {}", p, boards.back()["serial"].get<std::string>()));
    }
  }
  output.result["boards"] = std::move(boards);
  const auto& seed = buses[0].skin->scene().board_seed;
  output.result["board_seed"] = seed ? nlohmann::json(*seed) : nlohmann::json(nullptr);
  if (seed) output.say(fmt::format("serial numbers drawn with --board-seed {}", *seed));
  const hardware::Scene& scene = buses[0].skin->scene();
  output.result["converters"] = scene.effects.converters.drawn ? "drawn" : "ideal";
  output.say(scene.effects.converters.drawn ? fmt::format("converters drawn with seed {} of the scene", scene.seed)
                                            : "ideal converters: all as the data sheet says, and without noise");
}

void serve(std::vector<SimulatedBus>& buses, const Options& options, std::size_t modules, Output& output) {
  listen(buses, options.listen, reach_of(options.expose));
  if (buses[0].server->is_exposed()) warn_exposed(buses[0].server->link_name());
  std::vector<std::string> names;
  std::size_t controllers = 0;
  for (const SimulatedBus& bus : buses) {
    names.push_back(bus.name);
    controllers += bus.skin->controllers();
    if (!bus.name.empty())
      output.say(fmt::format("bus {}: {} on {}", bus.name, counted(bus.skin->controllers(), "controller"),
                             bus.server->link_name()));
  }
  output.say(fmt::format("{}, {} on {}; end with Ctrl-C", counted(controllers, "controller"),
                         counted(modules, "module"), buses[0].server->link_name()));
  tell_boards(buses, output);
  robot::on_each_bus(names,
                     [&](std::size_t k) { buses[k].server->run(interrupt_request(), std::max(0.0, options.seconds)); });
}

scenario::SceneCheck check_of(const Options& options, Output& output) {
  if (robot::is_robot_file(options.scene))
    throw InputError(
        fmt::format("{}: is a robot file; --check takes a scene, which may name it as its \"robot\"", options.scene));
  if (hardware::is_robot_scene(options.scene)) {
    SimulatedRobot robot(options);
    return scenario::check_buses(std::move(robot.buses), robot.scene->expectations, output.progress());
  }
  hardware::Scene scene = hardware::read_scene(options.scene);
  scene.switched = scene.switched || options.switched;
  return scenario::check_scene(std::move(scene), output.progress());
}

int run_check(const Options& options, Output& output) {
  const scenario::SceneCheck check = check_of(options, output);
  nlohmann::json list = nlohmann::json::array();
  for (const scenario::ExpectationResult& r : check.results) {
    const std::string expected = hardware::text_of(r.expectation);
    output.say(fmt::format("{}  {}: {} ({})", r.held ? "ok    " : "FAILED", r.expectation.place, expected, r.seen));
    list.push_back({{"place", r.expectation.place},
                    {"expected", expected},
                    {"held", r.held},
                    {"samples", r.samples},
                    {"seen", r.seen}});
  }
  output.result.update(
      {{"expectations", std::move(list)}, {"failed", check.failed()}, {"virtual_s", check.simulated_s}});
  output.say(fmt::format("{} of {} expectations held in {:.3g} s of virtual time",
                         check.results.size() - check.failed(), check.results.size(), check.simulated_s));
  return check.failed() == 0 ? 0 : 1;
}

int run_contacts(const Options& options, Output& output) {
  if (is_of_robot(options))
    throw InputError(
        fmt::format("{}: is of a robot; --contacts takes a design, or a scene of one design", options.scene));
  const hardware::HostPort at = hardware::parse_host_port(options.contacts);
  hardware::Scene scene = hardware::read_scene(options.scene);
  scene.switched = scene.switched || options.switched;
  catch_interrupts();
  scenario::ContactStream stream(std::move(scene));
  output.expect_interrupt();
  scenario::serve_contacts(stream, at, interrupt_request(), std::max(0.0, options.seconds), [&](int port) {
    output.say(fmt::format("contacts at {}:{}; end with Ctrl-C", at.host, port));
  });
  output.result["virtual_s"] = stream.time_s();
  return 0;
}

void run_without_clients(std::vector<SimulatedBus>& buses, const Options& options, Output& output) {
  tell_boards(buses, output);
  std::vector<std::string> names;
  for (const SimulatedBus& bus : buses) names.push_back(bus.name);
  const ProgressSink progress = output.progress();
  robot::on_each_bus(names, [&](std::size_t k) {
    run_alone(*buses[k].skin, options.seconds < 0.0 ? 1.0 : options.seconds, progress);
  });
}

int run(const Options& options, Output& output) {
  if (!options.contacts.empty()) return run_contacts(options, output);
  if (options.check) return run_check(options, output);
  std::vector<SimulatedBus> buses = buses_of(options);
  std::size_t modules = 0, controllers = 0;
  for (const SimulatedBus& bus : buses) {
    modules += bus.skin->scene().design.layout.modules.size();
    controllers += bus.skin->controllers();
  }
  catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  if (options.listen.empty())
    run_without_clients(buses, options, output);
  else
    serve(buses, options, modules, output);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  double virtual_s = 1e300;
  std::uint64_t bus_frames = 0;
  for (const SimulatedBus& bus : buses) {
    virtual_s = std::min(virtual_s, static_cast<double>(bus.skin->now_us()) * 1e-6);
    bus_frames += bus.skin->bus_frames();
  }
  const double factor = wall_s > 0.0 ? virtual_s / wall_s : 0.0;
  output.result.update({{"controllers", controllers},
                        {"modules", modules},
                        {"real_time_factor", factor},
                        {"virtual_s", virtual_s},
                        {"seconds", wall_s},
                        {"bus_frames", bus_frames},
                        {"buses", buses.size()},
                        {"switched", buses[0].skin->scene().switched}});
  output.say(fmt::format("{}, {}: {:.3f} s of virtual time in {:.3f} s, {:.1f} times real time",
                         counted(controllers, "controller"), counted(modules, "module"), virtual_s, wall_s, factor));
  return 0;
}

const Registration kSimulate{{
    "simulate",
    "run virtual controllers and skin; with --listen other commands reach them by --link sim:HOST:PORT",
    "triskin simulate scene.json --listen 127.0.0.1:7000",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene,
                     "scene file (docs/scene.md) of a design or a robot, design file, or robot file")
          ->required();
      app.add_option("--listen", options->listen,
                     "serve in real time at HOST:PORT (port 0: a free one), can:IFACE, or usb (devices in vhci-hcd)");
      add_expose_option(app, options->expose);
      app.add_option("--seconds", options->seconds,
                     "how long (default: 1 s of virtual time, with --listen until Ctrl-C)")
          ->check(CLI::Range(0.0, 1e7));
      app.add_flag("--switched", options->switched, "switched modules (in a scene: the key \"hardware\")");
      app.add_option("--board-seed", options->board_seed,
                     "random seed of the serial numbers (0: ascending; default: the scene's seed)");
      app.add_option("--contacts", options->contacts,
                     "HOST:PORT for another simulator, which sends touches and gets frames (docs/simulation.md)")
          ->excludes("--listen");
      app.add_flag("--check", options->check,
                   "run the scene and compare what the skin reports with its \"expect\" (status 1 if it differs)")
          ->excludes("--listen")
          ->excludes("--contacts")
          ->excludes("--seconds");
      app.add_flag("--fresh", options->fresh, "boards that were never flashed, in memory only");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli::simulate_command
