// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <cstdint>
#include <string>
#include <vector>

#include "triskin/core/bytes.hpp"

namespace triskin::bridge {

/// Cyclone DDS is given messages that are CDR already, and gives such: a sertype and a serdata of our own carry the
/// bytes as they are. A type without a key, of this name on DDS.
[[nodiscard]] ddsi_sertype* make_message_type(const std::string& name);
/// A message with the four bytes that name the encoding. The caller owns one reference.
[[nodiscard]] ddsi_serdata* make_message(const ddsi_sertype* type, Bytes message);
/// The bytes of a message of such a type.
[[nodiscard]] std::vector<std::uint8_t> bytes_of_message(const ddsi_serdata* message);

}  // namespace triskin::bridge
