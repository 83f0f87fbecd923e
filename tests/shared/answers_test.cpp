// SPDX-License-Identifier: GPL-3.0-or-later
// Compares every answer of the controller with bytes worked by hand in tests/vectors/answers.txt.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>

#include "triskin/wire/adoption.hpp"
#include "triskin/wire/calibration.hpp"
#include "triskin/wire/faults.hpp"
#include "triskin/wire/health.hpp"
#include "triskin/wire/icub_commands.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/lines.hpp"
#include "triskin/wire/live_taxels.hpp"
#include "triskin/wire/log.hpp"
#include "triskin/wire/module_state.hpp"
#include "triskin/wire/offsets.hpp"
#include "triskin/wire/sampling.hpp"
#include "triskin/wire/settled_rest.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/topology.hpp"
#include "vectors/vector_file.hpp"

namespace triskin::wire {
namespace {

using test::Vector;

template <class Number>
Number number(const Vector& v, const std::string& key) {
  const std::uint64_t n = v.number(key);
  EXPECT_LE(n, std::numeric_limits<Number>::max()) << key;
  return static_cast<Number>(n);
}
std::uint8_t byte(const Vector& v, const std::string& key) {
  return number<std::uint8_t>(v, key);
}
std::uint32_t word(const Vector& v, const std::string& key) {
  return number<std::uint32_t>(v, key);
}
UniqueId unique_id(const Vector& v) {
  UniqueId id{};
  const auto bytes = test::hex_bytes(v.one("unique_id"));
  EXPECT_EQ(bytes.size(), id.size());
  std::ranges::copy(bytes, id.begin());
  return id;
}
ModuleStates states(const Vector& v) {
  ModuleStates s;
  for (const std::uint64_t n : test::numbers(v.one("states"), 10)) s.add(static_cast<ModuleState>(n));
  return s;
}
// Each entry reads state.row.status.
FaultList fault_list(const Vector& v) {
  FaultList list;
  std::istringstream in(v.one("faults"));
  int state = 0, row = 0, status = 0;
  char dot = 0;
  while (in >> state >> dot >> row >> dot >> status) {
    list.add({{static_cast<ModuleState>(state), static_cast<std::uint8_t>(row)}, static_cast<std::uint8_t>(status)});
  }
  return list;
}

Hello hello(const Vector& v) {
  return {number<std::uint16_t>(v, "wire_version"),
          number<std::uint16_t>(v, "layout_version"),
          word(v, "firmware_version"),
          byte(v, "node"),
          unique_id(v),
          byte(v, "max_modules"),
          byte(v, "taxels")};
}
LineStates line_states(const Vector& v) {
  LineStates s;
  const auto stuck = test::numbers(v.one("stuck"), 10), recoveries = test::numbers(v.one("recoveries"), 10);
  for (std::size_t l = 0; l < s.lines.size(); ++l)
    s.lines[l] = {stuck.at(l) != 0, static_cast<std::uint32_t>(recoveries.at(l))};
  return s;
}
Discovery discovery(const Vector& v) {
  Discovery d{v.number("done") != 0, {}};
  const auto stuck = test::numbers(v.one("stuck"), 10), answers = test::numbers(v.one("answers"), 10),
             wrong = test::numbers(v.one("wrong_id"), 10);
  for (std::size_t l = 0; l < d.lines.size(); ++l) {
    d.lines[l] = {stuck.at(l) != 0, static_cast<std::uint8_t>(answers.at(l)), static_cast<std::uint8_t>(wrong.at(l))};
  }
  return d;
}
LiveTaxels live_taxels(const Vector& v) {
  LiveTaxels t;
  t.sequences = word(v, "sequences");
  t.time_us = v.number("time_us");
  if (!v.has("values")) return t;
  t.count = 1;
  t.modules[0].valid = number<std::uint16_t>(v, "valid");
  const auto values = test::numbers(v.one("values"), 10);
  for (std::size_t k = 0; k < values.size(); ++k) t.modules[0].value.at(k) = static_cast<std::uint16_t>(values[k]);
  return t;
}
BoardHealth health(const Vector& v) {
  BoardHealth h;
  h.clock = {static_cast<Crystal>(byte(v, "crystal")), byte(v, "crystal_mhz"),
             number<std::uint16_t>(v, "measured_khz")};
  h.reset_cause = byte(v, "reset_cause");
  h.findings = number<std::uint16_t>(v, "findings");
  h.crashes_in_row = byte(v, "crashes_in_row");
  const auto can = test::numbers(v.one("can"), 10);
  std::uint8_t* const bytes[] = {&h.can_send_errors, &h.can_receive_errors, &h.can_state, &h.can_last_error};
  for (std::size_t k = 0; k < std::size(bytes); ++k) *bytes[k] = static_cast<std::uint8_t>(can.at(k));
  h.bus_offs = word(v, "bus_offs");
  h.can_lost = word(v, "can_lost");
  h.can_ram_failures = number<std::uint16_t>(v, "can_ram_failures");
  const auto counts = test::numbers(v.one("words"), 10);
  std::uint32_t* const words[] = {&h.ecc_corrected, &h.ecc_detected, &h.flash_errors, &h.worst_loop_us,
                                  &h.worst_interrupt_us};
  for (std::size_t k = 0; k < std::size(words); ++k) *words[k] = static_cast<std::uint32_t>(counts.at(k));
  const auto shares = test::numbers(v.one("halves"), 10);
  std::uint16_t* const halves[] = {&h.stack_bytes, &h.stack_free_bytes, &h.idle_permille};
  for (std::size_t k = 0; k < std::size(halves); ++k) *halves[k] = static_cast<std::uint16_t>(shares.at(k));
  return h;
}
LogSetting log_setting(const Vector& v) {
  return {static_cast<LogLevel>(byte(v, "wanted")), static_cast<LogLevel>(byte(v, "compiled"))};
}
Crash crash(const Vector& v) {
  Crash c;
  c.cause = static_cast<CrashCause>(byte(v, "cause"));
  c.while_erasing = v.number("erasing") != 0;
  c.exception = number<std::uint16_t>(v, "exception");
  const auto values = test::numbers(v.one("words"), 10);
  std::uint32_t* const words[] = {
      &c.pc,     &c.lr,    &c.sp, &c.fault_status, &c.hard_fault_status, &c.address, &c.uptime_ms, &c.firmware_version,
      &c.origin, &c.number};
  for (std::size_t k = 0; k < std::size(words); ++k) *words[k] = static_cast<std::uint32_t>(values.at(k));
  return c;
}
Offsets offsets(const Vector& v) {
  Offsets o{v.number("positive") != 0, word(v, "searches"), 0, {}};
  if (!v.has("steps")) return o;
  o.count = 1;
  ModuleOffsets& m = o.modules[0];
  m.state = static_cast<OffsetState>(v.number("state"));
  m.latching = static_cast<Latching>(v.number("latching"));
  m.outside = number<std::uint16_t>(v, "outside");
  const auto steps = test::numbers(v.one("steps"), 10);
  for (std::size_t t = 0; t < m.steps.size(); ++t) m.steps[t] = static_cast<std::uint8_t>(steps.at(t));
  return o;
}
SettledRest settled_rest(const Vector& v) {
  SettledRest rest;
  if (!v.has("counts")) return rest;
  rest.count = 2;
  const auto counts = test::numbers(v.one("counts"), 10);
  for (std::size_t t = 0; t < counts.size(); ++t) rest.modules[0].at(t) = static_cast<std::uint16_t>(counts[t]);
  return rest;
}
Calibration calibration(const Vector& v) {
  const auto head = test::numbers(v.one("head"), 10);
  const auto at = [&](std::size_t k) { return static_cast<std::uint32_t>(head.at(k)); };
  Calibration c{static_cast<std::uint8_t>(at(0)),
                static_cast<std::uint16_t>(at(1)),
                v.number("design_id"),
                static_cast<std::uint16_t>(at(2)),
                at(3),
                static_cast<CalibrationMethod>(at(4)),
                at(5),
                at(6)};
  if (!v.has("place")) return c;
  c.count = 1;
  PlaceSensitivity& p = c.places[0];
  p.place = byte(v, "place");
  const auto sensitivity = test::numbers(v.one("sensitivity"), 10), quality = test::numbers(v.one("quality"), 10);
  for (std::size_t t = 0; t < p.sensitivity.size(); ++t)
    p.sensitivity[t] = static_cast<std::uint16_t>(sensitivity.at(t));
  p.error = static_cast<std::uint16_t>(quality.at(0));
  p.residual_pa = static_cast<std::uint16_t>(quality.at(1));
  return c;
}
icub::State icub_state(const Vector& v) {
  const auto f = test::numbers(v.one("fields"), 10);
  const auto at = [&](std::size_t k) { return static_cast<std::uint8_t>(f.at(k)); };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), static_cast<std::uint16_t>(f.at(7))};
}
Statistics statistics(const Vector& v) {
  const auto n = test::numbers(v.one("counts"), 10);
  const auto at = [&](std::size_t k) { return static_cast<std::uint32_t>(n.at(k)); };
  return {at(0), at(1), at(2), at(3)};
}

const std::map<std::string, Status> kStatuses{{"too_short", Status::kTooShort},
                                              {"bad_length", Status::kBadLength},
                                              {"bad_version", Status::kBadVersion},
                                              {"out_of_range", Status::kOutOfRange},
                                              {"duplicate", Status::kDuplicate}};

// The bytes must be refused as the vector says, or decode to its fields, which encode to its bytes.
template <class Value>
void check(const Vector& v, const std::function<Value(const Vector&)>& fields) {
  const auto bytes = test::hex_bytes(v.one("hex"));
  const Result<Value> got = Value::decode(bytes);
  if (v.has("status")) {
    ASSERT_FALSE(got) << "was taken";
    EXPECT_EQ(got.error(), kStatuses.at(v.one("status")));
    return;
  }
  ASSERT_TRUE(got) << "refused with status " << static_cast<int>(got.error());
  const Value expected = fields(v);
  EXPECT_EQ(*got, expected);
  if (v.has("decode_only")) return;
  std::array<std::uint8_t, 512> buffer{};
  ByteWriter w(buffer);
  expected.encode(w);
  EXPECT_TRUE(w.ok());
  EXPECT_EQ(std::vector(w.written().begin(), w.written().end()), bytes);
}

using Check = void (*)(const Vector&);
template <class Value, Value (*kFields)(const Vector&)>
void checked(const Vector& v) {
  check<Value>(v, kFields);
}

ActiveTable active_table(const Vector& v) {
  return {static_cast<Status>(v.number("table_status")), word(v, "sequence"), v.number("design_id"), word(v, "crc"),
          byte(v, "modules")};
}
ImageState image_state(const Vector& v) {
  return {byte(v, "slot"), v.number("confirmed") != 0, word(v, "sequence"), word(v, "size"), word(v, "crc")};
}
SamplingTiming timing_of(const Vector& v) {
  return v.has("timing") ? static_cast<SamplingTiming>(byte(v, "timing")) : SamplingTiming::kTracked;
}
SamplingSetting sampling(const Vector& v) {
  return {static_cast<Decimation>(v.number("decimation")), byte(v, "every"),
          static_cast<TaxelOutput>(v.number("output")), timing_of(v)};
}
FreezeFrame freeze(const Vector& v) {
  return {fault_list(v).records[0], {word(v, "time_ms"), word(v, "sample")}};
}
ActiveSession session(const Vector& v) {
  return {static_cast<Session>(v.number("session"))};
}
SerialNumber serial_number(const Vector& v) {
  return {unique_id(v)};
}
FirmwareVersion firmware(const Vector& v) {
  return {word(v, "version")};
}
NodeAddress node_address(const Vector& v) {
  return {byte(v, "node")};
}
SelfTestResult self_test(const Vector& v) {
  return {v.number("done") != 0, states(v)};
}
StreamSetting stream(const Vector& v) {
  return {static_cast<StreamMode>(v.number("mode"))};
}
// Each row reads number.unread.dropped.sent.waiting.
StreamAccount stream_account(const Vector& v) {
  StreamAccount a{byte(v, "starts"), v.number("time_us")};
  for (const std::uint64_t n : test::numbers(v.one("readers"), 10))
    a.reader.at(a.readers++) = static_cast<std::uint32_t>(n);
  std::istringstream in(v.one("rows"));
  std::uint32_t waiting = 0;
  char dot = 0;
  for (RowAccount r; in >> r.number >> dot >> r.unread >> dot >> r.dropped >> dot >> r.sent >> dot >> waiting;) {
    r.waiting = static_cast<std::uint8_t>(waiting);
    a.modules.at(a.count++) = r;
  }
  return a;
}
// Each adopted module reads parent.port.own port.line.address.
Adoption adoption(const Vector& v) {
  Adoption a{byte(v, "rows"), number<std::uint16_t>(v, "out_of_reach"), byte(v, "list")};
  std::istringstream in(v.one("guests"));
  std::array<int, 5> f{};
  char dot = 0;
  const auto at = [&](std::size_t k) { return static_cast<std::uint8_t>(f[k]); };
  while (in >> f[0] >> dot >> f[1] >> dot >> f[2] >> dot >> f[3] >> dot >> f[4])
    a.adopted_modules.at(a.count++) = {at(0), at(1), at(2), static_cast<std::uint8_t>(4 * f[3] + f[4])};
  return a;
}
RerouteResult reroute(const Vector& v) {
  return {v.number("done") != 0};
}
OffsetResult offset_result(const Vector& v) {
  return {v.number("done") != 0};
}
ProtectionResult protection(const Vector& v) {
  return {static_cast<Status>(byte(v, "result"))};
}
ActivationResult activation(const Vector& v) {
  return {static_cast<Status>(v.number("table_status"))};
}

const std::map<std::string, Check> kChecks{{"session", checked<ActiveSession, session>},
                                           {"adoption", checked<Adoption, adoption>},
                                           {"serial_number", checked<SerialNumber, serial_number>},
                                           {"firmware", checked<FirmwareVersion, firmware>},
                                           {"hello", checked<Hello, hello>},
                                           {"node_address", checked<NodeAddress, node_address>},
                                           {"active_table", checked<ActiveTable, active_table>},
                                           {"module_states", checked<ModuleStates, states>},
                                           {"self_test", checked<SelfTestResult, self_test>},
                                           {"statistics", checked<Statistics, statistics>},
                                           {"icub", checked<icub::State, icub_state>},
                                           {"stream", checked<StreamSetting, stream>},
                                           {"stream_account", checked<StreamAccount, stream_account>},
                                           {"line_states", checked<LineStates, line_states>},
                                           {"discovery", checked<Discovery, discovery>},
                                           {"sampling", checked<SamplingSetting, sampling>},
                                           {"image_state", checked<ImageState, image_state>},
                                           {"live_taxels", checked<LiveTaxels, live_taxels>},
                                           {"health", checked<BoardHealth, health>},
                                           {"crash", checked<Crash, crash>},
                                           {"log", checked<LogSetting, log_setting>},
                                           {"offsets", checked<Offsets, offsets>},
                                           {"settled_rest", checked<SettledRest, settled_rest>},
                                           {"calibration", checked<Calibration, calibration>},
                                           {"offset_result", checked<OffsetResult, offset_result>},
                                           {"reroute", checked<RerouteResult, reroute>},
                                           {"protection", checked<ProtectionResult, protection>},
                                           {"activation", checked<ActivationResult, activation>},
                                           {"faults", checked<FaultList, fault_list>},
                                           {"freeze", checked<FreezeFrame, freeze>}};

TEST(AnswerVectors, encode_and_decode_as_the_file_says) {
  std::map<std::string, int> taken, refused;
  for (const Vector& v : test::read_vectors("answers.txt")) {
    SCOPED_TRACE(v.name);
    const std::string kind = v.one("kind");
    ASSERT_TRUE(kChecks.contains(kind)) << kind;
    kChecks.at(kind)(v);
    ++(v.has("status") ? refused : taken)[kind];
  }
  for (const auto& [kind, check] : kChecks) {
    EXPECT_GE(taken[kind], 1) << kind;
    EXPECT_GE(refused[kind], 1) << kind;
  }
}

// The compiler also evaluates small cases.
template <class Value>
consteval bool encodes_to(const Value& value, std::initializer_list<std::uint8_t> bytes) {
  std::array<std::uint8_t, 64> buffer{};
  ByteWriter w(buffer);
  value.encode(w);
  return std::ranges::equal(w.written(), bytes) && Value::decode(w.written()) == value;
}
static_assert(encodes_to(StreamSetting{StreamMode::kIcub}, {0x01}));
static_assert(encodes_to(SamplingSetting{}, {0x00, 0x01, 0x00}));
static_assert(encodes_to(NodeAddress{}, {0x01}));
static_assert(encodes_to(ActiveSession{}, {0x01}));
static_assert(encodes_to(FirmwareVersion{0x00010203}, {0x00, 0x01, 0x02, 0x03}));
static_assert(encodes_to(ActivationResult{Status::kWrongTarget}, {0x09}));
static_assert(encodes_to(ProtectionResult{Status::kOk}, {0x00}));
static_assert(encodes_to(RerouteResult{true}, {0x01}));
static_assert(encodes_to(SelfTestResult{true, {1, {ModuleState::kFrozen}}}, {0x01, 0x06}));
static_assert(FaultCode{ModuleState::kFrozen, 15}.dtc() == 0x96000F);
static_assert(FaultCode::of(0x96000F) == FaultCode{ModuleState::kFrozen, 15});

// The longest value of each identifier and an identifier fit one response (service, identifier, value).
static_assert(std::ranges::all_of(kIdentifiers, [](const Identifier& i) { return i.max_bytes + 3 <= 512; }));

TEST(Enumerations, take_exactly_the_numbers_that_exist) {
  int states = 0, streams = 0, decimations = 0, outputs = 0, statuses = 0, sessions = 0, offset_states = 0,
      latchings = 0, methods = 0;
  for (unsigned n = 0; n < 256; ++n) {
    const auto b = static_cast<std::uint8_t>(n);
    states += to_module_state(b) ? 1 : 0;
    streams += to_stream_mode(b) ? 1 : 0;
    decimations += to_decimation(b) ? 1 : 0;
    outputs += to_taxel_output(b) ? 1 : 0;
    statuses += to_status(b) ? 1 : 0;
    sessions += to_session(b) ? 1 : 0;
    offset_states += to_offset_state(b) ? 1 : 0;
    latchings += to_latching(b) ? 1 : 0;
    methods += to_calibration_method(b) ? 1 : 0;
  }
  EXPECT_EQ(states, 9);
  EXPECT_EQ(streams, 3);
  EXPECT_EQ(decimations, 3);
  EXPECT_EQ(outputs, 2);
  EXPECT_EQ(statuses, 18);
  EXPECT_EQ(sessions, 3);
  EXPECT_EQ(offset_states, 5);
  EXPECT_EQ(latchings, 3);
  EXPECT_EQ(methods, 3);
}

}  // namespace
}  // namespace triskin::wire
