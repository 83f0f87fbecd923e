// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/wire/can_frame.hpp"
#include "vectors/vector_file.hpp"

namespace triskin::test {

/// Reads a frame as the vector files write it: kind (S 11 bit, E 29 bit, F 29 bit FD), identifier and bytes in hex.
inline wire::CanFrame frame_of(const std::string& text) {
  std::istringstream in(text);
  std::string kind, id, rest;
  in >> kind >> id;
  std::getline(in, rest);
  wire::CanFrame f;
  f.id = static_cast<std::uint32_t>(std::stoul(id, nullptr, 16));
  f.extended = kind != "S";
  f.fd = f.bit_rate_switch = kind == "F";
  for (const std::uint8_t b : hex_bytes(rest)) f.data.at(f.size++) = b;
  return f;
}

}  // namespace triskin::test
