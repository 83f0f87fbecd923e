// SPDX-License-Identifier: GPL-3.0-or-later
// Each programming line of docs/program_board.md, done to the modelled board as its tool does it: erase, write, option
// bytes, and the reset at its end. A soldered transceiver holds PB8, which is BOOT0 of a new chip, high.
#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <sstream>

#include "sampling_bench.hpp"
#include "support/places.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kSlotA = 0x08004000, kFlashRegisters = 0x40022000, kKeyr = 0x08, kOptKeyr = 0x0C, kOptr = 0x20,
                        kCr = 0x14, kOptionStart = 0x00020000, kOptionLaunch = 0x08000000;
const std::filesystem::path kSources = test::source_folder();

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

// What differs between versions of the tools, and nobody promises.
struct Habits {
  Filling filling{1024, 0xFF};
  bool starts_after_download = false;  // probe-rs leaves the core halted, or lets it run.
};

std::uint32_t number(const std::string& text) {
  const bool hex = text.starts_with("0x");
  std::uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data() + (hex ? 2 : 0), end, value, hex ? 16 : 10);
  EXPECT_TRUE(error == std::errc{} && at == end) << "no number: " << text;
  return value;
}

using Words = std::vector<std::string>;

// Words of a shell command; quotes join what they enclose.
Words words_of(const std::string& command) {
  Words words;
  bool quoted = false, open = false;
  for (const char c : command) {
    if (c == '"') {
      quoted = !quoted;
      if (!open) words.emplace_back();
      open = true;
    } else if (c == ' ' && !quoted) {
      open = false;
    } else {
      if (!open) words.emplace_back();
      open = true;
      words.back() += c;
    }
  }
  return words;
}

// The commands of a line: those between && and ;, loops unrolled as a shell does it.
std::vector<Words> commands_of(std::string line) {
  static const std::regex kLoop(R"(for (\w+) in ((?:"[^"]*" ?)+); do ([^;]*); done)");
  for (std::smatch loop; std::regex_search(line, loop, kLoop);) {
    std::string unrolled;
    for (const std::string& value : words_of(loop[2]))
      unrolled +=
          (unrolled.empty() ? "" : "; ") + std::regex_replace(loop[3].str(), std::regex("\\$" + loop[1].str()), value);
    line = loop.prefix().str() + unrolled + loop.suffix().str();
  }
  std::vector<Words> commands;
  std::string part;
  bool quoted = false;
  for (std::size_t k = 0; k <= line.size(); ++k) {
    const bool two = line.compare(k, 2, "&&") == 0;
    if (k == line.size() || (!quoted && (line[k] == ';' || two))) {
      commands.push_back(words_of(part));
      part.clear();
      k += two ? 1 : 0;
      continue;
    }
    quoted ^= line[k] == '"';
    part += line[k];
  }
  return commands;
}

class Programmers : public Sampling {
 protected:
  void take(const BenchBoard& kind) {
    board = kind;
    running_slot = 0;
    Bench::SetUp();
    flash = FlashChip{};
  }
  void SetUp() override { take(nucleo_board()); }

  void run(const std::string& line) {
    for (const Words& command : commands_of(line)) {
      SCOPED_TRACE(fmt::format("{}", fmt::join(command, " ")));
      const std::string& tool = command.at(0);
      if (tool == "openocd")
        openocd(command);
      else if (tool == "probe-rs")
        probe_rs(command);
      else if (tool == "pyocd")
        pyocd(command);
      else if (tool == "st-flash")
        st_flash(command);
      else if (tool == "STM32_Programmer_CLI")
        cube_programmer(command);
      else
        ADD_FAILURE() << "unknown tool";
      if (HasFatalFailure()) return;
    }
  }

  // The chip's flash is written before the machine starts: a blank chip does nothing.
  void program(const std::string& file, const Filling& filling) {
    ASSERT_EQ(machine, nullptr) << "written twice";
    flash.program_file(board.file(std::filesystem::path(file).filename().c_str()), filling);
    power_up();
    machine->hold_core(true);
  }
  void reset(bool held) {
    if (machine == nullptr) return;
    machine->press_reset();
    machine->hold_core(held);
    run_for(1'000);
  }
  void write(std::uint32_t offset, std::uint32_t value) { machine->write_register(kFlashRegisters + offset, value); }
  void unlock() {
    for (const std::uint32_t key : {0x45670123U, 0xCDEF89ABU}) write(kKeyr, key);
    for (const std::uint32_t key : {0x08192A3BU, 0x4C5D6E7FU}) write(kOptKeyr, key);
  }
  void write_options(std::uint32_t value, std::uint32_t mask) {
    unlock();
    write(kOptr, (machine->read_register(kFlashRegisters + kOptr) & ~mask) | (value & mask));
    write(kCr, kOptionStart);
    run_for(30'000);
    lock();
  }
  void lock() { write(kCr, 0xC0000000); }
  void load_options() {
    unlock();
    write(kCr, kOptionLaunch);
    run_for(1'000);
  }

  void openocd(const Words& w) {
    ASSERT_EQ(w.at(1), "-f");
    ASSERT_EQ(w.at(3), "-c");
    const std::string script = text_of(kSources / w.at(2));
    std::map<std::string, Words> procedures;
    static const std::regex kProcedure(R"(proc (\w+) \{(\w*)\} \{\n([^}]*)\})");
    for (std::sregex_iterator p(script.begin(), script.end(), kProcedure), end; p != end; ++p) {
      std::istringstream body((*p)[3]);
      for (std::string line; std::getline(body, line);) procedures[(*p)[1]].push_back(line);
    }
    const Words call = words_of(w.at(4));
    ASSERT_EQ(call.size(), 2U);
    openocd_procedure(procedures, call.at(0), call.at(1));
  }
  void openocd_procedure(const std::map<std::string, Words>& procedures, const std::string& name,
                         const std::string& argument) {
    ASSERT_TRUE(procedures.contains(name)) << name;
    for (const std::string& line : procedures.at(name)) {
      Words w = words_of(line);
      if (w.empty() || w.at(0) == "#" || w.at(0) == "init" || w.at(0) == "shutdown") continue;
      if (w.at(0) == "reset")
        reset(w.at(1) == "halt");
      else if (w.at(0) == "program")
        program(argument, {.block_bytes = 8});
      else if (w.at(0) == "stm32l4x" && w.at(1) == "option_write" && number(w.at(3)) == kOptr)
        write_options(number(w.at(4)), number(w.at(5)));
      else if (w.at(0) == "stm32l4x" && w.at(1) == "option_load")
        load_options();
      else if (w.at(0) != "stm32l4x" || w.at(1) != "mass_erase")
        openocd_procedure(procedures, w.at(0), "");
    }
  }

  void probe_rs(const Words& w) {
    if (w.at(1) == "download") {
      program(w.back(), habits.filling);
      if (habits.starts_after_download) reset(false);
    } else if (w.at(1) == "write") {
      ASSERT_EQ(w.size(), 7U);
      ASSERT_EQ(w.at(4), "b32");
      machine->write_register(number(w.at(5)), number(w.at(6)));
    } else {
      ASSERT_EQ(w.at(1), "reset");
      reset(false);
    }
    run_for(300'000);  // Each command is a process that attaches anew.
  }

  void pyocd(const Words& w) {
    if (w.at(1) == "flash") {
      program(w.back(), habits.filling);
      reset(false);
      run_for(1'000'000);
    } else if (w.at(1) == "cmd") {
      for (std::size_t k = 4; k + 1 < w.size(); k += 2) {
        ASSERT_EQ(w.at(k), "-c");
        const Words command = words_of(w.at(k + 1));
        if (command.at(0) == "write32")
          machine->write_register(number(command.at(1)), number(command.at(2)));
        else if (command.at(0) == "sleep")
          run_for(1000 * std::uint64_t{number(command.at(1))});
        else if (command.at(0) == "reset")
          reset(command.size() > 1 && command.at(1) == "halt");
        else
          FAIL() << command.at(0);
        run_for(1'000);
      }
    } else {
      ASSERT_EQ(w.at(1), "reset");
      reset(false);
    }
  }

  void st_flash(const Words& w) {
    if (w.at(1) == "write") {
      ASSERT_EQ(w.at(3), "0x08000000");
      program(w.at(2), {.block_bytes = 8});
      reset(false);
    } else if (w.at(1) == "--area=option") {
      ASSERT_EQ(w.at(2), "write");
      reset(true);
      write_options(number(w.at(3)), 0xFFFFFFFF);
      load_options();
      machine->hold_core(false);
    } else if (w.at(1) == "reset") {
      reset(false);
    } else {
      ASSERT_EQ(w.at(1), "erase");
    }
  }

  void cube_programmer(const Words& w) {
    for (std::size_t k = 1; k < w.size(); ++k) {
      if (w[k] == "-w") program(w.at(k + 1), {.block_bytes = 8});
      if (w[k] == "-rst") reset(false);
      if (w[k] != "-ob") continue;
      std::uint32_t value = 0, mask = 0;
      for (; k + 1 < w.size() && w[k + 1][0] != '-'; ++k) {
        const std::size_t equals = w[k + 1].find('=');
        const std::string name = w[k + 1].substr(0, equals);
        const unsigned shift = name == "nSWBOOT0" ? 26 : name == "nBOOT0" ? 27 : 8;
        ASSERT_TRUE(shift != 8 || name == "BOR_LEV") << name;
        mask |= (shift == 8 ? 7U : 1U) << shift;
        value |= number(w[k + 1].substr(equals + 1)) << shift;
      }
      write_options(value, mask);
      load_options();
    }
  }

  void expect_application(bool options_by_the_line) {
    ASSERT_NE(machine, nullptr) << "nothing was written";
    machine->hold_core(false);
    run_for(200'000);
    EXPECT_FALSE(machine->in_rom_loader()) << "at the end of the line";
    EXPECT_EQ(machine->vector_table(), kSlotA);
    if (options_by_the_line) {
      EXPECT_EQ(flash.options, 0xFBEFFCAAU);
    }
    run_for(3'000'000);
    EXPECT_EQ(flash.options, 0xFBEFFCAAU) << "three seconds later the firmware has set them itself";
    const FlashChip left = flash;
    machine->power_cycle(left);
    run_for(200'000);
    EXPECT_FALSE(machine->in_rom_loader()) << "after the power was cycled";
    EXPECT_EQ(machine->vector_table(), kSlotA);
    machine_resets_ = machine->counts().resets;
    EXPECT_TRUE(health().has_value());
    run_for(10'000);
    EXPECT_TRUE(confirmed()) << "what the programmer filled up must leave room for the marks";
  }

  Habits habits;
  int machine_resets_ = 0;  ///< resets until the board was in order
};

// Lines of the page by the chip's folder: tool and command of each row.
std::map<std::string, std::vector<std::pair<std::string, std::string>>> page_lines() {
  const std::string page = text_of(kSources / "docs/program_board.md");
  static const std::regex kRow(R"(\n\| ([\w\-]+) \| `([^`]*)` \|)");
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> lines;
  for (std::sregex_iterator r(page.begin(), page.end(), kRow), end; r != end; ++r) {
    const std::string command = (*r)[2];
    lines[command.find("nucleo_l452re") == std::string::npos ? "g474" : "l452"].emplace_back((*r)[1], command);
  }
  return lines;
}

TEST_F(Programmers, EachLineOfThePageEndsInTheApplicationWithATransceiverSoldered) {
  const auto commands = page_lines().at("g474");
  ASSERT_EQ(commands.size(), 5U);
  for (const Filling& filling : {Filling{1024, 0xFF}, Filling{1024, 0x00}}) {
    for (const bool starts : {false, true}) {
      for (const auto& [tool, line] : commands) {
        SCOPED_TRACE(fmt::format("{}, filled up with {:#x}, {}", tool, filling.value, starts ? "started" : "halted"));
        machine.reset();
        flash = FlashChip{};
        habits = {filling, starts};
        boot_pin_high = true;
        run(line);
        expect_application(true);
        expect_no_violation();
      }
    }
  }
}

// Without a transceiver the firmware starts at once and sets the options itself after two seconds, perhaps while a tool
// does the same.
TEST_F(Programmers, EachLineWorksWithoutATransceiverToo) {
  const auto commands = page_lines().at("g474");
  for (const auto& [tool, line] : commands) {
    SCOPED_TRACE(tool);
    machine.reset();
    flash = FlashChip{};
    habits = {.starts_after_download = true};
    boot_pin_high = false;
    run(line);
    boot_pin_high = true;
    expect_application(false);
  }
}

// Boards drawn from the whole of the ranges of docs/silicon.md at once: chip, crystal, edges, disturbances, tool, and
// what the tool fills up with. Each is programmed by a line of the page, takes a table, and streams.
TEST_F(Programmers, BoardsDrawnFromTheWholeOfTheRangesStream) {
  constexpr unsigned kSeed = 56;
  constexpr int kBoards = 12, kModules = 16;
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const auto commands = page_lines().at("g474");
  for (int drawn = 0; drawn < kBoards; ++drawn) {
    machine.reset();
    flash = FlashChip{};
    frames.clear();
    const auto& [tool, line] = commands.at(random() % commands.size());
    habits = {{random() % 2 == 0 ? 1024U : 8U, random() % 2 == 0 ? std::uint8_t{0xFF} : std::uint8_t{0}},
              random() % 2 == 0};
    crystal_hz = std::array{0, 8, 16, 24, 25, 40}.at(random() % 6) * 1'000'000ULL;
    scl_rise_ns = static_cast<std::uint32_t>(between(0, 300));
    spread = {between(-0.015, 0.015), between(-0.08, 0.06), between(0.9, 1.6)};
    disturbances = {};
    disturbances.clock_stretches = between(0, 3600);
    disturbances.bus_errors = between(0, 600);
    disturbances.seed = random();
    boot_pin_high = random() % 4 != 0;
    SCOPED_TRACE(fmt::format("board {} of seed {}: {}, crystal {}, rise {} ns, HSI {:+.3f}, LSI {:+.3f}, flash {:.2f}",
                             drawn, kSeed, tool, crystal_hz, scl_rise_ns, spread.internal_error, spread.watchdog_error,
                             spread.flash_factor));
    run(line);
    expect_application(boot_pin_high);
    ASSERT_TRUE(flash_table(patch(kModules)));
    ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
    run_for(4'000'000);
    EXPECT_EQ(samples().size(), static_cast<std::size_t>(kModules));
    EXPECT_EQ(machine->counts().resets, machine_resets_);
  }
}

class ProgrammersOfTheSecondBoard : public Programmers {
 protected:
  void SetUp() override { take(nucleo_l452re_board()); }
};

// BOOT0 of this board is a pin with a pull-down.
TEST_F(ProgrammersOfTheSecondBoard, EachLineEndsInTheApplication) {
  const auto commands = page_lines().at("l452");
  ASSERT_EQ(commands.size(), 5U);
  for (const auto& [tool, line] : commands) {
    SCOPED_TRACE(tool);
    machine.reset();
    flash = FlashChip{};
    boot_pin_high = false;
    run(line);
    expect_application(tool != "st-flash");
    expect_no_violation();
  }
}

}  // namespace
}  // namespace triskin::machine
