// SPDX-License-Identifier: GPL-3.0-or-later
// Tests two processes: `triskin simulate` serves the skin, and this test and `triskin` are its clients.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/device_fixture.hpp"
#include "support/places.hpp"
#include "triskin/hardware/tcp_link.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::link {

using test::Fixture;

namespace {

namespace fs = std::filesystem;

class Served : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("wire_link_test." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    design::write_design(folder_ / "strip.json", test::strip(10, 8));
    start();
  }
  void TearDown() override {
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
    ::close(output_);
    fs::remove_all(folder_);
  }
  // Serves on a free port, which the program prints: "… on sim:127.0.0.1:PORT; …".
  void start() {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    const std::string scene = folder_ / "strip.json";
    child_ = ::fork();
    if (child_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // A test that dies leaves no server behind.
      ::dup2(pipe[1], STDOUT_FILENO);
      ::execl(test::program_file().c_str(), "triskin", "simulate", scene.c_str(), "--fresh", "--listen", "127.0.0.1:0",
              nullptr);
      ::_exit(127);
    }
    ::close(pipe[1]);
    output_ = pipe[0];
    std::string line;
    char c = 0;
    while (::read(output_, &c, 1) == 1 && c != '\n') line += c;
    const std::size_t at = line.find("127.0.0.1:");
    ASSERT_NE(at, std::string::npos) << line;
    port_ = static_cast<std::uint16_t>(std::stoi(line.substr(at + 10)));
  }
  // Returns the result, which is the last line. The earlier output of `live` also has one object per line.
  nlohmann::json run(const std::string& command, int expected_status) const {
    const std::string line =
        test::program_file() + " " + command + " --link sim:127.0.0.1:" + std::to_string(port_) + " --json";
    std::FILE* p = ::popen(line.c_str(), "r");
    std::string text;
    for (int c = std::fgetc(p); c != EOF; c = std::fgetc(p)) text += static_cast<char>(c);
    const int status = ::pclose(p);
    EXPECT_EQ(WEXITSTATUS(status), expected_status) << text;
    if (text.empty()) return nullptr;
    return nlohmann::json::parse(text.substr(text.rfind('\n', text.size() - 2) + 1), nullptr, false);
  }
  fs::path folder_;
  pid_t child_ = -1;
  int output_ = -1;
  std::uint16_t port_ = 0;
};

TEST_F(Served, flash_verify_and_live_work_over_tcp) {
  const std::string design = (folder_ / "strip.json").string();
  EXPECT_EQ(run("verify " + design + " --watch-s 0 --no-touch", 1)["findings"][0]["kind"], "not_flashed");
  EXPECT_EQ(run("flash " + design, 0)["controllers"], 2);
  EXPECT_EQ(run("flash " + design, 0)["skipped"], 2);
  const nlohmann::json verified = run("verify " + design + " --watch-s 0", 0);
  EXPECT_EQ(verified["modules_ok"], 10);
  EXPECT_EQ(verified["touched"], 10);
  const nlohmann::json live = run("live " + design + " --press 9 --taxel 5 --seconds 1", 0);
  ASSERT_EQ(live["pressed"].size(), 1U) << live;
  EXPECT_EQ(live["pressed"][0]["module"], 9);
  EXPECT_EQ(live["pressed"][0]["taxel"], 5);
  const nlohmann::json found = run("discover", 0);
  EXPECT_EQ(found["controllers"].size(), 2U);
  EXPECT_EQ(found["controllers"][0]["chips"].size(), 8U);
}

TEST_F(Served, a_client_that_sends_malformed_records_is_dropped_and_the_others_are_not) {
  hardware::TcpLink good({"127.0.0.1", port_});
  session::Bus bus(good);
  for (const std::vector<std::uint8_t>& malformed : {std::vector<std::uint8_t>{0xFF, 0xFF, 0xFF, 0xFF, 1},
                                                     {0, 0, 0, 0},
                                                     {2, 0, 0, 0, 9, 9},
                                                     {3, 0, 0, 0, 1, 2, 3},
                                                     {6, 0, 0, 0, 2, 0xFF, 0, 0, 0, 0}}) {
    const std::string path = "/dev/tcp/127.0.0.1/" + std::to_string(port_);
    std::string bytes;
    for (const std::uint8_t b : malformed) {
      std::array<char, 8> text{};
      std::snprintf(text.data(), text.size(), "\\x%02x", b);
      bytes += text.data();
    }
    const std::string command =
        "bash -c 'exec 3<>" + path + "; printf \"" + bytes + "\" >&3; timeout 5 cat <&3 >/dev/null'";
    EXPECT_EQ(std::system(command.c_str()), 0)
        << bytes;  // The server has closed the connection, so cat ends before its timeout.
  }
  EXPECT_EQ(bus.discover().size(), 2U);
}

TEST(WireLink, a_dead_link_is_a_device_error) {
  EXPECT_THROW(hardware::TcpLink({"127.0.0.1", 1}), DeviceError);
  EXPECT_THROW((void)hardware::parse_host_port("nowhere"), InputError);
  EXPECT_THROW((void)hardware::parse_host_port("host:99999"), InputError);
  EXPECT_THROW((void)hardware::parse_host_port(":7"), InputError);
}

// RFC 3986 puts an IPv6 address into brackets, since its colons would hide that of the port.
TEST(WireLink, an_ipv6_address_stands_in_brackets) {
  const hardware::HostPort at = hardware::parse_host_port("[::1]:7000");
  EXPECT_EQ(at.host, "::1");
  EXPECT_EQ(at.port, 7000);
  EXPECT_EQ(hardware::host_port_text(at), "[::1]:7000");
  EXPECT_EQ(hardware::host_port_text({"localhost", 80}), "localhost:80");
  for (const char* text : {"::1:7000", "[::1]", "[]:7", "[::1]:", "[::1]7000"})
    EXPECT_THROW((void)hardware::parse_host_port(text), InputError) << text;
}

TEST(WireLink, records_survive_the_way_and_truncated_ones_wait) {
  wire::CanFrame frame;
  frame.id = 0x18DA01F1;
  frame.extended = frame.fd = true;
  frame.size = 12;
  frame.data[11] = 7;
  std::vector<std::uint8_t> bytes;
  hardware::record::put_frame(bytes, frame);
  std::vector<std::uint8_t> part;
  for (std::size_t k = 0; k + 1 < bytes.size(); ++k) {
    part.push_back(bytes[k]);
    EXPECT_FALSE(hardware::record::take(part).has_value());
  }
  part.push_back(bytes.back());
  const auto r = hardware::record::take(part);
  ASSERT_TRUE(r.has_value());
  EXPECT_EQ(hardware::record::frame_of(*r), frame);
  EXPECT_TRUE(part.empty());
}

// The first sample still shows a finger that has left: neither it nor the rest that follows is a touch.
TEST(LiveStream, a_finger_that_has_just_gone_is_not_taken_for_rest) {
  const design::Design design = test::strip(1);
  skin::TouchMap map(design);
  session::ModuleSample frame;
  frame.sample.valid = layout::kAllTaxels;
  frame.sample.value.fill(32'500);
  frame.sample.value[3] = 29'000;
  map.add(frame);
  EXPECT_TRUE(map.pressed().empty());
  frame.sample.value[3] = 32'500;
  map.add(frame);
  map.add(frame);
  EXPECT_TRUE(map.pressed().empty());
  frame.sample.value[5] = 29'500;
  map.add(frame);
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_EQ(map.pressed()[0].taxel, 5);
  EXPECT_EQ(map.pressed()[0].change_counts, 3'000);
}

TEST(LiveStream, finds_the_pressed_taxel_at_its_place_and_loses_nothing) {
  Fixture fixture(20, 8);
  fixture.flash();
  skin::TouchMap map(fixture.design());
  session::Stream stream(fixture.bus(), fixture.design(), [&](const session::ModuleSample& f) { map.add(f); });
  stream.run_until(fixture.bus().now_us() + 500'000);
  EXPECT_TRUE(map.pressed().empty());
  for (const auto& [module, taxel] : {std::pair{0, 3}, {13, 9}, {19, 1}}) {
    touch_actuator_of(fixture.bus().link())->press({layout::ModuleId{module}, layout::TaxelIndex{taxel}});
    stream.run_until(fixture.bus().now_us() + 100'000);
    const auto pressed = map.pressed();
    ASSERT_EQ(pressed.size(), 1U);
    EXPECT_EQ(pressed[0].module, module);
    EXPECT_EQ(pressed[0].taxel, taxel);
    const auto expected = design::taxels_of(fixture.design().layout.modules[static_cast<std::size_t>(module)],
                                            2)[static_cast<std::size_t>(taxel)];
    EXPECT_NEAR((pressed[0].position_mm - expected.position_mm).norm(), 0.0, 1e-9);
  }
  EXPECT_EQ(stream.lost(), 0U);
  EXPECT_GT(stream.frames(), 20U * 15);
}

}  // namespace
}  // namespace triskin::link
