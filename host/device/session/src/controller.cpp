// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/controller.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace triskin::session {

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
  w.u8(0x00);  // The data are neither compressed nor encrypted.
  w.u8(0x44);  // Address and size have four bytes each.
  w.be32(address);
  w.be32(size);
  return r;
}

constexpr std::size_t kBlockBytes = wire::memory::kMaxBlockBytes - 2U;
constexpr std::size_t kRoutineHead = 3;  // A result follows the sub-function and the two bytes of the identifier.

// Returns what `ask` returns; empty if the controller does not know the identifier, as with older firmware, or has no
// value.
template <class Ask>
auto unless_unknown(Ask ask) -> std::optional<decltype(ask())> {
  try {
    return ask();
  } catch (const Refused& e) {
    if (e.code() != wire::nrc::kOutOfRange) throw;
    return std::nullopt;
  }
}

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
    case Status::kOlder:
      return "older than the firmware that runs";
    case Status::kUnproven:
      return "the firmware that runs has not confirmed itself yet";
  }
  return fmt::format("status {}", static_cast<int>(status));
}

std::string to_text(const wire::UniqueId& id) {
  std::string text;
  for (const std::uint8_t b : id) text += fmt::format("{:02X}", b);
  return text;
}

wire::UniqueId to_unique_id(const std::string& text) {
  wire::UniqueId id{};
  for (std::size_t k = 0; 2 * k + 1 < text.size() && k < id.size(); ++k)
    id[k] = static_cast<std::uint8_t>(std::stoul(text.substr(2 * k, 2), nullptr, 16));
  return id;
}

std::string serial_at(std::span<const wire::NodeClaim> claims, int node) {
  const auto claim = std::ranges::find(claims, node, &wire::NodeClaim::node_address);
  return claim == claims.end() ? "" : to_text(claim->unique_id);
}

void Controller::malformed(const char* what) const {
  throw DeviceError(fmt::format("{}: controller {}: the answer about its {} is malformed; update its firmware",
                                bus_.link().name(), node_, what));
}

Controller::Message Controller::read(std::uint16_t did) {
  Message m = bus_.request(node_, request_of({wire::service::kRead, high(did), low(did)}), Repeat::kSafe);
  if (m.size() < 2 || m[0] != high(did) || m[1] != low(did)) malformed("data");
  m.erase(m.begin(), m.begin() + 2);
  return m;
}

template <class Value>
void Controller::write(const Value& value) {
  unlock(wire::Session::kExtended);
  std::array<std::uint8_t, Value::kMaxBytes> bytes{};
  ByteWriter out(bytes);
  value.encode(out);
  const auto head = {wire::service::kWrite, high(Value::kId), low(Value::kId)};
  (void)bus_.request(node_, request_of(head, Bytes(bytes).first(out.size())), Repeat::kSafe);
}

template <class Value>
Value Controller::value(const char* what) {
  const auto decoded = Value::decode(read(Value::kId));
  if (!decoded) malformed(what);
  return *decoded;
}

wire::Hello Controller::hello() {
  return value<wire::Hello>("identity");
}

void Controller::require_versions(const wire::Hello& h) const {
  if (h.wire_version == wire::kWireVersion && h.layout_version == layout::kLayoutVersion) return;
  throw DeviceError(fmt::format(
      "{}: controller {} speaks wire version {} and table layout {}, this program {} and {}; update its firmware "
      "or use the matching release",
      bus_.link().name(), node_, h.wire_version, h.layout_version, wire::kWireVersion, layout::kLayoutVersion));
}

std::string Controller::part_number() {
  const Message m = read(wire::did::kPartNumber);
  return {m.begin(), m.end()};
}

wire::ActiveTable Controller::active_table() {
  return value<wire::ActiveTable>("table");
}

std::vector<std::uint8_t> Controller::read_table(std::size_t size_bytes) {
  (void)bus_.request(
      node_, transfer_head(wire::service::kUpload, wire::memory::kActiveTable, static_cast<std::uint32_t>(size_bytes)),
      Repeat::kSafe);
  std::vector<std::uint8_t> bytes;
  for (std::uint8_t block = 1; bytes.size() < size_bytes; ++block) {
    const Message m = bus_.request(node_, request_of({wire::service::kTransfer, block}), Repeat::kSafe);
    if (m.size() < 2 || m[0] != block) malformed("table");
    bytes.insert(bytes.end(), m.begin() + 1, m.end());
  }
  end_transfer();
  return bytes;
}

// If the answer is lost and the request repeated, the controller reports that there is no transfer. Other code checks
// what arrived.
void Controller::end_transfer() {
  try {
    (void)bus_.request(node_, request_of({wire::service::kTransferExit}), Repeat::kSafe);
  } catch (const Refused& e) {
    if (e.code() != wire::nrc::kSequenceError) throw;
  }
}

namespace {

std::array<std::uint8_t, 4> key_for(std::uint32_t seed) {
  std::array<std::uint8_t, 4> key{};
  ByteWriter(key).be32(wire::security_key(seed));
  return key;
}

}  // namespace

// If the answer to the key is lost, it is unknown whether the controller accepted it, so both steps are repeated
// together.
void Controller::unlock(wire::Session session) {
  (void)bus_.request(node_, request_of({wire::service::kSession, wire::wire_number(session)}), Repeat::kSafe);
  constexpr int kAttempts = 3;
  for (int attempt = 1;; ++attempt) {
    const Message m = bus_.request(node_, request_of({wire::service::kSecurity, 0x01}), Repeat::kSafe);
    if (m.size() != 5) malformed("security");
    const std::uint32_t seed = ByteReader(Bytes(m).subspan(1)).be32();
    if (seed == 0) return;  // A seed of 0 means that the controller is already unlocked.
    try {
      (void)bus_.request(node_, request_of({wire::service::kSecurity, 0x02}, key_for(seed)), Repeat::kNever);
      return;
    } catch (const NoAnswer&) {
      if (attempt == kAttempts) throw;
    }
  }
}

void Controller::write_table(Bytes image, const std::function<void(double)>& steps) {
  unlock(wire::Session::kProgramming);
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
  const Bus::Uninterrupted guard(bus_);  // After an interruption here, it would be unknown which table is active.
  end_transfer();
  const auto id = wire::routine::kActivate;
  const Message m = bus_.request(node_, request_of({wire::service::kRoutine, 0x01, high(id), low(id)}), Repeat::kNever);
  const auto result = wire::ActivationResult::decode(Bytes(m).subspan(std::min(m.size(), kRoutineHead)));
  if (!result) malformed("activation");
  if (result->status != Status::kOk) {
    throw DeviceError(fmt::format("{}: controller {} did not activate the table: {}; the old one stays active",
                                  bus_.link().name(), node_, describe(result->status)));
  }
}

void Controller::protect_loader(bool on) {
  unlock(wire::Session::kExtended);
  const auto id = wire::routine::kProtectLoader;
  const auto option = static_cast<std::uint8_t>(on ? 1 : 0);
  const Message m =
      bus_.request(node_, request_of({wire::service::kRoutine, 0x01, high(id), low(id), option}), Repeat::kSafe);
  const auto result = wire::ProtectionResult::decode(Bytes(m).subspan(std::min(m.size(), kRoutineHead)));
  if (!result) malformed("protection");
  if (result->status == Status::kOk) return;
  throw DeviceError(
      fmt::format("{}: controller {} did not {} its loader: {}; it needs two seconds after its start, two banks "
                  "(DBANK) and no read "
                  "protection (triskin discover shows its findings)",
                  bus_.link().name(), node_, on ? "protect" : "release", describe(result->status)));
}

wire::ModuleStates Controller::module_states() {
  return value<wire::ModuleStates>("modules");
}

template <class Value>
Value Controller::run_routine(std::uint64_t poll_every_us, int polls, const char* what) {
  const std::uint16_t id = Value::kId;
  (void)bus_.request(node_, request_of({wire::service::kRoutine, 0x01, high(id), low(id)}), Repeat::kSafe);
  for (int poll = 0; poll < polls; ++poll) {
    bus_.listen(bus_.now_us() + poll_every_us);
    const Message m =
        bus_.request(node_, request_of({wire::service::kRoutine, 0x03, high(id), low(id)}), Repeat::kSafe);
    const auto result = Value::decode(Bytes(m).subspan(std::min(m.size(), kRoutineHead)));
    if (!result) malformed(what);
    if (result->done) return *result;
  }
  throw DeviceError(fmt::format("{}: controller {} does not finish its look at the {}; power-cycle it",
                                bus_.link().name(), node_, what));
}

std::array<wire::LineReport, layout::kLines> Controller::discover() {
  return run_routine<wire::Discovery>(25'000, 40, "lines").lines;
}

void Controller::reroute() {
  (void)run_routine<wire::RerouteResult>(20'000, 100, "chain");
}

wire::Offsets Controller::offsets() {
  return value<wire::Offsets>("offsets");
}

wire::SettledRest Controller::settled_rest() {
  return value<wire::SettledRest>("rest values");
}

wire::Offsets Controller::search_offsets() {
  (void)run_routine<wire::OffsetResult>(50'000, 100, "offsets");
  return offsets();
}

wire::FoundTopology Controller::topology() {
  return value<wire::FoundTopology>("topology");
}

wire::ActiveRoute Controller::route() {
  return value<wire::ActiveRoute>("route");
}

wire::Adoption Controller::adoption() {
  return unless_unknown([&] { return value<wire::Adoption>("adoption"); }).value_or(wire::Adoption{});
}

std::optional<wire::ImageState> Controller::image_state() {
  return unless_unknown([&] { return value<wire::ImageState>("firmware"); });
}

std::optional<wire::BoardHealth> Controller::health() {
  return unless_unknown([&] { return value<wire::BoardHealth>("health"); });
}

std::optional<wire::Crash> Controller::crash() {
  const auto last = unless_unknown([&] { return value<wire::Crash>("crash"); });
  return last && last->cause != wire::CrashCause::kNone ? last : std::nullopt;
}

void Controller::reset() {
  (void)bus_.request(node_, request_of({wire::service::kReset, 0x01}), Repeat::kNever);
}

wire::LineStates Controller::line_states() {
  return value<wire::LineStates>("lines");
}

wire::Statistics Controller::statistics() {
  return value<wire::Statistics>("statistics");
}

wire::FaultList Controller::faults() {
  const Message m = bus_.request(node_, request_of({wire::service::kReadFaults, 0x02, wire::fault_status::kAvailable}),
                                 Repeat::kSafe);
  const auto list = wire::FaultList::decode(Bytes(m).subspan(std::min<std::size_t>(m.size(), 1)));
  if (!list) malformed("faults");
  return *list;
}

void Controller::clear_faults() {
  (void)bus_.request(node_, request_of({wire::service::kClearFaults, 0xFF, 0xFF, 0xFF}), Repeat::kSafe);
}

wire::LiveTaxels Controller::taxels() {
  return value<wire::LiveTaxels>("taxels");
}

wire::SamplingSetting Controller::sampling() {
  return value<wire::SamplingSetting>("sampling");
}

wire::StreamAccount Controller::stream_account() {
  const auto account = unless_unknown([&] { return value<wire::StreamAccount>("stream"); });
  if (account) return *account;
  throw DeviceError(
      fmt::format("{}: controller {} cannot say how many samples it lost; update its firmware (triskin flash "
                  "--firmware)",
                  bus_.link().name(), node_));
}

std::optional<wire::Calibration> Controller::calibration() {
  return unless_unknown([&] { return value<wire::Calibration>("calibration"); });
}

bool Controller::set_calibration(const wire::Calibration& calibration) {
  unlock(wire::Session::kExtended);
  std::array<std::uint8_t, wire::Calibration::kMaxBytes> value{};
  ByteWriter out(value);
  calibration.encode(out);
  constexpr std::uint16_t kId = wire::Calibration::kId;
  try {
    (void)bus_.request(node_, request_of({wire::service::kWrite, high(kId), low(kId)}, out.written()), Repeat::kSafe);
  } catch (const Refused& e) {
    if (e.code() != wire::nrc::kOutOfRange && e.code() != wire::nrc::kConditionsNotCorrect) throw;
    return false;
  }
  return true;
}

void Controller::set_sampling(const wire::SamplingSetting& setting) {
  write(setting);
}

void Controller::set_log(wire::LogLevel level) {
  write(wire::LogSetting{level, wire::LogLevel::kOff});
}

wire::LogSetting Controller::log() {
  return value<wire::LogSetting>("log");
}

void Controller::set_stream(wire::StreamMode mode) {
  write(wire::StreamSetting{mode});
}

}  // namespace triskin::session
