// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/board_backup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "address_moves.hpp"
#include "table_writer.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/deploy/board_file.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/controller_calibration.hpp"
#include "triskin/session/scheduler.hpp"
#include "triskin/wire/calibration.hpp"
#include "triskin/wire/identifiers.hpp"

namespace triskin::deploy {
namespace {

using Message = session::Bus::Message;

// Two boards of one kind have equal values of these identifiers.
constexpr std::array<std::uint16_t, 2> kKind{wire::did::kPartNumber, wire::did::kHardware};

// Returns empty if the controller has no such value, like an older one or one without a table.
std::optional<std::vector<std::uint8_t>> raw_value(session::Bus& bus, std::uint8_t node, std::uint16_t id) {
  const auto high = static_cast<std::uint8_t>(id >> 8), low = static_cast<std::uint8_t>(id);
  try {
    Message m = bus.request(node, std::array{wire::service::kRead, high, low}, session::Bus::Repeat::kSafe);
    m.erase(m.begin(), m.begin() + 2);
    return m;
  } catch (const session::Refused&) {
    return std::nullopt;
  }
}

std::vector<std::uint8_t> noted_of(session::Bus& bus, std::uint8_t node, std::uint32_t code) {
  const auto byte = [&](int shift) { return static_cast<std::uint8_t>(code >> shift); };
  const std::array<std::uint8_t, 6> request{wire::service::kReadFaults, 0x04, byte(16), byte(8), byte(0),
                                            wire::FreezeFrame::kRecord};
  try {
    Message m = bus.request(node, request, session::Bus::Repeat::kSafe);
    m.erase(m.begin());
    return m;
  } catch (const session::Refused&) {
    return {};
  }
}

BoardBackup read_board(session::Bus& bus, const wire::NodeClaim& claim) {
  const std::uint8_t node = claim.node_address;
  session::Controller controller(bus, node);
  BoardBackup b;
  b.serial = session::to_text(claim.unique_id);
  b.node_address = node;
  for (const wire::Identifier& row : wire::kIdentifiers) {
    if (row.access == wire::Access::kFreeze) continue;
    if (auto value = raw_value(bus, node, row.id)) b.values[row.id] = std::move(*value);
  }
  const wire::ActiveTable table = controller.active_table();
  if (table.present()) b.table = controller.read_table(layout::kHeaderBytes + table.modules * layout::kRowBytes);
  const wire::FaultList faults = controller.faults();
  for (const wire::FaultRecord& f : faults.faults())
    b.faults.push_back({f.code.dtc(), f.status, noted_of(bus, node, f.code.dtc())});
  return b;
}

std::string hex_of(Bytes bytes) {
  return fmt::format("{:02X}", fmt::join(bytes, ""));
}

using design::JsonValue;

constexpr const char* kBackupFormat = "triskin-board-backup";
constexpr int kBackupVersion = 1;
constexpr const char* kBackupPage = "docs/deploy.md";

nlohmann::ordered_json board_json(const BoardBackup& b) {
  nlohmann::ordered_json values = nlohmann::ordered_json::object(), faults = nlohmann::ordered_json::array();
  for (const auto& [id, value] : b.values) values[fmt::format("{:04X}", id)] = hex_of(value);
  for (const BoardBackup::Fault& f : b.faults)
    faults.push_back({{"code", fmt::format("{:06X}", f.code)}, {"status", f.status}, {"noted", hex_of(f.noted)}});
  nlohmann::ordered_json board = {{"serial", b.serial},
                                  {"node_address", b.node_address},
                                  {"table", hex_of(b.table)},
                                  {"values", std::move(values)},
                                  {"faults", std::move(faults)}};
  if (b.calibration)
    board["calibration"] = nlohmann::ordered_json::parse(design::calibration_text(std::span(&*b.calibration, 1)));
  return board;
}

std::optional<design::BoardCalibration> calibration_in(const JsonValue& v, const std::string& serial) {
  if (!design::has(v, "calibration")) return std::nullopt;
  const JsonValue calibration = v["calibration"];
  const auto boards = design::parse_calibration(calibration.raw().dump(), "calibration of controller " + serial);
  if (boards.size() != 1 || boards[0].serial != serial)
    calibration.fail("is not that of this controller; use another copy");
  return boards[0];
}

// The CRC covers the boards as this program writes them, so key order and spaces of the file do not count.
std::uint32_t crc_of(std::span<const BoardBackup> boards) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BoardBackup& b : boards) list.push_back(board_json(b));
  const std::string text = list.dump();
  return crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::vector<std::uint8_t> hex_in(const JsonValue& v) {
  const std::string text = v.text();
  if (text.size() % 2 != 0 || text.find_first_not_of("0123456789ABCDEF") != std::string::npos)
    v.fail("must be pairs of hexadecimal digits, upper case");
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = 0; k < text.size(); k += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(k, 2), nullptr, 16)));
  return bytes;
}

std::uint32_t number_in_hex(const JsonValue& v, const std::string& text, std::size_t digits) {
  if (text.size() != digits || text.find_first_not_of("0123456789ABCDEF") != std::string::npos)
    v.fail(fmt::format("must be {} hexadecimal digits, upper case", digits));
  return static_cast<std::uint32_t>(std::stoul(text, nullptr, 16));
}

std::map<std::uint16_t, std::vector<std::uint8_t>> values_in(const JsonValue& v) {
  if (!v.raw().is_object()) v.fail("must be an object");
  std::map<std::uint16_t, std::vector<std::uint8_t>> values;
  for (const auto& [key, value] : v.raw().items())
    values[static_cast<std::uint16_t>(number_in_hex(v, key, 4))] = hex_in(v[key.c_str()]);
  return values;
}

BoardBackup::Fault fault_in(const JsonValue& v) {
  return {number_in_hex(v["code"], v["code"].text(), 6), static_cast<std::uint8_t>(v["status"].integer(0, 255)),
          hex_in(v["noted"])};
}

BoardBackup board_in(const JsonValue& v) {
  design::only_keys(v, {"serial", "node_address", "table", "values", "faults", "calibration"}, kBackupPage);
  BoardBackup b;
  b.serial = normal_serial(v["serial"].text());
  if (b.serial.empty()) v["serial"].fail("must have 24 hexadecimal digits");
  b.node_address = v["node_address"].integer(layout::kFirstNode, layout::kLastNode);
  b.table = hex_in(v["table"]);
  b.values = values_in(v["values"]);
  const JsonValue faults = v["faults"];
  for (std::size_t k = 0; k < faults.size(); ++k) b.faults.push_back(fault_in(faults.at(k)));
  b.calibration = calibration_in(v, b.serial);
  return b;
}

std::vector<BoardBackup> boards_in(const JsonValue& list) {
  std::vector<BoardBackup> boards;
  for (std::size_t k = 0; k < list.size(); ++k) {
    BoardBackup board = board_in(list.at(k));
    if (std::ranges::find(boards, board.serial, &BoardBackup::serial) != boards.end())
      list.at(k)["serial"].fail("the board stands twice");
    boards.push_back(std::move(board));
  }
  return boards;
}

// The CRC shows that nothing was changed; this check shows that it was a valid table in the first place.
void require_table(const JsonValue& v, const BoardBackup& b) {
  if (b.table.empty()) return;
  const auto image = layout::decode(b.table);
  if (!image)
    v["table"].fail(
        fmt::format("is no table of a controller: {}; save the board again", session::describe(image.error())));
  if (image->node_address != b.node_address)
    v["table"].fail(fmt::format("is for node address {}, the board had {}", image->node_address, b.node_address));
}

void require_calibration(const JsonValue& v, const BoardBackup& b) {
  const auto value = b.values.find(wire::Calibration::kId);
  if (value == b.values.end()) return;
  if (const auto kept = wire::Calibration::decode(value->second); !kept)
    v["values"].fail(
        fmt::format("keeps a calibration that is none: {}; save the board again", session::describe(kept.error())));
}

/// Each board of the file is paired with the controller that will receive its data.
struct Pair {
  const BoardBackup* board = nullptr;
  wire::NodeClaim claim;
};

class Restoration {
 public:
  Restoration(session::Bus& bus, std::span<const BoardBackup> boards, const RestoreOptions& options)
      : bus_(bus), boards_(boards), options_(options) {}

  std::vector<RestoredBoard> run() {
    pair();
    require_kinds();
    require_addresses();
    if (!options_.dry_run) move();
    std::vector<RestoredBoard> results(pairs_.size());
    std::vector<session::Task> tasks;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Pair& p = pairs_[k];
      const auto node = static_cast<std::uint8_t>(options_.dry_run ? p.claim.node_address : p.board->node_address);
      tasks.push_back({node, [this, k, &results](session::Bus& bus) { results[k] = write(bus, pairs_[k]); }});
    }
    require_done(session::run_tasks(bus_.link(), tasks, options_.per_wire));
    return results;
  }

 private:
  // Throws naming every board that was not written.
  void require_done(const std::vector<std::exception_ptr>& outcomes) const {
    std::vector<std::string> failed;
    for (std::size_t k = 0; k < outcomes.size(); ++k) {
      try {
        if (outcomes[k]) std::rethrow_exception(outcomes[k]);
      } catch (const DeviceError& e) {
        failed.push_back(fmt::format("controller {}: {}", session::to_text(pairs_[k].claim.unique_id), e.what()));
      }
    }
    if (failed.empty()) return;
    throw DeviceError(fmt::format("{}; {} of {} {} what was kept, the others what they held", fmt::join(failed, "\n  "),
                                  pairs_.size() - failed.size(), counted(pairs_.size(), "board"),
                                  agreeing(pairs_.size() - failed.size(), "has", "have")));
  }

  void require_onto() const {
    for (const auto& [from, to] : options_.onto) {
      if (std::ranges::none_of(boards_, [&](const BoardBackup& b) { return b.serial == from; }))
        throw InputError(fmt::format("--onto {}={}: the file keeps no controller {}", from, to, from));
    }
  }
  [[nodiscard]] const wire::NodeClaim& claim_of(const std::string& serial, const BoardBackup& b) const {
    const auto claim = std::ranges::find_if(
        claims_, [&](const wire::NodeClaim& c) { return session::to_text(c.unique_id) == serial; });
    if (claim == claims_.end())
      throw DeviceError(
          fmt::format("{}: no controller {} answers; connect it, or say which one takes its place: "
                      "--onto {}=SERIAL; nothing was written",
                      bus_.name(), serial, b.serial));
    return *claim;
  }
  void pair() {
    claims_ = bus_.discover();
    require_onto();
    std::set<std::string> taken;
    for (const BoardBackup& b : boards_) {
      const auto onto = options_.onto.find(b.serial);
      const std::string& serial = onto == options_.onto.end() ? b.serial : onto->second;
      const wire::NodeClaim& claim = claim_of(serial, b);
      if (!taken.insert(serial).second)
        throw InputError(fmt::format("controller {} would get what two boards held; nothing was written", serial));
      pairs_.push_back({&b, claim});
    }
  }

  void separate_addresses() {
    claims_ = put_apart(bus_, std::move(claims_), false);
    for (Pair& p : pairs_) p.claim = *std::ranges::find(claims_, p.claim.unique_id, &wire::NodeClaim::unique_id);
  }
  // Each controller is asked at its present address. New ones that share an address are moved first, except in a dry
  // run.
  void require_kinds() {
    if (!options_.dry_run) separate_addresses();
    const auto users = session::users_of_addresses(claims_);
    for (const Pair& p : pairs_) {
      if (users.at(p.claim.node_address) > 1) {
        if (options_.dry_run && !p.claim.has_table) continue;
        throw DeviceError(
            fmt::format("{}: controller {} shares node address {} and cannot be asked; connect it alone; "
                        "nothing was written",
                        bus_.name(), session::to_text(p.claim.unique_id), p.claim.node_address));
      }
      session::Controller controller(bus_, p.claim.node_address);
      controller.require_versions(controller.hello());
      for (const std::uint16_t id : kKind) require_kind(p, id);
    }
  }
  void require_kind(const Pair& p, std::uint16_t id) {
    const auto now = raw_value(bus_, p.claim.node_address, id);
    const auto kept = p.board->values.find(id);
    if (now && kept != p.board->values.end() && *now == kept->second) return;
    const auto text = [](const std::vector<std::uint8_t>& v) { return std::string(v.begin(), v.end()); };
    throw InputError(fmt::format(
        "controller {} is a \"{}\", what was kept is of a \"{}\": tables of one kind of board do not fit another; give "
        "a file of this kind of board; nothing was written",
        session::to_text(p.claim.unique_id), now ? text(*now) : "?",
        kept != p.board->values.end() ? text(kept->second) : "?"));
  }

  [[nodiscard]] bool is_paired(const wire::NodeClaim& c) const {
    return std::ranges::any_of(pairs_, [&](const Pair& p) { return p.claim.unique_id == c.unique_id; });
  }
  [[nodiscard]] const wire::NodeClaim* unpaired_at(int address) const {
    const auto found = std::ranges::find_if(
        claims_, [&](const wire::NodeClaim& c) { return c.node_address == address && !is_paired(c); });
    return found == claims_.end() ? nullptr : &*found;
  }
  void require_addresses() const {
    std::set<int> addresses;
    for (const Pair& p : pairs_) {
      const int address = p.board->node_address;
      if (!addresses.insert(address).second)
        throw InputError(
            fmt::format("two boards of the file had node address {}: restore them one after the other; "
                        "nothing was written",
                        address));
      const wire::NodeClaim* const other = unpaired_at(address);
      if (other == nullptr) continue;
      throw DeviceError(
          fmt::format("{}: controller {}, which is not in the file, has node address {} that controller "
                      "{} is to get; take it off the bus; nothing was written",
                      bus_.name(), session::to_text(other->unique_id), address, session::to_text(p.claim.unique_id)));
    }
  }

  void move() {
    std::map<wire::UniqueId, int> wanted;
    for (const Pair& p : pairs_) {
      if (p.claim.node_address != p.board->node_address) wanted[p.claim.unique_id] = p.board->node_address;
    }
    assign_addresses(bus_, std::move(wanted));
  }

  // Writes the calibration after its table. A board without one keeps its calibration unless a new table invalidated
  // it.
  void write_calibration(session::Controller& controller, const BoardBackup& b, RestoredBoard& r) const {
    const auto value = b.values.find(wire::Calibration::kId);
    if (value == b.values.end() || options_.dry_run) return;
    // The value is present, because read_backup() has validated it.
    const wire::Calibration kept = wire::Calibration::decode(value->second).value();
    if (controller.calibration() == kept) return;
    r.calibrated = write_and_compare(controller, kept, r.serial);
    r.calibration_refused = !r.calibrated;
  }
  RestoredBoard write(session::Bus& bus, const Pair& p) const {
    const BoardBackup& b = *p.board;
    RestoredBoard r{session::to_text(p.claim.unique_id), b.serial, b.node_address, b.table.size(), false, false};
    const bool moved = p.claim.node_address != b.node_address;
    if (b.table.empty() || (options_.dry_run && !p.claim.has_table)) return r;
    const auto now = static_cast<std::uint8_t>(options_.dry_run ? p.claim.node_address : b.node_address);
    session::Controller controller(bus, now);
    const bool same = holds_table(controller, b.table);
    r.equal = same && !moved;
    if (!same && !options_.dry_run) {
      write_and_compare(controller, bus, b.table, {});
      r.written = true;
    }
    write_calibration(controller, b, r);
    return r;
  }

  session::Bus& bus_;
  std::span<const BoardBackup> boards_;
  const RestoreOptions& options_;
  std::vector<wire::NodeClaim> claims_;
  std::vector<Pair> pairs_;
};

}  // namespace

std::vector<BoardBackup> save_boards(session::Bus& bus, const std::function<void(const std::string&)>& say) {
  const auto claims = bus.discover();
  if (claims.empty()) throw DeviceError(bus.nobody_answers());
  const auto users = session::users_of_addresses(claims);
  std::vector<BoardBackup> boards;
  for (const wire::NodeClaim& c : claims) {
    if (users.at(c.node_address) == 1) {
      boards.push_back(read_board(bus, c));
    } else if (c.has_table) {
      throw DeviceError(
          fmt::format("{}: controller {} holds a table and shares node address {}, so it cannot be asked; "
                      "connect it alone to keep what it holds",
                      bus.name(), session::to_text(c.unique_id), c.node_address));
    } else if (say) {
      say(fmt::format("controller {} was never flashed: there is nothing to keep", session::to_text(c.unique_id)));
    }
  }
  return boards;
}

std::string backup_text(std::span<const BoardBackup> boards) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BoardBackup& b : boards) list.push_back(board_json(b));
  const nlohmann::ordered_json document = {{"format", kBackupFormat},
                                           {"version", kBackupVersion},
                                           {"crc32", fmt::format("{:08X}", crc_of(boards))},
                                           {"boards", std::move(list)}};
  return document.dump(1) + "\n";
}

std::vector<BoardBackup> read_backup(const std::filesystem::path& path) {
  const std::string name = path.string();
  const nlohmann::json document = design::parse_json(read_text(path), name);
  const JsonValue v(document, name);
  design::require_head(v, kBackupFormat, kBackupVersion, "use the release that wrote it");
  design::only_keys(v, {"format", "version", "crc32", "boards"}, kBackupPage);
  const std::uint32_t stated = number_in_hex(v["crc32"], v["crc32"].text(), 8);
  const JsonValue list = v["boards"];
  std::vector<BoardBackup> boards = boards_in(list);
  if (crc_of(boards) != stated)
    v["crc32"].fail("differs from that of the boards: the file was changed or damaged; use another copy");
  for (std::size_t k = 0; k < list.size(); ++k) {
    require_table(list.at(k), boards[k]);
    require_calibration(list.at(k), boards[k]);
  }
  return boards;
}

std::vector<RestoredBoard> restore_boards(session::Bus& bus, std::span<const BoardBackup> boards,
                                          const RestoreOptions& options) {
  return Restoration(bus, boards, options).run();
}

}  // namespace triskin::deploy
