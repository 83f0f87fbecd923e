// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what @mcap/core finds in a recording and exits with 1 when a CRC is wrong. Usage: node read_recording.mjs FILE
import { readFileSync } from "node:fs";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";

const bytes = readFileSync(process.argv[2]);
const stream = new McapStreamReader({ validateCrcs: true });
stream.append(bytes);
let read = 0;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Message") ++read;
}
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
let index;
try {
  index = await McapIndexedReader.Initialize({ readable });
} catch {
  console.log(`read ${read}, no index`);
  process.exit(0);
}
let indexed = 0;
for await (const message of index.readMessages({ validateCrcs: true })) ++indexed;
const topics = [...index.channelsById.values()].map((channel) => channel.topic).sort();
const attachments = index.attachmentIndexes.map((attachment) => attachment.name);
const metadata = index.metadataIndexes.map((entry) => entry.name);
if (index.statistics.messageCount !== BigInt(indexed)) throw new Error("the statistics disagree");
console.log(`read ${read}, indexed ${indexed}, ${topics.join(" ")}, attachment ${attachments.join(" ")}, metadata ${metadata.join(" ")}`);
