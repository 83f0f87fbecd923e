// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/board_report.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <regex>
#include <string_view>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/session/firmware_version.hpp"

extern char** environ;

namespace triskin::diagnose {
namespace {

std::string read_to_end(int descriptor) {
  std::string text;
  std::array<char, 512> buffer{};
  for (ssize_t n = 0; (n = ::read(descriptor, buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  return text;
}

// Returns the output of a program, or nothing if it cannot be started or fails.
std::optional<std::string> output_of(std::vector<std::string> words) {
  std::array<int, 2> pipe_ends{};
  if (::pipe(pipe_ends.data()) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", 1, 0);
  ::posix_spawn_file_actions_addclose(&actions, pipe_ends[0]);
  std::vector<char*> arguments;
  for (std::string& w : words) arguments.push_back(w.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(pipe_ends[1]);
  std::string text = failed == 0 ? read_to_end(pipe_ends[0]) : "";
  ::close(pipe_ends[0]);
  int status = 0;
  if (failed != 0 || ::waitpid(child, &status, 0) != child || status != 0) return std::nullopt;
  return text;
}

std::string place_text(const std::filesystem::path& elf, std::uint32_t address) {
  if (elf.empty()) return fmt::format("{:08x}", address);
  const CodePlace place = code_place(elf, address);
  return fmt::format("{:08x}, {} ({})", address, place.function, place.line);
}

std::string_view cause_text(wire::CrashCause cause) {
  switch (cause) {
    case wire::CrashCause::kFault:
      return "a fault of the processor";
    case wire::CrashCause::kStackOverflow:
      return "a stack overflow";
    case wire::CrashCause::kWatchdog:
      return "the watchdog: its loop did not come round";
    case wire::CrashCause::kClock:
      return "the loss of its clock: the crystal stopped";
    case wire::CrashCause::kInterrupt:
      return "an interrupt that nobody asked for";
    case wire::CrashCause::kProgram:
      return "itself: an error of the program";
    case wire::CrashCause::kNone:
      break;
  }
  return "something that it does not know";
}

void add_can_remarks(const wire::BoardHealth& h, std::vector<std::string>& out) {
  if (h.bus_offs > 0)
    out.push_back(fmt::format("left the CAN bus {} (bus-off): check termination, H and L, bit rate",
                              counted(h.bus_offs, "time")));
  if ((h.can_state & wire::can_state::kErrorPassive) != 0)
    out.push_back(fmt::format("CAN error passive, counters {} and {}", h.can_send_errors, h.can_receive_errors));
  if (h.can_lost > 0) out.push_back(fmt::format("{} received CAN frames found no room", h.can_lost));
  if (h.can_ram_failures > 0) out.push_back(fmt::format("{} failures of the CAN message RAM", h.can_ram_failures));
}

void add_remarks(const wire::BoardHealth& h, std::vector<std::string>& out) {
  constexpr std::uint16_t kMinStackBytes = 1024;
  if (h.clock.crystal != wire::Crystal::kUsed && h.clock.crystal != wire::Crystal::kNotSaid)
    out.push_back("runs without its crystal: " + clock_text(h.clock));
  if (h.crashes_in_row > 0) out.push_back(fmt::format("{} crashes in a row", h.crashes_in_row));
  add_can_remarks(h, out);
  if (h.ecc_detected > 0 || h.ecc_corrected > 0)
    out.push_back(fmt::format("flash units with wrong bits: {} corrected, {} not", h.ecc_corrected, h.ecc_detected));
  if (h.flash_errors > 0) out.push_back(fmt::format("{} writes to the flash were refused", h.flash_errors));
  if (h.stack_bytes > 0 && h.stack_free_bytes < kMinStackBytes)
    out.push_back(
        fmt::format("only {} of {} of the stack were never used", h.stack_free_bytes, counted(h.stack_bytes, "byte")));
}

}  // namespace

BoardReport report_board(session::Controller& controller) {
  return {controller.health(), controller.crash()};
}

CodePlace code_place(const std::filesystem::path& elf, std::uint32_t address) {
  if (!std::filesystem::exists(elf))
    throw InputError(fmt::format("{}: no such file; give the image's ELF", elf.string()));
  for (const char* program : {"arm-none-eabi-addr2line", "llvm-addr2line", "llvm-addr2line-19", "llvm-addr2line-14"}) {
    const auto text = output_of({program, "-f", "-C", "-e", elf.string(), fmt::format("{:#x}", address & ~1U)});
    if (!text) continue;
    const std::size_t end = text->find('\n');
    if (end == std::string::npos) break;
    std::string line = text->substr(end + 1);
    line = line.substr(0, line.find_first_of("\n "));
    return {text->substr(0, end), line.substr(line.rfind('/') + 1)};
  }
  throw InputError(
      fmt::format("{}: no addr2line reads it; install binutils-arm-none-eabi, and give an ARM image with "
                  "debug information",
                  elf.string()));
}

std::string crash_text(const wire::Crash& c, const std::filesystem::path& elf) {
  std::string text = fmt::format("was stopped by {} after {:.1f} s", cause_text(c.cause), c.uptime_ms / 1000.0);
  if (c.pc != 0) text += " at " + place_text(elf, c.pc);
  // A return address points behind the call, so the call itself is just before it.
  if (c.lr != 0)
    text += fmt::format("{} {}", c.pc != 0 ? ", called from" : " in what was called from",
                        place_text(elf, (c.lr & ~1U) - 2));
  if (c.address != 0) text += fmt::format(", accessing {:08x}", c.address);
  if (c.firmware_version != 0) text += ", firmware " + session::firmware_version_text(c.firmware_version);
  if (c.number > 1) text += fmt::format(", {} times since power-up", c.number);
  return text;
}

std::string name_places(const std::string& text, const std::filesystem::path& elf) {
  static const std::regex kAddress("@([0-9a-f]{8})");
  std::string out;
  auto rest = text.begin();
  for (std::sregex_iterator at(text.begin(), text.end(), kAddress), end; at != end; ++at) {
    out.append(rest, text.begin() + at->position());
    const CodePlace place = code_place(elf, static_cast<std::uint32_t>(std::stoul((*at)[1].str(), nullptr, 16)));
    out += fmt::format("{} ({})", place.function, place.line);
    rest = text.begin() + at->position() + at->length();
  }
  out.append(rest, text.end());
  return out;
}

std::string clock_text(const wire::ClockState& clock) {
  switch (clock.crystal) {
    case wire::Crystal::kUsed:
      return fmt::format("{} MHz crystal", clock.crystal_mhz);
    case wire::Crystal::kSilent:
      return "internal oscillator, the crystal does not start: missing, broken, or wrong load capacitors";
    case wire::Crystal::kNotMeasured:
      return "internal oscillator, the crystal runs but cannot be measured";
    case wire::Crystal::kUnknown:
      return fmt::format("internal oscillator, the crystal swings at {:.3f} MHz, which is no known one",
                         clock.measured_khz / 1000.0);
    case wire::Crystal::kNoLock:
      return "internal oscillator, the PLL does not lock to the crystal";
    case wire::Crystal::kNoPll:
      return "no PLL";
    case wire::Crystal::kNotSaid:
      break;
  }
  return "not said";
}

std::vector<std::string> board_remarks(const BoardReport& report, const std::filesystem::path& elf) {
  std::vector<std::string> out;
  if (report.crash) out.push_back(crash_text(*report.crash, elf));
  if (report.health) add_remarks(*report.health, out);
  return out;
}

}  // namespace triskin::diagnose
