// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

namespace triskin::cli {

/// Returns the columns available for --help: COLUMNS of the environment, else those of the terminal on standard output,
/// else 80; always between 40 and 120.
[[nodiscard]] std::size_t help_columns();

/// Breaks `text` into lines of at most `columns` bytes; all except the first begin with `indent` blanks. It breaks only
/// at blanks; a longer word gets its own line.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

/// Formats --help in two columns that fit the terminal. The description of an option also states its range and choices.
class HelpFormat : public CLI::Formatter {
 public:
  /// `columns` is the width of a line, at least 40.
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
