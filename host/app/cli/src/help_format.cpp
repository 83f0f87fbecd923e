// SPDX-License-Identifier: GPL-3.0-or-later
#include "help_format.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <sstream>

namespace triskin::cli {
namespace {

constexpr std::size_t kMinColumns = 40, kMaxColumns = 120, kColumnsWithoutTerminal = 80;

std::size_t terminal_columns() {
  if (const char* columns = std::getenv("COLUMNS"); columns != nullptr && std::atoi(columns) > 0)
    return static_cast<std::size_t>(std::atoi(columns));
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return kColumnsWithoutTerminal;
}

// Continuation bytes of UTF-8 take no column.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

/// Validators give the type of an option in these words: the text after the name, and an addition to the description.
struct TypeWords {
  std::string name, remark;
};

std::string choices_of(std::string list) {
  for (const char separator : {'|', ','}) {
    for (std::size_t at = 0; (at = list.find(separator, at)) != std::string::npos; at += 2) list.replace(at, 1, ", ");
    if (list.find(", ") != std::string::npos) break;
  }
  return list;
}

std::string plain_number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size() ? fmt::format("{:.12g}", value) : text;
}

TypeWords words_of(const std::string& type) {
  static const std::regex range(R"((\w+):\w+ in \[(.*) - (.*)\])"), choice(R"((\w+):\{(.*)\})");
  static const std::regex kind(R"((\w+):(\w+))");
  std::smatch part;
  const auto name = [](const std::string& t) { return t == "FLOAT" || t == "UINT" || t == "INT" ? "NUMBER" : t; };
  if (std::regex_match(type, part, range))
    return {name(part[1]), fmt::format("{} to {}", plain_number(part[2]), plain_number(part[3]))};
  if (std::regex_match(type, part, choice)) return {"NAME", "one of " + choices_of(part[2])};
  if (std::regex_match(type, part, kind) && part[2] == "POSITIVE") return {name(part[1]), "above 0"};
  if (std::regex_match(type, part, kind) && part[2] == "NONNEGATIVE") return {name(part[1]), "0 or more"};
  if (std::regex_match(type, part, kind)) return {part[2] == "DIR" ? "FOLDER" : part[2].str(), ""};
  return {name(type), ""};
}

// Returns the text after the name of an option: its type, its default, and whether it may be repeated or is required.
std::string behind_name(const CLI::Option& option, const std::string& type) {
  std::string text = option.get_type_size() == 0 || type.empty() ? "" : " " + type;
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
  if (!option.get_default_str().empty() && option.get_type_size() != 0)
    text += fmt::format(" [{}]", plain_number(option.get_default_str()));
  return text + (option.get_required() ? " REQUIRED" : "");
}

}  // namespace

std::size_t help_columns() {
  return std::clamp(terminal_columns(), kMinColumns, kMaxColumns);
}

std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent) {
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && indent + width_of(line) + 1 + width_of(word) > columns) {
      lines += line + "\n" + std::string(indent, ' ');
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

std::string HelpFormat::row(const std::string& left, const std::string& right) const {
  constexpr std::size_t kMargin = 2, kGap = 2, kLeft = 26;
  const std::size_t indent = std::min<std::size_t>(kMargin + kLeft, columns_ / 3);
  const std::string text = right.empty() ? "" : wrapped(right, columns_, indent);
  std::string line = std::string(kMargin, ' ') + left;
  if (text.empty()) return line + "\n";
  if (width_of(line) + kGap > indent) return line + "\n" + std::string(indent, ' ') + text + "\n";
  return line + std::string(indent - width_of(line), ' ') + text + "\n";
}

std::string HelpFormat::make_option(const CLI::Option* option, bool is_positional) const {
  const TypeWords type = words_of(option->get_type_name());
  std::string right = option->get_description();
  if (!type.remark.empty()) right += fmt::format("{}({})", right.empty() ? "" : " ", type.remark);
  static const std::regex value_of_flag(R"(\{\w+\})");
  const std::string name = std::regex_replace(make_option_name(option, is_positional), value_of_flag, "");
  return row(name + behind_name(*option, is_positional ? "" : type.name), right);
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  return row(command->get_name(), command->get_description());
}

std::string HelpFormat::make_description(const CLI::App* command) const {
  const std::string text = wrapped(command->get_description(), columns_, 0);
  return text.empty() ? text : text + "\n";
}

std::string HelpFormat::make_usage(const CLI::App* command, std::string name) const {
  constexpr std::size_t kIndent = 7;  // Text is aligned with the first word after "Usage:".
  return wrapped(CLI::Formatter::make_usage(command, std::move(name)), columns_, kIndent) + "\n";
}

// An example that is longer than a line continues after a backslash, as a shell expects.
std::string HelpFormat::make_footer(const CLI::App* command) const {
  constexpr std::size_t kIndent = 6, kMargin = 2;
  std::istringstream lines(command->get_footer());
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    if (width_of(line) <= columns_) {
      text += line + "\n";
      continue;
    }
    const bool is_example = line.starts_with("  ");
    const std::size_t room = columns_ - (is_example ? 2 * kMargin : 0);
    std::string broken = wrapped(line, room, is_example ? kIndent : 0);
    if (is_example) {
      for (std::size_t at = 0; (at = broken.find('\n', at)) != std::string::npos; at += 3)
        broken.replace(at, 1, " \\\n");
      broken = "  " + broken;
    }
    text += broken + "\n";
  }
  return text;
}

}  // namespace triskin::cli
