#!/usr/bin/env python3
"""Lists every sentence that a command can print, for a reader who goes through them in one sitting.

  scripts/list_messages.py [--sample N --seed S]

Takes the string literals of the product's sources. Adjacent literals are one message, a value that the program puts in
is shown as {}. The parts of an error are one line, as the user reads them: where, what is wrong, how to mend it. Tags of
HTML and SVG, and literals of fewer than three words (names, formats, keys) are left out.
"""
import argparse
import pathlib
import random
import re

ROOMS = ("formats", "pointshell", "voxelize", "runtime", "workbench")
# A comment, a character, a raw string, a string, or one other character.
TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|\'(?:\\.|[^\'\\\n])\'|R"(\w*)\((.*?)\)\1"|"((?:\\.|[^"\\\n])*)"'
    r'|#\s*include[^\n]*|\s+|::|<<|.', re.DOTALL)
# A tag of HTML or SVG, and a style sheet.
TAG = re.compile(r"<style>.*?</style>|<[/?!]?[a-z][^<>]*>", re.DOTALL | re.IGNORECASE)
COLUMNS = re.compile(r"(?<=\S) {3,}(?=\S)")  # between the parts of a line
# Calls and types whose arguments are the parts of one error.
ERRORS = set("Error usage wrong fail fail_read fail_at refuse change untrue require entry_error".split())
ESCAPES = {r"\n": "\n", r"\"": '"', r"\\": "\\", r"\t": " "}


def value_text(code, literals):
    """{}, or both texts of a value such as `(is_one ? " is" : " are")`."""
    is_choice = len(literals) == 2 and all(literals) and re.search(r"\?_:_\)", code)
    return " {" + "/".join(text.strip() for text in literals) + "} " if is_choice else "{}"


def messages_of(text):
    """Yields (line, message, error, end) for each run of adjacent literals, and of literals joined by + or <<.

    `error` is the same number for all parts of one error, and None for another message. `end` is the character behind it.
    """
    brackets, name, errors, error = [], "", 0, None
    line, start, parts, between, depth, before, call_end, nested = 1, 0, [], "", 0, "", "", []
    for token in TOKEN.finditer(text):
        word = token.group(0)
        literal = token.group(2) if token.group(2) is not None else token.group(3)
        if literal is not None:
            if token.group(2) is None:
                literal = re.sub(r"\\.", lambda e: ESCAPES.get(e.group(0), e.group(0)), literal)
            if parts and depth > 0:  # within a value
                between += "_"
                nested.append(literal)
                yield line, literal, None, ""
            else:
                if not parts:
                    start, call_end = line, r"\)?" if before == "(" else ""  # `string("a") + value`
                    error = next((number for number in reversed(brackets) if number), None)
                if between or (not parts and before in ("+", "<<")):
                    parts.append(value_text(between, nested))
                parts.append(literal)
                between, nested = "", []
        elif parts and not word.isspace() and not word.startswith("//"):
            depth += (word in "([") - (word in ")]")
            # A value between two literals: `"a" + value + "b"`, `"a" << value << "b"`.
            joined = re.match(call_end + r"(\+|<<|$)", between + word)
            ends = word in ";{}" or len(between) > 120 or depth < -1 or (depth <= 0 and word in ",:?")
            between += word
            if not joined or ends:
                ends_in_value = re.match(call_end + r"(\+|<<)", between)
                yield start, "".join(parts) + (value_text(between, nested) if ends_in_value else ""), error, word
                start, parts, between, depth, before, nested = 0, [], "", 0, word, []
            depth = 0 if between == ")" else depth
        elif not word.isspace():
            before = word
        if word in ("(", "[", "{"):
            errors += name in ERRORS
            brackets.append(errors if name in ERRORS else 0)
        elif word in (")", "]", "}") and brackets:
            brackets.pop()
        name = name + word if re.fullmatch(r"\w", word) else ""
        line += word.count("\n")
    if parts:
        yield start, "".join(parts), error, ""


def whole_messages_of(text):
    """Yields (line, message), the parts of an error in one; of two texts, one of which is a part, with a slash."""
    parts, first, error, before = [], 0, None, ""
    for line, part, of, end in messages_of(text):
        if not part:
            continue
        if parts and (of is None or of != error):
            yield first, "".join(parts)
            parts = []
        if parts:
            is_where = len(parts) == 1 and " " not in parts[0]
            part = (" / " if before == ":" else ": " if is_where else "; ") + part
        else:
            first, error = line, of
        parts.append(part)
        before = end
    if parts:
        yield first, "".join(parts)


def list_messages(root):
    for room in ROOMS:
        for path in sorted((root / room).rglob("*")):
            if path.suffix not in (".h", ".cpp", ".c"):
                continue
            for line, message in whole_messages_of(path.read_text()):
                text = " ".join(COLUMNS.sub(" | ", TAG.sub(" ", message).strip()).split())
                if len(re.findall(r"[A-Za-z]{2,}", text)) >= 3 and " " in text:
                    yield f"{path.relative_to(root)}:{line}", text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sample", type=int, help="this many, drawn at random")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (default: 1)")
    options = parser.parse_args()
    found = list(list_messages(pathlib.Path(__file__).resolve().parent.parent))
    if options.sample is not None:
        found = random.Random(options.seed).sample(found, min(options.sample, len(found)))
    for place, text in found:
        print(f"{place}: {text}")


if __name__ == "__main__":
    main()
