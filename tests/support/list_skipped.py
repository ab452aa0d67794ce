#!/usr/bin/env python3
"""list_skipped.py [--strict] REPORT.xml...: which tests were skipped, and why, from ctest's --output-junit.

Parts of the tests of the commands that could not run count too. With --strict the status is 1 where something
was skipped that scripts/packages.txt would have let run.
"""
import os
import re
import sys
import xml.etree.ElementTree as tree

INSTALLABLE = "scripts/packages.txt"


def reasons(case):
    text = case.findtext("system-out") or ""
    # The test framework's "FILE:LINE: Skipped" stands before its reason, a script's "SKIPPED: " in front of it.
    found = re.findall(r": Skipped\n(.+)", text) + re.findall(r"^SKIPPED: (.+)", text, re.MULTILINE)
    if not found and case.get("status") == "notrun":
        found = ["no reason given"]
    return found


def main(arguments):
    strict = "--strict" in arguments
    reports = [a for a in arguments if a != "--strict"]
    skipped = [(os.path.basename(os.path.dirname(report)), case.get("name"), reason)
               for report in reports if os.path.exists(report)
               for case in tree.parse(report).iter("testcase") for reason in reasons(case)]
    for build, name, reason in skipped:
        print(f"  {build}: {name}: {reason}")
    if not skipped:
        print("  none")
    missing = [name for _, name, reason in skipped if INSTALLABLE in reason]
    if strict and missing:
        sys.exit(f"skipped for want of a package of {INSTALLABLE}: {', '.join(missing)}")


main(sys.argv[1:])
