// SPDX-License-Identifier: Apache-2.0
#include "triskin/app/journal.hpp"

namespace triskin::fw {

using wire::LogLevel;

namespace {

std::string_view text_of(wire::ModuleState state) {
  constexpr std::array<std::string_view, wire::kModuleStateCount> kTexts{
      "not known yet", "works",  "absent",       "is no AD7147",      "lost its configuration",
      "saturated",     "frozen", "line is held", "two at one address"};
  return kTexts[static_cast<std::size_t>(state)];
}

std::string_view text_of(wire::CrashCause cause) {
  constexpr std::array<std::string_view, 7> kTexts{
      "nothing", "a fault", "a stack overflow", "the watchdog", "the clock", "an interrupt", "an error of the program"};
  return kTexts[static_cast<std::size_t>(cause)];
}

}  // namespace

void Journal::started() {
  log_.add<LogLevel::kInformation>(now_us(), [&](LogText& t) {
    t.text("started: firmware ").decimal(kFirmwareVersion >> 24).text(".").decimal(kFirmwareVersion >> 16 & 0xFF);
    t.text(".").decimal(kFirmwareVersion >> 8 & 0xFF);
  });
  if (parts_.ports.monitor == nullptr) return;
  const wire::BoardHealth h = parts_.ports.monitor->health();
  bus_offs_ = h.bus_offs;
  if (h.clock.crystal == wire::Crystal::kUsed) {
    log_.add<LogLevel::kInformation>(now_us(),
                                     [&](LogText& t) { t.text("crystal ").decimal(h.clock.crystal_mhz).text(" MHz"); });
  } else {
    log_.add<LogLevel::kWarning>(now_us(), [&](LogText& t) {
      t.text("runs without crystal, measured ").decimal(h.clock.measured_khz).text(" kHz");
    });
  }
  if (h.findings != 0)
    log_.add<LogLevel::kWarning>(now_us(), [&](LogText& t) { t.text("findings ").decimal(h.findings); });
  crash();
}

void Journal::crash() {
  const auto c = parts_.ports.monitor->crash();
  if (!c) return;
  log_.add<LogLevel::kError>(now_us(), [&](LogText& t) {
    t.text("was stopped by ").text(text_of(c->cause)).text(" after ").decimal(c->uptime_ms).text(" ms");
    if (c->pc != 0) t.text(" at ").address(c->pc & ~1U);
    // A return address points behind the call, so the call itself is just before it.
    if (c->lr != 0) t.text(", called from ").address((c->lr & ~1U) - 2);
  });
}

void Journal::table() {
  states_ = {};
  const TableStore& tables = parts_.tables;
  if (!tables.has_table())
    return log_.add<LogLevel::kWarning>(now_us(), [](LogText& t) { t.text("no table: run triskin flash"); });
  log_.add<LogLevel::kInformation>(now_us(), [&](LogText& t) {
    t.text("table ").decimal(tables.sequence()).text(": ").decimal(tables.table().module_count);
    t.text(" modules, node address ").decimal(tables.node_address());
  });
}

void Journal::stream(wire::StreamMode mode) {
  log_.add<LogLevel::kDebug>(now_us(),
                             [&](LogText& t) { t.text("stream ").decimal(static_cast<std::uint32_t>(mode)); });
}

void Journal::restart() {
  log_.add<LogLevel::kInformation>(now_us(), [](LogText& t) { t.text("a host asks for a restart"); });
}

void Journal::look() {
  look_at_modules();
  look_at_lines();
  if (++looks_ % 128 == 0) look_at_bus();
}

void Journal::look_at_modules() {
  const std::size_t rows = parts_.tables.has_table() ? parts_.tables.table().module_count : 0;
  for (std::size_t k = 0; k < rows; ++k) {
    const wire::ModuleState state = parts_.samples[k].state, before = states_[k];
    if (state == before || state == wire::ModuleState::kUnknown) continue;
    states_[k] = state;
    const auto fill = [&](LogText& t) {
      t.text("module in row ").decimal(static_cast<std::uint32_t>(k)).text(": ");
      t.text(text_of(state));
    };
    if (state != wire::ModuleState::kOk)
      log_.add<LogLevel::kWarning>(now_us(), fill);
    else if (before != wire::ModuleState::kUnknown)
      log_.add<LogLevel::kInformation>(now_us(), fill);
    else
      log_.add<LogLevel::kDebug>(now_us(), fill);
  }
}

void Journal::look_at_lines() {
  for (std::size_t l = 0; l < stuck_.size(); ++l) {
    const bool stuck = parts_.lines[l].stuck();
    if (stuck == stuck_[l]) continue;
    stuck_[l] = stuck;
    const auto fill = [&](LogText& t) {
      t.text("line ").decimal(static_cast<std::uint32_t>(l)).text(stuck ? " is held low" : " is free again");
    };
    if (stuck)
      log_.add<LogLevel::kWarning>(now_us(), fill);
    else
      log_.add<LogLevel::kInformation>(now_us(), fill);
  }
}

void Journal::look_at_bus() {
  if (parts_.ports.monitor == nullptr) return;
  const std::uint32_t now = parts_.ports.monitor->health().bus_offs;
  if (now == bus_offs_) return;
  bus_offs_ = now;
  log_.add<LogLevel::kWarning>(
      now_us(), [&](LogText& t) { t.text("CAN bus-off, ").decimal(now).text(" times since the start"); });
}

}  // namespace triskin::fw
