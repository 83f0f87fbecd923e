// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "triskin/recording/mcap.hpp"
#include "triskin/recording/output_file.hpp"

/// Writes files of the format MCAP as messages arrive, and reads them up to the last whole record.
namespace triskin::recording::mcap {

/// A chunk is closed and written when it reaches the first of these limits.
struct ChunkLimits {
  std::uint64_t span_ns = 500'000'000;  ///< The next chunk begins this long after the chunk's first message.
  std::size_t size_bytes = std::size_t{1} << 20;
};

/// Writes a file. Memory holds one chunk, however long the file gets. Threads: one.
class Writer {
 public:
  /// Writes the header. `file` must outlive the writer. Throws WriteFailed, as every function of this class does.
  Writer(OutputFile& file, std::string_view profile, std::string_view library, ChunkLimits limits = {});

  /// Adds a schema and returns its number, 1 …. Throws WriteFailed.
  std::uint16_t add_schema(std::string_view name, std::string_view definition);
  /// Adds a channel of a schema, with messages in CDR, and returns its number, 1 …. Throws WriteFailed.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, const TextMap& metadata);
  /// Adds a message to the chunk. `log_ns` is its time of arrival, in ns since 1970; `publish_ns` is the time when it
  /// was made, or 0 if it is the same. Throws WriteFailed.
  void write(std::uint16_t channel, std::uint64_t log_ns, Bytes data, std::uint64_t publish_ns = 0);
  /// Closes the chunk and adds a file. Throws WriteFailed.
  void attach(const Attachment& attachment);
  /// Closes the chunk and adds a table. Throws WriteFailed.
  void describe(const Metadata& metadata);
  /// Closes the chunk, so that everything written so far can be read from the file. Throws WriteFailed.
  void flush();
  /// Closes the chunk and writes the summary; nothing can be written afterwards. Throws WriteFailed.
  void finish();
  /// Counts the messages of the open chunk.
  [[nodiscard]] std::uint64_t waiting() const { return waiting_; }

 private:
  void put(Kind kind, const Buffer& contents);
  void put(Bytes bytes);

  OutputFile& file_;
  ChunkLimits limits_;
  Buffer chunk_;
  std::uint64_t start_ns_ = 0, end_ns_ = 0, waiting_ = 0;
  std::map<std::uint16_t, std::uint32_t> sequence_;  // The next message of each channel gets this sequence number.
  std::uint16_t schemas_ = 0;
  std::uint32_t crc_ = 0;  // The CRC covers everything written so far.
};

/// Completes a file whose last record belongs to the data section: end of data, summary with an index of all chunks,
/// footer. `data_crc` covers all bytes so far; 0 means unknown. A file that cannot be read again, such as a pipe, gets
/// no summary. Throws WriteFailed. Cost: reads the head of every record.
void finish_file(OutputFile& file, std::uint32_t data_crc);

/// The reader calls these functions in the order of the file.
class Visitor {
 public:
  virtual ~Visitor() = default;
  /// Called for a definition of messages, before the channels that use it.
  virtual void on_schema(const Schema& /*schema*/) {}
  /// Called for a topic, before its messages.
  virtual void on_channel(const Channel& /*channel*/) {}
  /// Called for a message, whose data is valid only during the call.
  virtual void on_message(const Message& /*message*/) {}
  /// Called for a file that is embedded in the recording.
  virtual void on_attachment(const Attachment& /*attachment*/) {}
  /// Called for a table of texts.
  virtual void on_metadata(const Metadata& /*metadata*/) {}
};

/// Says how far a file could be read.
struct ReadReport {
  bool complete = false;          ///< The writer closed the file properly, with summary and footer.
  std::uint64_t messages = 0;     ///< This many messages were passed to the visitor.
  std::uint64_t whole_bytes = 0;  ///< Up to this offset, the data section consists of whole records.
  std::uint64_t file_bytes = 0;
  std::uint64_t unindexed_chunk = 0;  ///< The last chunk starts here if its index is incomplete; otherwise 0.
  std::string problem;                ///< The text says why the file ends early; it is empty if it does not.
};
/// Reads all records up to the first that is cut or damaged; a chunk with a wrong CRC is not passed on. Memory: one
/// chunk, at most 256 MiB. Throws InputError naming `name` when it is not an MCAP file or is compressed, which this
/// program cannot read.
ReadReport read_file(const ByteSource& source, const std::string& name, Visitor& visitor);

/// Makes the index records of a chunk with these records, one after the other. Throws nothing of its own. Cost: linear.
[[nodiscard]] Buffer index_of(Bytes records);

}  // namespace triskin::recording::mcap
