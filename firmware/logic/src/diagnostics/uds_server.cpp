// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/diagnostics/uds_server.hpp"

#include <algorithm>

namespace triskin::fw {

using namespace wire;

namespace {

constexpr std::uint8_t kDone = 0;  // The value stands for "no negative response".
constexpr std::uint8_t kSuppress = 0x80;
constexpr int kMaxWrongKeys = 3;

std::uint8_t nrc_of(Status s) {
  switch (s) {
    case Status::kOk:
      return kDone;
    case Status::kFlashFailed:
      return nrc::kProgrammingFailure;
    case Status::kEmpty:
      return nrc::kConditionsNotCorrect;
    default:
      return nrc::kOutOfRange;
  }
}

}  // namespace

Bytes UdsServer::handle(Bytes request, bool functional) {
  if (request.empty()) return {};
  last_request_us_ = host_.now_us();
  suppress_ = false;
  ByteWriter out(response_);
  out.u8(static_cast<std::uint8_t>(request[0] + service::kPositive));
  const std::uint8_t code = dispatch(request, out);
  if (code == kDone) return suppress_ ? Bytes{} : out.written();
  // A functional request goes to all controllers, so one that cannot serve it stays silent (ISO 14229-1, 7.5).
  const bool silent = code == nrc::kServiceNotSupported || code == nrc::kSubFunctionNotSupported ||
                      code == nrc::kOutOfRange || code == nrc::kSubFunctionNotInSession ||
                      code == nrc::kServiceNotInSession;
  if (functional && silent) return {};
  ByteWriter negative(response_);
  negative.u8(service::kNegative);
  negative.u8(request[0]);
  negative.u8(code);
  return negative.written();
}

void UdsServer::restart() {
  leave_session();
  seed_ = 0;
  wrong_keys_ = 0;
  locked_until_us_ = 0;
}

void UdsServer::tick() {
  if (session_ != Session::kDefault && host_.now_us() - last_request_us_ > kS3_us) leave_session();
}

void UdsServer::leave_session() {
  session_ = Session::kDefault;
  unlocked_ = false;
  transfer_ = Transfer::kNone;
}

std::uint8_t UdsServer::dispatch(Bytes request, Out& out) {
  switch (request[0]) {
    case service::kSession:
      return session_control(request, out);
    case service::kReset:
      return reset(request, out);
    case service::kClearFaults:
      return clear(request, out);
    case service::kReadFaults:
      return faults(request, out);
    case service::kRead:
      return read(request, out);
    case service::kSecurity:
      return security(request, out);
    case service::kWrite:
      return write(request, out);
    case service::kRoutine:
      return routine(request, out);
    case service::kDownload:
      return begin_transfer(request, true, out);
    case service::kUpload:
      return begin_transfer(request, false, out);
    case service::kTransfer:
      return transfer(request, out);
    case service::kTransferExit:
      return transfer_exit(request, out);
    case service::kTesterPresent:
      return tester_present(request, out);
    default:
      return nrc::kServiceNotSupported;
  }
}

std::uint8_t UdsServer::session_control(Bytes request, Out& out) {
  if (request.size() != 2) return nrc::kWrongLength;
  const auto wanted = to_session(request[1] & 0x7F);
  if (!wanted) return nrc::kSubFunctionNotSupported;
  suppress_ = (request[1] & kSuppress) != 0;
  leave_session();
  session_ = *wanted;
  out.u8(wire_number(session_));
  out.be16(static_cast<std::uint16_t>(kP2_us / 1000));
  out.be16(static_cast<std::uint16_t>(kP2Star_us / 10'000));  // ISO 14229 counts this time in 10 ms.
  return kDone;
}

std::uint8_t UdsServer::reset(Bytes request, Out& out) {
  if (request.size() != 2) return nrc::kWrongLength;
  const std::uint8_t kind = request[1] & 0x7F;
  if (kind != 0x01 && kind != 0x03) return nrc::kSubFunctionNotSupported;
  suppress_ = (request[1] & kSuppress) != 0;
  host_.request_reset();
  out.u8(kind);
  return kDone;
}

std::uint8_t UdsServer::read(Bytes request, Out& out) {
  if (request.size() < 3 || request.size() % 2 == 0) return nrc::kWrongLength;
  bool any = false;
  for (ByteReader r(request.subspan(1)); !r.rest().empty();) {
    const std::uint16_t did = r.be16();
    std::array<std::uint8_t, kMaxResponse> value{};
    ByteWriter w(value);
    if (did == did::kActiveSession)
      ActiveSession{session_}.encode(w);
    else if (!host_.read_identifier(did, w))
      continue;
    any = true;
    out.be16(did);
    out.bytes(w.written());
  }
  if (!out.ok()) return 0x14;  // The response is too long.
  return any ? kDone : nrc::kOutOfRange;
}

std::uint8_t UdsServer::need_unlocked() const {
  if (session_ == Session::kDefault) return nrc::kServiceNotInSession;
  return unlocked_ ? kDone : nrc::kSecurityDenied;
}

std::uint8_t UdsServer::write(Bytes request, Out& out) {
  if (request.size() < 4) return nrc::kWrongLength;
  if (const std::uint8_t code = need_unlocked(); code != kDone) return code;
  const auto did = static_cast<std::uint16_t>(request[1] << 8 | request[2]);
  if (const std::uint8_t code = nrc_of(host_.write_identifier(did, request.subspan(3))); code != kDone) return code;
  out.be16(did);
  return kDone;
}

std::uint8_t UdsServer::security(Bytes request, Out& out) {
  if (request.size() < 2) return nrc::kWrongLength;
  if (session_ == Session::kDefault) return nrc::kServiceNotInSession;
  if (request[1] == 0x01) {
    if (request.size() != 2) return nrc::kWrongLength;
    if (host_.now_us() < locked_until_us_) return nrc::kKeysLocked;
    // The seed stays the same until a key was tried: a tester whose answer was lost asks again, and either answer is
    // right.
    if (seed_ == 0) seed_ = static_cast<std::uint32_t>(host_.now_us()) * 2654435761U + ++seed_count_;
    if (seed_ == 0) seed_ = 1;
    out.u8(0x01);
    out.be32(unlocked_ ? 0 : seed_);
    return kDone;
  }
  if (request[1] != 0x02) return nrc::kSubFunctionNotSupported;
  if (request.size() != 6) return nrc::kWrongLength;
  if (seed_ == 0) return nrc::kSequenceError;
  const std::uint32_t key = ByteReader(request.subspan(2)).be32();
  const bool right = key == security_key(seed_);
  seed_ = 0;
  if (!right) {
    if (++wrong_keys_ < kMaxWrongKeys) return nrc::kInvalidKey;
    wrong_keys_ = 0;
    locked_until_us_ = host_.now_us() + kKeyLock_us;
    return nrc::kAttemptsExceeded;
  }
  wrong_keys_ = 0;
  unlocked_ = true;
  out.u8(0x02);
  return kDone;
}

std::uint8_t UdsServer::routine(Bytes request, Out& out) {
  if (request.size() < 4) return nrc::kWrongLength;
  const auto id = static_cast<std::uint16_t>(request[2] << 8 | request[3]);
  const std::uint8_t kind = request[1] & 0x7F;
  suppress_ = (request[1] & kSuppress) != 0;
  out.u8(kind);
  out.be16(id);
  if (kind == 0x03) return nrc_of(host_.routine_result(id, out));
  if (kind != 0x01) return nrc::kSubFunctionNotSupported;
  if (id != routine::kActivate && id != routine::kProtectLoader)
    return nrc_of(host_.start_routine(id, request.subspan(4), out));
  if (const std::uint8_t code = need_unlocked(); code != kDone) return code;
  // The result byte carries the reason, so that the host can name it.
  const Status s = host_.start_routine(id, request.subspan(4), out);
  ActivationResult{s}.encode(out);
  return kDone;
}

std::uint8_t UdsServer::faults(Bytes request, Out& out) {
  if (request.size() < 2) return nrc::kWrongLength;
  const std::uint8_t kind = request[1] & 0x7F;
  suppress_ = (request[1] & kSuppress) != 0;
  out.u8(kind);
  if (kind == 0x04) {  // The request asks for freeze data of one code, record 1 or all.
    if (request.size() != 6) return nrc::kWrongLength;
    const std::uint32_t dtc = ByteReader(request.subspan(1)).be32() & 0xFFFFFF;
    const bool known = (request[5] == 0x01 || request[5] == 0xFF) && host_.read_fault(dtc, out);
    return known ? kDone : nrc::kOutOfRange;
  }
  if (kind != 0x02) return nrc::kSubFunctionNotSupported;  // Only the report by status mask is supported.
  if (request.size() != 3) return nrc::kWrongLength;
  out.u8(fault_status::kAvailable);
  host_.read_faults(request[2], out);
  return kDone;
}

std::uint8_t UdsServer::clear(Bytes request, Out&) {
  if (request.size() != 4) return nrc::kWrongLength;
  // Only all groups at once can be cleared.
  if (request[1] != 0xFF || request[2] != 0xFF || request[3] != 0xFF) return nrc::kOutOfRange;
  return nrc_of(host_.clear_faults());
}

// Services 0x34 and 0x35 have data format 0, and address and length of 4 bytes each.
std::uint8_t UdsServer::begin_transfer(Bytes request, bool download, Out& out) {
  if (request.size() != 11) return nrc::kWrongLength;
  if (request[1] != 0x00 || request[2] != 0x44) return nrc::kOutOfRange;
  if (download) {
    if (const std::uint8_t code = need_unlocked(); code != kDone) return code;
  }
  ByteReader r(request.subspan(3));
  const std::uint32_t address = r.be32(), size = r.be32();
  transfer_ = Transfer::kNone;
  if (download) {
    if (address != memory::kInactiveTable || size == 0 || size > layout::kMaxImageBytes) return nrc::kOutOfRange;
    tables_.begin_download(size);
    transfer_ = Transfer::kDownload;
  } else {
    upload_ = address == memory::kActiveTable ? tables_.active_bytes() : Bytes{};
    if (upload_.empty() || size != upload_.size()) return nrc::kOutOfRange;
    upload_at_ = 0;
    transfer_ = Transfer::kUpload;
  }
  block_ = 0;
  out.u8(0x20);
  out.be16(memory::kMaxBlockBytes);
  return kDone;
}

std::uint8_t UdsServer::transfer(Bytes request, Out& out) {
  if (request.size() < 2) return nrc::kWrongLength;
  if (transfer_ == Transfer::kNone) return nrc::kSequenceError;
  const auto next = static_cast<std::uint8_t>(block_ + 1);
  constexpr std::size_t kData = memory::kMaxBlockBytes - 2U;
  out.u8(request[1]);
  if (transfer_ == Transfer::kDownload) {
    // Our answer was lost, and the block has already been stored.
    if (request[1] == block_ && block_ != 0) return kDone;
    if (request[1] != next) return nrc::kWrongBlock;
    if (request.size() == 2 || request.size() > kData + 2) return nrc::kWrongLength;
    if (tables_.append(request.subspan(2)) != Status::kOk) return nrc::kOutOfRange;
    block_ = next;
    return kDone;
  }
  if (request.size() != 2) return nrc::kWrongLength;
  if (request[1] == next) {
    if (upload_at_ >= upload_.size()) return nrc::kSequenceError;
    block_ = next;
    upload_at_ += std::min(kData, upload_.size() - upload_at_);
  } else if (request[1] != block_ || block_ == 0) {
    return nrc::kWrongBlock;
  }
  const std::size_t start = (upload_at_ - 1) / kData * kData;  // The block that ends at upload_at_ starts here.
  out.bytes(upload_.subspan(start, upload_at_ - start));
  return kDone;
}

std::uint8_t UdsServer::transfer_exit(Bytes request, Out&) {
  if (request.size() != 1) return nrc::kWrongLength;
  if (transfer_ == Transfer::kNone) return nrc::kSequenceError;
  if (transfer_ == Transfer::kDownload && !tables_.downloaded()) return nrc::kSequenceError;
  transfer_ = Transfer::kNone;
  return kDone;
}

std::uint8_t UdsServer::tester_present(Bytes request, Out& out) {
  if (request.size() != 2) return nrc::kWrongLength;
  if ((request[1] & 0x7F) != 0) return nrc::kSubFunctionNotSupported;
  suppress_ = (request[1] & kSuppress) != 0;
  out.u8(0);
  return kDone;
}

}  // namespace triskin::fw
