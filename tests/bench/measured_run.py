#!/usr/bin/env python3
"""measured_run.py REPORT COMMAND...: runs a command and writes what it took to REPORT, as JSON.

A process of its own, and a small one: on Linux a program's peak resident set starts at that of the
process that started it, and the benchmark's is large.
"""
import json
import os
import sys
import time

start = time.monotonic()
child = os.fork()
if child == 0:
    os.execvp(sys.argv[2], sys.argv[2:])
_, status, usage = os.wait4(child, 0)
with open(sys.argv[1], "w") as report:
    json.dump({"wall_s": time.monotonic() - start, "cpu_s": usage.ru_utime + usage.ru_stime,
               "peak_rss_bytes": usage.ru_maxrss * 1024}, report)
sys.exit(os.waitstatus_to_exitcode(status) & 0xFF)
