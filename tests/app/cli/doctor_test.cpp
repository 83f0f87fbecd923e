// SPDX-License-Identifier: GPL-3.0-or-later
// Runs `triskin doctor` and `triskin list` on prepared computers: folders that stand for /sys, /proc, /etc and /dev.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/cli/shell_case.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kSerial = "00112233445566778899AABB";

// Does to ip.json what ip does to the kernel, with its refusals: the bit rate of an interface that is up cannot be
// changed, and a chip without FD knows no words for it.
constexpr const char* kIp = R"(
import json, sys
links = json.load(open("root/ip.json"))
words = sys.argv[1:]
assert words[:2] == ["link", "set"], words
link = next(l for l in links if l["ifname"] == words[2])
info = link["linkinfo"]["info_data"]
words = iter(words[3:])
up = "UP" in link["flags"]
for word in words:
    if word in ("up", "down"):
        link["flags"] = [f for f in link["flags"] if f != "UP"] + (["UP"] if word == "up" else [])
    elif word == "txqueuelen":
        link["txqlen"] = int(next(words))
    elif word == "type":
        assert next(words) == "can"
    elif word == "bitrate":
        assert not up, "Device or resource busy"
        info["bittiming"] = {"bitrate": int(next(words))}
    elif word in ("dbitrate", "fd"):
        assert "data_bittiming_const" in info, "Operation not supported"
        value = next(words)
        link["mtu"] = 72 if value == "on" else link["mtu"]
    elif word in ("sample-point", "dsample-point"):
        assert next(words) == "0.8"
    elif word in ("restart-ms", "berr-reporting"):
        next(words)
    elif word == "restart":
        assert up, "Invalid argument"
        info["state"] = "ERROR-ACTIVE"
    else:
        raise SystemExit("what is " + word)
json.dump(links, open("root/ip.json", "w"))
)";

class Doctor : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    ::unsetenv("ROS_DOMAIN_ID");
    ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
    make_healthy();
  }
  void TearDown() override {
    ::unsetenv("ROS_DOMAIN_ID");
    ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
    ShellCase::TearDown();
  }

  void write(const std::string& file, const std::string& text) const {
    const fs::path path = folder_ / "root" / file;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  void write_interface(const json& changes) const {
    json can = {{"ifname", "can0"},
                {"flags", {"NOARP", "UP", "LOWER_UP"}},
                {"mtu", 72},
                {"txqlen", 128},
                {"linkinfo",
                 {{"info_kind", "can"},
                  {"info_data",
                   {{"state", "ERROR-ACTIVE"},
                    {"data_bittiming_const", {{"name", "mcp251xfd"}}},
                    {"berr_counter", {{"tx", 0}, {"rx", 0}}},
                    {"bittiming", {{"bitrate", 1000000}}}}}}}};
    can.merge_patch(changes);
    write("ip.json", json::array({can}).dump());
  }
  // Simulates a healthy computer with a CAN interface and a USB board.
  void make_healthy() const {
    write("etc/udev/rules.d/70-triskin.rules",
          "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"1209\", MODE=\"0660\"\nKERNEL==\"hidraw*\", "
          "ATTRS{idVendor}==\"1209\"\n");
    for (const char* module : {"can", "can_raw", "can_isotp", "vcan"})
      fs::create_directories(folder_ / "root/sys/module" / module);
    write("sys/class/net/can0/type", "280\n");
    write("sys/class/net/can0/flags", "0x40c1\n");
    write("sys/class/net/eth0/type", "1\n");
    write("sys/bus/usb/devices/1-2/idVendor", "1209\n");
    write("sys/bus/usb/devices/1-2/idProduct", "0001\n");
    write("sys/bus/usb/devices/1-2/serial", std::string(kSerial) + "\n");
    write("sys/bus/usb/devices/1-2/busnum", "1\n");
    write("sys/bus/usb/devices/1-2/devnum", "7\n");
    write("dev/bus/usb/001/007", "");
    write("usr/bin/xdg-open", "");
    write("proc/sys/kernel/seccomp/actions_avail", "kill_process errno allow\n");
    write_interface(json::object());
    write_boards(version());
  }
  void write_boards(const std::string& firmware) const {
    write("boards.json",
          json::array({{{"link", "can:can0"}, {"serial", "A0"}, {"firmware", version()}},
                       {{"link", std::string("usb:") + kSerial}, {"serial", kSerial}, {"firmware", firmware}}})
              .dump());
  }
  [[nodiscard]] std::string version() const {
    const std::string text = run("--version").out;
    return text.substr(0, text.find('\n'));
  }
  // Returns the checks that are not ok, with their remedies.
  [[nodiscard]] std::map<std::string, std::string> troubles(int status) const {
    const Outcome o = run("doctor --root root --json");
    EXPECT_EQ(o.status, status) << o.out << o.messages;
    std::map<std::string, std::string> bad;
    const json answer = json::parse(o.out);  // The value must outlive the loop.
    for (const json& c : answer["checks"])
      if (c["needed"].get<bool>() && !c["ok"].get<bool>()) bad[c["name"]] = c["remedy"];
    return bad;
  }
  // Expects exactly one trouble, by name and with its command.
  void expect_trouble(const std::string& name, const std::string& remedy) const {
    const auto bad = troubles(1);
    ASSERT_EQ(bad.size(), 1U) << name;
    EXPECT_EQ(bad.begin()->first, name);
    EXPECT_THAT(bad.begin()->second, HasSubstr(remedy));
  }
  // Runs the command that doctor names, as a person does, and then doctor in the same shell. Files below /etc are those
  // of the prepared computer; modprobe does there what it does to /sys.
  void expect_mended_by_its_command(const std::string& name, const std::string& remedy) const {
    expect_trouble(name, remedy);
    std::string command = troubles(1).begin()->second;
    for (std::size_t at = 0; (at = command.find(" /etc/", at)) != std::string::npos; at += 6)
      command.replace(at, 1, " root");
    std::ofstream(folder_ / "ip.py") << kIp;
    std::ofstream(folder_ / "mend.sh") << "sudo() { \"$@\"; }\nudevadm() { :; }\napt-get() { :; }\n"
                                       << "modprobe() { mkdir -p root/sys/module/$1; }\n"
                                       << "ip() { python3 ip.py \"$@\"; }\n"
                                       << command << " >/dev/null\nexec " << program_file() << " doctor --root root\n";
    const std::string run = fmt::format("cd '{}' && bash -e mend.sh >mended 2>&1", folder_.string());
    EXPECT_EQ(WEXITSTATUS(std::system(run.c_str())), 0) << command << "\n" << read_file(folder_ / "mended");
  }
};

TEST_F(Doctor, a_healthy_computer_has_no_trouble) {
  EXPECT_TRUE(troubles(0).empty());
  const Outcome o = run("list --root root --json");
  const json answer = json::parse(o.out);
  ASSERT_EQ(answer["links"].size(), 2U) << o.out;
  EXPECT_EQ(answer["links"][0]["link"], "can:can0");
  EXPECT_EQ(answer["links"][1]["link"], std::string("usb:") + kSerial);
}

// Doctor looks for the rules that the Debian packages install, and tells other users to write the same.
TEST_F(Doctor, the_rules_of_the_packages_are_those_that_it_wants) {
  fs::remove(folder_ / "root/etc/udev/rules.d/70-triskin.rules");
  const std::string remedies = troubles(1).at("udev rule for USB") + troubles(1).at("udev rule for HID");
  const std::string rules = read_file(fs::path(source_folder()) / "cmake/packaging/70-triskin.rules");
  write("usr/lib/udev/rules.d/70-triskin.rules", rules);
  EXPECT_TRUE(troubles(0).empty());
  std::istringstream lines(rules);
  for (std::string rule; std::getline(lines, rule);) {
    if (rule.starts_with("#")) continue;
    EXPECT_THAT(remedies, HasSubstr(rule));
  }
}

TEST_F(Doctor, twelve_troubles_are_named_each_with_its_command) {
  const std::string rules = read_file(folder_ / "root/etc/udev/rules.d/70-triskin.rules");
  const auto usb_rule = rules.substr(0, rules.find('\n') + 1), hid_rule = rules.substr(rules.find('\n') + 1);
  write("etc/udev/rules.d/70-triskin.rules", "# " + usb_rule + hid_rule);
  expect_mended_by_its_command("udev rule for USB", "sudo udevadm control --reload");
  write("etc/udev/rules.d/70-triskin.rules", usb_rule);
  expect_mended_by_its_command("udev rule for HID", "hidraw");
  write("etc/udev/rules.d/70-triskin.rules", rules);

  fs::remove_all(folder_ / "root/sys/module/can_raw");
  expect_mended_by_its_command("kernel module can_raw", "sudo modprobe can_raw");
  fs::remove_all(folder_ / "root/sys/module/can_raw");
  write("proc/sys/kernel/osrelease", "6.1.0\n");
  write("lib/modules/6.1.0/modules.dep", "kernel/net/can/can-raw.ko: kernel/net/can/can.ko\n");
  EXPECT_TRUE(troubles(0).empty());  // The kernel loads the module when it is needed.

  write_interface({{"flags", {"NOARP"}}});
  expect_mended_by_its_command(
      "interface can0",
      "up txqueuelen 128 type can bitrate 1000000 sample-point 0.8 dbitrate 2000000 dsample-point 0.8 fd on");
  write_interface({{"linkinfo", {{"info_data", {{"bittiming", {{"bitrate", 500000}}}}}}}});
  expect_mended_by_its_command("bit rate of can0", "bitrate 1000000");
  write_interface({{"mtu", 16}});
  expect_mended_by_its_command("FD of can0", "fd on");
  write_interface({{"txqlen", 10}});
  expect_mended_by_its_command("queue of can0", "sudo ip link set can0 txqueuelen 128");
  write_interface({{"linkinfo", {{"info_data", {{"state", "BUS-OFF"}}}}}});
  expect_mended_by_its_command("errors of can0", "type can restart");
  write_interface({{"linkinfo", {{"info_data", {{"state", "ERROR-PASSIVE"}}}}}});
  expect_trouble("errors of can0", "60 ohm");
  write_interface(json::object());

  write_boards("0.1.0");
  expect_trouble(std::string("firmware of ") + kSerial, std::string("dfu-util -d 1209:0001,1209:0002 -S ") + kSerial);
  write_boards(version());
  ::setenv("ROS_DOMAIN_ID", "300", 1);
  expect_mended_by_its_command("DDS domain", "export ROS_DOMAIN_ID=");
  ::unsetenv("ROS_DOMAIN_ID");
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "HOST", 1);
  expect_mended_by_its_command("ROS discovery", "unset ROS_LOCALHOST_ONLY");
  ::unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  ::setenv("FASTRTPS_DEFAULT_PROFILES_FILE", "/etc/none.xml", 1);
  expect_mended_by_its_command("DDS configuration", "unset FASTRTPS_DEFAULT_PROFILES_FILE");
  ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
  EXPECT_TRUE(troubles(0).empty());
}

// The chip of such an adapter refuses "fd on", so the command that brings it up must not have these words.
TEST_F(Doctor, an_adapter_without_FD_is_no_trouble_and_is_brought_up_without_it) {
  const json without = {{"mtu", 16}, {"linkinfo", {{"info_data", {{"data_bittiming_const", nullptr}}}}}};
  write_interface(without);
  EXPECT_TRUE(troubles(0).empty());
  EXPECT_THAT(run("doctor --root root").out, HasSubstr("without FD of can0: this adapter has classic frames only"));
  json down = without;
  down["flags"] = {"NOARP"};
  write_interface(down);
  expect_mended_by_its_command("interface can0",
                               "type can bitrate 1000000 sample-point 0.8 berr-reporting on restart-ms 100");
}

TEST_F(Doctor, old_firmware_on_CAN_is_mended_with_the_image_of_the_packages) {
  write("usr/share/triskin/firmware/triskin_firmware.tsf", "");
  write("boards.json",
        json::array({{{"link", "can:can0"}, {"serial", "A0"}, {"firmware", "0.1.0"}},
                     {{"link", std::string("usb:") + kSerial}, {"serial", kSerial}, {"firmware", version()}}})
            .dump());
  expect_trouble("firmware of A0",
                 "triskin flash DESIGN --link can:can0 --firmware "
                 "/usr/share/triskin/firmware/triskin_firmware.tsf");
}

TEST_F(Doctor, a_kernel_without_a_sandbox_for_readers_is_named) {
  fs::remove_all(folder_ / "root/proc");
  EXPECT_THAT(run("doctor --root root").out, HasSubstr("are read with your rights"));
}

TEST_F(Doctor, a_silent_bus_and_a_computer_without_hardware_are_troubles) {
  write("boards.json", "[]");
  const auto silent = troubles(1);
  EXPECT_EQ(silent.size(), 2U);
  EXPECT_TRUE(silent.contains("boards on can:can0"));
  fs::remove_all(folder_ / "root/sys/class");
  fs::remove_all(folder_ / "root/sys/bus");
  write("ip.json", "[]");
  expect_trouble("attached hardware", "lsusb");
}

TEST_F(Doctor, a_board_that_may_not_be_opened_is_a_trouble) {
  if (::geteuid() == 0) fs::remove(folder_ / "root/dev/bus/usb/001/007");  // Root may open any device.
  fs::permissions(folder_ / "root/dev/bus/usb/001", fs::perms::owner_all);
  if (::geteuid() != 0) fs::permissions(folder_ / "root/dev/bus/usb/001/007", fs::perms::none);
  write("boards.json", json::array({{{"link", "can:can0"}, {"serial", "A0"}, {"firmware", version()}}}).dump());
  expect_trouble(std::string("permission for usb:") + kSerial, "sudo usermod -aG plugdev");
}

}  // namespace
}  // namespace triskin::test
