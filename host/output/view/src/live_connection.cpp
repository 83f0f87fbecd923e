// SPDX-License-Identifier: GPL-3.0-or-later
#include "live_connection.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "messages.hpp"

namespace triskin::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using Clock = std::chrono::steady_clock;

// Sends one message at a time to the page. Meanwhile newer samples replace older ones in LatestSamples, so a slow page
// only gets fewer frames. A page that accepts nothing for `write_time` is disconnected.
class LiveConnection : public std::enable_shared_from_this<LiveConnection> {
 public:
  LiveConnection(beast::tcp_stream stream, Shared& shared, std::unique_ptr<Counted> counted)
      : shared_(shared),
        counted_(std::move(counted)),
        socket_(std::move(stream)),
        tick_(socket_.get_executor()),
        deadline_(socket_.get_executor()) {}

  void start(beast::http::request<beast::http::empty_body> request) {
    beast::error_code ignored;
    beast::get_lowest_layer(socket_).expires_never();
    beast::get_lowest_layer(socket_).socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    beast::get_lowest_layer(socket_).socket().set_option(
        asio::socket_base::send_buffer_size(shared_.limits.send_buffer_bytes), ignored);
    socket_.read_message_max(shared_.limits.message_bytes);
    socket_.set_option(
        websocket::stream_base::timeout{shared_.limits.request_time, websocket::stream_base::none(), false});
    request_ = std::move(request);
    socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->read();
      self->tick();
      self->shared_.had_page = true;
    });
  }

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->close();  // The page closed the connection, or a message exceeded the limit.
      self->take_message();
      self->read();
    });
  }

  void take_message() {
    const auto bytes = buffer_.cdata();
    const auto command = command_of({static_cast<const char*>(bytes.data()), bytes.size()});
    buffer_.consume(buffer_.size());
    if (command && socket_.got_text()) shared_.on_command(*command);
  }

  void tick() {
    if (closed_) return;
    if (!writing_) write_next();
    tick_.expires_after(shared_.limits.frame_interval);
    tick_.async_wait([self = shared_from_this()](beast::error_code error) {
      if (!error) self->tick();
    });
  }

  void write_next() {
    if (Clock::now() >= next_health_) {
      next_health_ = Clock::now() + shared_.limits.health_interval;
      return write(health_json(shared_.live.health()), true);
    }
    if (Clock::now() >= next_contacts_) {
      next_contacts_ = Clock::now() + LatestSamples::kContactsEvery;
      if (const auto contacts = shared_.live.contacts_since(seen_contacts_))
        return write(contacts_json(*contacts), true);
    }
    std::string frame = shared_.live.frame_since(seen_);
    if (!frame.empty()) write(std::move(frame), false);
  }

  void write(std::string message, bool text) {
    message_ = std::move(message);
    writing_ = true;
    deadline_.expires_after(shared_.limits.write_time);
    deadline_.async_wait([self = shared_from_this()](beast::error_code error) {
      if (!error) self->close();
    });
    socket_.text(text);
    socket_.async_write(asio::buffer(message_), [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->writing_ = false;
      self->deadline_.cancel();
      if (error) self->close();
    });
  }

  void close() {
    if (closed_) return;
    closed_ = true;
    tick_.cancel();
    deadline_.cancel();
    beast::get_lowest_layer(socket_).close();
  }

  Shared& shared_;
  std::unique_ptr<Counted> counted_;
  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer tick_, deadline_;
  beast::http::request<beast::http::empty_body> request_;
  beast::flat_buffer buffer_;
  std::string message_;
  std::uint64_t seen_ = 0, seen_contacts_ = 0;
  Clock::time_point next_health_{}, next_contacts_{};
  bool writing_ = false, closed_ = false;
};

}  // namespace

void serve_live(beast::tcp_stream stream, beast::http::request<beast::http::empty_body> request, Shared& shared,
                std::unique_ptr<Counted> counted) {
  std::make_shared<LiveConnection>(std::move(stream), shared, std::move(counted))->start(std::move(request));
}

}  // namespace triskin::view
