# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways in which files get damaged on their way, for texts and for bytes. Each yields (name of the mutation, bytes)."""
import random
import re

NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
VALUES = (b"1e7", b"1e20", b"-1e308", b"1e999", b"nan", b"NaN", b"inf", b"-inf", b"-0", b"9007199254740993",
          b"99999999999999999999", b"4294967296", b"2147483648", b"-1", b"0.5", b"0x10", b"1,5", b"", b"null")
BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def cuts(data, count, r):
    """The file ends early: at each byte of a small file, else at random bytes and near both ends."""
    places = set(range(min(len(data), 64))) | set(range(max(0, len(data) - 64), len(data)))
    if len(data) <= count:
        places |= set(range(len(data)))
    else:
        places = set(r.sample(sorted(places), min(len(places), count // 3)))
        places |= {r.randrange(len(data)) for _ in range(count - count // 3)}
    for at in sorted(places):
        yield f"cut at byte {at}", data[:at]


def numbers(data, count, r):
    """One number has another value."""
    found = list(NUMBER.finditer(data))
    pairs = [(number, value) for number in range(len(found)) for value in VALUES]
    for number, value in r.sample(pairs, min(count, len(pairs))):
        start, end = found[number].span()
        yield f"number at byte {start} is {value.decode()!r}", data[:start] + value + data[end:]


def line_ends(data):
    """Line ends of other systems, and the byte order mark; the content is the same."""
    lines = data.replace(b"\r\n", b"\n").split(b"\n")
    yield "line ends CR", b"\r".join(lines)
    yield "line ends CRLF", b"\r\n".join(lines)
    mixed = b"".join(line + (b"\r\n", b"\n", b"\r")[k % 3] for k, line in enumerate(lines[:-1])) + lines[-1]
    yield "line ends mixed", mixed
    yield "byte order mark", BYTE_ORDER_MARK + data
    yield "byte order mark and CRLF", BYTE_ORDER_MARK + b"\r\n".join(lines)
    text = data.decode()
    yield "UTF-16, little", b"\xff\xfe" + text.encode("utf-16-le")
    yield "UTF-16, big", b"\xfe\xff" + text.encode("utf-16-be")


def lines(data, count, r):
    """One line is missing, or stands twice."""
    found = data.split(b"\n")
    places = [k for k in range(len(found)) if found[k].strip()]
    for k in r.sample(places, min(count, len(places))):
        yield f"line {k + 1} is missing", b"\n".join(found[:k] + found[k + 1:])
        yield f"line {k + 1} stands twice", b"\n".join(found[:k + 1] + found[k:])


def bits(data, count, r):
    """One to three bits are turned."""
    for trial in range(count):
        changed = bytearray(data)
        for _ in range(trial % 3 + 1):
            changed[r.randrange(len(data))] ^= 1 << r.randrange(8)
        yield f"turned bits, trial {trial}", bytes(changed)


def pieces(data, count, r):
    """A piece is missing, zeroed, or stands twice, as bad copies and bad disks leave it."""
    for trial in range(count):
        start = r.randrange(len(data))
        size = r.randint(1, max(1, min(4096, len(data) // 4)))
        piece = data[start:start + size]
        put = (b"", bytes(len(piece)), piece + piece)[trial % 3]
        yield f"piece at byte {start} of {size} {('missing', 'zeroed', 'twice')[trial % 3]}", \
            data[:start] + put + data[start + size:]


def all_of(data, is_text, share, seed):
    """Mutations of one file, about 100 · share of them."""
    r = random.Random(seed)
    count = max(1, round(20 * share))
    yield "empty", b""
    yield from cuts(data, 2 * count, r)
    yield from bits(data, count, r)
    yield from pieces(data, count, r)
    if is_text:
        yield from numbers(data, 2 * count, r)
        yield from line_ends(data)
        yield from lines(data, count // 2, r)
