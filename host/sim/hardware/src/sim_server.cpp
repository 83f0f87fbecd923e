// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/sim_server.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "triskin/base/error.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/hardware/listener.hpp"
#include "triskin/layout/patch_image.hpp"

namespace triskin::hardware {
namespace {

constexpr const char* kRefusal =
    "other computers could reach this address, and whoever reaches it may read, press and flash the simulated skin "
    "without a password; listen on 127.0.0.1, or say --expose";

}  // namespace

SimServer::SimServer(hardware::VirtualSkin& skin, const HostPort& at, Reach reach) : SkinServer(skin), host_(at.host) {
  const Listener listener = listen_at(at, reach == Reach::kOtherComputers ? "" : kRefusal);
  listener_ = listener.socket;
  port_ = listener.port;
  is_exposed_ = listener.is_exposed;
  skin_.on_frame([this](const wire::CanFrame& frame, std::uint64_t) {
    for (Client& c : clients_) record::put_frame(c.out, frame);
  });
}

SimServer::~SimServer() {
  skin_.on_frame({});
  for (const Client& c : clients_) ::close(c.socket);
  ::close(listener_);
}

void SimServer::flush() {
  for (Client& c : clients_) write_client(c);
  drop_dead();
}

void SimServer::wait(std::uint64_t timeout_us) {
  // poll() skips a negative descriptor. When no descriptor is left for a client, one that waits must not keep a core
  // busy.
  const bool listens = std::chrono::steady_clock::now() >= listens_from_;
  std::vector<pollfd> sockets{{listens ? listener_ : -1, POLLIN, 0}};
  for (const Client& c : clients_)
    sockets.push_back({c.socket, static_cast<short>(POLLIN | (c.out.empty() ? 0 : POLLOUT)), 0});
  if (::poll(sockets.data(), sockets.size(), static_cast<int>(timeout_us / 1000)) <= 0) return;
  for (std::size_t k = 0; k < clients_.size(); ++k) {
    if ((sockets[k + 1].revents & (POLLIN | POLLHUP | POLLERR)) != 0) read_client(clients_[k]);
  }
  if ((sockets[0].revents & POLLIN) != 0) accept_client();
}

void SimServer::accept_client() {
  const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket < 0) {
    constexpr std::chrono::milliseconds kRest{100};
    if (errno != EAGAIN) listens_from_ = std::chrono::steady_clock::now() + kRest;
    return;
  }
  const int on = 1;
  (void)::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  clients_.push_back({socket, {}, {}, 0, false});
  std::array<std::uint8_t, 8> rates{};
  ByteWriter w(rates);
  w.le32(skin_.bit_rates().nominal);
  w.le32(skin_.bit_rates().data);
  record::put(clients_.back().out, record::kBitRates, rates);
}

void SimServer::read_client(Client& client) {
  std::array<std::uint8_t, 16'384> chunk{};
  const ssize_t n = ::recv(client.socket, chunk.data(), chunk.size(), 0);
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (n <= 0) {
    client.dead = true;
    return;
  }
  client.in.insert(client.in.end(), chunk.begin(), chunk.begin() + n);
  try {
    while (const auto r = record::take(client.in)) handle(client, *r);
  } catch (const DeviceError&) {
    client.dead = true;
  }
}

void SimServer::handle(Client& client, const record::Record& r) {
  if (r.kind == record::kCanFrame) {
    skin_.send(record::frame_of(r));
    return;
  }
  if (r.kind == record::kPressure) return pressurize(r);
  if (r.kind != record::kPress && r.kind != record::kLift) throw DeviceError("unknown record");
  if (client.touch != 0) skin_.release(client.touch);
  client.touch = 0;
  if (r.kind == record::kLift) return;
  ByteReader reader(r.contents);
  const std::uint32_t module = reader.le32();
  const std::uint8_t taxel = reader.u8();
  const bool whole = taxel == record::kWholeModule;
  if (!reader.ok() || module >= skin_.scene().design.layout.modules.size() ||
      (!whole && taxel >= layout::kTaxelsPerModule)) {
    throw DeviceError("no such module or taxel");
  }
  const layout::ModuleId id{module};
  client.touch = whole ? skin_.press_module(id) : skin_.press_taxel({id, layout::TaxelIndex{taxel}});
}

// The pressure remains when the client disconnects, because it stands for a bag around the skin and not for the
// client's finger.
void SimServer::pressurize(const record::Record& r) {
  constexpr double kKpaPerPa = 1e-3;
  ByteReader reader(r.contents);
  const std::uint32_t module = reader.le32(), pressure_pa = reader.le32();
  const bool all = module == record::kAllModules;
  if (!reader.ok() || (!all && module >= skin_.scene().design.layout.modules.size()))
    throw DeviceError("no such module");
  skin_.pressurize(all ? layout::ModuleId::none() : layout::ModuleId{module}, kKpaPerPa * pressure_pa);
}

void SimServer::write_client(Client& client) {
  while (!client.out.empty() && !client.dead) {
    const ssize_t n = ::send(client.socket, client.out.data(), client.out.size(), MSG_NOSIGNAL);
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (n <= 0)
      client.dead = true;
    else
      client.out.erase(client.out.begin(), client.out.begin() + n);
  }
  // A client that does not read must not stop the others.
  if (client.out.size() > kMaxBacklogBytes) client.dead = true;
}

void SimServer::drop_dead() {
  for (const Client& c : clients_) {
    if (!c.dead) continue;
    if (c.touch != 0) skin_.release(c.touch);
    ::close(c.socket);
  }
  std::erase_if(clients_, [](const Client& c) { return c.dead; });
}

}  // namespace triskin::hardware
