// SPDX-License-Identifier: GPL-3.0-or-later
#include "bridge_services.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "triskin/base/error.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/firmware_version.hpp"

namespace triskin::cli::bridge_services {
namespace {

// Calls `ask` for each controller; if one fails, this is reported and the others are still asked.
template <class Answer, class Ask>
void ask_each(session::Bus& bus, const design::Design& design, const std::vector<layout::PatchIndex>& patches,
              Answer& answer, Ask ask) {
  for (const layout::PatchIndex patch : patches) {
    const auto node = static_cast<std::uint8_t>(design::node_address_of(design, patch));
    try {
      session::Controller controller(bus, node);
      ask(patch, controller);
    } catch (const DeviceError& e) {
      answer.message += fmt::format("{}patch {}: {}", answer.message.empty() ? "" : "; ", patch, e.what());
    }
  }
  answer.success = answer.message.empty();
}

}  // namespace
}  // namespace triskin::cli::bridge_services

namespace triskin::cli {

CoverServices::CoverServices(bridge::Domain& domain, const std::string& base, skin::LiveCover& cover)
    : cover_(cover), tare_(domain, base), reroute_(domain, base), identify_(domain, base) {}

void CoverServices::step(session::Bus& bus) {
  step_tare(bus.now_us());
  // Each step serves one request of each kind, so that a client that asks all the time cannot delay the samples.
  if (const auto asked = reroute_.take()) reroute_.answer(asked->id, reroute(bus, asked->request.patch));
  if (const auto asked = identify_.take()) identify_.answer(asked->id, identify(bus));
}

namespace {

bridge::Tare::Answer answer_of(const skin::Tare& tare) {
  using State = skin::Tare::State;
  bridge::Tare::Answer answer;
  answer.taxels = tare.taxels();
  answer.success = tare.state() == State::kDone;
  if (tare.state() == State::kNoSample)
    answer.message = "no valid sample came in 2 s, so there is nothing to tare; look at /diagnostics";
  else if (tare.state() == State::kIncomplete)
    answer.message = "some taxels gave fewer than three samples in 2 s; ask again, or let the stream be faster";
  return answer;
}

}  // namespace

// Clients that ask during a tare get the answer of the tare that is started again for them.
void CoverServices::step_tare(std::uint64_t now_us) {
  bool begin = false;
  while (const auto asked = tare_.take()) {
    taring_.push_back(asked->id);
    begin = true;
  }
  if (begin) return cover_.begin_tare(now_us);
  using State = skin::Tare::State;
  const State state = cover_.tare().state();
  if (taring_.empty() || state == State::kRunning) return;
  const bridge::Tare::Answer answer = answer_of(cover_.tare());
  for (const bridge::RequestId& id : taring_) tare_.answer(id, answer);
  taring_.clear();
}

bridge::Reroute::Answer CoverServices::reroute(session::Bus& bus, std::int32_t patch) const {
  bridge::Reroute::Answer answer;
  std::vector<layout::PatchIndex> patches = design::patches_here(cover_.design());
  if (patch >= 0) std::erase_if(patches, [&](layout::PatchIndex p) { return p != patch; });
  if (patches.empty()) {
    answer.message = fmt::format("no controller of patch {} is on this bus; patches count from 0", patch);
    return answer;
  }
  bridge_services::ask_each(bus, cover_.design(), patches, answer,
                            [&](layout::PatchIndex p, session::Controller& controller) {
                              controller.reroute();
                              const wire::ActiveRoute route = controller.route();
                              answer.patch.push_back(p);
                              answer.modules.push_back(route.switched ? std::popcount(route.alive) : -1);
                            });
  return answer;
}

bridge::Identify::Answer CoverServices::identify(session::Bus& bus) const {
  bridge::Identify::Answer answer;
  answer.design_id = cover_.design().design_id;
  bridge_services::ask_each(bus, cover_.design(), design::patches_here(cover_.design()), answer,
                            [&](layout::PatchIndex patch, session::Controller& controller) {
                              const wire::Hello hello = controller.hello();
                              const wire::ActiveTable table = controller.active_table();
                              answer.patch.push_back(patch);
                              answer.node.push_back(hello.node_address);
                              answer.serial.push_back(session::to_text(hello.unique_id));
                              answer.firmware.push_back(session::firmware_version_text(hello.firmware_version));
                              answer.table_id.push_back(table.present() ? table.design_id : 0);
                            });
  return answer;
}

}  // namespace triskin::cli
