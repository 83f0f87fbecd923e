// SPDX-License-Identifier: GPL-3.0-or-later
// The other side of a link sends without a pause, sends nonsense, or takes nothing: deadlines must hold, and the first
// Ctrl-C must end the command.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <ctime>
#include <functional>
#include <thread>

#include "guarantees/faulty_program.hpp"
#include "support/strip_design.hpp"
#include "triskin/hardware/sim_server.hpp"
#include "triskin/hardware/tcp_link.hpp"
#include "triskin/wire/taxel_frames.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::test {
namespace {

using hardware::TcpLink;
namespace record = hardware::record;

// Accepts connections on 127.0.0.1 and gives each the same bytes again and again.
class HostileServer {
 public:
  explicit HostileServer(std::vector<std::uint8_t> bytes, bool reads = true)
      : bytes_(std::move(bytes)), reads_(reads), listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    const int small = 4096;
    if (!reads_) (void)::setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 || ::listen(listener_, 8) != 0 ||
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) != 0)
      throw std::runtime_error("cannot listen");
    port_ = ntohs(at.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  ~HostileServer() {
    thread_.request_stop();
    thread_.join();
    ::close(listener_);
  }
  HostileServer(const HostileServer&) = delete;
  HostileServer& operator=(const HostileServer&) = delete;

  [[nodiscard]] std::string link() const { return fmt::format("sim:127.0.0.1:{}", port_); }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::uint64_t sent_bytes() const { return sent_; }

 private:
  void serve(const std::stop_token& stop) {
    std::vector<int> clients;
    std::vector<std::uint8_t> swallowed(1 << 16);
    while (!stop.stop_requested()) {
      pollfd p{listener_, POLLIN, 0};
      if (::poll(&p, 1, clients.empty() ? 20 : 0) > 0) clients.push_back(::accept(listener_, nullptr, nullptr));
      for (const int client : clients) {
        if (reads_) (void)::recv(client, swallowed.data(), swallowed.size(), MSG_DONTWAIT);
        if (bytes_.empty()) continue;
        const ssize_t n = ::send(client, bytes_.data(), bytes_.size(), MSG_NOSIGNAL | (reads_ ? 0 : MSG_DONTWAIT));
        if (n > 0) sent_ += static_cast<std::uint64_t>(n);
      }
      if (bytes_.empty()) ::usleep(5'000);
    }
    for (const int client : clients) ::close(client);
  }

  std::vector<std::uint8_t> bytes_;
  bool reads_;
  int listener_;
  std::uint16_t port_ = 0;
  std::atomic<std::uint64_t> sent_ = 0;
  std::jthread thread_;
};

// Returns whole records only, so that a repetition begins with a record.
std::vector<std::uint8_t> many(const std::function<void(std::vector<std::uint8_t>&)>& put_one) {
  std::vector<std::uint8_t> bytes;
  while (bytes.size() < 60'000) put_one(bytes);
  return bytes;
}
std::vector<std::uint8_t> bit_rates_without_end() {
  return many(
      [](std::vector<std::uint8_t>& out) { record::put(out, record::kBitRates, std::vector<std::uint8_t>(8)); });
}
std::vector<std::uint8_t> frames_without_end(std::uint32_t id) {
  return many([id](std::vector<std::uint8_t>& out) {
    wire::CanFrame f;
    f.id = id;
    f.extended = true;
    f.size = 8;
    record::put_frame(out, f);
  });
}

class Deaf : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    design::write_design(folder_ / "strip.json", strip(4, 4));
  }
};

TEST(TcpLinkDeadline, holds_while_records_come_that_are_no_frames) {
  const HostileServer server(bit_rates_without_end());
  TcpLink link({"127.0.0.1", server.port()});
  const std::uint64_t end_us = link.now_us() + 200'000;
  EXPECT_FALSE(link.receive(end_us));
  EXPECT_GE(link.now_us(), end_us);
}

TEST(TcpLinkDeadline, a_server_that_takes_nothing_ends_the_link_and_not_the_patience) {
  const HostileServer server({}, false);
  TcpLink link({"127.0.0.1", server.port()});
  wire::CanFrame frame;
  frame.size = 8;
  try {
    for (int k = 0; k < 10'000'000; ++k) link.send(frame);
    FAIL() << "the kernel kept 100 MB";
  } catch (const DeviceError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("has taken nothing for 2 s"));
  }
}

// The flood has unexpected frames, samples, and answers of a controller that was not asked.
TEST_F(Deaf, the_first_ctrl_c_ends_every_command_in_a_flood) {
  for (const std::uint32_t id : {0x123U, wire::kFullBase | 0x0100U, wire::physical_id(wire::kTesterAddress, 1)}) {
    const HostileServer server(frames_without_end(id));
    for (const char* command : {"discover", "verify strip.json", "live strip.json --json",
                                "record strip.json -o r.mcap", "flash strip.json", "view strip.json --no-open"}) {
      const std::uint64_t before = server.sent_bytes();
      Running program(line(fmt::format("{} --link {}", command, server.link())), folder_ / "log");
      (void)wait_until([&] {
        return server.sent_bytes() > before + 300'000 || program.text().find("triskin: ") != std::string::npos;
      });
      program.signal(SIGINT);
      EXPECT_TRUE(program.ends()) << command << " is deaf to Ctrl-C while frames 0x" << std::hex << id << " come\n"
                                  << program.text();
    }
  }
}

TEST_F(Deaf, ctrl_c_ends_commands_on_a_link_that_is_silent) {
  const HostileServer server({});
  for (const char* command :
       {"discover", "verify strip.json", "live strip.json --json", "flash strip.json --wait-s 100"}) {
    Running program(line(fmt::format("{} --link {}", command, server.link())), folder_ / "log");
    ::usleep(300'000);
    program.signal(SIGINT);
    EXPECT_TRUE(program.ends()) << command;
  }
}

// The peers are a web server that waits for a request, a shell server, one that hangs up, and one that sends bytes.
TEST_F(Deaf, a_port_of_another_program_is_called_that) {
  const auto bytes_of = [](std::string_view text) { return std::vector<std::uint8_t>(text.begin(), text.end()); };
  const auto answer_of = [&](const std::string& link) {
    const Outcome o = run("discover --link " + link);
    EXPECT_EQ(o.status, 3);
    EXPECT_THAT(o.messages, testing::HasSubstr(link + ": "));
    return o.messages;
  };
  for (const char* greeting :
       {"", "SSH-2.0-OpenSSH_9.2\r\n", "HTTP/1.1 400 Bad Request\r\n\r\n", "220 mail ESMTP\r\n", "\xff\xff\xff\xff"}) {
    const HostileServer server(bytes_of(greeting));
    EXPECT_THAT(answer_of(server.link()), testing::HasSubstr("another program")) << greeting;
  }
  const Outcome o = run("discover --link sim:127.0.0.1:0");
  EXPECT_EQ(o.status, 2);
  EXPECT_THAT(o.messages, testing::HasSubstr("--listen alone"));
}

TEST_F(Deaf, a_simulation_without_boards_is_not_called_another_program) {
  const HostileServer server(bit_rates_without_end());
  const Outcome o = run("discover --link " + server.link());
  EXPECT_EQ(o.status, 3);
  EXPECT_THAT(o.messages, testing::HasSubstr("a Triskin simulation is there"));
}

TEST_F(Deaf, an_address_for_other_computers_needs_an_explicit_word) {
  Outcome o = run("simulate strip.json --listen 0.0.0.0:0 --seconds 0.1");
  EXPECT_EQ(o.status, 2);
  EXPECT_THAT(o.messages, testing::AllOf(testing::HasSubstr("other computers"), testing::HasSubstr("--expose")));
  o = run("simulate strip.json --listen 0.0.0.0:0 --expose --seconds 0.1");
  EXPECT_EQ(o.status, 0) << o.messages;
  EXPECT_THAT(o.messages, testing::HasSubstr("WARNING"));
  o = run("simulate strip.json --listen 127.0.0.1:0 --seconds 0.1");
  EXPECT_EQ(o.status, 0) << o.messages;
  EXPECT_THAT(o.messages, testing::Not(testing::HasSubstr("WARNING")));
}

// Without descriptors a waiting connection must not keep a core busy. Serving needs processor time, so the time that
// the server uses in this second of its own clock is compared with that second.
TEST(ServerWithoutDescriptors, rests) {
  hardware::Scene scene;
  scene.design = strip(1, 1);
  hardware::VirtualSkin skin(std::move(scene));
  hardware::SimServer server(skin, {"127.0.0.1", 0});
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  const rlimit before_limit = limit;
  limit.rlim_cur = 128;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  std::vector<int> held;
  const int client = ::socket(AF_INET, SOCK_STREAM, 0);
  for (int fd = ::dup(0); fd >= 0; fd = ::dup(0)) held.push_back(fd);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(server.port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::connect(client, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  const std::clock_t before = std::clock();
  const std::atomic<bool> never = false;
  server.run(never, 1.0);
  const double used_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  for (const int fd : held) ::close(fd);
  (void)::setrlimit(RLIMIT_NOFILE, &before_limit);
  EXPECT_LT(used_s, 0.5);
  server.run(never, 0.5);  // Descriptors are available again, and the client is served.
  std::array<char, 1> byte{};
  EXPECT_EQ(::recv(client, byte.data(), 1, MSG_DONTWAIT), 1);
  ::close(client);
}

}  // namespace
}  // namespace triskin::test
