// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes every message of a recording as a viewer or a reader of rosbag2 does: by the definition that stands in the file, with the CDR
// reader of Foxglove. Prints a line of JSON for each topic: type, number of messages, and what a test can compare.
// Usage: node decode_recording.mjs FILE
import {readFileSync} from "node:fs";
import {McapIndexedReader} from "@mcap/core";
import {parse} from "@foxglove/rosmsg";
import {MessageReader} from "@foxglove/rosmsg2-serialization";

const bytes = readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
const sum = (list) => Array.from(list).reduce((total, v) => total + Number(v), 0);

/** The first point of a cloud, read by its own table of fields. */
function firstPoint(cloud) {
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength), point = {};
  const FLOAT32 = 7, UINT32 = 6, UINT16 = 4, UINT8 = 2;
  for (const {name, offset, datatype} of cloud.fields) {
    const read = {[FLOAT32]: () => view.getFloat32(offset, true), [UINT32]: () => view.getUint32(offset, true),
                  [UINT16]: () => view.getUint16(offset, true), [UINT8]: () => view.getUint8(offset)}[datatype];
    if (!read) throw new Error(`field ${name} has datatype ${datatype}`);
    point[name] = read();
  }
  return point;
}

const facts = {
  "triskin_msgs/msg/RawFrame": (m, f) => { f.samples = (f.samples ?? 0) + m.module.length; f.counts = (f.counts ?? 0) + sum(m.value); },
  "triskin_msgs/msg/SkinLayout": (m, f) => { f.frame = m.header.frame_id; f.position = m.position.length; f.first_mm = Array.from(m.position.slice(0, 3), (v) => Math.round(1e6 * v) / 1e3); },
  "sensor_msgs/msg/PointCloud2": (m, f) => {
    f.points = m.width * m.height;
    f.fits = m.data.length === m.row_step * m.height && m.row_step === m.point_step * m.width;
    const {x, y, z} = firstPoint(m);
    f.first_mm = [x, y, z].map((v) => Math.round(1e6 * v) / 1e3);
    f.frame = m.header.frame_id;
  },
  "tf2_msgs/msg/TFMessage": (m, f) => { f.frames = m.transforms.map((t) => `${t.header.frame_id}>${t.child_frame_id}`); },
};

const reader = await McapIndexedReader.Initialize({readable}), readers = new Map(), topics = new Map();
for await (const message of reader.readMessages({validateCrcs: true})) {
  const channel = reader.channelsById.get(message.channelId), schema = reader.schemasById.get(channel.schemaId);
  if (channel.messageEncoding !== "cdr" || schema.encoding !== "ros2msg") throw new Error(`${channel.topic}: ${channel.messageEncoding}, ${schema.encoding}`);
  if (!readers.has(schema.name)) readers.set(schema.name, new MessageReader(parse(new TextDecoder().decode(schema.data), {ros2: true})));
  const decoded = readers.get(schema.name).readMessage(message.data), fact = topics.get(channel.topic) ?? {topic: channel.topic, type: schema.name, messages: 0};
  ++fact.messages;
  facts[schema.name]?.(decoded, fact);
  topics.set(channel.topic, fact);
}
for (const topic of [...topics.keys()].sort()) console.log(JSON.stringify(topics.get(topic)));
