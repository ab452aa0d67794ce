#!/usr/bin/env bash
# Every page begins with its title, every link in it leads to a file that exists, and every function that it names
# beside a file ("[`file.cpp: function`](file.cpp)") is in that file.
set -euo pipefail
exec python3 - "$FORCELAYER_SOURCE_DIR" <<'PYTHON'
import pathlib, re, subprocess, sys

root = pathlib.Path(sys.argv[1])
listed = subprocess.run(["git", "-C", root, "ls-files", "*.md"], capture_output=True, text=True).stdout.split()
pages = [root / page for page in listed] or [
    page for page in root.rglob("*.md") if not {"build", "_deps"} & set(page.relative_to(root).parts)]
wrong, links, functions = [], 0, 0
for page in pages:
    text = page.read_text()
    name = page.relative_to(root)
    if not text.startswith("# "):
        wrong.append(f"{name}: does not begin with a title")
    for label, target in re.findall(r"\[([^\]\[]*)\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        target, _, anchor = target.partition("#")
        file = page.parent / target if target else page
        links += 1
        if not file.exists():
            wrong.append(f"{name}: no such file: {target}")
            continue
        if anchor and file.suffix == ".md":
            titles = re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)
            anchors = {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
            if anchor not in anchors:
                wrong.append(f"{name}: no such section: {target}#{anchor}")
        named = re.fullmatch(r"`[\w./-]+: ([\w:~]+)`", label)
        if named:
            functions += 1
            last = named[1].split("::")[-1]
            if not re.search(rf"\b{re.escape(last)}\b", file.read_text()):
                wrong.append(f"{name}: {target} has no {named[1]}")
print("\n".join(wrong) or f"{len(pages)} pages, {links} links, {functions} functions, all there")
if wrong or links < 100 or functions < 50:
    sys.exit(1)
PYTHON
