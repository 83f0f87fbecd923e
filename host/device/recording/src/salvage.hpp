// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "record_walk.hpp"
#include "triskin/recording/byte_source.hpp"
#include "triskin/recording/mcap.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::recording::mcap {

/// A salvage lists the intact parts of a file of the format MCAP, even behind damage. The CRC of every chunk in it is
/// right.
struct Salvage {
  /// The records of the data section are in the order of the file, without message indexes.
  std::vector<Place> records;
  std::vector<Loss> losses;                           ///< The damaged places are in the order of the file.
  std::map<std::uint16_t, Buffer> schemas, channels;  ///< Only the summary still has these definitions, by id.
  std::uint64_t messages = 0;                         ///< Messages inside and outside chunks count.
  std::uint64_t data_end = 0;      ///< The intact data section ends here, with its end record or with the file.
  bool has_data_end = false;       ///< The end record of the data section was found.
  bool has_footer = false;         ///< The file was closed: it ends with footer and magic bytes.
  bool has_summary = false;        ///< The summary before the footer has the right CRC.
  bool is_checksum_wrong = false;  ///< A byte outside the chunks is wrong, but it is unknown which one.
};

/// Calls `take(kind, contents)` with each record in `records`, such as those of a chunk, until it returns false.
/// Returns true if all records are whole and were accepted. Cost: linear.
template <class Take>
bool each_record(Bytes records, Take take) {
  while (!records.empty()) {
    ByteReader r(records);
    const auto kind = static_cast<Kind>(r.u8());
    const std::uint64_t length = r.le64();
    if (!r.ok() || length > r.rest().size() || !take(kind, r.rest().first(length))) return false;
    records = r.rest().subspan(length);
  }
  return true;
}

/// Computes the head of a chunk again, with the times and the size of its records, because no CRC protects the stated
/// ones. Cost: linear.
[[nodiscard]] ChunkHead head_from(Bytes contents, const ChunkHead& stated);

/// Finds every whole record of a file. Behind damage it continues at the next record that can be verified: a chunk or
/// an attachment by its CRC, another one by its structure and that of the record behind it. Throws InputError naming
/// `name` for a file that is not MCAP, and for compressed chunks. Cost: linear. Memory: one record.
[[nodiscard]] Salvage salvage(const ByteSource& source, const std::string& name);

}  // namespace triskin::recording::mcap
