// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/file_head.hpp"

namespace triskin::design {

void require_format(const JsonValue& v, std::string_view wanted, std::string_view writer) {
  if (v["format"].text() != wanted) v["format"].fail(fmt::format("must be \"{}\", as {} writes it", wanted, writer));
}

void require_version(const JsonValue& v, int wanted, std::string_view remedy) {
  const int version = v["version"].integer(0, kMaxCount);
  if (version != wanted) v["version"].fail(fmt::format("is {}, this program reads {}; {}", version, wanted, remedy));
}

}  // namespace triskin::design
