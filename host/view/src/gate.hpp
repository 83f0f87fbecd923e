// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace triskin::view {

/// Decides which requests may pass: the rules that keep other users and other pages out.
class Gate {
 public:
  /// `port`: that of the server; `token`: that of its address.
  Gate(std::uint16_t port, std::string token) : port_(port), token_(std::move(token)) {}

  /// True if a Host header names this server. This refuses pages of another host that resolves to 127.0.0.1.
  [[nodiscard]] bool host_is_ours(std::string_view host) const;
  /// True if an Origin header is a page of this server.
  [[nodiscard]] bool origin_is_ours(std::string_view origin) const;
  /// Name of the document that a request target asks for: what follows "/TOKEN/". Empty: the token is missing or wrong.
  /// The name is looked up as it stands, so dots, escapes and queries lead nowhere.
  [[nodiscard]] std::optional<std::string> name_of(std::string_view target) const;

 private:
  std::uint16_t port_;
  std::string token_;
};

}  // namespace triskin::view
