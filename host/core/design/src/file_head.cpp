// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/file_head.hpp"

#include <fmt/format.h>

namespace triskin::design {

void require_head(const JsonValue& v, std::string_view format, int version, std::string_view remedy) {
  const std::string found = v["format"].text();
  if (found != format) v["format"].fail(fmt::format("is \"{}\", must be \"{}\"", found, format));
  const int number = v["version"].integer(0, kMaxCount);
  if (number != version)
    v["version"].fail(fmt::format("this file is of version {}, this program reads {}; {}", number, version, remedy));
}

}  // namespace triskin::design
