// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <ranges>
#include <set>
#include <utility>

#include "triskin/base/counted.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/robot/assembly.hpp"

namespace triskin::robot {
namespace {

// The limits for CAN are for 1 Mbit/s and inversely proportional to the bit rate (CiA 301: 25 m; stubs of 1.5 m,
// together 7.5 m, as makers of CAN devices state); USB 2.0 full speed allows 5 m.
constexpr double kMaxCan_mm = 25'000.0, kMaxStub_mm = 1'500.0, kMaxStubs_mm = 7'500.0, kMaxUsb_mm = 5'000.0;
constexpr double kCableRate = 1e6;
constexpr int kMaxEvery = 255;  // A reader cannot ask for fewer samples than every 255th.

class Checker {
 public:
  explicit Checker(const Assembly& a) : a_(a), robot_(a.robot), loads_(bus_loads(a)) {}

  std::vector<Problem> run() {
    check_buses();
    if (a_.frames && !is_frame_name(a_.frames->base()))
      add(robot_.urdf,
          fmt::format("its base link \"{}\" begins with a slash or has blanks, so ROS (tf2) drops it",
                      a_.frames->base()),
          "rename the link in the URDF");
    std::set<std::string> names;
    for (std::size_t c = 0; c < robot_.covers.size(); ++c) {
      const CoverEntry& cover = robot_.covers[c];
      if (!names.insert(cover.name).second)
        add("cover " + cover.name, "the name stands there twice", "give each cover a name of its own");
      check_design(cover, a_.designs[c]);
      check_frame(cover);
      for (const ControllerEntry& e : cover.controllers) check_controller(cover, e);
    }
    check_budget();
    check_stubs();
    return std::move(problems_);
  }

 private:
  void add(std::string place, std::string text, std::string remedy) {
    problems_.push_back({std::move(place), std::move(text), std::move(remedy)});
  }

  void check_buses() {
    std::set<std::string> names;
    std::map<std::string, std::string> links;  // For each real wire or server, the map has the bus that opens it.
    for (const BusEntry& bus : robot_.buses) {
      if (!names.insert(bus.name).second)
        add("bus " + bus.name, "the name stands there twice", "give each bus a name of its own");
      for (const auto part : std::views::split(bus.link, ',')) {
        const std::string link(part.begin(), part.end());
        if (link::is_in_process(link)) continue;  // Each bus has its own simulation.
        const auto [first, fresh] = links.try_emplace(link, bus.name);
        if (!fresh)
          add("bus " + bus.name, fmt::format("opens {}, which bus {} opens too", link, first->second),
              "give each bus a link of its own");
      }
      const double max_mm = kMaxCan_mm * kCableRate / bus.rates.nominal;
      if (!link::is_usb(bus.link) && bus.cable_mm > max_mm)
        add("bus " + bus.name,
            fmt::format("its cable of {:.1f} m is longer than {:.1f} m, the most at {} kbit/s", bus.cable_mm / 1e3,
                        max_mm / 1e3, bus.rates.nominal / 1000),
            "divide the bus, or lower its bit rate");
    }
  }

  void check_design(const CoverEntry& cover, const design::Design& design) {
    const std::string place = "cover " + cover.name;
    if (design.design_id != cover.design_id) {
      add(place,
          fmt::format("{} has design id {:016x}, the robot file notes {:016x}: another version of the design under the "
                      "same name",
                      cover.design, design.design_id, cover.design_id),
          fmt::format("take it over with triskin robot add {} {} --name {} --replace, or bring the noted version back",
                      a_.file.string(), cover.design, cover.name));
    }
    std::map<int, int> served;
    for (const ControllerEntry& e : cover.controllers) ++served[e.patch];
    for (const auto& [patch, count] : served) {
      if (!design::has_patch(design, patch))
        add(fmt::format("{}, patch {}", place, patch),
            fmt::format("the design has patches {}", design::patch_numbers(design)),
            "remove the controller, or add the cover again with --replace");
      else if (count > 1)
        add(fmt::format("{}, patch {}", place, patch), fmt::format("has {}", counted(count, "controller")),
            "keep one of them");
    }
    for (const layout::PatchIndex patch : design::patches_of(design)) {
      if (!served.contains(patch))
        add(fmt::format("{}, patch {}", place, patch), "has no controller",
            "give it one with a free node address, or add the cover again with --replace");
    }
  }

  void check_frame(const CoverEntry& cover) {
    if (!cover.frame.empty() && !is_frame_name(cover.frame)) {
      add("cover " + cover.name,
          fmt::format("its frame \"{}\" begins with a slash or has blanks, so ROS (tf2) drops it", cover.frame),
          "rename the link, also in the URDF");
      return;
    }
    if (!a_.frames || cover.frame.empty() || a_.frames->has(cover.frame)) return;
    std::vector<std::string> links;
    for (const auto& [name, pose] : a_.frames->poses()) links.push_back(name);
    add("cover " + cover.name, fmt::format("{} has no link \"{}\"", robot_.urdf, cover.frame),
        fmt::format("use one of its links: {}", fmt::join(links, ", ")));
  }

  void check_controller(const CoverEntry& cover, const ControllerEntry& e) {
    const std::string place = fmt::format("cover {}, patch {}", cover.name, e.patch);
    if (!e.serial.empty()) {
      const auto [first, fresh] = serials_.try_emplace(e.serial, place);
      if (!fresh)
        add(place, fmt::format("its controller {} is also that of {}", e.serial, first->second),
            "a controller serves one patch: correct one of the serial numbers");
    }
    const int index = bus_of(robot_, cover, e);
    if (index < 0) {
      add(place, fmt::format("there is no bus \"{}\"", e.bus.empty() ? cover.bus : e.bus),
          "name one of the file's buses, or add the bus");
      return;
    }
    const BusEntry& bus = robot_.buses[static_cast<std::size_t>(index)];
    if (e.node < bus.first_node || e.node > bus.last_node)
      add(place,
          fmt::format("node address {} lies outside {} … {}, the range of bus {}", e.node, bus.first_node,
                      bus.last_node, bus.name),
          "choose one of the range, or widen it");
    const auto [first, fresh] = nodes_.try_emplace({index, e.node}, place);
    if (!fresh)
      add(place, fmt::format("node address {} of bus {} is also that of {}", e.node, bus.name, first->second),
          "give one of them a free address");
    if (link::is_usb(bus.link) && e.cable_mm > kMaxUsb_mm)
      add(place, fmt::format("its USB cable of {:.1f} m is longer than 5 m", e.cable_mm / 1e3),
          "put a hub nearer to it");
  }

  void check_budget() {
    for (std::size_t b = 0; b < robot_.buses.size(); ++b) {
      if (loads_[b].every > kMaxEvery)
        add("bus " + robot_.buses[b].name,
            fmt::format("{} on {} {} {:.0f} % of it by every sample: not even each {}th fits",
                        counted(loads_[b].modules, "module"), counted(loads_[b].controllers, "controller"),
                        agreeing(loads_[b].controllers, "is", "are"), 100.0 * loads_[b].full, kMaxEvery),
            "divide the bus, or raise its data bit rate");
    }
    for (const CoverEntry& cover : robot_.covers) {
      for (const ControllerEntry& e : cover.controllers) {
        const int b = bus_of(robot_, cover, e);
        if (b < 0 || cover.rate_hz <= loads_[static_cast<std::size_t>(b)].rate_hz) continue;
        const BusLoad& load = loads_[static_cast<std::size_t>(b)];
        add("cover " + cover.name,
            fmt::format(
                "wants {:.1f} samples a second; bus {} carries {:.1f} of each of its {} ({:.0f} % by every sample)",
                cover.rate_hz, robot_.buses[static_cast<std::size_t>(b)].name, load.rate_hz,
                counted(load.modules, "module"), 100.0 * load.full),
            "move controllers to another bus, raise the data bit rate, or lower rate_hz");
        break;
      }
    }
  }

  void check_stubs() {
    std::map<int, double> sums_mm;
    for (const CoverEntry& cover : robot_.covers) {
      for (const ControllerEntry& e : cover.controllers) {
        const int index = bus_of(robot_, cover, e);
        if (index < 0 || link::is_usb(robot_.buses[static_cast<std::size_t>(index)].link)) continue;
        sums_mm[index] += e.cable_mm;
        const double max_mm = kMaxStub_mm * share(index);
        if (e.cable_mm > max_mm)
          add(fmt::format("cover {}, patch {}", cover.name, e.patch),
              fmt::format("its stub of {:.2f} m is longer than {:.2f} m, the most on bus {}", e.cable_mm / 1e3,
                          max_mm / 1e3, robot_.buses[static_cast<std::size_t>(index)].name),
              "lead the bus past the controller");
      }
    }
    for (const auto& [index, sum_mm] : sums_mm) {
      if (sum_mm > kMaxStubs_mm * share(index))
        add("bus " + robot_.buses[static_cast<std::size_t>(index)].name,
            fmt::format("its stubs are {:.2f} m together, {:.2f} m are the most", sum_mm / 1e3,
                        kMaxStubs_mm * share(index) / 1e3),
            "shorten the stubs, or divide the bus");
    }
  }
  [[nodiscard]] double share(int index) const {
    const wire::BitRates& r = robot_.buses[static_cast<std::size_t>(index)].rates;
    return kCableRate / std::max(r.nominal, r.data);
  }

  const Assembly& a_;
  const Robot& robot_;
  std::vector<BusLoad> loads_;
  std::map<std::string, std::string> serials_;
  std::map<std::pair<int, int>, std::string> nodes_;
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> check(const Assembly& assembly) {
  return Checker(assembly).run();
}

}  // namespace triskin::robot
