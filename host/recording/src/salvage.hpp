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

/// What is whole in a file of the format MCAP, also behind damage. Every chunk in it has the CRC that it states.
struct Salvage {
  /// The records of the data section stand in the order of the file, without message indexes.
  std::vector<Place> records;
  std::vector<Loss> losses;                           ///< They say what is damaged, in the order of the file.
  std::map<std::uint16_t, Buffer> schemas, channels;  ///< Only the summary still has these contents, keyed by id.
  std::uint64_t messages = 0;                         ///< It counts messages inside and outside the chunks.
  std::uint64_t data_end = 0;      ///< The intact data section ends here, with its end record or with the file.
  bool has_data_end = false;       ///< The end record of the data section was found.
  bool has_footer = false;         ///< The file was closed: footer and magic bytes stand at its end.
  bool has_summary = false;        ///< The summary before the footer has the CRC that it states.
  bool is_checksum_wrong = false;  ///< A byte outside the chunks is another one, and nobody can say which.
};

/// Calls `take(kind, contents)` with each record that stands in `records`, as in those of a chunk, until it returns
/// false. Result: all records are whole and were taken. Cost: linear.
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

/// The head of a chunk with the times and the size that its records have; no CRC protects those that it states. Cost:
/// linear.
[[nodiscard]] ChunkHead head_from(Bytes contents, const ChunkHead& stated);

/// Looks for every whole record of a file. Behind damage it goes on at the next record that proves itself: a chunk or
/// an attachment by its CRC, another one by its structure and that of the record behind it. Throws InputError naming
/// `name` for what is no MCAP file, and for chunks that are compressed. Cost: linear. Memory: one record.
[[nodiscard]] Salvage salvage(const ByteSource& source, const std::string& name);

}  // namespace triskin::recording::mcap
