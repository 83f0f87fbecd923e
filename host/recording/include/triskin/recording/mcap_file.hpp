// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "triskin/recording/mcap.hpp"
#include "triskin/recording/output_file.hpp"

/// Files of the format MCAP: written as messages come, read up to the last whole record.
namespace triskin::recording::mcap {

/// When a chunk is closed and written: whichever comes first.
struct ChunkLimits {
  std::uint64_t span_ns = 500'000'000;  ///< The next chunk begins this long after the chunk's first message.
  std::size_t size_bytes = std::size_t{1} << 20;
};

/// Writes a file. What is held in memory is one chunk, however long the file gets. Threads: one.
class Writer {
 public:
  /// Writes the header. `file` outlives the writer. Throws WriteFailed, as every function of this class.
  Writer(OutputFile& file, std::string_view profile, std::string_view library, ChunkLimits limits = {});

  /// Adds a schema; returns its number, 1 …. Throws WriteFailed.
  std::uint16_t add_schema(std::string_view name, std::string_view definition);
  /// Adds a channel of a schema, with messages in CDR; returns its number, 1 …. Throws WriteFailed.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, const TextMap& metadata);
  /// Adds a message to the chunk. `log_ns`: when it came here, ns since 1970; `publish_ns`: when it was made, 0: as
  /// `log_ns`. Throws WriteFailed.
  void write(std::uint16_t channel, std::uint64_t log_ns, Bytes data, std::uint64_t publish_ns = 0);
  /// Closes the chunk and adds a file. Throws WriteFailed.
  void attach(const Attachment& attachment);
  /// Closes the chunk and adds a table. Throws WriteFailed.
  void describe(const Metadata& metadata);
  /// Closes the chunk: what was written until now can be read from the file. Throws WriteFailed.
  void flush();
  /// Closes the chunk and writes the summary; nothing can be written then. Throws WriteFailed.
  void finish();
  /// Messages of the open chunk.
  [[nodiscard]] std::uint64_t waiting() const { return waiting_; }

 private:
  void put(Kind kind, const Buffer& contents);
  void put(Bytes bytes);

  OutputFile& file_;
  ChunkLimits limits_;
  Buffer chunk_;
  std::uint64_t start_ns_ = 0, end_ns_ = 0, waiting_ = 0;
  std::map<std::uint16_t, std::uint32_t> sequence_;  // Sequence number of the next message, keyed by channel.
  std::uint16_t schemas_ = 0;
  std::uint32_t crc_ = 0;  // CRC of everything written so far.
};

/// Ends a file whose last record belongs to the data section: end of data, summary with an index of all chunks, footer.
/// `data_crc` is that of all bytes so far, 0: unknown. A file that cannot be read again gets no summary. Throws
/// WriteFailed. Cost: reads the head of every record.
void finish_file(OutputFile& file, std::uint32_t data_crc);

/// Callbacks of a reader, in the order of the file.
class Visitor {
 public:
  virtual ~Visitor() = default;
  /// A definition of messages, before the channels that use it.
  virtual void on_schema(const Schema& /*schema*/) {}
  /// A topic, before its messages.
  virtual void on_channel(const Channel& /*channel*/) {}
  /// A message; its data is valid during the call only.
  virtual void on_message(const Message& /*message*/) {}
  /// A file inside the file.
  virtual void on_attachment(const Attachment& /*attachment*/) {}
  /// A table of texts.
  virtual void on_metadata(const Metadata& /*metadata*/) {}
};

/// How far a file could be read.
struct ReadReport {
  bool complete = false;          ///< The file was closed properly.
  std::uint64_t messages = 0;     ///< So many messages were passed to the visitor.
  std::uint64_t whole_bytes = 0;  ///< It reaches to the end of the last whole record of the data section.
  std::uint64_t file_bytes = 0;
  std::uint64_t unindexed_chunk = 0;  ///< It is the start of the last chunk if its index is not whole, otherwise 0.
  std::string problem;                ///< It says why the file ends early and is empty if it does not.
};
/// Reads all records up to the first that is cut or damaged; a chunk whose CRC is wrong is not passed on. Memory: one
/// chunk, at most 256 MiB. Throws InputError naming `name` when it is no MCAP file or uses compression, which this
/// program does not read.
ReadReport read_file(const ByteSource& source, const std::string& name, Visitor& visitor);

/// Index records of a chunk with these records, one after the other. Throws nothing of its own. Cost: linear.
[[nodiscard]] Buffer index_of(Bytes records);

}  // namespace triskin::recording::mcap
