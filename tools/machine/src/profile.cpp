// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/profile.hpp"

#include <cxxabi.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>

#include "triskin/machine/flash_chip.hpp"

namespace triskin::machine {
namespace {

std::string demangled(const std::string& symbol) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status),
                                                    std::free);
  return status == 0 ? text.get() : symbol;
}

}  // namespace

std::vector<Profile::Function> Profile::by_function(const ElfImage& image) const {
  std::map<std::uint32_t, std::string> symbols;
  for (const auto& [name, address] : image.symbols) {
    // A symbol of a function has bit 0 set, which selects Thumb; those without it are data and marks of the linker.
    if ((address & 1) != 0) symbols.emplace(address & ~1U, name);
  }
  std::map<std::string, std::uint64_t> sums;
  for (const auto& [address, instructions] : by_block_) {
    const auto behind = symbols.upper_bound(address);
    sums[behind == symbols.begin() ? "?" : std::prev(behind)->second] += instructions;
  }
  std::vector<Function> functions;
  for (const auto& [name, instructions] : sums) functions.push_back({demangled(name), instructions});
  std::ranges::stable_sort(functions, std::ranges::greater{}, &Function::instructions);
  return functions;
}

}  // namespace triskin::machine
