// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::device {

Stream::Stream(Bus& bus, const design::Design& design, OnFrame handler) : bus_(bus), handler_(std::move(handler)) {
  if (!bus.link().fd())
    throw InputError(fmt::format(
        "{}: carries classic frames only, and the full stream needs CAN FD; bring the interface up with fd on",
        bus.link().name()));
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    const layout::PatchImage image = image_of(design, static_cast<int>(p));
    Controller c(bus, image.node_address);
    const wire::ActiveTable table = c.active_table();
    if (!table.present() || !holds_image(table.crc, image)) {
      throw DeviceError(
          fmt::format("{}: the controller of patch {} does not hold the table of this design; run triskin flash first",
                      bus.link().name(), p));
    }
    Node node;
    for (const auto& row : image.rows()) node.modules.push_back(row.module_id);
    node.last.assign(node.modules.size(), 0);
    nodes_[image.node_address] = std::move(node);
  }
  bus_.on_stream([this](const wire::CanFrame& frame) { handle(frame); });
  for (const auto& [address, node] : nodes_) Controller(bus_, address).set_stream(wire::StreamMode::kFull);
}

Stream::~Stream() {
  bus_.on_stream({});
  const Bus::Uninterrupted guard(bus_);
  for (const auto& [address, node] : nodes_) {
    try {
      Controller(bus_, address).set_stream(wire::StreamMode::kOff);
    } catch (const Error&) {
      return;  // the link is gone, and so is the stream
    }
  }
}

void Stream::run_until(std::uint64_t until_us) {
  bus_.listen(until_us);
}

void Stream::handle(const wire::CanFrame& frame) {
  const auto decoded = wire::decode_full(frame);
  if (!decoded) return;
  const auto node = nodes_.find(decoded->node_address);
  if (node == nodes_.end() || decoded->module >= node->second.modules.size()) return;
  std::uint32_t& last = node->second.last[decoded->module];
  if (last != 0 && decoded->sample > last + 1) lost_ += decoded->sample - last - 1;
  last = decoded->sample;
  ++frames_;
  if (handler_) {
    handler_({node->second.modules[decoded->module], bus_.now_us(), *decoded});
  }
}

}  // namespace triskin::device
