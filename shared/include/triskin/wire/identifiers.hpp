// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// The tables list the data identifiers and routines of the controller with numbers, lengths, access and meaning of a
/// value. tools/make_vector_tables generates the tables of docs/protocol.md from this file. The headers named in the
/// rows define the types of the values, and each type checks its lengths against its row.
namespace triskin::wire {

namespace did {
inline constexpr std::uint16_t kActiveSession = 0xF186, kSerialNumber = 0xF18C, kPartNumber = 0xF190,
                               kHardware = 0xF191, kFirmware = 0xF195, kHello = 0xFD00, kNodeAddress = 0xFD01,
                               kActiveTable = 0xFD02, kModuleStates = 0xFD03, kStatistics = 0xFD04, kStream = 0xFD05,
                               kLineStates = 0xFD06, kTopology = 0xFD07, kRoute = 0xFD08, kImageState = 0xFD09,
                               kSampling = 0xFD0A, kOffsets = 0xFD0B, kStreamAccount = 0xFD0C, kCalibration = 0xFD0D,
                               kAdoption = 0xFD0E, kSettledRest = 0xFD0F, kLiveTaxels = 0xFD10, kBoardHealth = 0xFD11,
                               kCrash = 0xFD12, kLog = 0xFD13, kFreezeTime = 0xFD21, kFreezeSample = 0xFD22,
                               kIcub = 0xFD30;
}  // namespace did

namespace routine {
inline constexpr std::uint16_t kDiscover = 0x0201, kSelfTest = 0x0202, kCalibrate = 0x0203, kReroute = 0x0204,
                               kActivate = 0x0205, kOffsets = 0x0206, kProtectLoader = 0x0207;
}  // namespace routine

/// Tells in which sessions and with which services an identifier can be used.
enum class Access : std::uint8_t {
  kRead,       ///< Service 22 reads it in any session.
  kReadWrite,  ///< Service 2E can also write it, after security access.
  kFreeze,     ///< It appears only inside freeze data, service 19 04.
};

struct Identifier {
  std::uint16_t id;
  Access access;
  std::size_t min_bytes, max_bytes;  ///< The length of a value lies between these two limits.
  std::string_view header;  ///< The type of the value is defined in this header below shared/include/triskin/wire.
  std::string_view value;   ///< The fields are listed in order with their bytes, little-endian unless stated otherwise.
};

inline constexpr std::array<Identifier, 28> kIdentifiers{{
    {did::kActiveSession, Access::kRead, 1, 1, "identity.hpp", "session (1): 1 default, 2 programming, 3 extended"},
    {did::kSerialNumber, Access::kRead, 12, 12, "identity.hpp", "unique id (12)"},
    {did::kPartNumber, Access::kRead, 8, 8, "identity.hpp", "\"TRISKIN1\"; the last character is the kind of board"},
    {did::kHardware, Access::kRead, 8, 8, "identity.hpp", "\"TRISKIN1\"; likewise"},
    {did::kFirmware, Access::kRead, 4, 4, "identity.hpp", "firmware version, big-endian: major, minor, patch, build"},
    {did::kHello, Access::kRead, 23, 23, "identity.hpp",
     "wire version (2), layout version (2), firmware version (4), node address (1), unique id (12), most modules (1), "
     "taxels a module (1); the bytes up to the unique id are the same in every wire version"},
    {did::kNodeAddress, Access::kReadWrite, 1, 1, "identity.hpp",
     "node address (1): 1 … 126; written, it takes effect after the answer"},
    {did::kActiveTable, Access::kRead, 18, 18, "table_state.hpp",
     "Status (1): 0 with a table, 11 without, sequence (4), design id (8), CRC-32 of the image (4), modules (1)"},
    {did::kModuleStates, Access::kRead, 1, 16, "module_state.hpp",
     "per row of the table its state (1); refused without a table"},
    {did::kStatistics, Access::kRead, 16, 16, "statistics.hpp",
     "nominal sequences since power-up (4), bus errors (4), recoveries of lines (4), stream frames lost because the "
     "bus was too slow (4)"},
    {did::kStream, Access::kReadWrite, 1, 1, "sampling.hpp",
     "stream (1): 0 off, 1 iCub (refused for node addresses above 14), 2 full (refused on a classic bus)"},
    {did::kLineStates, Access::kRead, 20, 20, "lines.hpp", "per line: 1 when it is held low (1), recoveries (4)"},
    {did::kTopology, Access::kRead, 3, 67, "topology.hpp",
     "modules and joints as found on the route chain: flags (1; 1: switched modules, 2: complete, 4: module 0 is at "
     "the second cable), modules (1), cable port of module 0 (1), then per module far end of ports A, B, C (1 each; 0 "
     "none, else 1 + 3 × module + port) and its row in the table, or as a guest (1; FF: neither)"},
    {did::kRoute, Access::kRead, 18, 50, "topology.hpp",
     "active route: flags (1; 1 switched, 2 busy, 4 a tree is up, 8 the table's, 10 least depth, 20 second cable), "
     "ports left closed as shorted (1), modules unknown to the table (1), depth (1), rows in the tree (2, a bit each), "
     "looks at the whole patch (4), registers written again (4), µs of the last look (4), then per row of the table "
     "parent row (1; FF none) and the parent's port (1; 3 none)"},
    {did::kImageState, Access::kRead, 14, 14, "identity.hpp",
     "slot that runs (1): 0 or 1, confirmed (1), sequence (4), bytes (4), CRC-32 of its record (4); refused when not "
     "started from a slot"},
    {did::kSampling, Access::kReadWrite, 3, 4, "sampling.hpp",
     "decimation (1): 0 256, 1 128, 2 64; every n-th sequence (1): 1 … 255; output (1): 0 the converter's result, 1 "
     "compensated, 8000 at rest; as after power-up: 0, 1, 0; reading (1; may be left out): 0 in the window in which "
     "the "
     "results belong together, 1 by a timer, as installed iCub boards do"},
    {did::kOffsets, Access::kRead, 5, 261, "offsets.hpp",
     "electrodes at the positive input (1): 0 or 1, searches that have ended since power-up (4), then per row of the "
     "table: state (1): 0 none, 1 searching, 2 kept from the flash, 3 found since power-up, 4 a taxel rests outside "
     "the "
     "middle third; results change (1): 0 not seen yet, 1 stage by stage, 2 at the end of the sequence; taxels outside "
     "the middle third (2, a bit each), offset of each taxel in steps of 0.32 pF (12)"},
    {did::kStreamAccount, Access::kRead, 10, 314, "stream_account.hpp",
     "how often sampling began anew (1, modulo 256), time in µs (8), leases (1; 0 … 8), number of each reader (4), "
     "then "
     "per row of the table: number of the latest sample (4), samples not read (4), dropped (4), sent (4), waiting (1)"},
    {did::kCalibration, Access::kReadWrite, 27, 491, "calibration.hpp",
     "calibration kept with the table: version (1): 1, exponent e (1; 0 … 30), revision (2; from 1), design id (8; "
     "that of the table), patch (2), made (4; s since 1970 UTC), method (1): 0 steps, 1 weights, 2 ramp, largest "
     "pressure in Pa (4), area of a taxel in 10⁻⁴ mm² (4), then per module its place (1; 4 × line + address), "
     "sensitivity of 12 taxels in 2⁻ᵉ counts/kPa (2 each; 0 none), bound of their relative error in 0.01 % (2), "
     "farthest from the line in Pa (2); without modules it deletes what was kept; refused without one"},
    {did::kAdoption, Access::kRead, 4, 64, "adoption.hpp",
     "rows of the table (1), rows that it does not reach and offers to its neighbours (2, a bit each), number of the "
     "list of guests (1), then per module of another patch that it reads: row of the parent (1; from the number of "
     "rows on a guest before this one), the parent's port (1), the guest's port to it (1), 4 × line + address (1)"},
    {did::kSettledRest, Access::kRead, 1, 385, "settled_rest.hpp",
     "rows of the table (1), then per row what each taxel read when its offset was settled, in counts, pressure lowers "
     "it (2 each; 0 before that)"},
    {did::kLiveTaxels, Access::kRead, 12, 428, "live_taxels.hpp",
     "nominal sequences since power-up (4), time in µs (8), then per row of the table: valid taxels (2, a bit each), "
     "12 values of the converter (2 each)"},
    {did::kBoardHealth, Access::kRead, 54, 54, "health.hpp",
     "crystal (1): 0 used, 1 silent, 2 not measured, 3 unknown frequency, 4 no lock, 5 no PLL, 6 not said; its "
     "frequency in MHz (1; 0: the internal oscillator is used), as measured in kHz (2); cause of the last reset (1; 1 "
     "power, 2 pin, 4 software, 8 watchdog, 10 options), findings (2, a bit each: docs/bring_up.md), crashes in a row "
     "(1); CAN: send and receive error counters (1 each), state (1; 1 warning, 2 error passive, 4 bus-off), last "
     "error (1), times bus-off (4), received frames lost (4), message RAM failures (2); flash units with one wrong bit "
     "(4), with two (4), writes refused (4); longest pass of the loop and longest interrupt in µs (4 each); stack: "
     "bytes reserved, bytes never used (2 each); idle time in ‰ (2); reserved (6); refused where the board has none "
     "of it"},
    {did::kCrash, Access::kRead, 44, 44, "health.hpp",
     "what stopped the controller last: cause (1): 0 none, 1 fault, 2 stack overflow, 3 watchdog, 4 clock, 5 "
     "interrupt, 6 "
     "program; a page was being erased (1), exception that ran (2; 0 the loop), PC, LR, SP, CFSR, HFSR, address of the "
     "access, ms since its start, firmware version, origin of the image, crashes since power-up (4 each); kept in the "
     "fault memory; zeros without one; refused where the board has none of it"},
    {did::kLog, Access::kReadWrite, 2, 2, "log.hpp",
     "log to who asks, over this port, until the controller starts anew: level (1): 0 off, 1 errors, 2 warnings, 3 "
     "information, 4 debug; most that the image has (1; ignored when written)"},
    {did::kIcub, Access::kRead, 9, 9, "icub_commands.hpp",
     "flags (1; 1: the node address is above 14, so this is no iCub board, 2: an offset of the converter was asked for "
     "and not written, 4: an address was refused, 8: a command was refused), command refused last (1), commands "
     "refused (1; 255: as many or more), skin type (1), period in ms (1), value at rest (1), shift of triangle 0 (1), "
     "enabled triangles (2, a bit each)"},
    {did::kFreezeTime, Access::kFreeze, 4, 4, "faults.hpp", "ms since power-up (4)"},
    {did::kFreezeSample, Access::kFreeze, 4, 4, "faults.hpp", "number of the module's sample (4)"},
}};

struct Routine {
  std::uint16_t id;
  std::string_view name;
  std::string_view does;
  /// The result that follows the routine's identifier has a size between these; 0, 0 means that there is no result.
  std::size_t result_bytes_least, result_bytes_most;
  std::string_view result;
};

inline constexpr std::array<Routine, 7> kRoutines{{
    {routine::kDiscover, "discover", "looks at all four addresses of the four lines, also without a table", 13, 13,
     "done (1), per line: held low (1), answering addresses (1, a bit each), those with another device id (1, a bit "
     "each)"},
    {routine::kSelfTest, "self test", "finds, configures and checks every module again", 1, 17,
     "done (1), per row of the table its state (1)"},
    {routine::kCalibrate, "calibrate", "the next reading is the resting value of the iCub stream", 0, 0, ""},
    {routine::kReroute, "reroute",
     "switched modules: finds modules and joints anew and opens a tree; sampling rests up to 80 ms meanwhile, answers "
     "wait as long",
     1, 1, "done (1); then read FD07 and FD08"},
    {routine::kActivate, "activate", "checks the download, stores it, makes it active; needs the key", 1, 1,
     "Status (1), in the answer to the start"},
    {routine::kOffsets, "offsets",
     "forgets the offsets of all converters and searches them anew; nothing should touch "
     "the skin meanwhile",
     1, 1, "done (1); then read FD0B"},
    {routine::kProtectLoader, "protect loader",
     "option (1): 1 protects the pages of the loader against being written, 0 releases them, from the next power-up "
     "on; "
     "needs the key, and two seconds since the start",
     1, 1, "Status (1), in the answer to the start"},
}};

/// The function is never defined, so that a call of it makes a constant expression invalid.
[[noreturn]] void no_row();
/// Returns the row of an identifier; an unknown number makes a constant expression invalid.
[[nodiscard]] consteval const Identifier& identifier(std::uint16_t id) {
  for (const Identifier& row : kIdentifiers) {
    if (row.id == id) return row;
  }
  no_row();
}
/// Returns the row of a routine; an unknown number makes a constant expression invalid.
[[nodiscard]] consteval const Routine& routine_row(std::uint16_t id) {
  for (const Routine& row : kRoutines) {
    if (row.id == id) return row;
  }
  no_row();
}

/// Compares both lengths of a value type with its row in the table.
template <class Value>
inline constexpr bool kLengthsAsInTable =
    identifier(Value::kId).min_bytes == Value::kMinBytes && identifier(Value::kId).max_bytes == Value::kMaxBytes;
/// Compares both lengths of a routine's result type with its row in the table.
template <class Value>
inline constexpr bool kResultAsInTable = routine_row(Value::kId).result_bytes_least == Value::kMinBytes &&
                                         routine_row(Value::kId).result_bytes_most == Value::kMaxBytes;

}  // namespace triskin::wire
