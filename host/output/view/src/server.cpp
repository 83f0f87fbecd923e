// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/server.hpp"

#include <fmt/format.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <thread>

#include "connection.hpp"
#include "messages.hpp"
#include "triskin/base/error.hpp"
#include "triskin/view/page.hpp"

namespace triskin::view {

namespace asio = boost::asio;
using asio::ip::tcp;

struct Server::State {
  State(Site site, const LatestSamples& live, OnCommand on_command, const Limits& limits)
      : shared{std::move(site), live, std::move(on_command), limits, random_token()} {}

  void listen(std::uint16_t wanted);
  void accept();
  void accept_later();

  Shared shared;
  asio::io_context context{1};
  asio::steady_timer rest{context};
  tcp::acceptor acceptor{context};
  std::thread thread;
};

void Server::State::listen(std::uint16_t wanted) {
  const tcp::endpoint end(asio::ip::address_v4::loopback(), wanted);
  boost::system::error_code error;
  acceptor.open(end.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(end, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw DeviceError(fmt::format("127.0.0.1:{}: cannot serve the page ({}); choose another --port, 0 takes a free one",
                                  wanted, error.message()));
  shared.port = acceptor.local_endpoint().port();
}

void Server::State::accept() {
  acceptor.async_accept([this](const boost::system::error_code& error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) return accept_later();
    serve_http(std::move(socket), shared);
    accept();
  });
}

// Without a free file descriptor, a waiting connection would make the loop spin.
void Server::State::accept_later() {
  constexpr std::chrono::milliseconds kRest{100};
  rest.expires_after(kRest);
  rest.async_wait([this](const boost::system::error_code& error) {
    if (!error) accept();
  });
}

Server::Server(Site site, const LatestSamples& live, std::uint16_t port, OnCommand on_command, const Limits& limits)
    : state_(std::make_unique<State>(std::move(site), live, std::move(on_command), limits)) {
  state_->listen(port);
  state_->accept();
  state_->thread = std::thread([this] { state_->context.run(); });
}

Server::~Server() {
  state_->context.stop();
  state_->thread.join();
}

std::string Server::address() const {
  return fmt::format("http://127.0.0.1:{}/{}/", state_->shared.port, state_->shared.token);
}

std::uint16_t Server::port() const {
  return state_->shared.port;
}

std::string Server::token() const {
  return state_->shared.token;
}

bool Server::had_page() const {
  return state_->shared.had_page;
}

std::size_t Server::connections() const {
  return state_->shared.connections;
}

namespace {

// Returns the document with the names of all files that its scripts will ask for, so that the browser fetches them side
// by side instead of one after the other.
std::string with_preloads(std::string_view html) {
  std::string links = "<link rel=\"preload\" href=\"model.json\" as=\"fetch\" crossorigin=\"anonymous\">\n";
  for (const auto& [name, asset] : assets()) {
    if (name.ends_with(".js")) links += fmt::format("<link rel=\"modulepreload\" href=\"{}\">\n", name);
  }
  std::string document(html);
  return document.insert(document.find("</head>"), links);
}

}  // namespace

Site site_of(const design::Design& design, std::string track, const Notes& notes) {
  require_page();
  Site site;
  for (const auto& [name, asset] : assets()) {
    const bool is_document = name == "index.html";
    site[is_document ? "" : std::string(name)] = {std::string(asset.type),
                                                  is_document ? with_preloads(asset.bytes) : std::string(asset.bytes)};
  }
  site["model.json"] = {"application/json", model_json(design, !track.empty(), notes)};
  if (!track.empty()) site["recording.bin"] = {"application/octet-stream", std::move(track)};
  return site;
}

}  // namespace triskin::view
