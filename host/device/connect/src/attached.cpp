// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/connect/attached.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "triskin/wire/usb_packet.hpp"

namespace triskin::connect {
namespace {

namespace fs = std::filesystem;

// Returns the first line of a small file of /sys, or an empty text if it cannot be read.
std::string line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    entries.push_back(at->path());
  std::ranges::sort(entries);
  return entries;
}

// The kernel writes the type of an interface as ARPHRD_CAN of <linux/if_arp.h>, and its flags with IFF_UP.
AttachedDevice can_interface(const fs::path& entry) {
  constexpr unsigned kUp = 1;
  const std::string flags = line_of(entry / "flags");
  const bool up = (std::strtoul(flags.c_str(), nullptr, 16) & kUp) != 0;
  std::error_code error;
  const bool is_virtual = fs::read_symlink(entry, error).string().find("/virtual/") != std::string::npos;
  const std::string name = entry.filename().string();
  return {"can:" + name,
          fmt::format("{}CAN interface{}", is_virtual ? "virtual " : "",
                      up ? "" : fmt::format(", down: sudo ip link set {} up", name)),
          up};
}

bool is_board(const std::string& vendor, const std::string& product) {
  return vendor == fmt::format("{:04x}", wire::kUsbVendor) && product == fmt::format("{:04x}", wire::kUsbProduct);
}

bool may_open(const fs::path& node) {
  return ::access(node.c_str(), R_OK | W_OK) == 0;
}

AttachedDevice board_at(const std::string& kind, const std::string& serial, const fs::path& node) {
  const bool open = may_open(node);
  return {kind + ":" + serial, open ? "USB board" : "USB board, no permission to open it: run triskin doctor", open};
}

void add_can(const fs::path& root, std::vector<AttachedDevice>& devices) {
  for (const fs::path& entry : entries_of(root / "sys/class/net"))
    if (line_of(entry / "type") == "280") devices.push_back(can_interface(entry));
}

void add_usb(const fs::path& root, std::vector<AttachedDevice>& devices) {
  for (const fs::path& entry : entries_of(root / "sys/bus/usb/devices")) {
    if (!is_board(line_of(entry / "idVendor"), line_of(entry / "idProduct"))) continue;
    const std::string bus = line_of(entry / "busnum"), number = line_of(entry / "devnum");
    const auto padded = [](const std::string& n) {
      return std::string(3 - std::min<std::size_t>(3, n.size()), '0') + n;
    };
    devices.push_back(board_at("usb", line_of(entry / "serial"), root / "dev/bus/usb" / padded(bus) / padded(number)));
  }
}

// The uevent file has HID_ID=0003:00001209:00000001 (bus, vendor, product) and HID_UNIQ=SERIAL.
void add_hid(const fs::path& root, std::vector<AttachedDevice>& devices) {
  const std::string wanted = fmt::format("HID_ID=0003:{:08X}:{:08X}", wire::kUsbVendor, wire::kUsbProduct);
  for (const fs::path& entry : entries_of(root / "sys/class/hidraw")) {
    std::ifstream stream(entry / "device/uevent");
    std::string serial;
    bool board = false;
    for (std::string line; std::getline(stream, line);) {
      board = board || line == wanted;
      if (line.starts_with("HID_UNIQ=")) serial = line.substr(9);
    }
    if (board) devices.push_back(board_at("hid", serial, root / "dev" / entry.filename()));
  }
}

}  // namespace

std::vector<AttachedDevice> attached_devices(const fs::path& root) {
  std::vector<AttachedDevice> devices;
  add_can(root, devices);
  add_usb(root, devices);
  add_hid(root, devices);
  std::ranges::sort(devices, {}, &AttachedDevice::link);
  return devices;
}

std::string unnamed_link_text(const std::vector<AttachedDevice>& devices) {
  std::string text = "no link is named, and nothing is simulated unless you ask for it. Attached here:";
  if (devices.empty()) text += " nothing (no CAN interface, no USB board); triskin doctor says what is missing.";
  for (const AttachedDevice& d : devices) text += fmt::format("\n  {:32} {}", d.link, d.remark);
  const auto usable = std::ranges::find(devices, true, &AttachedDevice::usable);
  const std::string example = usable == devices.end() ? "can:can0" : usable->link;
  return text + fmt::format(
                    "\nName one with --link, for example --link {}, or in the environment variable TRISKIN_LINK; "
                    "--link sim simulates",
                    example);
}

}  // namespace triskin::connect
