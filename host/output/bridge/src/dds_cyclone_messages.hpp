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

/// Cyclone DDS normally encodes messages itself, but ours are already CDR, so our own sertype and serdata pass the
/// bytes through in both directions. This makes such a type, without a key, with this name on DDS.
[[nodiscard]] ddsi_sertype* make_message_type(const std::string& name);
/// Makes a message from the four bytes that name the encoding and the contents. The caller owns one reference.
[[nodiscard]] ddsi_serdata* make_message(const ddsi_sertype* type, Bytes message);
/// Returns the bytes of a message of such a type.
[[nodiscard]] std::vector<std::uint8_t> bytes_of_message(const ddsi_serdata* message);

}  // namespace triskin::bridge
