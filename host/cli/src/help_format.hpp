// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

namespace triskin::cli {

/// Columns that --help may use: COLUMNS of the environment, else those of the terminal on standard output, else 80;
/// never under 40 or over 120.
[[nodiscard]] std::size_t help_columns();

/// `text` in lines of at most `columns` bytes that begin with `indent` blanks (the first with none). Breaks at blanks
/// alone; a longer word gets a line of its own.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

/// --help in two columns that fit the terminal. Ranges and choices stand in words behind what an option does.
class HelpFormat : public CLI::Formatter {
 public:
  /// `columns`: of a line, at least 40.
  explicit HelpFormat(std::size_t columns) : columns_(columns) {}

  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_description(const CLI::App* command) const override;
  std::string make_usage(const CLI::App* command, std::string name) const override;
  std::string make_footer(const CLI::App* command) const override;

 private:
  [[nodiscard]] std::string row(const std::string& left, const std::string& right) const;

  std::size_t columns_;
};

}  // namespace triskin::cli
