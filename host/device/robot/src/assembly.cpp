// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/assembly.hpp"

#include "triskin/base/error.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/session/bus_budget.hpp"
#include "triskin/wire/bus_load.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::robot {
namespace {

// Computes the load by every sample of the full stream at the controllers' fastest clock.
double load_of(std::size_t modules, std::uint64_t sample_ns) {
  return session::kFastestClock * wire::stream_load(modules, sample_ns, wire::sequence_us(wire::Decimation::k256));
}

}  // namespace

Assembly read_assembly(const std::filesystem::path& path) {
  return assemble(read_robot(path), path);
}

Assembly assemble(const Robot& robot, const std::filesystem::path& path) {
  Assembly a{path, robot, {}, std::nullopt};
  for (const CoverEntry& cover : a.robot.covers) {
    try {
      a.designs.push_back(design::read_intact_design(path.parent_path() / cover.design));
    } catch (const InputError& e) {
      throw InputError(path.string() + ": cover " + cover.name + ": " + e.what());
    }
  }
  if (!a.robot.urdf.empty()) a.frames = Frames::read_urdf(path.parent_path() / a.robot.urdf);
  return a;
}

std::vector<BusLoad> bus_loads(const Assembly& a) {
  std::vector<BusLoad> loads(a.robot.buses.size());
  for (std::size_t c = 0; c < a.robot.covers.size(); ++c) {
    for (const ControllerEntry& e : a.robot.covers[c].controllers) {
      const int bus = bus_of(a.robot, a.robot.covers[c], e);
      if (bus < 0 || !design::has_patch(a.designs[c], e.patch)) continue;
      BusLoad& load = loads[static_cast<std::size_t>(bus)];
      const std::size_t modules = a.designs[c].patches[static_cast<std::size_t>(e.patch)].modules.size();
      ++load.controllers;
      load.modules += static_cast<int>(modules);
      const BusEntry& entry = a.robot.buses[static_cast<std::size_t>(bus)];
      // Each USB device has its own wire.
      if (link::is_usb(entry.link)) {
        const bool hid = entry.link.starts_with("hid");
        load.full = std::max(load.full, load_of(modules, hid ? wire::kUsbHidFrame_ns : wire::kUsbBulkFrame_ns));
      } else {
        load.full += load_of(modules, wire::full_sample_ns(entry.rates));
      }
    }
  }
  for (BusLoad& load : loads) {
    load.every = session::min_every(load.full);
    load.rate_hz = 1e6 / wire::sequence_us(wire::Decimation::k256) / load.every;
  }
  return loads;
}

}  // namespace triskin::robot
