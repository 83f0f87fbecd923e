// SPDX-License-Identifier: GPL-3.0-or-later
// Tests who may read the page, and what a hostile or slow reader costs.
#include "triskin/view/server.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "output/view/browser.hpp"
#include "triskin/base/error.hpp"

namespace {

std::atomic<int> accepts_without_descriptor = 0;

}  // namespace

// Stands before that of the C library, and counts the attempts of the server for which the process had no descriptor
// left.
extern "C" int accept(int listener, sockaddr* peer, socklen_t* size) {
  static const auto next = reinterpret_cast<int (*)(int, sockaddr*, socklen_t*)>(::dlsym(RTLD_NEXT, "accept"));
  const int descriptor = next(listener, peer, size);
  if (descriptor < 0 && errno == EMFILE) ++accepts_without_descriptor;
  return descriptor;
}

namespace triskin::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using view::Command;
using view::LatestSamples;
using view::Server;

constexpr int kModules = 2570;

view::PressureSample sample_of(double below_rest_counts) {
  view::PressureSample sample{wire::ModuleState::kOk, layout::kAllTaxels, {}};
  sample.below_rest_counts.fill(below_rest_counts);
  return sample;
}

class ViewServer : public testing::Test {
 protected:
  explicit ViewServer(const Server::Limits& limits = {})
      : server_(
            {{"", {"text/html", "the page"}}, {"main.js", {"text/javascript", "code"}}}, live_, 0,
            [this](const Command& c) { take(c); }, limits) {}

  [[nodiscard]] std::string host() const { return fmt::format("127.0.0.1:{}", server_.port()); }
  [[nodiscard]] std::string path(const std::string& name) const { return fmt::format("/{}/{}", server_.token(), name); }
  [[nodiscard]] std::string ours() const { return fmt::format("Host: {}\r\n", host()); }
  // Returns the answer's header and body to a request with these header lines.
  [[nodiscard]] std::string ask(const std::string& first_line, const std::string& more) const {
    RawClient client(server_.port());
    client.send(fmt::format("{} HTTP/1.1\r\n{}Connection: close\r\n\r\n", first_line, more));
    return client.read(1 << 20);
  }
  [[nodiscard]] std::string get(const std::string& target) const { return ask(fmt::format("GET {}", target), ours()); }
  [[nodiscard]] std::string upgrade(const std::string& host, const std::string& origin) const {
    return fmt::format(
        "GET {} HTTP/1.1\r\nHost: {}\r\n{}Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        path("live"), host, origin.empty() ? "" : fmt::format("Origin: {}\r\n", origin));
  }
  [[nodiscard]] std::unique_ptr<RawClient> open_live(int receive_bytes = 0) const {
    auto client = std::make_unique<RawClient>(server_.port(), receive_bytes);
    client->send(upgrade(host(), fmt::format("http://{}", host())));
    EXPECT_THAT(client->read_to("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
    return client;
  }
  // Returns the next frame of the server; empty if it closed.
  static std::string next_message(RawClient& client) {
    const std::string head = client.read(2);
    if (head.size() < 2) return {};
    std::size_t size = static_cast<unsigned char>(head[1]);
    const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (more > 0) size = 0;
    for (const char c : client.read(more)) size = size << 8 | static_cast<unsigned char>(c);
    return client.read(size);
  }
  // Returns a message that arrived after a sample.
  std::string next_message_after_sample(RawClient& client) {
    fill_skin(1.0);
    return next_message(client);
  }
  void fill_skin(double below_rest_counts) {
    for (int k = 0; k < kModules; ++k) live_.add(layout::SkinModule{k}, sample_of(below_rest_counts), 1'000'000);
  }
  void take(const Command& command) {
    if (!got_command_) command_.set_value(command);
    got_command_ = true;
  }

  LatestSamples live_{kModules};
  std::promise<Command> command_;
  bool got_command_ = false;
  Server server_;
};

TEST_F(ViewServer, gives_the_page_to_who_has_the_token) {
  const std::string answer = get(path(""));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("\r\n\r\nthe page"));
  EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'"));
  EXPECT_THAT(answer, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(answer, HasSubstr("Cache-Control: no-store"));
  EXPECT_EQ(server_.address(), fmt::format("http://{}/{}/", host(), server_.token()));
}

TEST_F(ViewServer, has_a_new_token_each_time) {
  const Server other({}, live_, 0, [](const Command&) {}, {});
  EXPECT_EQ(other.token().size(), 32U);
  EXPECT_NE(other.token(), server_.token());
}

TEST_F(ViewServer, refuses_requests_without_the_token) {
  std::string wrong = server_.token();
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  const std::string token = server_.token();
  for (const std::string& target : {std::string("/"), std::string("/main.js"), fmt::format("/{}/", wrong),
                                    fmt::format("/{}", token), fmt::format("/?{}", token), fmt::format("//{}/", token),
                                    fmt::format("/{}x/", token), fmt::format("http://{}{}", host(), path(""))})
    EXPECT_THAT(get(target), StartsWith("HTTP/1.1 403")) << target;
}

TEST_F(ViewServer, has_no_paths_but_its_documents) {
  for (const char* name : {"../main.js", "./main.js", "%6dain.js", "main.js?x", "main.js/", "..%2f..%2fetc/passwd",
                           "/etc/passwd", "model.json", "main.js%00", "live"})
    EXPECT_THAT(get(path(name)), StartsWith("HTTP/1.1 404")) << name;
  EXPECT_THAT(get(path("main.js")), StartsWith("HTTP/1.1 200"));
}

TEST_F(ViewServer, refuses_another_host) {
  const std::string request = fmt::format("GET {}", path(""));
  for (const std::string& other :
       {std::string("evil.example"), fmt::format("evil.example:{}", server_.port()), std::string("127.0.0.1"),
        fmt::format("127.0.0.1.evil.example:{}", server_.port()), fmt::format("127.0.0.2:{}", server_.port())})
    EXPECT_THAT(ask(request, fmt::format("Host: {}\r\n", other)), StartsWith("HTTP/1.1 421")) << other;
  EXPECT_THAT(ask(request, ""), StartsWith("HTTP/1.1 421"));
  EXPECT_THAT(ask(request, fmt::format("{}Host: evil.example\r\n", ours())), StartsWith("HTTP/1.1 4"));
  EXPECT_THAT(ask(request, fmt::format("Host: localhost:{}\r\n", server_.port())), StartsWith("HTTP/1.1 200"));
}

TEST_F(ViewServer, refuses_another_origin) {
  const std::string request = fmt::format("GET {}", path(""));
  for (const char* other : {"http://evil.example", "https://127.0.0.1", "null", "http://127.0.0.1:1"})
    EXPECT_THAT(ask(request, fmt::format("{}Origin: {}\r\n", ours(), other)), StartsWith("HTTP/1.1 403")) << other;
  EXPECT_THAT(ask(request, fmt::format("{}Origin: http://{}\r\n", ours(), host())), StartsWith("HTTP/1.1 200"));
}

TEST_F(ViewServer, refuses_a_live_connection_of_another_origin_or_of_none) {
  for (const char* other : {"http://evil.example", "null", ""}) {
    RawClient client(server_.port());
    client.send(upgrade(host(), other));
    EXPECT_THAT(client.read(64), StartsWith("HTTP/1.1 403")) << other;
  }
  RawClient client(server_.port());
  client.send(upgrade(fmt::format("evil.example:{}", server_.port()), fmt::format("http://{}", host())));
  EXPECT_THAT(client.read(64), StartsWith("HTTP/1.1 421"));
}

TEST_F(ViewServer, takes_only_get_and_head_without_a_body) {
  EXPECT_THAT(ask(fmt::format("DELETE {}", path("")), ours()), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(ask(fmt::format("POST {}", path("")), ours() + "Content-Length: 5\r\n"), StartsWith("HTTP/1.1 413"));
  const std::string head = ask(fmt::format("HEAD {}", path("")), ours());
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
}

TEST_F(ViewServer, refuses_a_header_that_is_too_long) {
  EXPECT_THAT(ask(fmt::format("GET {}", path("")), fmt::format("{}X: {:x>20000}\r\n", ours(), "")),
              StartsWith("HTTP/1.1 431"));
}

TEST_F(ViewServer, closes_a_connection_that_speaks_no_http) {
  RawClient client(server_.port());
  client.send("\x16\x03\x01 this is no request\r\n\r\n");
  EXPECT_TRUE(client.is_closed_by_server());
}

TEST_F(ViewServer, sends_the_state_of_the_link_and_then_what_changed) {
  live_.set_health({"sim", true, "", 7, 2});
  const auto page = open_live();
  EXPECT_EQ(next_message(*page), R"({"frames":7,"link":"sim","live":true,"lost":2,"trouble":""})");
  live_.add(layout::SkinModule{5}, sample_of(-300), 2'000'000);
  std::string frame = next_message(*page);
  // This frame is older than the last sample.
  while (frame.size() == 48 && frame[24] == 0) frame = next_message(*page);
  ASSERT_EQ(frame.size(), LatestSamples::kHeaderBytes + LatestSamples::kRecordBytes);
  EXPECT_EQ(frame[2], 1);                                                  // The frame has one module.
  EXPECT_EQ(frame[16], 5);                                                 // The module is this one.
  EXPECT_EQ(static_cast<unsigned char>(frame[24]) | frame[25] << 8, 300);  // The value is its change.
}

TEST_F(ViewServer, SendsNewContactsOfAllCoversTheStrongestFirst) {
  live_.set_health({"sim", true, "", 0, 0});
  live_.set_contacts(0, {});  // Nothing in place of nothing is not told.
  const auto page = open_live();
  (void)next_message(*page);
  LatestSamples::Contact weak, strong;
  weak.taxels = {91, 92};
  weak.change_counts = 500.0;
  weak.force_n = weak.force_sd_n = std::numeric_limits<double>::quiet_NaN();
  strong.taxels = {3};
  strong.position_mm = {1.0, 2.0, 3.0};
  strong.change_counts = 900.0;
  strong.force_n = 2.0;
  live_.set_contacts(0, {weak});
  live_.set_contacts(1, {strong});
  const auto told = nlohmann::json::parse(next_message(*page)).at("contacts");
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].at("taxels"), nlohmann::json({3}));
  EXPECT_EQ(told[0].at("position_mm"), nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(told[0].at("force_n"), 2.0);
  EXPECT_EQ(told[1].at("taxels"), nlohmann::json({91, 92}));
  EXPECT_TRUE(told[1].at("force_n").is_null());
  live_.set_contacts(0, {});
  live_.set_contacts(1, {});
  EXPECT_TRUE(nlohmann::json::parse(next_message(*page)).at("contacts").empty());
}

TEST_F(ViewServer, hands_over_commands_of_the_page) {
  const auto page = open_live();
  page->send(masked_frame(1, R"({"do":"press","module":70000000,"taxel":-1})"));  // ignored
  page->send(masked_frame(1, R"({"do":"press","module":3})"));                    // ignored
  page->send(masked_frame(1, "[[[["));                                            // The server ignores this text.
  page->send(masked_frame(1, R"({"do":"press","module":3,"taxel":7})"));
  auto future = command_.get_future();
  ASSERT_EQ(future.wait_for(std::chrono::seconds(5)), std::future_status::ready);
  const Command command = future.get();
  EXPECT_EQ(command.kind, Command::Kind::kPress);
  EXPECT_EQ(command.module, 3);
  EXPECT_EQ(command.taxel, 7);
}

TEST_F(ViewServer, cuts_a_page_that_sends_an_oversized_message) {
  const auto page = open_live(), other = open_live();
  page->send(masked_frame(1, std::string(257, ' ')));
  EXPECT_TRUE(page->is_closed_by_server());
  EXPECT_FALSE(next_message(*other).empty());
}

class ImpatientServer : public ViewServer {
 protected:
  ImpatientServer() : ViewServer(limits()) {}
  static Server::Limits limits() {
    Server::Limits limits;
    limits.request_time = limits.write_time = std::chrono::milliseconds(300);
    limits.frame_interval = std::chrono::milliseconds(5);
    limits.health_interval = std::chrono::hours(1);
    limits.send_buffer_bytes = 4096;
    limits.connections = 4;
    limits.strangers = 5;
    return limits;
  }
};

TEST_F(ImpatientServer, cuts_a_slow_reader_while_others_read_on) {
  const auto slow = open_live(4096), quick = open_live();
  std::jthread skin([this](const std::stop_token& stop) {
    for (std::uint16_t value = 0; !stop.stop_requested(); ++value) {
      fill_skin(value);
      std::this_thread::yield();
    }
  });
  // The slow client reads nothing; the quick one gets whole frames all the time until the slow one is disconnected.
  int frames = 0;
  while (server_.connections() > 1 && frames < 2000) {
    const std::string message = next_message(*quick);
    ASSERT_FALSE(message.empty());
    ++frames;
  }
  EXPECT_EQ(server_.connections(), 1U);
  EXPECT_GT(frames, 3);
  EXPECT_FALSE(next_message(*quick).empty());
}

TEST_F(ImpatientServer, cuts_a_request_that_never_ends) {
  RawClient client(server_.port());
  client.send("GET /");
  EXPECT_TRUE(client.is_closed_by_server());
}

TEST_F(ImpatientServer, refuses_pages_beyond_its_number) {
  const auto a = open_live(), b = open_live(), c = open_live(), d = open_live();
  EXPECT_THAT(get(path("")), StartsWith("HTTP/1.1 503"));
  EXPECT_FALSE(next_message_after_sample(*a).empty()) << "the others are not disturbed";
}

// Any user of the computer can connect. A user who opens connections and sends nothing must not keep out the one who
// has the token.
TEST_F(ImpatientServer, who_has_no_token_does_not_keep_out_who_has_it) {
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int k = 0; k < 200; ++k) {
    idle.push_back(std::make_unique<RawClient>(server_.port()));
    if (k % 10 > 0) continue;
    EXPECT_THAT(get(path("main.js")), StartsWith("HTTP/1.1 200")) << k << " idle connections";
  }
  EXPECT_LE(server_.connections(), 5U + 4U + 1U);
  const auto page = open_live();
  for (int k = 0; k < 20; ++k) idle.push_back(std::make_unique<RawClient>(server_.port()));
  EXPECT_FALSE(next_message_after_sample(*page).empty()) << "a page that is open stays";
}

TEST_F(ViewServer, refuses_a_request_with_two_origins) {
  const std::string ours_too = fmt::format("Origin: http://{}\r\n", host());
  EXPECT_THAT(ask("GET " + path(""), ours() + ours_too), StartsWith("HTTP/1.1 200"));
  for (const std::string& other : {ours_too + ours_too, ours_too + "Origin: http://evil.example\r\n",
                                   "Origin: http://evil.example\r\n" + ours_too})
    EXPECT_THAT(ask("GET " + path(""), ours() + other), StartsWith("HTTP/1.1 403"));
}

// Returns the resident memory of this process, bytes.
std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(ViewDocuments, are_shared_by_readers_that_are_slow) {
  constexpr std::size_t kBody_bytes = std::size_t{16} << 20;
  const LatestSamples live(1);
  const Server server({{"recording.bin", {"application/octet-stream", std::string(kBody_bytes, 'x')}}}, live, 0,
                      [](const Command&) {}, {});
  const std::size_t before = resident_bytes();
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int k = 0; k < 20; ++k) {
    slow.push_back(std::make_unique<RawClient>(server.port(), 4096));
    slow.back()->send(
        fmt::format("GET /{}/recording.bin HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", server.token(), server.port()));
    EXPECT_THAT(slow.back()->read_to("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_LT(resident_bytes(), before + 3 * kBody_bytes) << "twenty copies would be 320 MiB";
}

// Without file descriptors a waiting connection must not keep the server's thread busy: it tries again each 100 ms.
TEST(ViewWithoutDescriptors, rests) {
  const LatestSamples live(1);
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &old), 0);
  const Server server({{"", {"text/html", "the page"}}}, live, 0, [](const Command&) {}, {});
  const RawClient client(server.port());
  while (server.connections() == 0) std::this_thread::yield();
  rlimit few = old;
  few.rlim_cur = 128;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  std::vector<int> held;
  for (int fd = ::dup(0); fd >= 0; fd = ::dup(0)) held.push_back(fd);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(server.port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto before = std::chrono::steady_clock::now();
  ASSERT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  while (accepts_without_descriptor < 5) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto passed = std::chrono::steady_clock::now() - before;
  for (const int fd : held) ::close(fd);
  (void)::setrlimit(RLIMIT_NOFILE, &old);
  EXPECT_GE(passed, std::chrono::milliseconds(400)) << "four rests lie between five attempts";
  const RawClient later(server.port());
  while (server.connections() < 3) std::this_thread::yield();  // with descriptors it accepts again
  ::close(socket);
}

TEST(ViewPort, says_which_port_is_taken) {
  LatestSamples live(1);
  const Server first({}, live, 0, [](const Command&) {}, {});
  try {
    const Server second({}, live, first.port(), [](const Command&) {}, {});
    FAIL() << "two servers on one port";
  } catch (const DeviceError& e) {
    EXPECT_THAT(e.what(), HasSubstr(fmt::format("127.0.0.1:{}", first.port())));
    EXPECT_THAT(e.what(), HasSubstr("--port"));
  }
}

}  // namespace
}  // namespace triskin::test
