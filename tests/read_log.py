"""Reads a log of storegga with the libraries of other people and says what is in it.

    python tests/read_log.py LOG [--torn] [--frames N] [--particles N] [--expect-json '{...}']

Prints one JSON object: per topic the number of messages, their first and last time in s, for JSON topics the
properties of the schema and the last message, for point clouds the number of points of each frame, the fields
with their offsets and the first point of the last frame; the attachments and the metadata records.

--torn reads from the start without looking for a summary and stops quietly where the file was cut off.
--frames asks that each point cloud has N frames, --particles that their last frames together have N points. --expect-json is a part of the printed object that must be found in it.
Exits with 1 and a message when something is not as expected. Needs: pip install mcap mcap-protobuf-support
"""

import argparse
import json
import struct
import sys

from mcap.exceptions import EndOfFile, McapError
from mcap.reader import make_reader
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

FORMATS = {1: "B", 2: "b", 3: "H", 4: "h", 5: "I", 6: "i", 7: "f", 8: "d"}  # foxglove.PackedElementField


def records_whole(file):
    """Messages, attachments and metadata through the index, with every checksum looked at."""
    reader = make_reader(file, validate_crcs=True)
    yield from reader.iter_messages()
    for record in (*reader.iter_attachments(), *reader.iter_metadata()):
        yield None, None, record
    file.seek(0)
    for _ in StreamReader(file, validate_crcs=True).records:
        pass  # once more from the start, for the checksum over all data


def records_torn(file):
    """The same, in the order of the file, up to the end or the cut."""
    schemas, channels = {}, {}
    try:
        for record in StreamReader(file, validate_crcs=True).records:
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                channel = channels[record.channel_id]
                yield schemas.get(channel.schema_id), channel, record
            elif isinstance(record, (Attachment, Metadata)):
                yield None, None, record
    except (EndOfFile, struct.error):
        pass  # the cut


def add_cloud(topic, cloud):
    """Notes one frame of a point cloud; its first point replaces that of the frame before."""
    points, rest = divmod(len(cloud.data), cloud.point_stride)
    if rest:
        sys.exit(f"{len(cloud.data)} bytes are no whole number of points of {cloud.point_stride} bytes")
    topic.setdefault("points", []).append(points)
    topic["frame_id"] = cloud.frame_id
    topic["stride"] = cloud.point_stride
    topic["fields"] = {field.name: field.offset for field in cloud.fields}
    topic["sample"] = points and {
        field.name: struct.unpack_from("<" + FORMATS[field.type], cloud.data, field.offset)[0]
        for field in cloud.fields
    }


def describe(records):
    """Everything the log says about itself, as one object."""
    found = {"topics": {}, "attachments": {}, "metadata": {}}
    factory, decoders = DecoderFactory(), {}
    for schema, channel, record in records:
        if isinstance(record, Attachment):
            found["attachments"][record.name] = {"media_type": record.media_type, "bytes": len(record.data)}
            continue
        if isinstance(record, Metadata):
            found["metadata"][record.name] = record.metadata
            continue
        time = record.log_time / 1e9
        topic = found["topics"].setdefault(
            channel.topic, {"schema": schema.name, "encoding": schema.encoding, "count": 0, "first_s": time}
        )
        topic["count"] += 1
        topic["last_s"] = time
        if schema.encoding == "jsonschema":
            topic["properties"] = list(json.loads(schema.data)["properties"])
            topic["last"] = json.loads(record.data)
            missing = set(json.loads(schema.data)["required"]) ^ set(topic["last"])
            if missing:
                sys.exit(f"{channel.topic}: schema and message differ in {sorted(missing)}")
            continue
        if schema.id not in decoders:
            decoders[schema.id] = factory.decoder_for(channel.message_encoding, schema)
        message = decoders[schema.id](record.data)
        if schema.name == "foxglove.PointCloud":
            add_cloud(topic, message)
        elif schema.name == "foxglove.Log":
            topic["last"] = message.message
    return found


def differences(expected, found, place="log"):
    """Where `expected` is not a part of `found`. Numbers may differ by rounding to 32 bits."""
    if isinstance(expected, dict) and isinstance(found, dict):
        for key, value in expected.items():
            if key in found:
                yield from differences(value, found[key], f"{place}.{key}")
            else:
                yield f"{place}.{key} is missing"
    elif isinstance(expected, float) and isinstance(found, (int, float)):
        if abs(expected - found) > 1e-6 * max(abs(expected), 1e-6):
            yield f"{place} is {found}, not {expected}"
    elif expected != found:
        yield f"{place} is {json.dumps(found)}, not {json.dumps(expected)}"


def check(found, arguments):
    """Lines about what is not as the command line asks."""
    clouds = {name: topic for name, topic in found["topics"].items() if "points" in topic}
    if (arguments.frames is not None or arguments.particles is not None) and not clouds:
        yield "there is no point cloud"
    for name, topic in clouds.items():
        if arguments.frames is not None and topic["count"] != arguments.frames:
            yield f"{name} has {topic['count']} frames, not {arguments.frames}"
    particles = sum(topic["points"][-1] for topic in clouds.values())
    if arguments.particles is not None and particles != arguments.particles:
        yield f"the last frame has {particles} points, not {arguments.particles}"
    yield from differences(arguments.expect_json, found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log")
    parser.add_argument("--torn", action="store_true")
    parser.add_argument("--frames", type=int)
    parser.add_argument("--particles", type=int)
    parser.add_argument("--expect-json", type=json.loads, default={})
    arguments = parser.parse_args()
    try:
        with open(arguments.log, "rb") as file:
            found = describe(records_torn(file) if arguments.torn else records_whole(file))
    except (OSError, ValueError, McapError) as error:
        sys.exit(f"cannot read {arguments.log}: {type(error).__name__}: {error}")
    print(json.dumps(found))
    wrong = list(check(found, arguments))
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
