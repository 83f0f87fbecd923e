// SPDX-License-Identifier: GPL-3.0-or-later
#include "gate.hpp"

#include <fmt/format.h>

#include "messages.hpp"

namespace triskin::view {

bool Gate::host_is_ours(std::string_view host) const {
  return host == fmt::format("127.0.0.1:{}", port_) || host == fmt::format("localhost:{}", port_);
}

bool Gate::origin_is_ours(std::string_view origin) const {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && host_is_ours(origin.substr(kScheme.size()));
}

std::optional<std::string> Gate::name_of(std::string_view target) const {
  if (target.size() < token_.size() + 2 || target.front() != '/' || target[token_.size() + 1] != '/')
    return std::nullopt;
  if (!equal_in_constant_time(target.substr(1, token_.size()), token_)) return std::nullopt;
  return std::string(target.substr(token_.size() + 2));
}

}  // namespace triskin::view
