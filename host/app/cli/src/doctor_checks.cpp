// SPDX-License-Identifier: GPL-3.0-or-later
#include "doctor_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <sstream>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/bridge/ros_discovery.hpp"
#include "triskin/link/link_kind.hpp"

namespace triskin::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRuleFile = "/etc/udev/rules.d/70-triskin.rules";
constexpr const char* kUsbRule =
    R"(SUBSYSTEM=="usb", ATTR{idVendor}=="1209", ATTR{idProduct}=="0001|0002", MODE="0660", )"
    R"(GROUP="plugdev", TAG+="uaccess")";
constexpr const char* kHidRule =
    R"(KERNEL=="hidraw*", ATTRS{idVendor}=="1209", ATTRS{idProduct}=="0001", MODE="0660", )"
    R"(GROUP="plugdev", TAG+="uaccess")";

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

DoctorCheck good(const std::string& name, const std::string& found) {
  return {name, true, found, ""};
}

// A rule exists if one line that is not a comment names the subsystem and the vendor.
bool has_rule(const fs::path& root, const std::string& subsystem) {
  for (const char* folder : {"etc/udev/rules.d", "run/udev/rules.d", "usr/lib/udev/rules.d", "lib/udev/rules.d"}) {
    std::error_code error;
    for (fs::directory_iterator at(root / folder, error), end; !error && at != end; at.increment(error)) {
      if (at->path().extension() != ".rules") continue;
      std::istringstream lines(text_of(at->path()));
      for (std::string line; std::getline(lines, line);)
        if (!line.starts_with('#') && line.find(subsystem) != std::string::npos &&
            line.find("\"1209\"") != std::string::npos)
          return true;
    }
  }
  return false;
}

DoctorCheck rule_check(const Machine& machine, const std::string& name, const std::string& subsystem,
                       const std::string& rule) {
  if (has_rule(machine.root, subsystem)) return good(name, "is installed");
  return {name, false, "missing, so only root may open a board",
          fmt::format("echo '{}' | sudo tee -a {} && sudo udevadm control --reload && sudo udevadm trigger", rule,
                      kRuleFile)};
}

// A module counts if it is loaded, built into the kernel, or loaded by the kernel on demand.
bool has_module(const fs::path& root, const std::string& name) {
  if (fs::exists(root / "sys/module" / name)) return true;
  std::string release = text_of(root / "proc/sys/kernel/osrelease");
  release.erase(std::find(release.begin(), release.end(), '\n'), release.end());
  std::string file = "/" + name + ".ko", dashed = file;
  std::ranges::replace(dashed, '_', '-');
  for (const char* list : {"modules.builtin", "modules.dep"}) {
    const std::string text = text_of(root / "lib/modules" / release / list);
    if (text.find(file) != std::string::npos || text.find(dashed) != std::string::npos) return true;
  }
  return false;
}

DoctorCheck module_check(const Machine& machine, const std::string& name, const std::string& use, bool needed) {
  const std::string title = "kernel module " + name;
  if (has_module(machine.root, name)) return good(title, "is there");
  return {title, false, fmt::format("missing in this kernel; needed for {}", use),
          fmt::format("sudo apt-get install linux-image-$(dpkg --print-architecture) && sudo modprobe {}", name),
          needed};
}

bool holds(const nlohmann::json& list, const std::string& word) {
  return list.is_array() && std::ranges::find(list, nlohmann::json(word)) != list.end();
}

// Returns `otherwise` if the key is missing or has another type.
int number_at(const nlohmann::json& object, const std::string& pointer, int otherwise) {
  const nlohmann::json::json_pointer at(pointer);
  if (!object.contains(at) || !object.at(at).is_number()) return otherwise;
  return object.at(at).get<int>();
}

std::string word_at(const nlohmann::json& object, const std::string& pointer) {
  const nlohmann::json::json_pointer at(pointer);
  return object.contains(at) && object.at(at).is_string() ? object.at(at).get<std::string>() : "";
}

DoctorCheck state_check(const nlohmann::json& link, const std::string& name) {
  const std::string state = word_at(link, "/linkinfo/info_data/state");
  const int sent = number_at(link, "/linkinfo/info_data/berr_counter/tx", 0);
  const int received = number_at(link, "/linkinfo/info_data/berr_counter/rx", 0);
  const std::string title = "errors of " + name,
                    counters = fmt::format("error counters {} sent, {} received", sent, received);
  if (state == "BUS-OFF")
    return {title, false, "bus-off: the controller has left the bus",
            fmt::format("sudo ip link set {} type can restart", name)};
  if (state == "ERROR-PASSIVE" || state == "ERROR-WARNING")
    return {title, false, counters,
            "measure the cable: 60 ohm between H and L with the power off, equal bit rates, board powered"};
  return good(title, counters);
}

// Returns whether FD frames are switched on: the kernel then passes frames of 72 bytes.
bool sends_fd(const nlohmann::json& link) {
  constexpr int kFdBytes = 72;
  return number_at(link, "/mtu", 0) >= kFdBytes;
}

// Returns whether the controller chip of an interface can send FD frames: the kernel lists its limits for their data.
bool can_do_fd(const nlohmann::json& link) {
  const nlohmann::json::json_pointer info("/linkinfo/info_data");
  if (sends_fd(link) || word_at(link, "/linkinfo/info_kind") == "vcan") return true;
  if (!link.contains(info)) return false;
  const nlohmann::json& data = link.at(info);
  return data.contains("data_bittiming_const") || data.contains("data_bitrate_const");
}

// Returns the command that brings an interface up for the controllers, which sample at 80 % (docs/bring_up.md); Linux
// alone would choose 75 %. A chip without FD refuses the words for FD.
std::string up_command(const std::string& name, bool is_virtual, bool fd) {
  if (is_virtual) return fmt::format("sudo ip link set {} mtu 72 up", name);
  return fmt::format(
      "sudo ip link set {0} down && sudo ip link set {0} up txqueuelen 128 type can bitrate 1000000 "
      "sample-point 0.8{1} berr-reporting on restart-ms 100",
      name, fd ? " dbitrate 2000000 dsample-point 0.8 fd on" : "");
}

DoctorCheck fd_check(const nlohmann::json& link, const std::string& name, const std::string& command) {
  const std::string title = "FD of " + name;
  if (sends_fd(link)) return good(title, "on");
  if (can_do_fd(link)) return {title, false, "off: the full stream needs it", command};
  return {title, false, "this adapter has classic frames only: flash and verify work, the full stream does not",
          "use an adapter with CAN FD", false};
}

namespace {

DoctorCheck queue_check(const nlohmann::json& link, const std::string& name, bool is_virtual) {
  constexpr int kMinQueue = 32;
  const int queue = number_at(link, "/txqlen", kMinQueue);
  if (is_virtual || queue >= kMinQueue) return good("queue of " + name, counted(queue, "frame"));
  return {"queue of " + name, false, fmt::format("{}: updates stall", counted(queue, "frame")),
          fmt::format("sudo ip link set {} txqueuelen 128", name)};
}

}  // namespace

std::vector<DoctorCheck> interface_checks(const nlohmann::json& link) {
  constexpr int kBitRate = 1'000'000;
  const std::string name = word_at(link, "/ifname");
  const bool is_virtual = word_at(link, "/linkinfo/info_kind") == "vcan";
  const std::string command = up_command(name, is_virtual, can_do_fd(link));
  if (!link.contains("flags") || !holds(link["flags"], "UP")) return {{"interface " + name, false, "is down", command}};
  std::vector<DoctorCheck> checks{good("interface " + name, is_virtual ? "is up, virtual" : "is up")};
  const int rate = number_at(link, "/linkinfo/info_data/bittiming/bitrate", is_virtual ? kBitRate : 0);
  if (rate == kBitRate)
    checks.push_back(good("bit rate of " + name, is_virtual ? "none: virtual" : "1 Mbit/s"));
  else
    checks.push_back({"bit rate of " + name, false, fmt::format("{} bit/s, controllers have 1000000", rate), command});
  checks.push_back(fd_check(link, name, command));
  checks.push_back(queue_check(link, name, is_virtual));
  if (!is_virtual) checks.push_back(state_check(link, name));
  return checks;
}

// Firmware goes over CAN by triskin, and over USB by dfu-util. The packages bring the image.
DoctorCheck firmware_check(const AnsweringBoard& board, const Machine& machine) {
  constexpr const char* kPackaged = "/usr/share/triskin/firmware/triskin_firmware.tsf";
  const std::string name = "firmware of " + board.serial;
  if (board.firmware == machine.program_version) return good(name, board.firmware);
  const bool packaged = fs::exists(machine.root / fs::path(kPackaged).relative_path());
  const std::string file = packaged ? kPackaged : "triskin_firmware.tsf";
  return {name, false, fmt::format("{}, the program is {}", board.firmware, machine.program_version),
          link::is_usb(board.link) ? fmt::format("dfu-util -d 1209:0001,1209:0002 -S {} -D {} -R", board.serial, file)
                                   : fmt::format("triskin flash DESIGN --link {} --firmware {}", board.link, file)};
}

std::vector<DoctorCheck> attached_checks(const connect::AttachedDevice& device,
                                         const std::vector<AnsweringBoard>& boards) {
  if (!device.usable) {
    if (device.link.starts_with("can:")) return {};  // check_interfaces() reports CAN interfaces.
    return {{"permission for " + device.link, false,
             "no permission to open the device; a new group takes effect at the next login",
             "sudo usermod -aG plugdev \"$USER\" && sudo udevadm trigger"}};
  }
  const bool answers = std::ranges::any_of(boards, [&](const AnsweringBoard& b) { return b.link == device.link; });
  if (answers) return {good("boards on " + device.link, "answer")};
  return {{"boards on " + device.link, false, "no controller answers",
           "check power, cable and termination, then run triskin discover --link " + device.link}};
}

DoctorCheck domain_check(const Machine& machine) {
  constexpr int kMaxDomain = 232;
  const std::string text = machine.variable("ROS_DOMAIN_ID");
  int id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  if (text.empty() || (is_number && id >= 0 && id <= kMaxDomain)) return good("DDS domain", text.empty() ? "0" : text);
  return {"DDS domain", false, fmt::format("ROS_DOMAIN_ID is {}, not 0 to {}", text, kMaxDomain),
          "export ROS_DOMAIN_ID=0"};
}

DoctorCheck discovery_check(const Machine& machine) {
  std::map<std::string, std::string> values;
  const auto variable = [&](const char* name) -> const char* {
    return (values[name] = machine.variable(name)).c_str();
  };
  try {
    const std::string words = bridge::ros_discovery(variable).words;
    return good("ROS discovery", words.empty() ? "by default" : words);
  } catch (const InputError& e) {
    return {"ROS discovery", false, e.what(),
            "unset ROS_LOCALHOST_ONLY ROS_AUTOMATIC_DISCOVERY_RANGE ROS_STATIC_PEERS"};
  }
}

DoctorCheck sandbox_check(const Machine& machine) {
  if (fs::exists(machine.root / "proc/sys/kernel/seccomp/actions_avail"))
    return good("sandbox", "STEP, IGES and DAE files are read by a process that can neither write nor connect");
  return {"sandbox", false, "this kernel has none (seccomp), so STEP, IGES and DAE files are read with your rights",
          "read files of people you do not know on another computer", false};
}

DoctorCheck dds_file_check(const Machine& machine) {
  const std::string path = machine.variable("FASTRTPS_DEFAULT_PROFILES_FILE");
  if (path.empty() || fs::exists(machine.root / fs::path(path).relative_path()))
    return good("DDS configuration", path.empty() ? "by default" : path);
  return {"DDS configuration", false,
          fmt::format("FASTRTPS_DEFAULT_PROFILES_FILE names {}, which does not exist", path),
          "unset FASTRTPS_DEFAULT_PROFILES_FILE"};
}

}  // namespace

std::vector<DoctorCheck> check_rules(const Machine& machine) {
  return {rule_check(machine, "udev rule for USB", "SUBSYSTEM==\"usb\"", kUsbRule),
          rule_check(machine, "udev rule for HID", "hidraw", kHidRule)};
}

std::vector<DoctorCheck> check_kernel(const Machine& machine) {
  return {module_check(machine, "can", "CAN", true), module_check(machine, "can_raw", "CAN", true),
          module_check(machine, "can_isotp", "long messages; without it the program makes them", false),
          module_check(machine, "vcan", "virtual interfaces", false)};
}

std::vector<DoctorCheck> check_interfaces(const Machine& machine) {
  std::vector<DoctorCheck> checks;
  for (const nlohmann::json& link : machine.interfaces) {
    const std::string kind = word_at(link, "/linkinfo/info_kind");
    if (kind != "can" && kind != "vcan") continue;
    for (DoctorCheck& check : interface_checks(link)) checks.push_back(std::move(check));
  }
  return checks;
}

std::vector<DoctorCheck> check_boards(const Machine& machine) {
  std::vector<DoctorCheck> checks;
  const auto devices = connect::attached_devices(machine.root);
  if (devices.empty())
    checks.push_back({"attached hardware", false, "no CAN interface and no USB board",
                      "plug it in; lsusb and ip -br link show whether the computer sees it"});
  for (const connect::AttachedDevice& device : devices)
    for (DoctorCheck& check : attached_checks(device, machine.boards)) checks.push_back(std::move(check));
  for (const AnsweringBoard& board : machine.boards) checks.push_back(firmware_check(board, machine));
  return checks;
}

std::vector<DoctorCheck> check_surroundings(const Machine& machine) {
  std::vector<DoctorCheck> checks{domain_check(machine), discovery_check(machine), dds_file_check(machine),
                                  sandbox_check(machine)};
  if (machine.has_program("xdg-open"))
    checks.push_back(good("browser", "xdg-open is there"));
  else
    checks.push_back({"browser", false, "none found, so triskin view cannot start one",
                      "sudo apt-get install xdg-utils firefox-esr", false});
  for (const OptionalPart& part : machine.parts) {
    if (part.is_there)
      checks.push_back(good(part.name, "is built in"));
    else
      checks.push_back({part.name, false, "was left out when the program was built",
                        fmt::format("sudo apt-get install {}, then build again", part.package), false});
  }
  return checks;
}

std::vector<DoctorCheck> check_machine(const Machine& machine) {
  std::vector<DoctorCheck> all;
  for (const auto checks : {check_rules, check_kernel, check_interfaces, check_boards, check_surroundings})
    for (DoctorCheck& check : checks(machine)) all.push_back(std::move(check));
  return all;
}

}  // namespace triskin::cli
