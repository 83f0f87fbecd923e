// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <optional>

#include "connection.hpp"
#include "live_connection.hpp"

namespace triskin::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using Request = http::request<http::empty_body>;
using Response = http::response<http::span_body<const char>>;

// All connections share the documents of the site, so answers to slow readers cost no copies.
struct Answer {
  Response response;
  std::string text;
  const std::string* document = nullptr;

  [[nodiscard]] const std::string& body() const { return document != nullptr ? *document : text; }
};

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

// Restricts a document to resources that came from this server.
void add_policy(Response& response, const Shared& shared) {
  response.set("Content-Security-Policy",
               fmt::format("default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self' "
                           "ws://127.0.0.1:{0} ws://localhost:{0}; base-uri 'none'; form-action 'none'; "
                           "frame-ancestors 'none'",
                           shared.port));
  response.set("X-Content-Type-Options", "nosniff");
  response.set("X-Frame-Options", "DENY");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set(http::field::cache_control, "no-store");
}

Answer make_answer(const Request& request, http::status status, const Shared& shared, std::string_view type) {
  Answer answer{Response(status, request.version()), {}, nullptr};
  answer.response.set(http::field::content_type, std::string(type));
  add_policy(answer.response, shared);
  answer.response.keep_alive(request.keep_alive() && status == http::status::ok);
  return answer;
}

Answer refusal(const Request& request, http::status status, const Shared& shared, std::string text) {
  Answer answer = make_answer(request, status, shared, "text/plain; charset=utf-8");
  answer.text = std::move(text) + "\n";
  return answer;
}

// Returns empty if the request may pass. A live connection must state its origin, as every browser does.
std::optional<Answer> refuse(const Request& request, const Shared& shared) {
  const Gate gate = shared.gate();
  if (request.count(http::field::host) != 1 || !gate.host_is_ours(view_of(request[http::field::host])))
    return refusal(request, http::status::misdirected_request, shared, "this server is 127.0.0.1 only");
  const std::size_t origins = request.count(http::field::origin);
  if ((origins > 0 || beast::websocket::is_upgrade(request)) &&
      (origins != 1 || !gate.origin_is_ours(view_of(request[http::field::origin]))))
    return refusal(request, http::status::forbidden, shared, "pages of another origin may not read the skin");
  if (!gate.name_of(view_of(request.target())))
    return refusal(request, http::status::forbidden, shared, "open the address that triskin view printed");
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return refusal(request, http::status::method_not_allowed, shared, "only GET and HEAD");
  return std::nullopt;
}

Answer answer(const Request& request, const Shared& shared) {
  const auto document = shared.site.find(*shared.gate().name_of(view_of(request.target())));
  if (document == shared.site.end()) return refusal(request, http::status::not_found, shared, "no such document");
  Answer answer = make_answer(request, http::status::ok, shared, document->second.type);
  answer.document = &document->second.body;
  return answer;
}

class HttpConnection : public Stranger, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::asio::ip::tcp::socket socket, Shared& shared)
      : shared_(shared), counted_(std::make_unique<Counted>(shared)), stream_(std::move(socket)) {}

  void drop() override {
    if (counted_ && !counted_->is_known()) stream_.close();
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(shared_.limits.header_bytes));
    parser_->body_limit(0);
    stream_.expires_after(shared_.limits.request_time);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_request(error); });
  }

 private:
  void on_request(beast::error_code error) {
    if (error) return refuse_malformed(error);
    const Request& request = parser_->get();
    const bool head = request.method() == http::verb::head;
    if (auto refused = refuse(request, shared_)) return write(std::move(*refused), head);
    if (!counted_->make_known())
      return write(refusal(request, http::status::service_unavailable, shared_, "too many pages are open; close one"),
                   head);
    const bool live =
        beast::websocket::is_upgrade(request) && shared_.gate().name_of(view_of(request.target())) == "live";
    if (live) return serve_live(std::move(stream_), parser_->release(), shared_, std::move(counted_));
    write(answer(request, shared_), head);
  }

  // A request that is too long or not HTTP gets one answer; time-outs and closed connections get none.
  void refuse_malformed(beast::error_code error) {
    if (error == http::error::header_limit)
      return write(refusal(Request{}, http::status::request_header_fields_too_large, shared_, "header too long"),
                   false);
    if (error == http::error::body_limit || error == http::error::unexpected_body)
      return write(refusal(Request{}, http::status::payload_too_large, shared_, "a request has no body here"), false);
    close();
  }

  void write(Answer answer, bool head) {
    answer_.emplace(std::move(answer));
    const std::string& body = answer_->body();
    answer_->response.body() = {body.data(), body.size()};
    answer_->response.prepare_payload();
    stream_.expires_after(shared_.limits.write_time);
    const auto done = [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error || !self->answer_->response.keep_alive()) return self->close();
      self->read();
    };
    serializer_.emplace(answer_->response);
    if (head) {
      http::async_write_header(stream_, *serializer_, done);
    } else {
      http::async_write(stream_, *serializer_, done);
    }
  }

  void close() {
    beast::error_code ignored;
    stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  }

  Shared& shared_;
  std::unique_ptr<Counted> counted_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Answer> answer_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
};

}  // namespace

void Shared::add_stranger(const std::shared_ptr<Stranger>& stranger) {
  std::erase_if(strangers, [](const auto& one) { return one.expired(); });
  for (; strangers.size() >= limits.strangers; strangers.pop_front()) {
    if (const auto oldest = strangers.front().lock()) oldest->drop();
  }
  strangers.push_back(stranger);
}

void serve_http(boost::asio::ip::tcp::socket socket, Shared& shared) {
  const auto connection = std::make_shared<HttpConnection>(std::move(socket), shared);
  shared.add_stranger(connection);
  connection->read();
}

}  // namespace triskin::view
