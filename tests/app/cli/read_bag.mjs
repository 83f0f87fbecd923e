// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a bag of ROS 2 with js-yaml and @mcap/core and exits with 1 where it is not as rosbag2_storage writes it
// (metadata_io.cpp, yaml.hpp). Usage: node read_bag.mjs FOLDER VERSION
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { McapIndexedReader } from "@mcap/core";
import yaml from "js-yaml";

const [folder, version] = [process.argv[2], Number(process.argv[3])];
const fail = (text) => {
  console.log(text);
  process.exit(1);
};
const same = (a, b, what) => {
  if (JSON.stringify(a) !== JSON.stringify(b)) fail(`${what}: ${JSON.stringify(a)}, not ${JSON.stringify(b)}`);
};
const text = readFileSync(join(folder, "metadata.yaml"), "utf8");
const root = yaml.load(text, { schema: yaml.CORE_SCHEMA });
same(Object.keys(root), ["rosbag2_bagfile_information"], "root");
const bag = root.rosbag2_bagfile_information;
const fields = ["version", "storage_identifier", "duration", "starting_time", "message_count", "topics_with_message_count",
  "compression_format", "compression_mode", "relative_file_paths", "files"];
if (version >= 6) fields.push("custom_data");
if (version >= 8) fields.push("ros_distro");
same(Object.keys(bag), fields, "fields");
same([bag.version, bag.storage_identifier, bag.compression_format, bag.compression_mode], [version, "mcap", "", ""], "values");
same(bag.files.map((file) => file.path), bag.relative_file_paths, "paths");

// Times are larger than a double holds, so they are taken from the text.
const times = [...text.matchAll(/nanoseconds_since_epoch: (\d+)/g)].map((match) => BigInt(match[1]));
const durations = [...text.matchAll(/nanoseconds: (\d+)/g)].map((match) => BigInt(match[1]));
const counts = {};
const types = {};
const qualities = {};
let first, last, messages = 0;
for (const [k, file] of bag.files.entries()) {
  same(Object.keys(file), ["path", "starting_time", "duration", "message_count"], "fields of a file");
  const bytes = readFileSync(join(folder, file.path));
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
    },
  });
  same(reader.header.profile, "ros2", "profile");
  let start, end, n = 0;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    same([channel.messageEncoding, schema.encoding], ["cdr", "ros2msg"], channel.topic);
    counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
    types[channel.topic] = schema.name;
    qualities[channel.topic] = channel.metadata.get("offered_qos_profiles");
    if (start === undefined || message.logTime < start) start = message.logTime;
    if (end === undefined || message.logTime > end) end = message.logTime;
    ++n;
  }
  same(file.message_count, n, "messages of a file");
  if (times[k + 1] !== start || durations[k + 1] !== end - start) fail(`${file.path}: other times`);
  if (first === undefined || start < first) first = start;
  if (last === undefined || end > last) last = end;
  messages += n;
}
if (times[0] !== first || durations[0] !== last - first) fail("other times of the bag");
same(bag.message_count, messages, "messages");
const wanted = ["name", "type", "serialization_format", "offered_qos_profiles"];
if (version >= 7) wanted.push("type_description_hash");
for (const { topic_metadata: topic, message_count, ...rest } of bag.topics_with_message_count) {
  same([Object.keys(topic), Object.keys(rest)], [wanted, []], "fields of a topic");
  same([message_count, topic.serialization_format], [counts[topic.name] ?? 0, "cdr"], topic.name);
  if (counts[topic.name]) same(topic.type, types[topic.name], topic.name);
  const latched = topic.name.endsWith("/layout") || topic.name === "/tf_static";
  if (version < 9) {
    if (typeof topic.offered_qos_profiles !== "string") fail(`${topic.name}: its qualities are no text`);
    if (counts[topic.name]) same(topic.offered_qos_profiles, qualities[topic.name], `qualities of ${topic.name}`);
    if (latched) same(yaml.load(topic.offered_qos_profiles)[0].durability, 1, `durability of ${topic.name}`);
  } else {
    if (!Array.isArray(topic.offered_qos_profiles)) fail(`${topic.name}: its qualities are no sequence`);
    if (latched) {
      const { history, reliability, durability, liveliness, deadline } = topic.offered_qos_profiles[0];
      same([history, reliability, durability, liveliness, deadline],
        ["keep_last", "reliable", "transient_local", "automatic", { sec: 9223372036, nsec: 854775807 }], topic.name);
    }
  }
  if (version >= 7 && topic.type !== "triskin_msgs/msg/Readers" && !/^RIHS01_[0-9a-f]{64}$/.test(topic.type_description_hash))
    fail(`${topic.name}: ${topic.type_description_hash} is no hash`);
}
console.log(`bag of ${bag.files.length} with ${messages} messages in ${bag.topics_with_message_count.length} topics`);
