// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/log_reader.hpp"

#include <utility>

#include "triskin/session/controller.hpp"

namespace triskin::session {

LogReader::LogReader(Bus& bus, std::vector<std::uint8_t> nodes, wire::LogLevel level, OnLine on_line)
    : bus_(bus), nodes_(std::move(nodes)), on_line_(std::move(on_line)), all_levels_(level == wire::LogLevel::kDebug) {
  bus_.on_stream([this](const wire::CanFrame& frame) { take(frame); });
  for (const std::uint8_t node : nodes_) {
    Controller c(bus_, node);
    all_levels_ = all_levels_ || c.log().compiled <= level;
    c.set_log(level);
  }
}

LogReader::~LogReader() {
  try {
    finish();
  } catch (const std::exception&) {
    open_ = false;  // A controller that is gone sends nothing anyway.
  }
  bus_.on_stream({});
}

void LogReader::run_until(std::uint64_t until_us) {
  bus_.listen(until_us);
}

void LogReader::finish() {
  if (!std::exchange(open_, false)) return;
  const Bus::Uninterrupted guard(bus_);
  for (const std::uint8_t node : nodes_) Controller(bus_, node).set_log(wire::LogLevel::kOff);
}

// Numbers count the lines of all levels, so a gap means a loss only when every level is read. A controller that
// restarts begins with 0.
void LogReader::take(const wire::CanFrame& frame) {
  const auto node = static_cast<std::uint8_t>(frame.id & 0xFF);
  Source& source = sources_[node];
  const auto line = source.decoder.add(frame);
  if (!line) return;
  if (all_levels_ && source.last_number >= 0 && line->number != 0)
    lost_ += static_cast<std::uint8_t>(line->number - source.last_number - 1);
  source.last_number = line->number;
  on_line_({node, line->level, line->time_ms / 1000.0, std::string(line->view())});
}

}  // namespace triskin::session
