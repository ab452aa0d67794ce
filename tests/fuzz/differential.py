#!/usr/bin/env python3
"""Two readers of one format: this project's (baked_verdicts) and one in Python that was written from the specifications
alone (tests/golden/check_baked_file.py), over mutated files whose sizes and checksums are repaired. Both must accept
the same files and find the same in them.

    tests/fuzz/differential.py BAKED_VERDICTS [--files N] [--seed N] [--keep FOLDER]
"""
import argparse
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS / "golden"))
import check_baked_file  # noqa: E402
from read_baked_file import xxhash  # noqa: E402

WORDS = [0, 1, 2, 3, 4, 5, 7, 15, 16, 63, 64, 127, 128, 255, 256, 511, 512, 4095, 4096, 65535, 65536, 1 << 20,
         (1 << 21) + 1, (1 << 23) - 1, 1 << 28, 0x7fffffff, 0x80000000, 0x80000001, 0x80000100, 0x800000ff, 0xffffffff]
LONGS = [0, 1, 512, (1 << 32), (1 << 52), (1 << 52) + 1, (1 << 63) - 1, 1 << 63, (1 << 64) - 1, (1 << 64) - 512]
DOUBLES = [0.0, -0.0, 1.0, -1.0, 1e-9, 1e6, 1.0000001e6, 9e-10, 1e300, -1e-300, float("inf"), float("-inf"), float("nan")]


def header_bytes(data):
    return struct.unpack_from("<I", data, 16)[0]


def table_of(data):
    """Places of the table's entries; none where they are not there."""
    begin, count = header_bytes(data), struct.unpack_from("<I", data, 20)[0]
    return [begin + 32 * n for n in range(count) if begin + 32 * n + 32 <= len(data)] if count <= 4096 else []


def repair(data, rng):
    """Size and checksums; one in twenty times one of them is left as it is."""
    leave = rng.randrange(60)
    if leave != 0:
        struct.pack_into("<Q", data, 24, len(data))
    for at in table_of(data):
        _, _, offset, length = struct.unpack_from("<IIQQ", data, at)
        if leave != 1 and offset <= len(data) and length <= len(data) - offset:
            struct.pack_into("<Q", data, at + 24, xxhash.xxh3_64_intdigest(bytes(data[offset:offset + length])))
    end = header_bytes(data) + 32 * struct.unpack_from("<I", data, 20)[0]
    if leave != 2 and end <= len(data):
        front = bytes(data[:48]) + bytes(8) + bytes(data[56:end])
        struct.pack_into("<Q", data, 48, xxhash.xxh3_64_intdigest(front))


def put_any(data, at, rng):
    kind = rng.randrange(5)
    if kind == 0:
        data[at] ^= 1 << rng.randrange(8)
    elif kind == 1 and at + 4 <= len(data):
        struct.pack_into("<I", data, at, rng.choice(WORDS))
    elif kind == 2 and at + 8 <= len(data):
        struct.pack_into("<Q", data, at, rng.choice(LONGS))
    elif kind == 3 and at + 8 <= len(data):
        struct.pack_into("<d", data, at, rng.choice(DOUBLES))
    elif at + 4 <= len(data):
        value = struct.unpack_from("<I", data, at)[0]
        struct.pack_into("<I", data, at, (value + rng.choice([-1, 1, 2, 8, 64])) & 0xffffffff)


def change_length(data, rng):
    """Moves the end of a section, and the bytes after it, by some elements."""
    entries = [at for at in table_of(data)]
    if not entries:
        return
    index = rng.randrange(len(entries))
    number, element, offset, length, _ = struct.unpack_from("<IIQQQ", data, entries[index])
    if element == 0 or element > 4096 or offset + length > len(data):
        return
    sections = [bytes(data[o:o + n]) for o, n in (struct.unpack_from("<8xQQ", data, at) for at in entries)]
    more = rng.choice([-2, -1, 1, 2]) * element
    sections[index] = sections[index][:more] if more < 0 else sections[index] + bytes(more)
    begin = entries[-1] + 32
    del data[begin:]
    for at, section in zip(entries, sections):
        data.extend(bytes(-len(data) % 64))
        struct.pack_into("<QQ", data, at + 8, len(data), len(section))
        data.extend(section)


def mutated(whole, rng):
    data = bytearray(whole)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        where = rng.randrange(10)
        entries = table_of(data)
        if where < 3:
            put_any(data, rng.randrange(8, min(header_bytes(data), len(data))) // 4 * 4, rng)
        elif where < 4 and entries:
            put_any(data, rng.choice(entries) + rng.choice([0, 4, 8, 16]), rng)
        elif where < 5:
            change_length(data, rng)
        elif where < 6:
            if rng.randrange(2):
                data.extend(bytes(rng.choice([1, 4, 64])))
            else:
                del data[-rng.choice([1, 4, 64, 1000]):]
        elif where < 7:
            struct.pack_into("<H", data, 14, rng.choice([0, 1, 9]))
        else:
            put_any(data, rng.randrange(min(header_bytes(data), len(data) - 8), len(data) - 7) // 4 * 4, rng)
        if len(data) < 64 or header_bytes(data) > len(data) or header_bytes(data) < 64:
            break
    if len(data) >= 64:
        repair(data, rng)
    return bytes(data)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verdicts")
    parser.add_argument("--files", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", default="", help="a folder for files about which the two differ")
    arguments = parser.parse_args()
    if xxhash is None:
        print("skipped: python3-xxhash is not installed")
        return 77
    seeds = [path for path in sorted((TESTS / "golden").glob("*")) if path.suffix in (".vox", ".pshell")
             and path.stat().st_size < 100_000]
    wholes = [(path.suffix, path.read_bytes()) for path in seeds]
    ours = subprocess.Popen([arguments.verdicts], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    accepted, reasons, differ = 0, set(), 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.files):
            rng = random.Random(f"{arguments.seed} {number}")
            suffix, whole = rng.choice(wholes)
            data = whole if number < len(wholes) else mutated(whole, rng)
            if number < len(wholes):
                suffix, data = wholes[number]
            path = pathlib.Path(folder) / ("file" + suffix)
            path.write_bytes(data)
            ours.stdin.write(f"{path}\n")
            ours.stdin.flush()
            said, theirs = ours.stdout.readline().strip(), check_baked_file.verdict(data)
            both_refuse = said.startswith("no ") and theirs.startswith("no ")
            accepted += theirs.startswith("ok ")
            reasons.add(theirs if theirs.startswith("no ") else "ok")
            if both_refuse or said == theirs:
                continue
            differ += 1
            print(f"seed {arguments.seed}, file {number} ({suffix}): ours '{said}', the specification's '{theirs}'")
            if arguments.keep:
                (pathlib.Path(arguments.keep) / f"{arguments.seed}-{number}{suffix}").write_bytes(data)
    ours.stdin.close()
    if ours.wait() != 0:
        print(f"baked_verdicts ended with {ours.returncode}")
        differ += 1
    print(f"{arguments.files} files, {accepted} accepted by both, {len(reasons) - 1} reasons to refuse, {differ} differ")
    if accepted < arguments.files // 20 or len(reasons) < min(20, arguments.files // 30):
        print("too few accepted, or too few reasons: nothing was tried")
        return 1
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
