// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/connect/open_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <ranges>

#include "triskin/base/interrupt.hpp"
#include "triskin/base/nearest_name.hpp"
#include "triskin/connect/attached.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/hardware/tcp_link.hpp"
#include "triskin/link/can_link.hpp"
#include "triskin/link/combined_link.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/link/usb_link.hpp"

namespace triskin::connect {
namespace {

constexpr const char* kKnown =
    "sim, sim-usb, sim:HOST:PORT, can:IFACE, hid[:SERIAL] or usb[:SERIAL]; several of the last three joined by commas";

std::unique_ptr<link::Link> open_sim(const LinkOptions& options, const design::Design* design) {
  if (options.scene.empty()) {
    if (design == nullptr) throw InputError("link sim: give the scene or the design to simulate with --scene FILE");
    hardware::Scene scene;
    scene.design = *design;
    scene.switched = options.switched;
    scene.board_seed = board_seed_of(options.board_seed, scene.seed);
    const auto folder = hardware::state_folder_of(scene.design);
    return simulate_here(options.link, std::move(scene), folder);
  }
  hardware::Scene scene = hardware::read_scene(options.scene);
  scene.switched = scene.switched || options.switched;
  if (design != nullptr && scene.design.design_id != design->design_id) {
    throw InputError(fmt::format("{}: its design is {:016x}, the one given is {:016x}; use a scene of this design",
                                 options.scene, scene.design.design_id, design->design_id));
  }
  scene.board_seed = board_seed_of(options.board_seed, scene.seed);
  const auto folder = hardware::state_folder_of(scene.design);
  return simulate_here(options.link, std::move(scene), folder);
}

// Returns null if the link is neither hid nor usb.
std::unique_ptr<link::Link> open_usb(const std::string& link) {
  const std::size_t colon = link.find(':');
  const std::string kind = link.substr(0, colon);
  if (kind != "hid" && kind != "usb") return nullptr;
  std::string serial = colon == std::string::npos ? "" : link.substr(colon + 1);
  std::ranges::transform(serial, serial.begin(),
                         [](char c) { return c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c; });
  if (colon != std::string::npos &&
      (serial.empty() || serial.find_first_not_of("0123456789ABCDEF") != std::string::npos)) {
    throw InputError(
        fmt::format("link {}: a serial number has 24 hexadecimal digits, as triskin discover shows them", link));
  }
  return std::make_unique<link::UsbLink>(kind == "hid" ? link::make_hid_driver() : link::make_bulk_driver(), serial);
}

}  // namespace

std::unique_ptr<link::Link> simulate_here(const std::string& link, hardware::Scene scene,
                                          const std::filesystem::path& folder) {
  if (link == link::kSimulatedHub) return std::make_unique<hardware::SimUsbLink>(std::move(scene), folder);
  return std::make_unique<hardware::SimLink>(std::move(scene), folder);
}

std::optional<std::uint64_t> board_seed_of(std::optional<std::uint64_t> asked, std::uint64_t by_default) {
  const std::uint64_t seed = asked.value_or(by_default);
  return seed == 0 ? std::nullopt : std::optional(seed);
}

namespace {

// Returns a question for a link that was probably mistyped: the name of an interface without "can:", or a slip.
std::string meant_link(const std::string& link) {
  for (const AttachedDevice& device : attached_devices())
    if (device.link == "can:" + link) return fmt::format("; did you mean {}?", device.link);
  std::string small = link;
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::string nearest = nearest_name(small, {"sim", "sim-usb", "usb", "hid"}, small.size());
  if (!nearest.empty()) return fmt::format("; did you mean {}?", nearest);
  const bool interface = link.find(':') == std::string::npos && small.find("can") != std::string::npos;
  return interface ? fmt::format("; did you mean can:{}?", link) : "";
}

[[noreturn]] void refuse_unknown(const std::string& link) {
  throw InputError(fmt::format("link \"{}\" is unknown{}; use {}", link, meant_link(link), kKnown));
}

// Returns null if the link is not a real wire.
std::unique_ptr<link::Link> open_wire(const std::string& link) {
  if (link.starts_with("can:")) return std::make_unique<link::CanLink>(link.substr(4));
  return open_usb(link);
}

std::unique_ptr<link::Link> open_several(const std::string& text) {
  std::vector<std::unique_ptr<link::Link>> links;
  for (const auto part : std::views::split(text, ',')) {
    const std::string link(part.begin(), part.end());
    links.push_back(open_wire(link));
    if (!links.back())
      throw InputError(
          fmt::format("link \"{}\" cannot be one of several; use can:IFACE, hid[:SERIAL] or usb[:SERIAL]", link));
  }
  return std::make_unique<link::CombinedLink>(std::move(links));
}

}  // namespace

void settle_link(LinkOptions& options, bool simulates) {
  if (options.chosen) return;
  const char* named = std::getenv("TRISKIN_LINK");
  options.link = simulates ? link::kSimulatedBus : named != nullptr ? named : "";
}

void require_link(const LinkOptions& options) {
  if (options.link.empty()) throw InputError(unnamed_link_text(attached_devices()));
}

void require_known_link(const std::string& link) {
  if (link::is_in_process(link) || link.starts_with("sim:")) return;
  for (const auto part : std::views::split(link, ',')) {
    const std::string one(part.begin(), part.end());
    if (!one.starts_with("can:") && !link::is_usb(one)) refuse_unknown(one);
  }
}

std::unique_ptr<link::Link> open_link(const LinkOptions& options, const design::Design* design) {
  require_link(options);
  if (options.own_interrupts) catch_interrupts();
  if (link::is_in_process(options.link)) return open_sim(options, design);
  if (!options.scene.empty())
    throw InputError("a scene belongs to the links sim and sim-usb; give it to triskin simulate instead");
  if (options.link.starts_with("sim:"))
    return std::make_unique<hardware::TcpLink>(hardware::parse_host_port(options.link.substr(4)));
  if (options.link.find(',') != std::string::npos) return open_several(options.link);
  if (auto wire = open_wire(options.link)) return wire;
  refuse_unknown(options.link);
}

}  // namespace triskin::connect
