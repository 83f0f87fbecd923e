// SPDX-License-Identifier: Apache-2.0
#include "usb.hpp"

#include <algorithm>

#include "interrupt_timer.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/registers/usb.hpp"

namespace triskin::board {

using namespace usb_reg;

Stm32Usb usb;

namespace {

constexpr std::uint32_t kMasks = kTransferred | kReset | kSuspend | kWakeUp;
constexpr std::uint8_t kSetAddress = 5, kSetConfiguration = 9, kSetInterface = 11, kClearFeature = 1;
constexpr std::uint8_t kToDevice = 0, kToInterface = 1, kToEndpoint = 2;

// The packet memory begins with the table of buffers (eight bytes per end point), followed by 64 bytes for each.
constexpr std::uint32_t kBuffers = 64;
constexpr std::uint32_t send_buffer(std::size_t n) {
  return kBuffers + 128 * static_cast<std::uint32_t>(n);
}
constexpr std::uint32_t receive_buffer(std::size_t n) {
  return send_buffer(n) + 64;
}
volatile std::uint16_t& half(std::uint32_t offset) {
  return *reinterpret_cast<volatile std::uint16_t*>(kMemory + offset);
}
volatile std::uint16_t& descriptor(std::size_t n, std::uint32_t field) {
  return half(8 * static_cast<std::uint32_t>(n) + 2 * field);
}
constexpr std::uint32_t kSendAddress = 0, kSendCount = 1, kReceiveAddress = 2, kReceiveCount = 3;

// The status fields toggle where ones are written, the flags change only by zeros.
void set_status(std::size_t n, std::uint32_t mask, std::uint32_t wanted) {
  const Register r = endpoint(n);
  const std::uint32_t now = r.read();
  r.write((now & kPlain) | kReceived | kSent | ((now ^ wanted) & mask));
}
void receive_status(std::size_t n, std::uint32_t status) {
  set_status(n, kReceiveMask, status << kReceiveShift);
}
void send_status(std::size_t n, std::uint32_t status) {
  set_status(n, kSendMask, status << kSendShift);
}
void clear_flag(std::size_t n, std::uint32_t flag) {
  const Register r = endpoint(n);
  r.write((r.read() & kPlain) | ((kReceived | kSent) & ~flag));
}

void put_packet(std::size_t n, Bytes bytes) {
  for (std::uint32_t k = 0; k < bytes.size(); k += 2) {
    const unsigned high = k + 1 < bytes.size() ? bytes[k + 1] : 0U;
    half(send_buffer(n) + k) = static_cast<std::uint16_t>(bytes[k] | high << 8);
  }
  descriptor(n, kSendCount) = static_cast<std::uint16_t>(bytes.size());
  send_status(n, kValid);
}

std::size_t take_packet(std::size_t n, std::span<std::uint8_t, 64> out) {
  const std::size_t count = std::min<std::size_t>(descriptor(n, kReceiveCount) & kCountMask, out.size());
  for (std::uint32_t k = 0; k < count; k += 2) {
    const std::uint16_t two = half(receive_buffer(n) + k);
    out[k] = static_cast<std::uint8_t>(two);
    out[k + 1] = static_cast<std::uint8_t>(two >> 8);
  }
  return count;
}

void switch_supply_on() {
  if constexpr (pwr_reg::kUsbSupplyValid != 0) {
    rcc_reg::kApb1Enr1.set(rcc_reg::kPwr);
    (void)rcc_reg::kApb1Enr1.read();
    pwr_reg::kUsbSupply.set(pwr_reg::kUsbSupplyValid);
  }
}

void start_48_mhz() {
  rcc_reg::kCrrcr.set(rcc_reg::kHsi48On);
  while (!rcc_reg::kCrrcr.any(rcc_reg::kHsi48Ready)) {
  }
  rcc_reg::kApb1Enr1.set(rcc_reg::kCrs | rcc_reg::kUsb);  // CCIPR.CLK48SEL is HSI48 after a reset.
  (void)rcc_reg::kApb1Enr1.read();
  crs_reg::kCr.set(crs_reg::kEnable | crs_reg::kAutomatic);  // After a reset its source is the start of frame.
}

}  // namespace

void Stm32Usb::open(wire::UsbFunction& function, bool data_endpoints) {
  function_ = &function;
  data_endpoints_ = data_endpoints;
  switch_supply_on();
  start_48_mhz();
  kCntr.write(kForceReset);  // The block is powered and still in reset.
  for (const std::uint64_t until = microseconds() + 2;
       microseconds() < until;) {  // The transceiver needs 1 µs to start (data sheet).
  }
  kCntr.write(0);
  kIstr.write(0);
  kBtable.write(0);
  power_ = 0;
  kCntr.write(kMasks);
  core_reg::set_priority(kIrq, priority::kUsb);
  core_reg::enable_interrupt(kIrq);
  kBcdr.set(kPullUp);
}

void Stm32Usb::close() {
  kBcdr.clear(kPullUp);
  kCntr.write(kForceReset | kPowerDown);
  function_ = nullptr;
  pending_ = false;
}

void Stm32Usb::on_interrupt() {
  kCntr.write(power_);  // The device stays silent until the loop has served it.
  pending_ = true;
}

void Stm32Usb::open_endpoint(std::size_t n, bool in, bool out) {
  const Register r = endpoint(n);
  const std::uint32_t toggles = (in ? kSendToggle | kSendMask : 0) | (out ? kReceiveToggle | kReceiveMask : 0);
  const std::uint32_t wanted = (in ? kNak << kSendShift : 0) | (out ? kValid << kReceiveShift : 0);
  const std::uint32_t type = n == 0 ? kControl : n == 1 ? kInterrupt : kBulk;
  descriptor(n, kSendAddress) = static_cast<std::uint16_t>(send_buffer(n));
  descriptor(n, kReceiveAddress) = static_cast<std::uint16_t>(receive_buffer(n));
  descriptor(n, kReceiveCount) = static_cast<std::uint16_t>(kBlocksOf64);
  r.write(type | static_cast<std::uint32_t>(n) | kReceived | kSent | ((r.read() ^ wanted) & toggles));
  if (in) busy_[n] = false;
}

void Stm32Usb::reset() {
  stage_ = Stage::kIdle;
  address_ = 0;
  function_->reset();
  for (std::size_t n = 0; n < (data_endpoints_ ? kEndpoints : 1); ++n) {
    endpoint(n).write(0);  // Flags from before the reset are cleared here.
    open_endpoint(n, true, true);
  }
  kDaddr.write(kEnableFunction);
}

void Stm32Usb::serve() {
  if (function_ == nullptr || !pending_) return;
  pending_ = false;
  const std::uint32_t events = kIstr.read();
  kIstr.write(~(kReset | kSuspend | kWakeUp) | ~events);  // Writing a zero clears a flag.
  if ((events & kReset) != 0) reset();
  if ((events & kSuspend) != 0) power_ = kForceSuspend;
  if ((events & (kWakeUp | kReset)) != 0) power_ = 0;
  serve_control(endpoint(0).read());
  for (std::size_t n = 1; data_endpoints_ && n < kEndpoints; ++n) serve_data(n, endpoint(n).read());
  kCntr.write(kMasks | power_);
}

void Stm32Usb::serve_data(std::size_t n, std::uint32_t state) {
  if ((state & kSent) != 0) {
    clear_flag(n, kSent);
    busy_[n] = false;
  }
  if ((state & kReceived) == 0) return;
  std::array<std::uint8_t, kPacket> packet;
  const std::size_t count = take_packet(n, packet);
  clear_flag(n, kReceived);
  receive_status(n, kValid);
  function_->out(static_cast<std::uint8_t>(n), Bytes(packet).first(count));
}

void Stm32Usb::send() {
  if (function_ == nullptr || !data_endpoints_) return;
  for (std::size_t n = 1; n < kEndpoints; ++n) {
    if (busy_[n]) continue;
    const Bytes packet = function_->in(static_cast<std::uint8_t>(0x80 | n));
    if (packet.empty()) continue;
    busy_[n] = true;
    put_packet(n, packet);
  }
}

void Stm32Usb::stream() {
  if (function_ == nullptr || !data_endpoints_) return;
  for (std::size_t n = 1; n < kEndpoints; ++n) {
    if (!endpoint(n).any(kSent)) continue;
    clear_flag(n, kSent);
    busy_[n] = false;
  }
  send();
}

// A full packet takes 50 µs on the bus.
std::uint64_t Stm32Usb::stream_again_us() const {
  constexpr std::uint64_t kLook_us = 100;
  for (std::size_t n = 1; n < kEndpoints; ++n) {
    if (busy_[n]) return kLook_us;
  }
  return UINT64_MAX;
}

// Sent packets are handled before received ones, because a host begins the next stage only after that.
void Stm32Usb::serve_control(std::uint32_t state) {
  if ((state & kSent) != 0) {
    clear_flag(0, kSent);
    control_sent();
  }
  if ((state & kReceived) == 0) return;
  if ((state & kSetup) != 0) {
    std::array<std::uint8_t, kPacket> packet;
    const std::size_t count = take_packet(0, packet);
    clear_flag(0, kReceived);
    if (count == 8)
      begin(Bytes(packet).first(8));
    else
      stall();
    return;
  }
  control_received();
}

void Stm32Usb::begin(Bytes setup) {
  ByteReader r(setup);
  setup_.type = r.u8();
  setup_.request = r.u8();
  setup_.value = r.le16();
  setup_.index = r.le16();
  setup_.length = r.le16();
  received_ = 0;
  address_ = 0;
  if (setup_.to_host() || setup_.length == 0) return run();
  if (setup_.length > data_.size()) return stall();
  stage_ = Stage::kDataOut;
  receive_status(0, kValid);
}

void Stm32Usb::stall() {
  stage_ = Stage::kIdle;
  send_status(0, kStall);
  receive_status(0, kStall);
}

// The transfer is complete except for its answer.
void Stm32Usb::run() {
  const bool set_address = setup_.type == kToDevice && setup_.request == kSetAddress;
  std::optional<Bytes> result = Bytes{};
  if (set_address)
    address_ = static_cast<std::uint8_t>(setup_.value & 0x7F);
  else
    result = function_->control(setup_, Bytes(data_).first(received_));
  if (!result) return stall();
  if (data_endpoints_ && ((setup_.type == kToDevice && setup_.request == kSetConfiguration) ||
                          (setup_.type == kToInterface && setup_.request == kSetInterface))) {
    for (std::size_t n = 1; n < kEndpoints; ++n) open_endpoint(n, true, true);
  }
  if (data_endpoints_ && setup_.type == kToEndpoint && setup_.request == kClearFeature) {
    const std::size_t n = setup_.index & 0xF;
    const bool in = (setup_.index & 0x80) != 0;
    if (n > 0 && n < kEndpoints) open_endpoint(n, in, !in);
  }
  if (!setup_.to_host()) {
    stage_ = Stage::kStatusIn;
    return put_packet(0, {});
  }
  answer_ = result->first(std::min<std::size_t>(result->size(), setup_.length));
  short_packet_owed_ = answer_.size() < setup_.length && answer_.size() % kPacket == 0;
  stage_ = Stage::kDataIn;
  receive_status(0, kValid);  // A host may end the transfer early.
  answer();
}

void Stm32Usb::answer() {
  const std::size_t count = std::min(answer_.size(), kPacket);
  if (count < kPacket) short_packet_owed_ = false;
  put_packet(0, answer_.first(count));
  answer_ = answer_.subspan(count);
}

void Stm32Usb::control_sent() {
  if (stage_ == Stage::kDataIn && (!answer_.empty() || short_packet_owed_)) return answer();
  if (stage_ != Stage::kStatusIn) return;
  stage_ = Stage::kIdle;
  if (address_ != 0) kDaddr.write(kEnableFunction | address_);
  address_ = 0;
}

void Stm32Usb::control_received() {
  std::array<std::uint8_t, kPacket> packet;
  const std::size_t count = take_packet(0, packet);
  clear_flag(0, kReceived);
  if (stage_ != Stage::kDataOut) {  // This is the host's status stage.
    stage_ = Stage::kIdle;
    return;
  }
  const std::size_t room = setup_.length - received_;
  std::copy_n(packet.begin(), std::min(count, room), data_.begin() + static_cast<std::ptrdiff_t>(received_));
  received_ += std::min(count, room);
  if (received_ == setup_.length || count < kPacket) return run();
  receive_status(0, kValid);
}

}  // namespace triskin::board

extern "C" void usb_handler() {
  const triskin::board::InterruptTimer timer;
  triskin::board::usb.on_interrupt();
}
