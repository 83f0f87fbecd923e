// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/tcp_link.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include "resolved_host.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/core/bytes.hpp"

namespace triskin::hardware {

HostPort parse_host_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  HostPort result;
  if (colon != std::string::npos) {
    result.host = text.substr(0, colon);
    const bool is_bracketed = result.host.starts_with('[') && result.host.ends_with(']');
    if (is_bracketed) result.host = result.host.substr(1, result.host.size() - 2);
    if (!is_bracketed && result.host.find(':') != std::string::npos)
      throw InputError(fmt::format("\"{}\": an IPv6 address stands in brackets, for example [::1]:7000", text));
    const char* first = text.data() + colon + 1;
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(first, last, result.port);
    if (error == std::errc{} && end == last && !result.host.empty()) return result;
  }
  throw InputError(fmt::format("\"{}\" is no HOST:PORT, for example 127.0.0.1:7000 or [::1]:7000", text));
}

std::string host_port_text(const HostPort& at) {
  const bool is_ipv6 = at.host.find(':') != std::string::npos;
  return is_ipv6 ? fmt::format("[{}]:{}", at.host, at.port) : fmt::format("{}:{}", at.host, at.port);
}

namespace {
constexpr const char* kOtherProgram = "does the port belong to another program, or a tunnel lead to another port?";
}  // namespace

namespace record {
namespace {
constexpr std::uint32_t kExtended = 1U << 31, kFd = 1U << 30, kRateSwitch = 1U << 29, kIdMask = 0x1FFFFFFF;
}

void put(std::vector<std::uint8_t>& out, std::uint8_t kind, std::span<const std::uint8_t> contents) {
  std::array<std::uint8_t, 5> head{};
  ByteWriter w(head);
  w.le32(static_cast<std::uint32_t>(contents.size() + 1));
  w.u8(kind);
  out.insert(out.end(), head.begin(), head.end());
  out.insert(out.end(), contents.begin(), contents.end());
}

void put_frame(std::vector<std::uint8_t>& out, const wire::CanFrame& frame) {
  std::array<std::uint8_t, 68> contents{};
  ByteWriter w(contents);
  w.le32(frame.id | (frame.extended ? kExtended : 0) | (frame.fd ? kFd : 0) |
         (frame.bit_rate_switch ? kRateSwitch : 0));
  w.bytes(frame.payload());
  put(out, kCanFrame, w.written());
}

std::optional<Record> take(std::vector<std::uint8_t>& in) {
  constexpr std::size_t kLengthBytes = 4;
  if (in.size() < kLengthBytes) return std::nullopt;
  const std::size_t length = ByteReader(in).le32();
  if (length < 1 || length > kMaxBytes)
    throw DeviceError(fmt::format("the other side is not a Triskin simulation of this release; {}", kOtherProgram));
  if (in.size() < kLengthBytes + length) return std::nullopt;
  const auto end = in.begin() + static_cast<std::ptrdiff_t>(kLengthBytes + length);
  Record r{in[kLengthBytes], {in.begin() + kLengthBytes + 1, end}};
  in.erase(in.begin(), end);
  return r;
}

wire::CanFrame frame_of(const Record& r) {
  wire::CanFrame f;
  if (r.contents.size() < 4 || r.contents.size() > 4 + f.data.size())
    throw DeviceError("a record of the simulation is not a frame");
  const std::uint32_t head = ByteReader(r.contents).le32();
  f.extended = (head & kExtended) != 0;
  f.fd = (head & kFd) != 0;
  f.bit_rate_switch = (head & kRateSwitch) != 0;
  f.id = head & kIdMask;
  f.size = static_cast<std::uint8_t>(r.contents.size() - 4);
  if ((!f.extended && f.id > 0x7FF) || (!f.fd && f.size > 8))
    throw DeviceError("a record of the simulation is not a frame");
  std::copy(r.contents.begin() + 4, r.contents.end(), f.data.begin());
  return f;
}

}  // namespace record

namespace {

constexpr std::chrono::milliseconds kConnectTime{5'000}, kWriteTime{2'000}, kInterruptLook{100};

// Waits for `events` until `end`, or until the process is asked to end; returns false if they did not occur.
bool wait_for(int socket, short events, std::chrono::steady_clock::time_point end) {
  using std::chrono::milliseconds;
  while (!interrupt_request()) {
    const auto left = std::chrono::ceil<milliseconds>(end - std::chrono::steady_clock::now());
    if (left <= milliseconds{0}) return false;
    pollfd p{socket, events, 0};
    if (::poll(&p, 1, static_cast<int>(std::min(left, kInterruptLook).count())) > 0) return true;
  }
  return false;
}

// Returns 0 or the errno of the failure.
int connect_in_time(int socket, const addrinfo& to) {
  if (::connect(socket, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS && errno != EINTR) return errno;
  if (!wait_for(socket, POLLOUT, std::chrono::steady_clock::now() + kConnectTime))
    return interrupt_request() ? EINTR : ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

}  // namespace

TcpLink::TcpLink(const HostPort& to) : name_("sim:" + host_port_text(to)) {
  if (to.port == 0)
    throw InputError(name_ +
                     ": port 0 stands for a free port in --listen alone; give the one that simulate has printed");
  const ResolvedHost found = resolve(to, 0, name_);
  int error = 0;
  for (const addrinfo* a = found.get(); a != nullptr && socket_ < 0; a = a->ai_next) {
    socket_ = ::socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol);
    error = socket_ < 0 ? errno : connect_in_time(socket_, *a);
    if (error == 0) break;
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  if (socket_ < 0)
    fail(fmt::format("cannot connect: {}; start triskin simulate SCENE --listen {}", std::strerror(error),
                     host_port_text(to)));
  const int on = 1;
  (void)::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

TcpLink::~TcpLink() {
  if (socket_ >= 0) ::close(socket_);
}

void TcpLink::fail(const std::string& what) const {
  throw DeviceError(name_ + ": " + what);
}

std::uint64_t TcpLink::now_us() const {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_).count());
}

void TcpLink::write_all(const std::vector<std::uint8_t>& bytes) {
  std::size_t done = 0;
  const auto end = std::chrono::steady_clock::now() + kWriteTime;
  while (done < bytes.size()) {
    const ssize_t n = ::send(socket_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) {
      if (wait_for(socket_, POLLOUT, end)) continue;
      if (interrupt_request()) throw Cancelled(name_ + ": ended on request");
      fail(fmt::format("the simulation has taken nothing for {} s; end it and start it again",
                       std::chrono::duration_cast<std::chrono::seconds>(kWriteTime).count()));
    }
    if (n <= 0) fail("the simulation has ended the connection");
    done += static_cast<std::size_t>(n);
  }
}

void TcpLink::send(const wire::CanFrame& frame) {
  std::vector<std::uint8_t> bytes;
  record::put_frame(bytes, frame);
  write_all(bytes);
}

void TcpLink::press(layout::ModuleId module) {
  send_press(module, record::kWholeModule);
}

void TcpLink::press(layout::TaxelId taxel) {
  send_press(taxel.module, static_cast<std::uint8_t>(taxel.taxel));
}

void TcpLink::send_press(layout::ModuleId module, std::uint8_t pad) {
  std::array<std::uint8_t, 5> contents{};
  ByteWriter w(contents);
  w.le32(static_cast<std::uint32_t>(module));
  w.u8(pad);
  std::vector<std::uint8_t> bytes;
  record::put(bytes, record::kPress, contents);
  write_all(bytes);
}

void TcpLink::lift() {
  std::vector<std::uint8_t> bytes;
  record::put(bytes, record::kLift, {});
  write_all(bytes);
}

void TcpLink::pressurize(layout::ModuleId module, double kpa) {
  constexpr double kPaPerKpa = 1000.0;
  std::array<std::uint8_t, 8> contents{};
  ByteWriter w(contents);
  w.le32(module < 0 ? record::kAllModules : static_cast<std::uint32_t>(module));
  w.le32(static_cast<std::uint32_t>(std::lround(kpa * kPaPerKpa)));
  std::vector<std::uint8_t> bytes;
  record::put(bytes, record::kPressure, contents);
  write_all(bytes);
}

std::optional<wire::CanFrame> TcpLink::receive(std::uint64_t until_us) {
  // The deadline also applies while records other than frames arrive, however fast.
  for (bool is_over = false;; is_over = now_us() >= until_us) {
    if (auto frame = frame_received()) return frame;
    if (is_over) return std::nullopt;
    const std::uint64_t now = now_us();
    const std::uint64_t left_us = until_us > now ? until_us - now : 0;
    constexpr std::uint64_t kLook_us = 100'000;
    pollfd p{socket_, POLLIN, 0};
    const int ready = ::poll(&p, 1, static_cast<int>((std::min(left_us, kLook_us) + 999) / 1000));
    if (ready > 0) read_chunk();
    if (interrupt_request() && ready <= 0) return std::nullopt;
  }
}

std::optional<wire::CanFrame> TcpLink::frame_received() {
  try {
    while (const auto r = record::take(in_)) {
      if (r->kind == record::kCanFrame) return record::frame_of(*r);
      ByteReader reader(r->contents);
      const wire::BitRates rates{reader.le32(), reader.le32()};
      if (r->kind != record::kBitRates || !reader.ok()) continue;
      rates_ = rates;
      has_greeted_ = true;
    }
  } catch (const DeviceError& e) {
    fail(e.what());
  }
  return std::nullopt;
}

std::string TcpLink::when_silent() const {
  return has_greeted_ ? "a Triskin simulation is there: does its scene take the power of all boards?"
                      : fmt::format("what listens there says nothing that triskin simulate says; {}", kOtherProgram);
}

void TcpLink::read_chunk() {
  std::array<std::uint8_t, 16'384> chunk{};
  const ssize_t n = ::recv(socket_, chunk.data(), chunk.size(), 0);
  if (n < 0 && (errno == EINTR || errno == EAGAIN)) return;
  if (n <= 0)
    fail(has_greeted_ ? "the simulation has ended the connection"
                      : fmt::format("the other side has ended the connection; {}", kOtherProgram));
  in_.insert(in_.end(), chunk.begin(), chunk.begin() + n);
}

}  // namespace triskin::hardware
