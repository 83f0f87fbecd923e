// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace triskin::view {

/// Decides which requests may pass, to keep other users and other pages out.
class Gate {
 public:
  /// `port` is that of the server, `token` that of its address.
  Gate(std::uint16_t port, std::string token) : port_(port), token_(std::move(token)) {}

  /// Returns true if a Host header names this server. This refuses pages of another host name that resolves to
  /// 127.0.0.1.
  [[nodiscard]] bool host_is_ours(std::string_view host) const;
  /// Returns true if an Origin header is a page of this server.
  [[nodiscard]] bool origin_is_ours(std::string_view origin) const;
  /// Returns the name of the document that a request target asks for, which is the text after "/TOKEN/". Empty: the
  /// token is missing or wrong. The name is used exactly as it is, so dots, escapes and queries lead nowhere.
  [[nodiscard]] std::optional<std::string> name_of(std::string_view target) const;

 private:
  std::uint16_t port_;
  std::string token_;
};

}  // namespace triskin::view
