// SPDX-License-Identifier: GPL-3.0-or-later
#include "generate_docs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <sstream>
#include <vector>

#include "help_command.hpp"

namespace triskin::cli {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* c) { return !c->get_name().empty() && !c->get_group().empty(); });
}

// troff gives a special meaning to a dot or an apostrophe at the start of a line, and to backslashes and hyphens
// everywhere.
std::string escaped(const std::string& text) {
  std::string out;
  bool start = true;
  for (const char c : text) {
    if (start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    start = c == '\n';
  }
  return out;
}

std::string section_of(const CLI::App& command, bool positional) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional() != positional || option->get_group().empty()) continue;
    const std::string name = option->get_name(positional, !positional);
    text += fmt::format(".TP\n.B {}\n{}\n", escaped(name), escaped(option->get_description()));
  }
  return text;
}

// Examples follow a headline in the footer.
std::string example_of(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const auto end = footer.find('\n');
  return end == std::string::npos || !footer.starts_with("Example")
             ? ""
             : ".SH EXAMPLE\n.nf\n" + escaped(footer.substr(end + 1)) + "\n.fi\n";
}

std::string list_of(const CLI::App& program) {
  std::string text = ".SH COMMANDS\n";
  for (const CLI::App* c : commands_of(program))
    text += fmt::format(".TP\n.BR triskin\\-{} (1)\n{}\n", escaped(c->get_name()), escaped(c->get_description()));
  return text;
}

std::string option_words(const CLI::App& command) {
  std::string words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) words += " --" + name;
  }
  return words;
}

int refuse() {
  std::fputs("triskin: generate-docs: give man [COMMAND] or bash\n", stderr);
  return 2;
}

}  // namespace

std::string manual_page(const CLI::App& program, const CLI::App& command) {
  const bool whole = &program == &command;
  const std::string name = whole ? "triskin" : "triskin-" + command.get_name();
  std::string text = fmt::format(
      ".TH {} 1 \"\" \"triskin {}\" \"Triskin\"\n.SH NAME\n{} \\- {}\n", name, TRISKIN_VERSION, escaped(name),
      escaped(whole ? "robot skin from a CAD mesh to a streaming patch" : command.get_description()));
  std::string usage = whole ? "triskin COMMAND [OPTIONS]" : "triskin " + command.get_name() + " [OPTIONS]";
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) usage += " " + option->get_name(true, false);
  text += fmt::format(".SH SYNOPSIS\n.B {}\n", escaped(usage));
  if (whole) return text + list_of(program);
  const std::string positionals = section_of(command, true);
  if (!positionals.empty()) text += ".SH ARGUMENTS\n" + positionals;
  text += ".SH OPTIONS\n" + section_of(command, false);
  return text + example_of(command) +
         ".SH EXIT STATUS\n0 done; 1 the answer is bad; 2 unusable input; 3 a device or link failed.\n.SH SEE "
         "ALSO\n.BR triskin (1)\n";
}

std::string bash_completion(const CLI::App& program) {
  std::string names, cases;
  for (const CLI::App* c : commands_of(program)) {
    names += " " + c->get_name();
    cases += fmt::format("    {}) options=\"{}\" ;;\n", c->get_name(), option_words(*c).substr(1));
  }
  return fmt::format(
      "# bash completion of triskin, made by triskin generate-docs bash\n_triskin() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" options=\"\"\n"
      "  if ((COMP_CWORD == 1)); then\n    mapfile -t COMPREPLY < <(compgen -W \"help{}\" -- \"$word\")\n    return\n  "
      "fi\n"
      "  case \"${{COMP_WORDS[1]}}\" in\n{}  esac\n"
      "  if [[ $word == -* ]]; then mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n"
      "  else mapfile -t COMPREPLY < <(compgen -f -- \"$word\"); fi\n}}\ncomplete -o filenames -F _triskin triskin\n",
      names, cases);
}

std::optional<int> answer_generate_docs(const CLI::App& program, int argc, const char* const* argv) {
  if (argc < 2 || std::string(argv[1]) != "generate-docs") return std::nullopt;
  const std::string kind = argc > 2 ? argv[2] : "";
  const CLI::App* command = argc > 3 ? find_command(program, argv[3]) : &program;
  if (command == nullptr) return refuse();
  std::string text;
  if (kind == "man") text = manual_page(program, *command);
  if (kind == "bash") text = bash_completion(program);
  if (text.empty()) return refuse();
  std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace triskin::cli
