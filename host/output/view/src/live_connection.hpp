// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <memory>

#include "connection.hpp"

namespace triskin::view {

/// Upgrades a connection to a WebSocket that carries frames of the skin to the page and commands back, until either
/// side closes it or the reader is too slow. `request` is the checked request to upgrade.
void serve_live(boost::beast::tcp_stream stream, boost::beast::http::request<boost::beast::http::empty_body> request,
                Shared& shared, std::unique_ptr<Counted> counted);

}  // namespace triskin::view
