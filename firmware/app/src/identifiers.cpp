// SPDX-License-Identifier: Apache-2.0
#include "triskin/app/identifiers.hpp"

#include <algorithm>

#include "triskin/logic/diagnostics/log.hpp"

namespace triskin::fw {

struct Identifiers::Row {
  using Read = bool(const Identifiers&, ByteWriter&);
  using Write = Status(PatchControl&, Bytes);

  constexpr Row(std::uint16_t did, Read* on_read) : id(did), read(on_read), write(refuse), writable(false) {}
  constexpr Row(std::uint16_t did, Read* on_read, Write* on_write)
      : id(did), read(on_read), write(on_write), writable(true) {}

  std::uint16_t id;
  Read* read;
  Write* write;
  // The static assertion uses this flag, because under gcc's sanitizer a comparison of the pointer is not a constant
  // expression.
  bool writable;

 private:
  static Status refuse(PatchControl&, Bytes) { return Status::kOutOfRange; }
};

struct Identifiers::Table {
  template <class Value>
  static bool append(const Value& value, ByteWriter& out) {
    value.encode(out);
    return true;
  }
  template <class Value>
  static bool append(const std::optional<Value>& value, ByteWriter& out) {
    if (value) value->encode(out);
    return value.has_value();
  }
  template <auto kGet>
  static bool read(const Identifiers& self, ByteWriter& out) {
    if constexpr (requires { kGet(); })
      return append(kGet(), out);
    else
      return append((self.*kGet)(), out);
  }
  static bool part_number(const Identifiers&, ByteWriter& out) {
    out.bytes(wire::kPartNumber);
    return true;
  }
  static bool calibration(const Identifiers& self, ByteWriter& out) {
    const Bytes kept = self.parts_.tables.calibration();
    out.bytes(kept);
    return !kept.empty();
  }
  static Status set_calibration(PatchControl& c, Bytes value) { return c.set_calibration(value); }
  /// Decodes a value and passes it on.
  template <class Value, auto kSet>
  static Status write(PatchControl& control, Bytes bytes) {
    const auto value = Value::decode(bytes);
    return value ? kSet(control, *value) : value.error();
  }
  static Status set_node(PatchControl& c, const wire::NodeAddress& n) { return c.set_node_address(n.address); }
  static Status set_stream(PatchControl& c, const wire::StreamSetting& s) { return c.set_stream(s.mode); }
  static Status set_sampling(PatchControl& c, const wire::SamplingSetting& s) { return c.set_sampling(s); }

  static Status set_log(PatchControl& c, const wire::LogSetting& s) { return c.set_log(s.wanted); }

  static constexpr std::array kRows{
      Row{wire::did::kSerialNumber, read<&Identifiers::serial_number>},
      Row{wire::did::kPartNumber, part_number},
      Row{wire::did::kHardware, part_number},
      Row{wire::did::kFirmware, read<&Identifiers::firmware>},
      Row{wire::did::kHello, read<&Identifiers::hello>},
      Row{wire::did::kNodeAddress, read<&Identifiers::node_address>, write<wire::NodeAddress, set_node>},
      Row{wire::did::kActiveTable, read<&Identifiers::active_table>},
      Row{wire::did::kModuleStates, read<&Identifiers::module_states>},
      Row{wire::did::kStatistics, read<&Identifiers::statistics>},
      Row{wire::did::kStream, read<&Identifiers::stream>, write<wire::StreamSetting, set_stream>},
      Row{wire::did::kLineStates, read<&Identifiers::line_states>},
      Row{wire::did::kTopology, read<&Identifiers::topology>},
      Row{wire::did::kRoute, read<&Identifiers::route>},
      Row{wire::did::kImageState, read<&Identifiers::image_state>},
      Row{wire::did::kSampling, read<&Identifiers::sampling>, write<wire::SamplingSetting, set_sampling>},
      Row{wire::did::kOffsets, read<&Identifiers::offsets>},
      Row{wire::did::kStreamAccount, read<&Identifiers::stream_account>},
      Row{wire::did::kCalibration, calibration, set_calibration},
      Row{wire::did::kAdoption, read<&Identifiers::adoption>},
      Row{wire::did::kSettledRest, read<&Identifiers::settled_rest>},
      Row{wire::did::kLiveTaxels, read<&Identifiers::live_taxels>},
      Row{wire::did::kBoardHealth, read<&Identifiers::health>},
      Row{wire::did::kCrash, read<&Identifiers::crash>},
      Row{wire::did::kLog, read<&Identifiers::log>, write<wire::LogSetting, set_log>},
      Row{wire::did::kIcub, read<&Identifiers::icub>},
  };
  /// Checks that every identifier on the wire has its row, in order and writable as stated there, except those of the
  /// server and of freeze data.
  static constexpr bool as_on_the_wire() {
    std::size_t at = 0;
    for (const wire::Identifier& i : wire::kIdentifiers) {
      if (i.access == wire::Access::kFreeze || i.id == wire::did::kActiveSession) continue;
      if (at == kRows.size() || kRows[at].id != i.id) return false;
      if (kRows[at].writable != (i.access == wire::Access::kReadWrite)) return false;
      ++at;
    }
    return at == kRows.size();
  }

  static const Row* find(std::uint16_t did) {
    static_assert(as_on_the_wire());
    const auto* const row = std::ranges::find(kRows, did, &Row::id);
    return row == kRows.end() ? nullptr : row;
  }
};

bool Identifiers::read(std::uint16_t did, ByteWriter& out) const {
  const Row* const row = Table::find(did);
  return row != nullptr && row->read(*this, out);
}

Status Identifiers::write(std::uint16_t did, Bytes value) const {
  const Row* const row = Table::find(did);
  return row == nullptr ? Status::kOutOfRange : row->write(control_, value);
}

Status Identifiers::routine_result(std::uint16_t routine, ByteWriter& out) const {
  switch (routine) {
    case wire::routine::kDiscover:
      discovery().encode(out);
      return Status::kOk;
    case wire::routine::kSelfTest:
      self_test().encode(out);
      return Status::kOk;
    case wire::routine::kOffsets:
      wire::OffsetResult{std::ranges::all_of(parts_.lines, [](const LineSampler& l) { return l.checked(); })}.encode(
          out);
      return Status::kOk;
    case wire::routine::kReroute:
      wire::RerouteResult{!parts_.route.route().busy}.encode(out);
      return Status::kOk;
    default:
      return Status::kOutOfRange;
  }
}

wire::Hello Identifiers::hello() const {
  wire::Hello h;
  h.firmware_version = kFirmwareVersion;
  h.node_address = parts_.tables.node_address();
  h.unique_id = parts_.ports.unique_id;
  return h;
}

wire::ActiveTable Identifiers::active_table() const {
  const TableStore& t = parts_.tables;
  return {t.status(), t.sequence(), t.has_table() ? t.table().design_id : 0, crc32(t.active_bytes()), rows()};
}

wire::ModuleStates Identifiers::states() const {
  wire::ModuleStates s;
  for (std::size_t k = 0; k < rows(); ++k) s.add(shown(k).state);
  return s;
}

std::optional<wire::ModuleStates> Identifiers::module_states() const {
  if (!parts_.tables.has_table()) return std::nullopt;
  return states();
}

wire::Statistics Identifiers::statistics() const {
  wire::Statistics s{parts_.sequences, 0, 0, control_.dropped_samples()};
  for (const LineSampler& l : parts_.lines) {
    s.bus_errors += l.bus_errors();
    s.recoveries += l.recoveries();
  }
  return s;
}

wire::LineStates Identifiers::line_states() const {
  wire::LineStates s;
  for (std::size_t l = 0; l < s.lines.size(); ++l) s.lines[l] = {parts_.lines[l].stuck(), parts_.lines[l].recoveries()};
  return s;
}

wire::ActiveRoute Identifiers::route() const {
  wire::ActiveRoute r = parts_.route.route();
  r.rows = rows();
  return r;
}

std::optional<wire::ImageState> Identifiers::image_state() const {
  if (parts_.ports.restart == nullptr) return std::nullopt;
  return parts_.ports.restart->image_state();
}

std::optional<wire::BoardHealth> Identifiers::health() const {
  if (parts_.ports.monitor == nullptr) return std::nullopt;
  return parts_.ports.monitor->health();
}

std::optional<wire::Crash> Identifiers::crash() const {
  if (parts_.ports.monitor == nullptr) return std::nullopt;
  if (const auto last = parts_.ports.monitor->crash()) return last;
  return parts_.faults.crash().value_or(wire::Crash{});
}

wire::LogSetting Identifiers::log() const {
  return {control_.log_level(), kCompiledLogLevel};
}

wire::SamplingSetting Identifiers::sampling() const {
  return {parts_.sampling.decimation, parts_.sampling.every, parts_.output, parts_.sampling.timing};
}

const PlaceOffsets& Identifiers::offsets_of(std::size_t row) const {
  const layout::ModuleRow& r = parts_.tables.table().modules[row];
  return parts_.offsets[static_cast<std::size_t>(r.line * layout::kAddressesPerLine + r.address)];
}

wire::Offsets Identifiers::offsets() const {
  wire::Offsets o;
  o.count = rows();
  if (o.count > 0) o.positive_input = parts_.tables.table().positive_input;
  for (std::size_t k = 0; k < o.count; ++k) {
    const PlaceOffsets& p = offsets_of(k);
    o.searches += p.searches;
    o.modules[k] = {p.state, p.latching, p.outside, p.steps};
  }
  return o;
}

wire::SettledRest Identifiers::settled_rest() const {
  wire::SettledRest r;
  r.count = rows();
  for (std::size_t k = 0; k < r.count; ++k) r.modules[k] = offsets_of(k).rest;
  return r;
}

wire::LiveTaxels Identifiers::live_taxels() const {
  wire::LiveTaxels t;
  t.sequences = parts_.sequences;
  t.time_us = parts_.ports.clock->now_us();
  t.count = rows();
  for (std::size_t k = 0; k < t.count; ++k) t.modules[k] = {shown(k).valid, shown(k).raw};
  return t;
}

wire::Discovery Identifiers::discovery() const {
  wire::Discovery d;
  d.done = std::ranges::all_of(parts_.lines, [](const LineSampler& l) { return l.scan().done; });
  for (std::size_t l = 0; l < d.lines.size(); ++l) {
    const auto& scan = parts_.lines[l].scan();
    d.lines[l] = {scan.stuck, scan.answers, scan.wrong_id};
  }
  return d;
}

wire::SelfTestResult Identifiers::self_test() const {
  return {std::ranges::all_of(parts_.lines, [](const LineSampler& l) { return l.checked(); }), states()};
}

}  // namespace triskin::fw
