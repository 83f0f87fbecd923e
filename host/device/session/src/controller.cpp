// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/controller.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace triskin::device {

using Repeat = Bus::Repeat;

namespace {

std::vector<std::uint8_t> request_of(std::initializer_list<std::uint8_t> head, Bytes rest = {}) {
  std::vector<std::uint8_t> r(head);
  r.insert(r.end(), rest.begin(), rest.end());
  return r;
}

constexpr std::uint8_t high(std::uint32_t v) {
  return static_cast<std::uint8_t>(v >> 8);
}
constexpr std::uint8_t low(std::uint32_t v) {
  return static_cast<std::uint8_t>(v);
}

std::vector<std::uint8_t> transfer_head(std::uint8_t service, std::uint32_t address, std::uint32_t size) {
  std::vector<std::uint8_t> r(11);
  ByteWriter w(r);
  w.u8(service);
  w.u8(0x00);  // neither compressed nor encrypted
  w.u8(0x44);  // four bytes of address, four of size
  w.be32(address);
  w.be32(size);
  return r;
}

constexpr std::size_t kBlockBytes = wire::memory::kMaxBlockBytes - 2U;

}  // namespace

std::string describe(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kTooShort:
      return "too short";
    case Status::kBadMagic:
      return "not a table";
    case Status::kBadVersion:
      return "another layout version";
    case Status::kBadLength:
      return "wrong length";
    case Status::kBadCrc:
      return "wrong CRC";
    case Status::kOutOfRange:
      return "a field is out of range";
    case Status::kDuplicate:
      return "a place stands twice";
    case Status::kBadTree:
      return "the route is no tree";
    case Status::kWrongTarget:
      return "a table for another controller";
    case Status::kFlashFailed:
      return "the flash memory failed";
    case Status::kEmpty:
      return "nothing stored";
    case Status::kNoSpace:
      return "no space";
    case Status::kBusError:
      return "no acknowledgement on the line";
    case Status::kLineStuck:
      return "the line is held low";
    case Status::kWrongId:
      return "wrong device id";
  }
  return fmt::format("status {}", static_cast<int>(status));
}

std::string to_text(const wire::UniqueId& id) {
  std::string text;
  for (const std::uint8_t b : id) text += fmt::format("{:02X}", b);
  return text;
}

void Controller::nonsense(const char* what) const {
  throw DeviceError(fmt::format("{}: controller {}: the answer about its {} makes no sense; update its firmware",
                                bus_.link().name(), node_, what));
}

Controller::Message Controller::read(std::uint16_t did) {
  Message m = bus_.request(node_, request_of({wire::service::kRead, high(did), low(did)}), Repeat::kSafe);
  if (m.size() < 2 || m[0] != high(did) || m[1] != low(did)) nonsense("data");
  m.erase(m.begin(), m.begin() + 2);
  return m;
}

Hello Controller::hello() {
  const Message m = read(wire::did::kHello);
  ByteReader r(m);
  Hello h;
  h.wire_version = r.le16();
  h.layout_version = r.le16();
  h.firmware_version = r.le32();
  h.node_address = r.u8();
  for (std::uint8_t& b : h.unique_id) b = r.u8();
  if (!r.ok()) nonsense("identity");
  return h;
}

void Controller::require_versions(const Hello& h) const {
  if (h.wire_version == wire::kWireVersion && h.layout_version == layout::kLayoutVersion) return;
  throw DeviceError(fmt::format(
      "{}: controller {} speaks wire version {} and table layout {}, this program {} and {}; update its firmware "
      "or use the matching release",
      bus_.link().name(), node_, h.wire_version, h.layout_version, wire::kWireVersion, layout::kLayoutVersion));
}

ActiveTable Controller::active_table() {
  const Message m = read(wire::did::kActiveTable);
  ByteReader r(m);
  ActiveTable t;
  t.present = static_cast<Status>(r.u8()) == Status::kOk;
  t.sequence = r.le32();
  t.design_id = r.le64();
  t.crc = r.le32();
  t.modules = r.u8();
  if (!r.ok() || t.modules > layout::kMaxModules) nonsense("table");
  return t;
}

std::vector<std::uint8_t> Controller::read_table(std::size_t size_bytes) {
  (void)bus_.request(
      node_, transfer_head(wire::service::kUpload, wire::memory::kActiveTable, static_cast<std::uint32_t>(size_bytes)),
      Repeat::kSafe);
  std::vector<std::uint8_t> bytes;
  for (std::uint8_t block = 1; bytes.size() < size_bytes; ++block) {
    const Message m = bus_.request(node_, request_of({wire::service::kTransfer, block}), Repeat::kSafe);
    if (m.size() < 2 || m[0] != block) nonsense("table");
    bytes.insert(bytes.end(), m.begin() + 1, m.end());
  }
  (void)bus_.request(node_, request_of({wire::service::kTransferExit}), Repeat::kNever);
  return bytes;
}

// A lost answer to the key leaves open whether it was taken, so both steps are done again together.
void Controller::unlock(std::uint8_t session) {
  (void)bus_.request(node_, request_of({wire::service::kSession, session}), Repeat::kSafe);
  constexpr int kAttempts = 3;
  for (int attempt = 1;; ++attempt) {
    const Message m = bus_.request(node_, request_of({wire::service::kSecurity, 0x01}), Repeat::kSafe);
    if (m.size() != 5) nonsense("security");
    const std::uint32_t seed = ByteReader(Bytes(m).subspan(1)).be32();
    if (seed == 0) return;  // unlocked already
    std::array<std::uint8_t, 4> key{};
    ByteWriter(key).be32(wire::security_key(seed));
    try {
      (void)bus_.request(node_, request_of({wire::service::kSecurity, 0x02}, key), Repeat::kNever);
      return;
    } catch (const NoAnswer&) {
      if (attempt == kAttempts) throw;
    }
  }
}

void Controller::write_table(Bytes image, const std::function<void(double)>& steps) {
  unlock(wire::session::kProgramming);
  (void)bus_.request(
      node_,
      transfer_head(wire::service::kDownload, wire::memory::kInactiveTable, static_cast<std::uint32_t>(image.size())),
      Repeat::kSafe);
  std::uint8_t block = 1;
  for (std::size_t at = 0; at < image.size(); at += kBlockBytes, ++block) {
    const Bytes part = image.subspan(at, std::min(kBlockBytes, image.size() - at));
    (void)bus_.request(node_, request_of({wire::service::kTransfer, block}, part), Repeat::kSafe);
    if (steps) steps(static_cast<double>(at + part.size()) / static_cast<double>(image.size()));
  }
  const Bus::Uninterrupted guard(bus_);  // so that it is known which table is active
  (void)bus_.request(node_, request_of({wire::service::kTransferExit}), Repeat::kNever);
  const auto id = wire::routine::kActivate;
  const Message m = bus_.request(node_, request_of({wire::service::kRoutine, 0x01, high(id), low(id)}), Repeat::kNever);
  if (m.size() < 4) nonsense("activation");
  if (const auto status = static_cast<Status>(m.back()); status != Status::kOk) {
    throw DeviceError(fmt::format("{}: controller {} did not activate the table: {}; the old one stays active",
                                  bus_.link().name(), node_, describe(status)));
  }
}

std::vector<wire::ModuleState> Controller::module_states() {
  std::vector<wire::ModuleState> states;
  for (const std::uint8_t b : read(wire::did::kModuleStates)) states.push_back(static_cast<wire::ModuleState>(b));
  return states;
}

Controller::Message Controller::run_routine(std::uint16_t id, std::size_t bytes, std::uint64_t poll_every_us, int polls,
                                            const char* what) {
  (void)bus_.request(node_, request_of({wire::service::kRoutine, 0x01, high(id), low(id)}), Repeat::kSafe);
  for (int poll = 0; poll < polls; ++poll) {
    bus_.listen(bus_.now_us() + poll_every_us);
    Message m = bus_.request(node_, request_of({wire::service::kRoutine, 0x03, high(id), low(id)}), Repeat::kSafe);
    if (m.size() != 4 + bytes) nonsense(what);
    if (m[3] != 0) return m;
  }
  throw DeviceError(fmt::format("{}: controller {} does not finish its look at the {}; power-cycle it",
                                bus_.link().name(), node_, what));
}

std::array<LineReport, layout::kLines> Controller::discover() {
  const Message m = run_routine(wire::routine::kDiscover, std::size_t{3} * layout::kLines, 25'000, 40, "lines");
  std::array<LineReport, layout::kLines> lines;
  ByteReader r(Bytes(m).subspan(4));
  for (LineReport& l : lines) {
    l.stuck = r.u8() != 0;
    l.answers = r.u8();
    l.wrong_id = r.u8();
  }
  return lines;
}

void Controller::reroute() {
  (void)run_routine(wire::routine::kReroute, 0, 20'000, 100, "chain");
}

wire::FoundTopology Controller::topology() {
  wire::FoundTopology t;
  if (!wire::decode(read(wire::did::kTopology), t)) nonsense("topology");
  return t;
}

wire::ActiveRoute Controller::route() {
  wire::ActiveRoute a;
  if (!wire::decode(read(wire::did::kRoute), a)) nonsense("route");
  return a;
}
std::optional<ImageState> Controller::image_state() {
  try {
    const Message m = read(wire::did::kImageState);
    ByteReader r(m);
    ImageState s;
    s.slot = r.u8();
    s.confirmed = r.u8() != 0;
    s.sequence = r.le32();
    s.size_bytes = r.le32();
    s.record_crc = r.le32();
    if (!r.ok()) nonsense("firmware");
    return s;
  } catch (const Refused& e) {
    if (e.code() != wire::nrc::kOutOfRange) throw;
    return std::nullopt;
  }
}

void Controller::reset() {
  (void)bus_.request(node_, request_of({wire::service::kReset, 0x01}), Repeat::kNever);
}

std::array<std::uint32_t, layout::kLines> Controller::recoveries() {
  const Message m = read(wire::did::kLineStates);
  ByteReader r(m);
  std::array<std::uint32_t, layout::kLines> counts{};
  for (std::uint32_t& c : counts) {
    (void)r.u8();
    c = r.le32();
  }
  if (!r.ok()) nonsense("lines");
  return counts;
}

std::vector<RememberedFault> Controller::remembered_faults() {
  constexpr std::uint8_t kPresent = 0x01, kConfirmed = 0x08, kModuleGroup = 0x90;
  const Message m =
      bus_.request(node_, request_of({wire::service::kReadFaults, 0x02, kConfirmed | kPresent}), Repeat::kSafe);
  if (m.size() < 2 || (m.size() - 2) % 4 != 0) nonsense("faults");
  std::vector<RememberedFault> faults;
  for (std::size_t at = 2; at < m.size(); at += 4) {
    if ((m[at] & 0xF0) != kModuleGroup || m[at + 2] >= layout::kMaxModules) continue;
    faults.push_back({static_cast<wire::ModuleState>(m[at] & 0x0F), m[at + 2], (m[at + 3] & kPresent) != 0});
  }
  return faults;
}

void Controller::clear_faults() {
  (void)bus_.request(node_, request_of({wire::service::kClearFaults, 0xFF, 0xFF, 0xFF}), Repeat::kSafe);
}

TaxelSample Controller::taxels() {
  const Message m = read(wire::did::kLiveTaxels);
  constexpr std::size_t kHead = 12, kModule = 2 + 2 * layout::kTaxelsPerModule;
  if (m.size() < kHead || (m.size() - kHead) % kModule != 0) nonsense("taxels");
  ByteReader r(m);
  TaxelSample s;
  s.sample = r.le32();
  s.device_time_us = r.le64();
  s.modules.resize((m.size() - kHead) / kModule);
  for (auto& module : s.modules) {
    module.valid = r.le16();
    for (std::uint16_t& v : module.raw) v = r.le16();
  }
  return s;
}

void Controller::set_stream(wire::StreamMode mode) {
  unlock(wire::session::kExtended);
  const auto id = wire::did::kStream;
  (void)bus_.request(node_, request_of({wire::service::kWrite, high(id), low(id), static_cast<std::uint8_t>(mode)}),
                     Repeat::kSafe);
}

}  // namespace triskin::device
