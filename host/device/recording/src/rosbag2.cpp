// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/rosbag2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "record_walk.hpp"
#include "triskin/base/error.hpp"

namespace triskin::recording {
namespace {

struct Topic {
  std::string type, qos;
  std::uint64_t messages = 0;
};
struct Span {
  std::string path;
  std::uint64_t start_ns = 0, end_ns = 0, messages = 0;
};
using Topics = std::map<std::string, Topic>;

// Our recordings have schemas and channels outside of chunks, and an index behind each chunk.
Span survey(const std::filesystem::path& path, Topics& topics) {
  const InputFile file(path);
  std::map<std::uint16_t, std::string> types, names;  // of schemas and channels
  Span span{path.filename().string()};
  bool any = false;
  for (auto p = mcap::place_at(file, mcap::kMagic.size()); p; p = mcap::place_at(file, p->end())) {
    if (p->kind == mcap::Kind::kDataEnd) {
      if (!any) throw InputError(fmt::format("{}: there is no message in it to make a bag of", path.string()));
      return span;
    }
    const std::vector<std::uint8_t> contents = p->kind == mcap::Kind::kAttachment || p->kind == mcap::Kind::kChunk
                                                   ? mcap::contents_of(file, *p, 256)
                                                   : mcap::contents_of(file, *p);
    mcap::Schema schema;
    mcap::Channel channel;
    mcap::ChunkHead chunk;
    if (p->kind == mcap::Kind::kSchema && decode(contents, schema)) {
      types[schema.id] = schema.name;
    } else if (p->kind == mcap::Kind::kChannel && decode(contents, channel)) {
      names[channel.id] = channel.topic;
      Topic& topic = topics[channel.topic];
      topic.type = types[channel.schema];
      topic.qos = channel.metadata["offered_qos_profiles"];
    } else if (p->kind == mcap::Kind::kChunk && decode(contents, chunk)) {
      span.start_ns = any ? std::min(span.start_ns, chunk.start_ns) : chunk.start_ns;
      span.end_ns = std::max(span.end_ns, chunk.end_ns);
      any = true;
    } else if (p->kind == mcap::Kind::kMessageIndex) {
      constexpr std::uint32_t kEntry_bytes = 16;
      ByteReader r(contents);
      const std::string& topic = names[r.le16()];
      const std::uint32_t messages = r.le32() / kEntry_bytes;
      topics[topic].messages += messages;
      span.messages += messages;
    }
  }
  throw InputError(
      fmt::format("{}: the recording was not finished; run: triskin recover {}", path.string(), path.string()));
}

// A text in double quotes, as YAML has it.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + "\"";
}

// Up to version 8 the profiles are a text that holds YAML with the numbers of rmw/types.h; version 9 has them as YAML,
// with names.
std::string profiles(const std::string& qos, int version) {
  if (version < 9) return fmt::format(" {}", in_quotes(qos));
  if (qos.empty()) return " []";
  std::string named;
  std::size_t at = 0;
  while (at < qos.size()) {
    const std::size_t end = std::min(qos.find('\n', at), qos.size());
    std::string line = qos.substr(at, end - at);
    for (const auto& [number, name] :
         std::map<std::string, std::string>{{"history: 1", "history: keep_last"},
                                            {"reliability: 1", "reliability: reliable"},
                                            {"durability: 1", "durability: transient_local"},
                                            {"liveliness: 1", "liveliness: automatic"}})
      if (line.ends_with(number)) line.replace(line.size() - number.size(), number.size(), name);
    named += "\n          " + line;
    at = end + 1;
  }
  return named;
}

std::string number_of(const char* key, std::uint64_t number) {
  return fmt::format("{}: {}", key, number);
}

}  // namespace

std::string rosbag2_metadata(std::span<const std::filesystem::path> files, int version,
                             const std::function<std::string(std::string_view)>& type_hash) {
  Topics topics;
  std::vector<Span> spans;
  for (const std::filesystem::path& file : files) spans.push_back(survey(file, topics));
  const std::uint64_t start_ns = std::ranges::min(spans, {}, &Span::start_ns).start_ns;
  const std::uint64_t end_ns = std::ranges::max(spans, {}, &Span::end_ns).end_ns;
  std::uint64_t messages = 0;
  for (const Span& s : spans) messages += s.messages;

  std::string yaml = fmt::format(
      "rosbag2_bagfile_information:\n  version: {}\n  storage_identifier: mcap\n  duration:\n    {}\n"
      "  starting_time:\n    {}\n  {}\n  topics_with_message_count:\n",
      version, number_of("nanoseconds", end_ns - start_ns), number_of("nanoseconds_since_epoch", start_ns),
      number_of("message_count", messages));
  for (const auto& [name, topic] : topics) {
    yaml += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n"
        "        offered_qos_profiles:{}\n",
        name, topic.type, profiles(topic.qos, version));
    if (version >= 7) yaml += fmt::format("        type_description_hash: {}\n", in_quotes(type_hash(topic.type)));
    yaml += fmt::format("      {}\n", number_of("message_count", topic.messages));
  }
  yaml += "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n";
  for (const Span& s : spans) yaml += fmt::format("    - {}\n", in_quotes(s.path));
  yaml += "  files:\n";
  for (const Span& s : spans)
    yaml += fmt::format("    - path: {}\n      starting_time:\n        {}\n      duration:\n        {}\n      {}\n",
                        in_quotes(s.path), number_of("nanoseconds_since_epoch", s.start_ns),
                        number_of("nanoseconds", s.end_ns - s.start_ns), number_of("message_count", s.messages));
  if (version >= 6) yaml += "  custom_data: ~\n";
  if (version >= 8) yaml += "  ros_distro: unknown\n";
  return yaml;
}

}  // namespace triskin::recording
