// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/ros_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "triskin/base/ascii_name.hpp"
#include "triskin/base/error.hpp"

namespace triskin::bridge {
namespace {

// Whether every part between slashes is such a name as stands in topics; a "~" may stand first.
bool is_name(std::string_view name) {
  if (name.starts_with("~/")) name.remove_prefix(2);
  if (name.starts_with('/')) name.remove_prefix(1);
  while (true) {
    const std::size_t end = name.find('/');
    if (!is_part_name(name.substr(0, end))) return false;
    if (end == std::string_view::npos) return true;
    name.remove_prefix(end + 1);
  }
}

std::string joined(const std::string& space, std::string_view name) {
  return (space == "/" ? "/" : space + "/") + std::string(name);
}

std::string expanded(const RosNode& node, std::string_view name) {
  if (name.starts_with('/')) return std::string(name);
  if (name.starts_with("~/")) return joined(joined(node.space, node.name), name.substr(2));
  return joined(node.space, name);
}

// A number, a truth value, or else text, as YAML has it.
ParameterValue value_of(std::string_view text) {
  if (text == "true" || text == "True") return true;
  if (text == "false" || text == "False") return false;
  const char *first = text.data(), *last = text.data() + text.size();
  std::int64_t whole = 0;
  if (const auto r = std::from_chars(first, last, whole); r.ec == std::errc{} && r.ptr == last) return whole;
  double number = 0.0;
  if (const auto r = std::from_chars(first, last, number); r.ec == std::errc{} && r.ptr == last) return number;
  const bool quoted = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front();
  return std::string(quoted ? text.substr(1, text.size() - 2) : text);
}

// "a:=b"
std::pair<std::string, std::string> rule_of(const std::string& argument, std::string_view option) {
  const std::size_t at = argument.find(":=");
  if (at == std::string::npos || at == 0 || at + 2 == argument.size())
    throw InputError(fmt::format("--ros-args {} {}: a rule is NAME:=VALUE, as __ns:=/robot1", option, argument));
  return {argument.substr(0, at), argument.substr(at + 2)};
}

void add_remap(RosNode& node, std::vector<std::pair<std::string, std::string>>& of_node, const std::string& rule) {
  auto [from, to] = rule_of(rule, "-r");
  if (from == "__node" || from == "__name") {
    if (!is_part_name(to))
      throw InputError(fmt::format("--ros-args -r {}: a node's name has letters, digits and _", rule));
    node.name = to;
  } else if (from == "__ns") {
    if (to != "/" && (!to.starts_with('/') || !is_name(to)))
      throw InputError(fmt::format("--ros-args -r {}: a namespace begins with / and has letters, digits and _", rule));
    node.space = to;
  } else {
    const std::size_t colon = from.find(':');
    const std::string plain = colon == std::string::npos ? from : from.substr(colon + 1);
    if (!is_name(plain) || !is_name(to))
      throw InputError(
          fmt::format("--ros-args -r {}: both sides are names of topics or services, as skin/arm/raw", rule));
    of_node.emplace_back(from, to);
  }
}

}  // namespace

std::string RosNode::resolve(std::string_view relative) const {
  std::string full = expanded(*this, relative);
  for (const auto& [from, to] : remaps)
    if (expanded(*this, from) == full) return expanded(*this, to);
  return full;
}

RosNode ros_node(std::span<const std::string> arguments, std::string_view distribution) {
  RosNode node;
  constexpr std::string_view kLongGids[] = {"foxy", "galactic", "humble"};
  node.gid_has_24_bytes = std::ranges::find(kLongGids, distribution) != std::end(kLongGids);
  std::vector<std::pair<std::string, std::string>> remaps;
  std::size_t k = 0;
  const auto next = [&](const std::string& option) -> const std::string& {
    if (++k == arguments.size()) throw InputError(fmt::format("--ros-args {}: its value is missing", option));
    return arguments[k];
  };
  for (; k < arguments.size(); ++k) {
    const std::string& option = arguments[k];
    if (option == "-r" || option == "--remap") {
      add_remap(node, remaps, next(option));
    } else if (option == "-p" || option == "--param") {
      auto [name, value] = rule_of(next(option), "-p");
      if (const std::size_t colon = name.find(':'); colon != std::string::npos) name.erase(0, colon + 1);
      node.parameters[name] = value_of(value);
    } else if (option == "--log-level" || option == "--enclave" || option == "-e") {
      (void)next(option);
    } else if (option != "--ros-args") {
      throw InputError(fmt::format(
          "--ros-args {}: this program takes -r FROM:=TO and -p NAME:=VALUE, no files of parameters", option));
    }
  }
  // A rule "node:from:=to" is for the node of that name, which may be given after it.
  for (auto& [from, to] : remaps) {
    const std::size_t colon = from.find(':');
    if (colon == std::string::npos) {
      node.remaps.emplace_back(from, to);
    } else if (from.substr(0, colon) == node.name) {
      node.remaps.emplace_back(from.substr(colon + 1), to);
    }
  }
  return node;
}

}  // namespace triskin::bridge
