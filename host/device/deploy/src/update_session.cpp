// SPDX-License-Identifier: GPL-3.0-or-later
#include "update_session.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/layout/image_label.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/firmware_version.hpp"
#include "triskin/wire/bus_load.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::deploy {

using wire::update::Command;
using wire::update::kUnitBytes;
using wire::update::Phase;

namespace {

// A board is silent for at most this long, except while it erases a page.
constexpr std::uint64_t kSilence_us = 20'000;
constexpr std::uint64_t kClaims_us = 60'000;
constexpr std::uint64_t kErasePage_us = 23'000;  // An erase takes 22 ms, and some work happens between two pages.
constexpr std::uint64_t kBetweenPolls_us = 25'000;
constexpr std::uint64_t kErasePatience_us = 2'000'000, kCheckPatience_us = 1'500'000, kStartPatience_us = 2'000'000;
constexpr std::uint64_t kStarts_us = 40'000;  // Covers the queue, the loader's window and the check of both slots.
constexpr std::uint64_t kConfirmed_us = 2'500'000;  // An application has proved itself by this time.
constexpr std::uint64_t kBusyPause_us = 500'000;    // Boards of another tester are asked again after this time.
constexpr const char* kAnotherTester = "another tester updates it; wait until it has ended";
constexpr int kTries = 3, kMaxRounds = 25;
// A slow board, or one whose answers were lost, has this many rounds to report its missing units.
constexpr int kSilentRounds = 3;
constexpr std::uint64_t kMaxLag_us = 2'000;  // Sending catches up with at most this delay.

std::string why_refused(Status s) {
  switch (s) {
    case Status::kWrongTarget:
      return "the image is for other hardware or for another slot";
    case Status::kOlder:
      return "the image is older than the firmware that runs; --allow-older takes it";
    case Status::kBadCrc:
      return "the image arrived damaged: another sender was on the bus, or the flash failed; run the command again";
    case Status::kBadMagic:
      return "the image has no label";
    case Status::kBadVersion:
      return "the image is of another version than its package says";
    case Status::kUnproven:
      return "the firmware that runs has not confirmed itself yet; run the command again in three seconds";
    default:
      return session::describe(s);
  }
}

}  // namespace

UpdateSession::UpdateSession(session::Bus& bus, std::span<const wire::NodeClaim> boards, const FirmwarePackage& package,
                             const UpdateOptions& options, std::uint16_t session, OnProgress progress)
    : bus_(bus),
      package_(package),
      options_(options),
      session_(session),
      progress_(std::move(progress)),
      fd_(bus.link().fd() && bus.link().frame_bytes() > kUnitBytes),
      frame_bytes_(fd_ ? bus.link().frame_bytes() / kUnitBytes * kUnitBytes : kUnitBytes),
      silence_us_(std::max(kSilence_us, bus.link().answer_us() / 10)) {
  for (const wire::NodeClaim& claim : boards) {
    by_answer_[wire::claim_id(claim.unique_id)] = boards_.size();
    Board b;
    b.result.claim = claim;
    b.result.serial = session::to_text(claim.unique_id);
    b.id_crc = crc32(claim.unique_id);
    boards_.push_back(std::move(b));
  }
}

void UpdateSession::send(const wire::update::Order& order) {
  wire::CanFrame f = wire::update::encode_order(order);
  f.fd = f.bit_rate_switch = fd_;  // With FD, answers may be FD frames as well.
  bus_.link().send(f);
}

void UpdateSession::take(const wire::CanFrame& f) {
  if (!wire::is_claim(f)) return;
  const auto found = by_answer_.find(f.id);
  if (found == by_answer_.end()) return;
  Board& b = boards_[found->second];
  if (f.size == 8 && f.data[0] <= 1) b.claims = true;
  if (const auto who = wire::update::decode_who(f.payload())) b.who = *who;
  if (const auto image = wire::update::decode_image(f.payload())) b.image = *image;
  if (const auto state = wire::update::decode_state(f.payload())) b.state = *state;
  (void)wire::update::decode_missing(f.payload(), [&](std::uint16_t unit) { b.missing.insert(unit); });
}

void UpdateSession::listen_while(std::uint64_t until_us, const std::function<bool()>& goes_on) {
  while (bus_.now_us() < until_us && goes_on()) {
    if (const auto frame = bus_.receive(until_us)) take(*frame);
  }
}

void UpdateSession::listen(std::uint64_t until_us) {
  listen_while(until_us, [] { return true; });
}

void UpdateSession::ask(Command command, const Done& wanted, const Done& done, int tries) {
  const auto open = [&](const Board& b) { return wanted(b) && !done(b); };
  for (int k = 0; k < tries && std::ranges::any_of(boards_, open); ++k) {
    std::uint64_t sending_us = 0;
    for (const Board& b : boards_) {
      if (!open(b)) continue;
      const auto order = wire::update::order_to(command, session_, b.id_crc);
      send(order);
      sending_us += wire::frame_ns(wire::update::encode_order(order), wire::kControllerRates) / 1000;
    }
    // The answers of all boards share the bus, so the silence is counted from the last frame.
    std::uint64_t until_us = bus_.now_us() + sending_us + silence_us_;
    while (bus_.now_us() < until_us && std::ranges::any_of(boards_, open)) {
      const auto frame = bus_.receive(until_us);
      if (!frame || !wire::is_claim(*frame)) continue;
      take(*frame);
      until_us = std::max(until_us, bus_.now_us() + silence_us_);
    }
  }
}

bool UpdateSession::equal(const Board& b) const {
  return b.image->record_crc == layout::slot_crc(b.image->sequence, package_.image(b.who->running_slot));
}

void UpdateSession::give_up(Board& b, UpdateOutcome outcome, const std::string& why) {
  b.under_way = false;
  b.result.outcome = outcome;
  b.result.why = why;
}

bool UpdateSession::any_under_way() const {
  return std::ranges::any_of(boards_, &Board::under_way);
}

void UpdateSession::ask_all() {
  ask(
      Command::kAsk, [](const Board&) { return true; }, [](const Board& b) { return b.who && b.image && b.state; },
      kTries);
}

// A board that does not know the broadcast still claims its address.
void UpdateSession::look_for_silent() {
  const auto silent = [](const Board& b) { return !b.who; };
  if (std::ranges::none_of(boards_, silent)) return;
  bus_.link().send(wire::who_is_there());
  listen(bus_.now_us() + kClaims_us);
}

bool UpdateSession::of_another(const Board& b) {
  return b.state && b.state->session != 0 && b.state->phase != Phase::kRefused;
}

// A command that was cut off has left its session on the boards, which end it when it was silent for kPatience_us. The
// session of a tester at work lasts longer.
void UpdateSession::wait_for_another() {
  const std::uint64_t until_us = bus_.now_us() + wire::update::kPatience_us + 2 * kBusyPause_us;
  while (std::ranges::any_of(boards_, of_another) && bus_.now_us() < until_us) {
    listen(bus_.now_us() + kBusyPause_us);
    for (std::size_t k = 0; k < boards_.size(); ++k) {
      if (!of_another(boards_[k])) continue;
      progress_(k, "waiting for another update to end", 0.0);
      boards_[k].who.reset();
      boards_[k].image.reset();
      boards_[k].state.reset();
    }
    ask_all();
  }
}

void UpdateSession::decide(Board& b) {
  if (!b.who && !b.claims) return give_up(b, UpdateOutcome::kGivenUp, "does not answer; check its power and its cable");
  if (!b.who || !b.image || !b.state) return give_up(b, UpdateOutcome::kByLoader, "does not know the broadcast");
  b.result.slot = b.who->running_slot;
  if (b.who->protocol != wire::update::kProtocol)
    return give_up(b, UpdateOutcome::kRefused, "speaks another update protocol; use the tool of its release");
  if (of_another(b)) return give_up(b, UpdateOutcome::kRefused, kAnotherTester);
  if (equal(b) && !options_.force) return give_up(b, UpdateOutcome::kEqual, "");
  const std::uint32_t offered = package_.head.firmware_version;
  if (offered < b.who->firmware_version && !options_.allow_older) {
    return give_up(
        b, UpdateOutcome::kRefused,
        fmt::format("runs version {}, the package has {}; --allow-older takes it",
                    session::firmware_version_text(b.who->firmware_version), session::firmware_version_text(offered)));
  }
  if (options_.dry_run) return give_up(b, UpdateOutcome::kWould, "");
  b.under_way = true;
}

std::array<bool, 2> UpdateSession::slots_wanted() const {
  std::array<bool, 2> wanted{};
  for (const Board& b : boards_) {
    if (b.under_way) wanted[static_cast<std::size_t>(free_slot(b))] = true;
  }
  return wanted;
}

wire::update::Offer UpdateSession::offer_of(int slot) const {
  const Bytes image = package_.image(slot);
  return {.slot = static_cast<std::uint8_t>(slot),
          .may_be_older = options_.allow_older,
          .size_bytes = static_cast<std::uint32_t>(image.size()),
          .firmware_version = package_.head.firmware_version,
          .hardware_crc = crc32(options_.hardware),
          .image_crc = crc32(image)};
}

// The offer of each slot that is free on some board is sent to all; then each board is asked to take part.
void UpdateSession::join() {
  const auto wanted = slots_wanted();
  for (Board& b : boards_) b.state.reset();
  std::vector<wire::update::Offer> offers;
  for (int slot = 0; slot < 2; ++slot) {
    if (wanted[static_cast<std::size_t>(slot)]) offers.push_back(offer_of(slot));
  }
  const std::uint64_t until_us = bus_.now_us() + kConfirmed_us;
  for (int k = 0; k < kTries || bus_.now_us() < until_us; ++k) {
    for (const wire::update::Offer& offer : offers) {
      for (const auto& order : wire::update::encode_offer(offer, session_)) send(order);
    }
    ask(
        Command::kJoin, [&](const Board& b) { return b.under_way && !joined(b); },
        [](const Board& b) { return b.state.has_value(); }, 1);
    if (std::ranges::none_of(boards_, [&](const Board& b) { return may_join_later(b); })) break;
    const bool unproven = std::ranges::any_of(
        boards_, [&](const Board& b) { return b.under_way && b.state && b.state->status == Status::kUnproven; });
    if (!unproven && k + 1 >= kTries) break;
    if (unproven) listen(bus_.now_us() + 10 * kBetweenPolls_us);
    for (Board& b : boards_) {
      if (!joined(b)) b.state.reset();
    }
  }
  for (Board& b : boards_) {
    if (b.under_way && !joined(b)) refused_at_join(b);
  }
}

bool UpdateSession::joined(const Board& b) const {
  return b.state && b.state->session == session_ && b.state->phase == Phase::kJoined;
}

bool UpdateSession::may_join_later(const Board& b) const {
  if (!b.under_way || joined(b)) return false;
  // Without a session, the answer is older than the question.
  return !b.state || b.state->session == 0 || b.state->status == Status::kEmpty || b.state->status == Status::kUnproven;
}

void UpdateSession::refused_at_join(Board& b) {
  if (!b.state) return give_up(b, UpdateOutcome::kGivenUp, "does not answer any more; nothing was written");
  if (b.state->session != session_ || b.state->phase != Phase::kRefused)
    return give_up(b, UpdateOutcome::kRefused, kAnotherTester);
  give_up(b, UpdateOutcome::kRefused, why_refused(b.state->status));
}

void UpdateSession::expect_answer(Board& b, const char* doing) {
  if (!b.under_way) return;
  if (!b.state)
    return give_up(b, UpdateOutcome::kGivenUp,
                   fmt::format("does not answer any more while {}; what it ran is what it starts", doing));
  if (b.state->session != session_)
    return give_up(b, UpdateOutcome::kGivenUp, fmt::format("was restarted while {}; what it ran runs again", doing));
  if (b.state->phase == Phase::kRefused) give_up(b, UpdateOutcome::kRefused, why_refused(b.state->status));
}

// Asks the participating boards for their state until each is done. If one is still in phase `from`, it has missed the
// command, which is then sent again.
void UpdateSession::poll_until(const Done& done, std::uint64_t patience_us, Command repeat, Phase from,
                               const char* doing) {
  const std::uint64_t until_us = bus_.now_us() + patience_us;
  const auto open = [&](const Board& b) { return b.under_way && !done(b); };
  while (std::ranges::any_of(boards_, open)) {
    const bool late = bus_.now_us() >= until_us;
    for (Board& b : boards_) {
      if (open(b)) b.state.reset();
    }
    ask(Command::kAsk, open, [](const Board& b) { return b.state.has_value(); }, kTries);
    bool again = false;
    for (Board& b : boards_) {
      expect_answer(b, doing);
      if (b.under_way && b.state->phase == from) again = true;
      if (late && open(b)) give_up(b, UpdateOutcome::kGivenUp, fmt::format("does not get on with {}", doing));
    }
    if (again) send_to_all(repeat);
    if (std::ranges::any_of(boards_, open)) listen(bus_.now_us() + kBetweenPolls_us);
  }
}

void UpdateSession::erase() {
  std::size_t most = 0;
  for (std::size_t k = 0; k < boards_.size(); ++k) {
    if (!boards_[k].under_way) continue;
    most = std::max(most, package_.image(free_slot(boards_[k])).size());
    progress_(k, "erasing", 0.0);
  }
  if (most == 0) return;
  send_to_all(Command::kErase);
  const std::size_t pages = (most + layout::kFlashPageBytes - 1) / layout::kFlashPageBytes + 1;
  listen(bus_.now_us() + pages * kErasePage_us);
  poll_until([](const Board& b) { return b.state && b.state->phase == Phase::kReceiving; }, kErasePatience_us,
             Command::kErase, Phase::kJoined, "erasing");
}

bool UpdateSession::erased(int slot, std::size_t unit) const {
  return std::ranges::all_of(package_.image(slot).subspan(unit * kUnitBytes, kUnitBytes),
                             [](std::uint8_t v) { return v == 0xFF; });
}

void UpdateSession::send_image() {
  const auto wanted = slots_wanted();
  std::array<Units, 2> units;
  for (int slot = 0; slot < 2; ++slot) {
    if (!wanted[static_cast<std::size_t>(slot)]) continue;
    const std::size_t count = package_.image(slot).size() / kUnitBytes;
    for (std::size_t u = 0; u < count; ++u) {
      if (!erased(slot, u)) units[static_cast<std::size_t>(slot)].push_back(static_cast<std::uint16_t>(u));
    }
  }
  send_units(std::move(units), "writing firmware");
}

namespace {

// The streams of the two slots alternate: while the flash stores units of one, the bus carries those of the other.
struct SlotStream {
  std::vector<std::uint16_t> units;
  std::size_t at = 0;
  std::uint64_t next_us = 0;
  [[nodiscard]] bool done() const { return at == units.size(); }
  // Counts the consecutive units from `at` on, limited to `most`.
  [[nodiscard]] std::size_t run(std::size_t most) const {
    std::size_t n = 1;
    while (n < most && at + n < units.size() && units[at + n] == units[at] + n) ++n;
    // CAN FD has frames of 8, 16, 24, 32, 48 and 64 bytes, so other sizes are rounded down.
    if (n > 6 && n < 8) n = 6;
    if (n == 5) n = 4;
    return n;
  }
};

}  // namespace

void UpdateSession::report_to_all(const char* stage, double fraction) const {
  for (std::size_t k = 0; k < boards_.size(); ++k) {
    if (boards_[k].under_way) progress_(k, stage, fraction);
  }
}

void UpdateSession::send_units(std::array<Units, 2> units, const char* stage) {
  std::array<SlotStream, 2> streams{{{std::move(units[0])}, {std::move(units[1])}}};
  std::uint64_t bus_us = bus_.now_us();
  const std::size_t all = streams[0].units.size() + streams[1].units.size();
  std::size_t sent = 0, told = 0;
  while (!streams[0].done() || !streams[1].done()) {
    const bool second = streams[0].done() || (!streams[1].done() && streams[1].next_us < streams[0].next_us);
    SlotStream& s = streams[second ? 1 : 0];
    const std::size_t n = s.run(frame_bytes_ / kUnitBytes);
    const Bytes bytes = package_.image(second ? 1 : 0).subspan(s.units[s.at] * kUnitBytes, n * kUnitBytes);
    const wire::CanFrame frame = wire::update::encode_data(second ? 1 : 0, s.units[s.at], bytes);
    const std::uint64_t now_us = bus_.now_us();
    bus_us = std::max({bus_us, s.next_us, now_us > kMaxLag_us ? now_us - kMaxLag_us : 0});
    listen(bus_us);
    bus_.link().send(frame);
    ++frames_;
    s.at += n;
    sent += n;
    s.next_us = bus_us + n * wire::update::kUnit_us;
    bus_us += (wire::frame_ns(frame, wire::kControllerRates) + 999) / 1000;
    if (sent < told + 512 && sent < all) continue;
    told = sent;
    report_to_all(stage, static_cast<double>(sent) / static_cast<double>(all));
  }
  listen(std::max({bus_us, streams[0].next_us, streams[1].next_us}));
}

bool UpdateSession::complete(const Board& b) const {
  return b.state && b.state->session == session_ && b.state->phase == Phase::kReceiving &&
         b.state->count == b.missing.size();
}

// Collects the missing units of all boards and sends their union again, until none is missing.
void UpdateSession::send_missing() {
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < boards_.size(); ++k) {
    if (boards_[k].under_way) open.push_back(k);
  }
  while (!open.empty()) {
    ++rounds_;
    ask_missing(open);
    MissingUnits missing;
    std::erase_if(open, [&](std::size_t at) { return !still_needs(boards_[at], missing); });
    const std::size_t before = frames_;
    send_units({Units(missing[0].begin(), missing[0].end()), Units(missing[1].begin(), missing[1].end())},
               "sending again");
    again_ += frames_ - before;
  }
}

void UpdateSession::ask_missing(const std::vector<std::size_t>& open) {
  for (int k = 0; k < kTries; ++k) {
    for (const std::size_t at : open) {
      if (complete(boards_[at]) && k > 0) continue;
      boards_[at].state.reset();
      boards_[at].missing.clear();
    }
    const auto is_open = [&](const Board& b) {
      return std::ranges::any_of(open, [&](std::size_t at) { return &boards_[at] == &b; });
    };
    ask(Command::kMissing, is_open, [](const Board& b) { return b.state.has_value(); }, 1);
    // A board that was silent before is asked only once per round, so that a dead board does not delay the others.
    const auto waits = [&](std::size_t at) { return !complete(boards_[at]) && boards_[at].silent_rounds == 0; };
    if (std::ranges::none_of(open, waits)) break;
  }
}

bool UpdateSession::still_needs(Board& b, MissingUnits& missing) {
  b.silent_rounds = b.state ? 0 : b.silent_rounds + 1;
  if (b.silent_rounds > 0 && b.silent_rounds < kSilentRounds) return true;
  expect_answer(b, "receiving");
  if (!b.under_way) return false;
  const int slot = free_slot(b);
  bool any = !complete(b);
  for (const std::uint16_t u : b.missing) {
    if (erased(slot, u)) continue;
    missing[static_cast<std::size_t>(slot)].insert(u);
    any = true;
  }
  if (any && rounds_ >= kMaxRounds)
    give_up(b, UpdateOutcome::kGivenUp, "loses too many frames; check its cable and termination");
  return any && b.under_way;
}

void UpdateSession::check() {
  if (!any_under_way()) return;
  send_to_all(Command::kCheck);
  report_to_all("checking", 1.0);
  listen(bus_.now_us() + kBetweenPolls_us);
  poll_until([](const Board& b) { return b.state && b.state->phase == Phase::kReady; }, kCheckPatience_us,
             Command::kCheck, Phase::kReceiving, "checking");
}

void UpdateSession::begin() {
  ask_all();
  wait_for_another();
  look_for_silent();
  for (Board& b : boards_) decide(b);
  if (any_under_way()) join();
}

void UpdateSession::transfer() {
  if (!any_under_way()) return;
  erase();
  send_image();
  send_missing();
  check();
}

bool UpdateSession::any_refused() const {
  return std::ranges::any_of(
      boards_, [](const Board& b) { return b.result.outcome == UpdateOutcome::kRefused && !b.under_way; });
}

bool UpdateSession::started(const Board& b) const {
  return b.who && b.image && b.state && b.state->session == 0 && b.who->running_slot != b.result.slot && equal(b);
}

void UpdateSession::activate() {
  if (!any_under_way()) return;
  const session::Bus::Uninterrupted together(bus_);  // An interruption must not leave only some of them sent.
  send_to_all(Command::kActivate);
  listen(bus_.now_us() + kStarts_us);
  const std::uint64_t until_us = bus_.now_us() + kStartPatience_us;
  const auto open = [&](const Board& b) { return b.under_way && !started(b); };
  while (bus_.now_us() < until_us) {
    for (Board& b : boards_) {
      if (!open(b)) continue;
      b.who.reset();
      b.image.reset();
      b.state.reset();
    }
    ask(Command::kAsk, open, [](const Board& b) { return b.who && b.image && b.state; }, 1);
    if (std::ranges::none_of(boards_, open)) break;
    if (std::ranges::any_of(boards_,
                            [&](const Board& b) { return open(b) && b.state && b.state->phase == Phase::kReady; }))
      send_to_all(Command::kActivate);
    listen(bus_.now_us() + kBetweenPolls_us);
  }
  for (Board& b : boards_) {
    if (b.under_way) conclude(b);
  }
  abandon();
}

void UpdateSession::conclude(Board& b) {
  if (!started(b))
    return give_up(b, UpdateOutcome::kGivenUp, "has not started the new firmware; look at it with triskin discover");
  b.under_way = false;
  b.result.outcome = UpdateOutcome::kUpdated;
  b.result.slot = b.who->running_slot;
  b.result.bytes = package_.image(b.result.slot).size();
}

void UpdateSession::hold_back(const std::string& why) {
  for (Board& b : boards_) {
    if (b.under_way) give_up(b, UpdateOutcome::kHeldBack, why);
  }
  abandon();
}

void UpdateSession::abandon() noexcept {
  try {
    send_to_all(Command::kEnd);
  } catch (...) {  // If the link is dead, the boards end the session by themselves.
  }
}

std::vector<BoardUpdate> UpdateSession::take_boards() {
  std::vector<BoardUpdate> out;
  for (Board& b : boards_) out.push_back(std::move(b.result));
  return out;
}

}  // namespace triskin::deploy
