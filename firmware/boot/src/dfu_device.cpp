// SPDX-License-Identifier: Apache-2.0
#include "triskin/boot/dfu_device.hpp"

#include <algorithm>

namespace triskin::boot {
namespace {

constexpr std::uint8_t kClassOut = 0x21, kClassIn = 0xA1;
constexpr std::uint8_t kDetach = 0, kDownload = 1, kUpload = 2, kGetStatus = 3, kClearStatus = 4, kGetState = 5,
                       kAbort = 6;
// A block of 1 KB takes 10.5 ms to program, and every second one needs an erase of 22 ms (DS12288). All of this is over
// when the host may ask for the status again. The commit reads the image twice.
constexpr std::uint8_t kPoll_ms = 35;
constexpr std::size_t kUnit = 8;

}  // namespace

std::optional<Bytes> DfuDevice::control(const wire::UsbSetup& s, Bytes data) {
  heard_ = true;
  if (s.type == kClassOut && s.index == 0) {
    switch (s.request) {
      case kDetach:
        leave_ = true;
        return Bytes{};
      case kDownload:
        return download(s, data);
      case kClearStatus:
      case kAbort:
        state_ = State::kIdle;
        error_ = Error::kNone;
        at_ = 0;
        return Bytes{};
      default:
        return fail(Error::kStalled);
    }
  }
  if (s.type == kClassIn && s.index == 0) {
    if (s.request == kGetStatus) return status();
    if (s.request == kGetState) {
      reply_[0] = static_cast<std::uint8_t>(state_);
      return Bytes(reply_).first(1);
    }
    return s.request == kUpload ? fail(Error::kStalled) : std::nullopt;
  }
  return control_.handle(s);
}

std::optional<Bytes> DfuDevice::fail(Error error) {
  state_ = State::kError;
  error_ = error;
  return std::nullopt;
}

// A stalled download makes the host ask for the status, which contains the reason.
std::optional<Bytes> DfuDevice::download(const wire::UsbSetup& s, Bytes data) {
  if (state_ != State::kIdle && state_ != State::kDownloadIdle) return fail(Error::kStalled);
  if (s.length == 0) {
    if (state_ != State::kDownloadIdle) return fail(Error::kStalled);
    state_ = State::kManifestSync;
    return Bytes{};
  }
  if (data.size() != s.length) return fail(Error::kStalled);
  if (state_ == State::kIdle) at_ = 0;
  if (const Error error = take(data); error != Error::kNone) return fail(error);
  state_ = State::kDownloadSync;
  return Bytes{};
}

DfuDevice::Error DfuDevice::begin(Bytes head) {
  const auto decoded = layout::decode_package_head(head);
  if (!decoded) return Error::kFile;
  committed_ = false;
  head_ = *decoded;
  slot_ = slots_.choose() == 0 ? 1 : 0;
  erased_pages_ = 0;
  return slots_.erase_page(slot_, slots_.records(slot_)) ? Error::kNone : Error::kErase;
}

// Pages are erased as the image grows, because an erase of the whole slot would delay one control transfer by 2.6 s,
// and hosts give up after five.
DfuDevice::Error DfuDevice::erase_up_to(std::size_t end) {
  for (; erased_pages_ * slots_.page_bytes() < end; ++erased_pages_) {
    if (!slots_.erase_page(slot_, erased_pages_ * slots_.page_bytes())) return Error::kErase;
  }
  return Error::kNone;
}

// Takes the bytes of the package in order and stores only the image for the free slot. Bytes after the package (the
// suffix) are ignored.
DfuDevice::Error DfuDevice::take(Bytes data) {
  if (at_ == 0) {
    if (const Error error = begin(data); error != Error::kNone) return error;
  }
  const std::uint32_t first = head_.offset(slot_), end = first + head_.size_bytes[static_cast<std::size_t>(slot_)];
  const std::uint32_t from = std::max(at_, first), to = std::min(at_ + static_cast<std::uint32_t>(data.size()), end);
  if (from < to) {
    if (const Error error = erase_up_to(to - first); error != Error::kNone) return error;
  }
  for (std::uint32_t p = from; p < to; p += kUnit) {
    if (p % kUnit != 0 || p + kUnit > at_ + data.size()) return Error::kFile;  // Blocks must be multiples of a unit.
    if (slots_.program(slot_, p - first, data.subspan(p - at_, kUnit)) != Status::kOk) return Error::kWrite;
  }
  at_ += static_cast<std::uint32_t>(data.size());
  return Error::kNone;
}

DfuDevice::Error DfuDevice::manifest() {
  if (at_ < head_.total()) return Error::kNotDone;
  const auto k = static_cast<std::size_t>(slot_);
  switch (slots_.commit(slot_, head_.size_bytes[k], head_.crc[k])) {
    case Status::kOk:
      return Error::kNone;
    case Status::kFlashFailed:
      return Error::kWrite;
    case Status::kWrongTarget:
      return Error::kTarget;
    default:
      return Error::kFirmware;
  }
}

Bytes DfuDevice::status() {
  if (state_ == State::kDownloadSync)
    state_ = State::kDownloadIdle;
  else if (state_ == State::kManifestSync) {
    error_ = manifest();
    committed_ = error_ == Error::kNone;
    state_ = committed_ ? State::kIdle : State::kError;
    at_ = 0;
  }
  reply_ = {static_cast<std::uint8_t>(error_), kPoll_ms, 0, 0, static_cast<std::uint8_t>(state_), 0};
  return reply_;
}

void DfuDevice::tick(std::uint64_t now_us) {
  if (heard_) last_us_ = now_us;
  heard_ = false;
  if (!stays() && now_us >= last_us_ + patience_us()) leave_ = true;
}

}  // namespace triskin::boot
