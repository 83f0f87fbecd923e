// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/bus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "triskin/base/interrupt.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::session {

using wire::IsoTp;

namespace {

static_assert(wire::kKeyLock_us == 10'000'000, "reason() says 10 s");

const char* reason(std::uint8_t code) {
  switch (code) {
    case wire::nrc::kServiceNotSupported:
      return "service not supported";
    case wire::nrc::kSubFunctionNotSupported:
      return "sub-function not supported";
    case wire::nrc::kWrongLength:
      return "wrong message length";
    case wire::nrc::kConditionsNotCorrect:
      return "conditions not correct";
    case wire::nrc::kSequenceError:
      return "request out of sequence";
    case wire::nrc::kOutOfRange:
      return "request out of range";
    case wire::nrc::kSecurityDenied:
      return "security access denied";
    case wire::nrc::kInvalidKey:
      return "invalid key";
    case wire::nrc::kAttemptsExceeded:
    case wire::nrc::kKeysLocked:
      return "it got three wrong keys and takes none for 10 s; wait, then run the command again";
    case wire::nrc::kUploadNotAccepted:
      return "transfer not accepted";
    case wire::nrc::kProgrammingFailure:
      return "programming failure: the flash memory refused the data";
    case wire::nrc::kWrongBlock:
      return "wrong block counter";
    case wire::nrc::kSubFunctionNotInSession:
    case wire::nrc::kServiceNotInSession:
      return "not in this session";
    default:
      return "refused";
  }
}

// A positive answer repeats the identifier of the request, so a late answer to an earlier request of the same service
// can be told apart.
bool answers(Bytes answer, Bytes request) {
  if (answer[0] != request[0] + wire::service::kPositive) return false;
  std::size_t repeated = 1;
  switch (request[0]) {
    case wire::service::kRead:
    case wire::service::kWrite:
      repeated = 2;
      break;
    case wire::service::kRoutine:
      repeated = 3;
      break;
    case wire::service::kClearFaults:
    case wire::service::kDownload:
    case wire::service::kUpload:
    case wire::service::kTransferExit:
      repeated = 0;
      break;
    default:
      break;  // The answer repeats the sub-function or the block counter.
  }
  return answer.size() > repeated && request.size() > repeated &&
         std::ranges::equal(answer.subspan(1, repeated), request.subspan(1, repeated));
}

bool is_answer_id(const wire::CanFrame& frame) {
  return frame.extended && (frame.id & 0x1FFF0000U) == wire::kPhysicalBase;
}

}  // namespace

IsoTp& Bus::connection(std::uint8_t node) {
  auto& found = connections_[node];
  if (!found) {
    found = std::make_unique<IsoTp>(wire::physical_id(node, wire::kTesterAddress),
                                    wire::physical_id(wire::kTesterAddress, node), link_.frame_bytes());
  }
  return *found;
}

void Bus::transmit(IsoTp& c) {
  while (const auto frame = c.transmit(link_.now_us())) link_.send(*frame);
}

// Receives frames until one completes a message of this connection, the transfer fails, or the deadline is reached.
IsoTp::Event Bus::receive_for(IsoTp& c, std::uint64_t deadline_us) {
  while (true) {
    transmit(c);
    const std::uint64_t now_us = link_.now_us();
    if (const IsoTp::Event event = c.tick(now_us); event == IsoTp::Event::kFailed) return event;
    if (now_us >= deadline_us) return IsoTp::Event::kNone;
    const auto frame = receive(std::min(deadline_us, std::max(c.next_event_us(), now_us)));
    if (!frame) continue;
    if (frame->extended && frame->id == c.rx_id()) {
      const IsoTp::Event event = c.receive(*frame, link_.now_us());
      transmit(c);
      if (event == IsoTp::Event::kReceived || event == IsoTp::Event::kFailed) return event;
      // While a long message is being received, its own timeouts decide when it is late.
      if (c.next_event_us() != UINT64_MAX) deadline_us = std::max(deadline_us, link_.now_us() + IsoTp::kTimeout_us + 1);
    } else if (!is_answer_id(*frame) && on_stream_) {
      on_stream_(*frame);
    }
  }
}

// Discards answers that came too late for an earlier request.
void Bus::drain(std::uint8_t node) {
  connections_.erase(node);
  poll();
  const auto channel = channels_.find(node);
  const std::uint64_t end_us = link_.now_us() + kLongestDrain_us;
  Message late;
  while (channel != channels_.end() && channel->second &&
         channel->second->take(late) != link::MessageChannel::Arrival::kNothing && link_.now_us() < end_us) {
  }
}

bool Bus::start(std::uint8_t node, Bytes request) {
  auto& channel = channels_[node];
  if (!channel)
    channel = link_.open_channel(wire::physical_id(node, wire::kTesterAddress),
                                 wire::physical_id(wire::kTesterAddress, node));
  if (channel) return channel->send(request);
  if (connection(node).send(request, link_.now_us()) != Status::kOk)
    throw DeviceError("request longer than a transfer can be");
  return true;
}

Bus::Message Bus::next_of_channel(link::MessageChannel& channel, std::uint64_t deadline_us) {
  Message message;
  while (true) {
    end_on_request();
    switch (channel.take(message)) {
      case link::MessageChannel::Arrival::kMessage:
        return message;
      case link::MessageChannel::Arrival::kFailed:
        return {};
      case link::MessageChannel::Arrival::kNothing:
        break;
    }
    if (link_.now_us() >= deadline_us) return {};
    const auto frame = receive(deadline_us);
    if (frame && !is_answer_id(*frame) && on_stream_) on_stream_(*frame);
  }
}

Bus::Message Bus::next_message(std::uint8_t node, std::uint64_t deadline_us) {
  if (const auto& channel = channels_[node]) return next_of_channel(*channel, deadline_us);
  IsoTp& c = connection(node);
  if (receive_for(c, deadline_us) != IsoTp::Event::kReceived) return {};
  return {c.message().begin(), c.message().end()};
}

Bus::Message Bus::exchange(std::uint8_t node, Bytes request) {
  end_on_request();
  drain(node);
  std::uint64_t deadline_us = link_.now_us() + link_.answer_us();
  const std::uint64_t last_us = link_.now_us() + kLongestPending_us;
  if (!start(node, request)) {  // The kernel still has the previous request of this kind.
    channels_.erase(node);
    return {};
  }
  while (true) {
    Message answer = next_message(node, deadline_us);
    const bool is_late = link_.now_us() > std::max(deadline_us, last_us);
    if (answer.empty() || is_late) {
      channels_.erase(node);
      return {};
    }
    if (answer.size() == 3 && answer[0] == wire::service::kNegative && answer[1] == request[0]) {
      if (answer[2] == wire::nrc::kPending) {
        deadline_us = std::min(link_.now_us() + wire::kP2Star_us, last_us);
        continue;
      }
      return answer;
    }
    if (answers(answer, request)) return answer;
    // The answer belongs to another tester or to an earlier request, so waiting continues.
  }
}

Bus::Message Bus::request(std::uint8_t node, Bytes request, Repeat repeat) {
  const int attempts = repeat == Repeat::kSafe ? kRepeats : 1;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    Message answer = exchange(node, request);
    if (answer.empty()) continue;
    if (answer[0] == wire::service::kNegative) {
      throw Refused(fmt::format("{}: controller {} refused service 0x{:02X}: {} (0x{:02X})", link_.name(), node,
                                request[0], reason(answer[2]), answer[2]),
                    answer[2]);
    }
    answer.erase(answer.begin());
    return answer;
  }
  const std::string trouble = link_.trouble();
  throw NoAnswer(fmt::format(
      "{}: controller {} does not answer service 0x{:02X}; check its power and the cable, then run the command again{}",
      link_.name(), node, request[0], trouble.empty() ? "" : " (" + trouble + ")"));
}

bool Bus::ask_who_is_there(std::map<wire::UniqueId, wire::NodeClaim>& claims) {
  std::map<std::uint32_t, wire::IdFrames> partial;
  std::set<wire::UniqueId> heard;
  link_.send(wire::who_is_there());
  const std::uint64_t asked_us = link_.now_us();
  std::uint64_t until_us = asked_us + kClaimWindow_us;
  while (link_.now_us() < until_us) {
    const auto frame = receive(until_us);
    if (!frame || !wire::is_claim(*frame)) continue;
    // Many claims on a slow bus take long: as long as they arrive, more may follow.
    until_us = std::min(std::max(until_us, link_.now_us() + kClaimGap_us), asked_us + kLongestClaims_us);
    const auto joined = partial[frame->id].add(*frame);
    if (!joined || wire::claim_id(joined->unique_id) != frame->id) continue;
    if (const auto claim = wire::decode_claim(*joined)) {
      claims[claim->unique_id] = *claim;
      heard.insert(claim->unique_id);
    }
  }
  known_.insert(heard.begin(), heard.end());
  return heard.size() == known_.size();
}

std::vector<wire::NodeClaim> Bus::discover() {
  std::map<wire::UniqueId, wire::NodeClaim> found;
  bool all_heard = false;
  for (int round = 0; round < kMinClaimRounds || (round < kMaxClaimRounds && !all_heard); ++round)
    all_heard = ask_who_is_there(found);
  std::vector<wire::NodeClaim> claims;
  for (const auto& [id, claim] : found) claims.push_back(claim);
  return claims;
}

std::vector<wire::UniqueId> Bus::silent(std::span<const wire::NodeClaim> claims) const {
  std::vector<wire::UniqueId> silent;
  std::ranges::copy_if(known_, std::back_inserter(silent), [&](const wire::UniqueId& id) {
    return std::ranges::find(claims, id, &wire::NodeClaim::unique_id) == claims.end();
  });
  return silent;
}

void Bus::assign(const wire::UniqueId& id, std::uint8_t node_address) {
  for (const wire::CanFrame& frame : wire::encode_assignment(id, node_address)) link_.send(frame);
}

void Bus::end_on_request() const {
  if (held_ == 0 && interrupt_request()) throw Cancelled(link_.name() + ": ended on request");
}

std::optional<wire::CanFrame> Bus::receive(std::uint64_t until_us) {
  end_on_request();
  return link_.receive(std::min(until_us, link_.now_us() + kInterruptPoll_us));
}

void Bus::reconnect() {
  connections_.clear();
  channels_.clear();
  link_.reconnect();
}

// Frames may arrive faster than they are handled, so the time is limited.
void Bus::poll() {
  const std::uint64_t end_us = link_.now_us() + kLongestDrain_us;
  for (auto frame = link_.receive(link_.now_us()); frame; frame = link_.receive(link_.now_us())) {
    if (!is_answer_id(*frame) && on_stream_) on_stream_(*frame);
    if (link_.now_us() >= end_us) return;
  }
}

void Bus::listen(std::uint64_t until_us) {
  while (link_.now_us() < until_us) {
    const auto frame = receive(until_us);
    if (frame && !is_answer_id(*frame) && on_stream_) on_stream_(*frame);
  }
}

}  // namespace triskin::session
