// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/virtual_skin.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>

#include "change_times.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/layout/flash_pages.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::hardware {
namespace {

// A controller that stays busy is run again after this time, so that the loop always advances.
constexpr std::uint64_t kBusyStepUs = 50;
constexpr std::uint64_t kNeverUs = ~std::uint64_t{0};
constexpr std::uint32_t kStreamMask = 0x1FFF0000;

// Returns the name of the files that store a controller's flash.
std::string board_name(const Scene& scene, std::size_t patch) {
  if (scene.boards.empty()) return fmt::format("controller_{}", patch + 1);
  return fmt::format("{:02X}", fmt::join(scene.boards.at(patch), ""));
}

// Returns the patch that a controller's cable really leads to.
layout::PatchIndex plugged_patch(const Scene& scene, layout::PatchIndex patch, std::uint64_t at_us) {
  for (const Fault& f : scene.faults) {
    if (f.kind != FaultKind::kSwappedPatches || !is_present(f, at_us)) continue;
    if (f.patch == patch) return f.other_patch;
    if (f.other_patch == patch) return f.patch;
  }
  return patch;
}

// The boards remember the faults of their patch. Another scene is another patch, to which these faults do not belong.
constexpr const char* kHardwareFile = "hardware";

bool is_noted(const std::filesystem::path& folder, const Scene& scene) {
  std::ifstream in(folder / kHardwareFile);
  std::string noted;
  return in >> noted && noted == fmt::format("{:016x}", hardware_id(scene));
}

void note(const std::filesystem::path& folder, const Scene& scene) {
  write_file_atomically(folder / kHardwareFile, fmt::format("{:016x}\n", hardware_id(scene)));
}

void forget_faults(FlashMemory& flash) {
  for (std::size_t k = 0; k < layout::kFaultPages; ++k)
    (void)flash.erase_page((layout::kFirstFaultPage + k) * flash.page_bytes());
}

void make_folder(const std::filesystem::path& state_folder) {
  std::error_code error;
  std::filesystem::create_directories(state_folder, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot make the folder of the simulated flash: {}; set XDG_STATE_HOME",
                                 state_folder.string(), error.message()));
  }
}

// Without a state folder the contents are lost at the end of the simulation.
std::unique_ptr<FlashMemory> make_flash(std::size_t bytes, const std::filesystem::path& state_folder,
                                        const std::string& file) {
  return state_folder.empty() ? std::make_unique<FlashMemory>(bytes)
                              : std::make_unique<FlashMemory>(bytes, state_folder / file);
}

}  // namespace

std::filesystem::path state_folder() {
  return state_home() / "sim";
}

std::filesystem::path state_folder_of(const design::Design& design) {
  return state_folder() / fmt::format("{:016x}", design.design_id);
}

VirtualSkin::VirtualSkin(Scene scene, const std::filesystem::path& state_folder)
    : scene_(std::move(scene)), switched_(scene_), skin_(scene_, &switched_), nodes_(scene_.design.patches.size()) {
  if (!state_folder.empty()) make_folder(state_folder);
  const bool other_hardware = !state_folder.empty() && !is_noted(state_folder, scene_);
  for (std::size_t p = 0; p < nodes_.size(); ++p) build(p, state_folder, other_hardware);
  if (other_hardware) note(state_folder, scene_);
  std::set<std::uint64_t> changes_us =
      change_times_us(scene_, [](const Fault& f) { return f.kind == FaultKind::kSwappedPatches; });
  changes_us.erase(0);
  cable_changes_us_.assign(changes_us.rbegin(), changes_us.rend());
  std::ranges::copy_if(scene_.faults, std::back_inserter(numberings_),
                       [](const Fault& f) { return f.kind == FaultKind::kSameNumber; });
  std::ranges::stable_sort(numberings_, std::greater{}, &Fault::from_us);
}

void VirtualSkin::build(std::size_t patch, const std::filesystem::path& state_folder, bool other_hardware) {
  if (scene_.design.patches[patch].is_gap()) return;
  Node& node = nodes_[patch];
  const std::string name = board_name(scene_, patch);
  node.flash = make_flash(kFlashBytes, state_folder, name + ".flash");
  if (other_hardware) forget_faults(*node.flash);
  if (patch < scene_.effects.clock_ppm.size()) node.clock = BoardClock(scene_.effects.clock_ppm[patch]);
  plug_in(node, plugged_patch(scene_, layout::PatchIndex{patch}, 0));
  node.slots = make_flash(sim::kSlotsBytes, state_folder, name + ".firmware");
  node.board.flash = node.flash.get();
  node.board.slots = node.slots.get();
  node.board.unique_id = unique_id_of(scene_, layout::PatchIndex{patch});
  node.board.send = [this, patch](const wire::CanFrame& frame) {
    pending_.push_back({of_its_firmware(frame, layout::PatchIndex{patch}), patch});
    ++nodes_[patch].in_buffers;
  };
  // The FDCAN of the microcontroller has three transmit buffers; further frames wait in the controller.
  node.board.room = [this, patch] { return scene_.effects.bus_bit_rate == 0 || nodes_[patch].in_buffers < kBuffers; };
  power_up(patch);
}

// Connects the lines of a controller without power to a patch.
void VirtualSkin::plug_in(Node& node, layout::PatchIndex patch) {
  node.plugged = patch;
  node.lines.clear();
  for (int l = 0; l < layout::kLines; ++l)
    node.board.lines[static_cast<std::size_t>(l)] = &node.lines.emplace_back(skin_.line(patch, l), node.clock);
  if (switched_.present()) node.board.chain = &switched_.patch(patch).chain_of(switched_.controller_of(patch));
}

// The cable of a patch also powers its controller, so a board that is plugged in elsewhere restarts.
void VirtualSkin::exchange_cables() {
  if (cable_changes_us_.empty() || now_us_ < cable_changes_us_.back()) return;
  while (!cable_changes_us_.empty() && now_us_ >= cable_changes_us_.back()) cable_changes_us_.pop_back();
  for (std::size_t p = 0; p < nodes_.size(); ++p) {
    const layout::PatchIndex plugged = plugged_patch(scene_, layout::PatchIndex{p}, now_us_);
    if (plugged == nodes_[p].plugged) continue;
    nodes_[p].controller.reset();
    plug_in(nodes_[p], plugged);
    power_up(p);
  }
}

// Somebody gives a controller the number of another one.
void VirtualSkin::number_boards() {
  while (!numberings_.empty() && now_us_ >= numberings_.back().from_us) {
    const Fault f = numberings_.back();
    numberings_.pop_back();
    Node& node = nodes_.at(static_cast<std::size_t>(f.patch));
    if (node.controller == nullptr) continue;
    run_controller(node);
    const auto number = static_cast<std::uint8_t>(design::node_address_of(scene_.design, f.other_patch).value());
    for (const wire::CanFrame& frame : wire::encode_assignment(node.board.unique_id, number))
      node.controller->receive(frame);
    node.run_again_us = now_us_;
  }
}

// A controller with firmware of another release greets with another wire version; nothing else of it is simulated. The
// answer to the greeting begins with 62 FD 00 behind the two bytes of its transport.
wire::CanFrame VirtualSkin::of_its_firmware(wire::CanFrame frame, layout::PatchIndex patch) const {
  for (const Fault& f : scene_.faults) {
    if (f.kind != FaultKind::kOtherFirmware || f.patch != patch || !is_present(f, now_us_)) continue;
    constexpr std::array<std::uint8_t, 3> kGreeting{0x62, 0xFD, 0x00};
    if (frame.size < 7 || !std::equal(kGreeting.begin(), kGreeting.end(), frame.data.begin() + 2)) continue;
    frame.data[5] = static_cast<std::uint8_t>(f.value & 0xFF);
    frame.data[6] = static_cast<std::uint8_t>(f.value >> 8);
  }
  return frame;
}

VirtualSkin::~VirtualSkin() = default;

std::unique_ptr<sim::VirtualController> VirtualSkin::make_controller(std::size_t patch) {
  Node& node = nodes_[patch];
  const bool by_table = patch < scene_.levels.size() && scene_.levels[patch] == ControllerLevel::kTable;
  if (!by_table) return sim::make_virtual_controller(node.board);
  return sim::make_table_controller(node.board, [this, &node](int line, std::uint8_t address, std::uint64_t at_us) {
    return skin_.line(node.plugged, line).look(address, node.clock.time_us(at_us));
  });
}

void VirtualSkin::power_up(std::size_t patch) {
  Node& node = nodes_[patch];
  if (node.flash == nullptr) return;  // No board has this number.
  node.run_again_us = now_us_;
  node.clock.power(now_us_);
  try {
    node.controller = make_controller(patch);
    node.controller->run_until(node.clock.shown_us(now_us_));
  } catch (const sim::PowerLost&) {
    node.controller.reset();
  }
}

void VirtualSkin::crash(std::size_t patch, const wire::Crash& crash) {
  Node& node = nodes_.at(patch);
  node.board.crash = crash;
  power_cycle(patch);
  node.board.crash.reset();  // The next start is one after a loss of power.
}

void VirtualSkin::power_cycle(std::size_t patch) {
  nodes_.at(patch).controller.reset();
  power_up(patch);
}

void VirtualSkin::use_fd(bool fd) {
  for (std::size_t p = 0; p < nodes_.size(); ++p) {
    if (nodes_[p].board.can_fd == fd) continue;
    nodes_[p].board.can_fd = fd;
    power_cycle(p);
  }
}

void VirtualSkin::send(const wire::CanFrame& frame) {
  if (plugged_) pending_.push_back({frame, kHost});
}

std::size_t VirtualSkin::host_frames_waiting() const {
  return static_cast<std::size_t>(std::ranges::count(pending_, kHost, &Pending::from));
}

void VirtualSkin::deliver(const Pending& pending) {
  ++bus_frames_;
  // Samples make up most of the traffic, and the filter of a controller rejects them.
  const bool refused = pending.frame.extended && (pending.frame.id & kStreamMask) == wire::kFullBase;
  for (std::size_t p = 0; p < nodes_.size() && !refused; ++p) {
    if (p == pending.from || nodes_[p].controller == nullptr) continue;
    // The controller must finish earlier work before it gets the frame; otherwise its answer would have a time before
    // the request.
    if (pending.from == kHost) run_controller(nodes_[p]);
    if (nodes_[p].controller == nullptr) continue;
    if (hears_ && !hears_(p, pending.frame)) continue;
    nodes_[p].controller->receive(pending.frame);
    nodes_[p].run_again_us = now_us_;
  }
  if (pending.from == kHost || !plugged_) return;
  if (hears_ && !hears_(kToHost, pending.frame)) return;
  frame_came_ = true;
  if (on_frame_) on_frame_(pending.frame, now_us_);
}

wire::BitRates VirtualSkin::bit_rates() const {
  const Effects& e = scene_.effects;
  return {static_cast<std::uint32_t>(e.bus_bit_rate), static_cast<std::uint32_t>(e.bus_data_bit_rate)};
}

std::uint64_t VirtualSkin::frame_us(const wire::CanFrame& frame) const {
  const wire::BitRates rates = bit_rates();
  if (rates.nominal == 0) return 0;
  const wire::FrameBits bits = wire::bits_of(frame);
  const std::uint64_t data_rate = rates.data != 0 ? rates.data : rates.nominal;
  return static_cast<std::uint64_t>(bits.nominal) * 1'000'000 / rates.nominal +
         static_cast<std::uint64_t>(bits.data) * 1'000'000 / data_rate;
}

// In arbitration the lowest base identifier wins, and at equal ones the 11-bit frame. Frames of one sender keep their
// order, so only its first one takes part.
std::deque<VirtualSkin::Pending>::iterator VirtualSkin::winner() {
  const auto priority = [](const Pending& p) {
    const std::uint32_t base = p.frame.extended ? p.frame.id >> 18 : p.frame.id;
    return std::pair{(base << 1) | (p.frame.extended ? 1U : 0U), p.frame.id};
  };
  std::vector<bool> heard(nodes_.size() + 1, false);  // The last entry is the host.
  auto best = pending_.end();
  for (auto p = pending_.begin(); p != pending_.end(); ++p) {
    const std::size_t sender = std::min(p->from, nodes_.size());
    if (heard[sender]) continue;
    heard[sender] = true;
    if (best == pending_.end() || priority(*p) < priority(*best)) best = p;
  }
  return best;
}

// Moves at most one frame on; returns true if something changed at this instant.
bool VirtualSkin::advance_bus() {
  if (!on_wire_.empty()) {
    if (now_us_ < wire_free_us_) return false;
    const Pending arrived = on_wire_.back();
    on_wire_.clear();
    deliver(arrived);
    return true;
  }
  if (pending_.empty()) return false;
  const auto first = scene_.effects.bus_bit_rate != 0 ? winner() : pending_.begin();
  const Pending next = *first;
  pending_.erase(first);
  if (next.from != kHost) {
    --nodes_[next.from].in_buffers;
    nodes_[next.from].run_again_us = now_us_;
  }
  const std::uint64_t duration_us = frame_us(next.frame);
  bus_busy_us_ += duration_us;
  if (duration_us == 0) {
    deliver(next);
  } else {
    on_wire_.push_back(next);
    wire_free_us_ = now_us_ + duration_us;
  }
  return true;
}

void VirtualSkin::run_controller(Node& node) {
  try {
    node.controller->run_until(node.clock.shown_us(now_us_));
    node.run_again_us = std::max(node.clock.time_us(node.controller->next_event_us()), now_us_ + kBusyStepUs);
  } catch (const sim::PowerLost&) {
    node.controller.reset();
  }
}

void VirtualSkin::run_controllers() {
  for (Node& node : nodes_) {
    if (node.controller != nullptr && node.run_again_us <= now_us_) run_controller(node);
  }
}

std::uint64_t VirtualSkin::next_event_us() const {
  std::uint64_t next = std::min(on_wire_.empty() ? kNeverUs : wire_free_us_, switched_.next_event_us());
  if (!cable_changes_us_.empty()) next = std::min(next, cable_changes_us_.back());
  if (!numberings_.empty()) next = std::min(next, numberings_.back().from_us);
  for (const Node& node : nodes_) {
    if (node.controller != nullptr) next = std::min(next, node.run_again_us);
  }
  return next;
}

bool VirtualSkin::run(std::uint64_t until_us, bool stop_at_frame) {
  frame_came_ = false;
  while (true) {
    switched_.advance(now_us_);
    exchange_cables();
    number_boards();
    run_controllers();
    const bool moved = advance_bus();
    if (frame_came_ && stop_at_frame) return true;
    if (moved) continue;
    const std::uint64_t next = next_event_us();
    if (next > until_us) break;
    now_us_ = std::max(now_us_, next);
  }
  now_us_ = std::max(now_us_, until_us);
  return frame_came_;
}

layout::ModuleId VirtualSkin::touched_instead_of(layout::ModuleId module) const {
  layout::ModuleId touched = module;
  for (const Fault& f : scene_.faults) {
    if (f.kind == FaultKind::kFingerElsewhere && f.module == module && is_present(f, now_us_)) touched = f.other;
  }
  return touched;
}

int VirtualSkin::press_taxel(layout::TaxelId taxel) {
  const auto k = static_cast<std::size_t>(touched_instead_of(taxel.module));
  const int rotation = design::wiring_of(scene_.design)[k].routed.rotation;
  const auto taxels = design::taxels_of(scene_.design.layout.modules[k], rotation);
  // Pads are at least 3.7 mm apart, so the tip touches only this one.
  constexpr double kTipRadius_mm = 3.0;
  constexpr double kTipForce_n = 1.0;
  Contact tip;
  tip.from_us = now_us_;
  tip.position_mm = taxels[static_cast<std::size_t>(taxel.taxel)].position_mm;
  tip.radius_mm = kTipRadius_mm;
  tip.force_n = kTipForce_n;
  return skin_.press(tip);
}

int VirtualSkin::press_module(layout::ModuleId module) {
  // The finger reaches all pads of a module (the farthest is 11.4 mm from the centre) and little beyond.
  constexpr double kRadius_mm = 12.0;
  constexpr double kForce_n = 20.0;
  Contact finger;
  finger.from_us = now_us_;
  finger.position_mm = center_of(scene_.design, touched_instead_of(module));
  finger.radius_mm = kRadius_mm;
  finger.force_n = kForce_n;
  return skin_.press(finger);
}

}  // namespace triskin::hardware
