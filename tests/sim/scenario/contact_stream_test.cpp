// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/contact_stream.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::scenario {
namespace {

using nlohmann::json;
using testing::HasSubstr;

hardware::Scene strip_scene() {
  hardware::Scene scene;
  scene.design = test::strip(6);
  return scene;
}

std::string step_to(double time_s, const std::string& contacts) {
  return fmt::format(R"({{"time_s":{:.6f},"contacts":[{}]}})", time_s, contacts);
}

std::string error_of(ContactStream& stream, const std::string& line) {
  try {
    (void)stream.take(line);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

double largest_change(const json& answer, int module) {
  double largest = 0.0;
  for (const json& s : answer["samples"]) {
    if (s["module"] == module)
      for (const json& c : s["change_counts"]) largest = std::max(largest, c.get<double>());
  }
  return largest;
}

TEST(ContactStream, a_contact_reaches_the_samples_and_the_frames) {
  ContactStream stream(strip_scene());
  const json head = json::parse(stream.greeting());
  EXPECT_EQ(head["format"], "triskin-contacts");
  EXPECT_EQ(head["modules"], 6);
  const double begin_s = stream.time_s();
  const json quiet = json::parse(stream.take(step_to(begin_s + 0.2, "")));
  EXPECT_LT(largest_change(quiet, 2), 10.0);
  // The centre of module 2 of the strip is given 3 mm above the skin in metres.
  const design::Vec3 at = hardware::center_of(test::strip(6), layout::ModuleId{2}) * 1e-3;
  const std::string contact =
      fmt::format(R"({{"body":"cover","point_m":[{},{},0.003],"normal":[0,0,1],"force_n":5}})", at.x(), at.y());
  const json pressed = json::parse(stream.take(step_to(begin_s + 0.4, contact)));
  EXPECT_GT(largest_change(pressed, 2), 500.0);
  EXPECT_EQ(pressed["contacts"], 1);
  EXPECT_EQ(pressed["unfelt"], 0);
  EXPECT_NEAR(pressed["time_s"].get<double>(), begin_s + 0.4, 1e-6);
  // Every frame of the stream has the identifier of a full sample.
  std::size_t samples = 0;
  for (const json& frame : pressed["frames"]) {
    if ((frame["id"].get<std::uint32_t>() & 0x1FFF0000U) != wire::kFullBase) continue;
    ++samples;
    EXPECT_EQ(frame["data"].get<std::string>().size(), 2U * wire::kFullBytes);
  }
  EXPECT_EQ(samples, pressed["samples"].size());
  EXPECT_GE(samples, 6U * 4U);
  const json lifted = json::parse(stream.take(step_to(begin_s + 0.6, "")));
  const json rest = json::parse(stream.take(step_to(begin_s + 0.8, "")));
  EXPECT_LT(largest_change(rest, 2), 10.0);
}

TEST(ContactStream, a_depth_becomes_a_force) {
  ContactStream stream(strip_scene());
  const design::Vec3 at = hardware::center_of(test::strip(6), layout::ModuleId{2});
  const auto press = [&](double depth_mm) {
    const std::string contact =
        fmt::format(R"({{"point_mm":[{},{},0],"depth_mm":{},"tip_radius_mm":20}})", at.x(), at.y(), depth_mm);
    return largest_change(json::parse(stream.take(step_to(stream.time_s() + 0.3, contact))), 2);
  };
  const double shallow = press(0.2), deep = press(0.4);
  EXPECT_GT(shallow, 50.0);
  // The pressure in the centre of an elastic foundation is proportional to the depth.
  EXPECT_NEAR(deep / shallow, 2.0, 0.2);
}

TEST(ContactStream, contacts_elsewhere_and_beside_the_skin_are_counted) {
  ContactStream stream(strip_scene());
  const json answer =
      json::parse(stream.take(step_to(stream.time_s() + 0.1, R"({"body":"table","point_m":[0,0,0],"force_n":1},
                                        {"point_m":[0,0,1],"force_n":1})")));
  EXPECT_EQ(answer["elsewhere"], 1);
  EXPECT_EQ(answer["unfelt"], 1);
  EXPECT_EQ(answer["contacts"], 0);
}

TEST(ContactStream, damaged_lines_are_refused_with_a_sentence) {
  ContactStream stream(strip_scene());
  (void)stream.take(step_to(stream.time_s() + 0.1, ""));
  const double now_s = stream.time_s();
  const std::pair<std::string, const char*> cases[] = {
      {"", "is not JSON"},
      {"GET / HTTP/1.1", "is not JSON"},
      {std::string(100'000, '['), "nested deeper"},
      {"[]", "must be an object"},
      {R"({"contacts":[]})", "\"time_s\" is missing"},
      {R"({"time_s":0,"contacts":[]})", "before the time of the skin"},
      {step_to(now_s + 11, ""), "make smaller steps"},
      {R"({"time_s":1e999,"contacts":[]})", "out of range"},
      {step_to(now_s, "7"), "must be an object"},
      {step_to(now_s, R"({"force_n":1})"), "needs \"point_m\""},
      {step_to(now_s, R"({"point_m":[0,0],"force_n":1})"), "must have 3 elements"},
      {step_to(now_s, R"({"point_m":[0,0,1e9],"force_n":1})"), "must be in"},
      {step_to(now_s, R"({"point_m":[0,0,0],"point_mm":[0,0,0],"force_n":1})"), "leave one out"},
      {step_to(now_s, R"({"point_m":[0,0,0]})"), "needs either \"force_n\""},
      {step_to(now_s, R"({"point_m":[0,0,0],"force_n":1,"depth_m":0.001})"), "needs either \"force_n\""},
      {step_to(now_s, R"({"point_m":[0,0,0],"depth_mm":3})"), "must be in"},
      {step_to(now_s, R"({"point_m":[0,0,0],"force_n":-1})"), "must be in"},
      {step_to(now_s, R"({"point_m":[0,0,0],"force_n":1,"normal":[0,0,0]})"), "has no length"},
      {step_to(now_s, R"({"point_m":[0,0,0],"force_n":1,"wind":2})"), "\"wind\" is unknown"},
  };
  for (const auto& [line, expected] : cases)
    EXPECT_THAT(error_of(stream, line), HasSubstr(expected)) << line.substr(0, 100);
  std::string many = R"({"point_m":[0,0,0],"force_n":1})";
  for (std::size_t k = 0; k < ContactStream::kMaxContacts; ++k) many += R"(,{"point_m":[0,0,0],"force_n":1})";
  EXPECT_THAT(error_of(stream, step_to(now_s, many)), HasSubstr("at most 1000"));
  EXPECT_EQ(stream.time_s(), now_s);
}

// Acts as a client of the server, line by line.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  void send(const std::string& text) const {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  // An empty line means that the server has closed the connection.
  [[nodiscard]] std::string line() const {
    std::string text;
    for (char c = 0; ::recv(socket_, &c, 1, 0) == 1 && c != '\n';) text += c;
    return text;
  }

 private:
  int socket_;
};

// The test changes each byte of a line, makes each number extreme, and sends each beginning alone: the line is accepted
// or refused in our words, and the skin's time does not run away.
TEST(ContactStream, no_byte_of_a_line_can_do_harm) {
  ContactStream stream(strip_scene());
  const double begin_s = stream.time_s();
  const std::string whole = fmt::format(
      R"({{"time_s":{:.6f},"contacts":[{{"point_mm":[15.5,8.5,0.5],"normal":[0,0,1],"force_n":2.5,"radius_mm":5}}]}})",
      begin_s);
  ASSERT_EQ(error_of(stream, whole), "no error");
  std::vector<std::string> lines;
  // A wrong time would make all later lines too old.
  for (std::size_t at = whole.find("\"contacts\""); at < whole.size(); ++at) {
    lines.push_back(whole.substr(0, at));
    for (const char with : std::string("{}[],:\"\\x0-.e\n\xFF\x01", 17)) {
      lines.push_back(whole);
      lines.back()[at] = with;
    }
  }
  for (std::size_t at = whole.find_first_of("0123456789"); at != std::string::npos;
       at = whole.find_first_of("0123456789", whole.find_first_not_of("0123456789.", at))) {
    for (const char* value : {"1e7", "1e20", "-1e308", "1e999", "nan", "-0", "9007199254740993", "null", "\"5\"", ""}) {
      lines.push_back(whole);
      lines.back().replace(at, whole.find_first_not_of("0123456789.", at) - at, value);
    }
  }
  for (const std::string& line : lines) {
    const std::string error = error_of(stream, line);
    for (const char* raw : {"exception", "last read", "syntax error", "std::"})
      ASSERT_THAT(error, testing::Not(HasSubstr(raw))) << line;
  }
  EXPECT_LT(stream.time_s(), begin_s + 30.0);
}

TEST(ContactServer, serves_this_computer_only) {
  ContactStream stream(strip_scene());
  const std::atomic<bool> stop = true;
  EXPECT_THROW(serve_contacts(stream, {"0.0.0.0", 0}, stop, 0.0, {}), InputError);
  EXPECT_NO_THROW(serve_contacts(stream, {"127.0.0.1", 0}, stop, 0.0, {}));
}

TEST(ContactServer, refuses_a_client_and_serves_the_next) {
  ContactStream stream(strip_scene());
  std::atomic<bool> stop = false;
  std::promise<int> port;
  std::thread server([&] { serve_contacts(stream, {"127.0.0.1", 0}, stop, 0.0, [&](int p) { port.set_value(p); }); });
  const int at = port.get_future().get();
  {
    const Client bad(at);
    EXPECT_EQ(json::parse(bad.line())["format"], "triskin-contacts");
    bad.send("hello\n");
    EXPECT_THAT(json::parse(bad.line())["error"].get<std::string>(), HasSubstr("is not JSON"));
    EXPECT_EQ(bad.line(), "");
  }
  const Client good(at);
  const double begin_s = json::parse(good.line())["time_s"].get<double>();
  good.send(step_to(begin_s + 0.1, "") + "\n" + step_to(begin_s + 0.2, "") + "\n");
  EXPECT_NEAR(json::parse(good.line())["time_s"].get<double>(), begin_s + 0.1, 1e-6);
  EXPECT_NEAR(json::parse(good.line())["time_s"].get<double>(), begin_s + 0.2, 1e-6);
  stop = true;
  server.join();
}

}  // namespace
}  // namespace triskin::scenario
