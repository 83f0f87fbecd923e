// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/frame_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>

#include "triskin/base/counted.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/image_update.hpp"
#include "triskin/wire/loader_protocol.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/stream_lease.hpp"
#include "triskin/wire/taxel_frames.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::session {
namespace {

using Span = std::span<const std::uint8_t>;

struct Named {
  unsigned value;
  const char* name;
};
constexpr std::array kServices{Named{wire::service::kSession, "session"},
                               Named{wire::service::kReset, "reset"},
                               Named{wire::service::kClearFaults, "clear faults"},
                               Named{wire::service::kReadFaults, "read faults"},
                               Named{wire::service::kRead, "read"},
                               Named{wire::service::kSecurity, "security access"},
                               Named{wire::service::kWrite, "write"},
                               Named{wire::service::kRoutine, "routine"},
                               Named{wire::service::kDownload, "download"},
                               Named{wire::service::kUpload, "upload"},
                               Named{wire::service::kTransfer, "transfer data"},
                               Named{wire::service::kTransferExit, "transfer exit"},
                               Named{wire::service::kTesterPresent, "tester present"}};
constexpr std::array kRefusals{Named{wire::nrc::kServiceNotSupported, "service not supported"},
                               Named{wire::nrc::kSubFunctionNotSupported, "sub-function not supported"},
                               Named{wire::nrc::kWrongLength, "wrong length"},
                               Named{wire::nrc::kConditionsNotCorrect, "conditions not correct"},
                               Named{wire::nrc::kSequenceError, "sequence error"},
                               Named{wire::nrc::kOutOfRange, "out of range"},
                               Named{wire::nrc::kSecurityDenied, "security access denied"},
                               Named{wire::nrc::kInvalidKey, "invalid key"},
                               Named{wire::nrc::kAttemptsExceeded, "too many attempts"},
                               Named{wire::nrc::kKeysLocked, "keys are locked"},
                               Named{wire::nrc::kUploadNotAccepted, "upload or download not accepted"},
                               Named{wire::nrc::kProgrammingFailure, "programming failure"},
                               Named{wire::nrc::kWrongBlock, "wrong block counter"},
                               Named{wire::nrc::kPending, "pending: the answer follows"},
                               Named{wire::nrc::kSubFunctionNotInSession, "sub-function not in this session"},
                               Named{wire::nrc::kServiceNotInSession, "service not in this session"}};

template <class Names>
std::string name_in(const Names& names, unsigned value) {
  const auto found = std::ranges::find(names, value, &Named::value);
  return found == names.end() ? fmt::format("{:02X}", value) : found->name;
}

// Names the identifier or routine of a request or an answer.
std::string about(unsigned service, Span rest) {
  const std::size_t skip = service == wire::service::kRoutine ? 1 : 0;
  const bool has_id = service == wire::service::kRead || service == wire::service::kWrite || skip == 1;
  if (!has_id || rest.size() < skip + 2) return {};
  return fmt::format(" {:02X}{:02X}", rest[skip], rest[skip + 1]);
}

std::string message_text(Span bytes) {
  if (bytes.empty()) return "empty message";
  const unsigned first = bytes[0];
  const std::string size = bytes.size() > 8 ? fmt::format(", {}", counted(bytes.size(), "byte")) : "";
  if (first == wire::service::kNegative && bytes.size() >= 3)
    return fmt::format("{} refused: {}", name_in(kServices, bytes[1]), name_in(kRefusals, bytes[2]));
  const unsigned service = first & ~unsigned{wire::service::kPositive};
  const bool positive = (first & wire::service::kPositive) != 0;
  return fmt::format("{}{}{}{}", name_in(kServices, service), about(service, bytes.subspan(1)),
                     positive ? ": done" : "", size);
}

std::string parties(std::uint32_t id) {
  const unsigned target = id >> 8 & 0xFF, source = id & 0xFF;
  if (id == wire::kFunctionalId) return "request to all: ";
  return source == wire::kTesterAddress ? fmt::format("request to {}: ", target)
                                        : fmt::format("answer of {}: ", source);
}

// Formats half of a unique id; the second frame also contains a node address.
std::string id_text(const wire::CanFrame& f) {
  if (f.size != 8 || f.data[0] > 1) return "damaged";
  const bool second = f.data[0] == 1;
  const Span part = f.payload().subspan(1, second ? 5 : 7);
  return fmt::format("unique id {}{:02X}{}", second ? "…" : "", fmt::join(part, ""), second ? "" : "…");
}

std::string claim_text(const wire::CanFrame& f) {
  if (f.size == 8 && f.data[0] <= 1) {
    const std::string text = id_text(f);
    if (f.data[0] == 0) return "claim: " + text;
    return fmt::format("claim: {}, node address {}, {}", text, f.data[6], f.data[7] != 0 ? "has a table" : "no table");
  }
  return "a controller says how its update stands";
}

std::string assignment_text(const wire::CanFrame& f) {
  if (f.size == 0) return "damaged";
  const std::string text = id_text(f);
  return f.data[0] == 1 ? fmt::format("assignment: {} gets node address {}", text, f.data[6]) : "assignment: " + text;
}

std::string lease_text(const wire::CanFrame& f) {
  const auto lease = wire::decode_lease(f);
  if (!lease) return "lease: damaged";
  if (lease->lasts_10ms == 0) return fmt::format("lease of reader {:08X} ends", lease->reader);
  return fmt::format("lease of reader {:08X}: {} ms, every {}. sample", lease->reader, 10 * lease->lasts_10ms,
                     lease->every);
}

std::string sample_text(const wire::CanFrame& f) {
  const unsigned node = f.id >> 8 & 0xFF, row = f.id & 0xFF;
  const auto sample = wire::decode_full(f);
  if (!sample) return fmt::format("sample of controller {}, row {}: damaged", node, row);
  return fmt::format("sample {} of controller {}, row {}: {}", sample->sample, node, row,
                     fmt::join(sample->value, " "));
}

std::string loader_text(const wire::CanFrame& f) {
  const unsigned command = f.size > 0 ? f.data[0] : 0U;
  if (f.id == wire::loader::kRequestId) return fmt::format("loader: request {}", command);
  if (f.id == wire::loader::kReplyId) return fmt::format("loader: reply to {}", command);
  return "loader: data of an image";
}

std::string update_text(const wire::CanFrame& f) {
  if (f.id == wire::update::kCommandId) return fmt::format("update: command {}", f.size > 0 ? f.data[0] : 0U);
  return fmt::format("update: data for slot {}, unit {}", f.id >> 16 & 1, f.id & 0xFFFF);
}

// Identifiers of eleven bits belong to the iCub protocol.
std::string icub_text(const wire::CanFrame& f) {
  const unsigned kind = f.id >> 8, high = f.id >> 4 & 0xF, low = f.id & 0xF;
  if (kind == 4) return fmt::format("iCub taxels of board {}, triangle {}", high, low);
  if (kind == 2 || kind == 7) {
    const char* what = kind == 2 ? "iCub command" : "iCub loader command";
    return fmt::format("{} {:02X} from {} to {}", what, f.size > 0 ? f.data[0] : 0U, high, low);
  }
  return "not of Triskin";
}

std::string single_text(const wire::CanFrame& f) {
  if (f.id == wire::kWhoIsThereId) return "who is there?";
  if (f.id == wire::kAssignId) return assignment_text(f);
  if (f.id == wire::kLeaseId) return lease_text(f);
  if ((f.id & ~0xFFU) == wire::kReachBase)
    return fmt::format("controller {} says what it does not reach, and what it reads of others", f.id & 0xFF);
  if ((f.id & ~0xFFFFU) == wire::kFullBase) return sample_text(f);
  if (f.id == wire::loader::kRequestId || f.id == wire::loader::kDataId || f.id == wire::loader::kReplyId)
    return loader_text(f);
  if (f.id == wire::update::kCommandId || (f.id & wire::update::kDataMask) == wire::update::kDataBase)
    return update_text(f);
  return wire::is_claim(f) ? claim_text(f) : "not of Triskin";
}

}  // namespace

std::string bytes_text(const wire::CanFrame& f) {
  const std::string id = f.extended ? fmt::format("{:08X}", f.id) : fmt::format("     {:03X}", f.id);
  const std::string size = f.fd ? fmt::format("[{:02}]", f.size) : fmt::format(" [{}]", f.size);
  return fmt::format("{}  {}  {:02X}", id, size, fmt::join(f.payload(), " "));
}

std::string FrameReader::first_segment(const wire::CanFrame& f) {
  const Span bytes = f.payload();
  std::size_t size = (bytes[0] & 0xFU) << 8 | bytes[1], head = 2;
  if (size == 0 && bytes.size() >= 6) {
    size = std::size_t{bytes[2]} << 24 | std::size_t{bytes[3]} << 16 | std::size_t{bytes[4]} << 8 | bytes[5];
    head = 6;
  }
  messages_[f.id] = {{bytes.begin() + static_cast<std::ptrdiff_t>(head), bytes.end()}, size};
  return fmt::format("first part of {}, {}", counted(size, "byte"), message_text(bytes.subspan(head)));
}

std::string FrameReader::next_segment(const wire::CanFrame& f) {
  const auto found = messages_.find(f.id);
  if (found == messages_.end()) return "part of a message whose beginning was not seen";
  Message& m = found->second;
  m.bytes.insert(m.bytes.end(), f.data.begin() + 1, f.data.begin() + f.size);
  if (m.bytes.size() < m.size)
    return fmt::format("part {}, {} of {}", f.data[0] & 0xF, m.bytes.size(), counted(m.size, "byte"));
  m.bytes.resize(m.size);
  const std::string text = message_text(m.bytes);
  messages_.erase(found);
  return "whole: " + text;
}

// In ISO 15765-2, the upper half of the first byte is the kind of the frame.
std::string FrameReader::segment(const wire::CanFrame& f) {
  const Span bytes = f.payload();
  if (bytes.size() < 2) return "damaged";
  switch (bytes[0] >> 4) {
    case 0: {
      const std::size_t head = bytes[0] == 0 ? 2 : 1, size = bytes[0] == 0 ? bytes[1] : bytes[0];
      return size + head <= bytes.size() ? message_text(bytes.subspan(head, size)) : "damaged";
    }
    case 1:
      return first_segment(f);
    case 2:
      return next_segment(f);
    case 3:
      return bytes[0] == 0x30 ? "go on" : bytes[0] == 0x31 ? "wait" : "message too long";
    default:
      return "damaged";
  }
}

std::string FrameReader::text(const wire::CanFrame& f) {
  if (!f.extended) return icub_text(f);
  const bool diagnostic = f.id == wire::kFunctionalId || (f.id & 0x1FFF0000) == wire::kPhysicalBase;
  const bool ours = f.id == wire::kFunctionalId || (f.id & 0xFF) == wire::kTesterAddress ||
                    (f.id >> 8 & 0xFF) == wire::kTesterAddress;
  return diagnostic && ours ? parties(f.id) + segment(f) : single_text(f);
}

}  // namespace triskin::session
