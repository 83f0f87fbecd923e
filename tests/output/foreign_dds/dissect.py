# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what the RTPS dissector of tshark finds in a capture, as JSON: for each topic that a writer announces its type, user
data, qualities, and the numbers of the messages that were sent. Usage: dissect.py PACKETS"""
import json
import subprocess
import sys
import xml.etree.ElementTree as tree

PUBLICATIONS, DATA, DATA_FRAGMENT = 0x3C2, 0x15, 0x16  # The writer of announcements, then kinds of submessages.


def first(submessage, name, key="show"):
    for field in submessage.iter("field"):
        if field.get("name") == name:
            return field.get(key)
    return None


topics, writers = {}, {}
packets = subprocess.run(["tshark", "-r", sys.argv[1], "-Y", "rtps", "-T", "pdml"], capture_output=True, check=True)
for rtps in tree.fromstring(packets.stdout).iter("proto"):
    if rtps.get("name") != "rtps":
        continue
    sender = first(rtps, "rtps.guidPrefix.src", "value")
    for submessage in rtps.findall("field[@name='rtps.sm.id']"):
        if int(submessage.get("show"), 16) not in (DATA, DATA_FRAGMENT):
            continue
        writer = int(first(submessage, "rtps.sm.wrEntityId"), 16)
        topic = first(submessage, "rtps.param.topicName")
        if writer == PUBLICATIONS and topic:
            topics[topic] = {
                "writer": first(submessage, "rtps.param.endpoint_guid", "value"),
                "type": first(submessage, "rtps.param.typeName"),
                "user_data": bytes.fromhex(first(submessage, "rtps.param.userData", "value") or "").decode(),
                # A writer that states nothing is reliable and volatile by the defaults of RTPS.
                "reliable": int(first(submessage, "rtps.reliability_kind") or "2", 16) == 2,
                "latched": int(first(submessage, "rtps.durability") or "0", 16) == 1}
        else:
            numbers = writers.setdefault(f"{sender}{writer:08x}", set())
            numbers.add(int(first(submessage, "rtps.sm.seqNumber")))
for topic in topics.values():
    numbers = writers.get(topic.pop("writer"), set())
    topic["messages"], topic["newest"] = len(numbers), max(numbers, default=0)
print(json.dumps(topics))
