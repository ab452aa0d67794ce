#!/usr/bin/env python3
"""Plants faults into gate, guard and validators, each for itself, and looks which test notices.

    tests/fuzz/plant_faults.py                    all of them
    tests/fuzz/plant_faults.py --only gate door   those whose group, file or meaning has one of these in it
    tests/fuzz/plant_faults.py --list

Each row that it prints is a fault and the first test that failed.

A fault is one text for another in one file. The file is changed in a copy: what reads it is compiled again, linked
with the rest of build/release into another program, and of the tests only those run that may notice. CI plants the
faults of the guard (scripts/test.sh). Status 1 where a fault that is planted goes unnoticed.
"""
import argparse
import concurrent.futures
import functools
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build" / "release"

FORMATS = ("formats_tests", "*")
AUDIT = ("formats_tests", "VoxmapAudit*:BrickFacts*:NodeRows*:CodeRules*")
DAMAGE = ("formats_tests", "-VoxmapAudit*:DistanceBounds*")
GATE = ("runtime_tests", "OutputGate*:OutputStage*")
SERVO = ("runtime_tests", "*ServoTest*:VelocityCheck*")
GUARD = ("runtime_tests", "DefaultModel*")
RULE = ("runtime_tests", "GuardRule*:GuardDistance*")
SEAT = ("runtime_tests", "Seat.*:TwoSided*")
WALLS, TABS = ("runtime_tests", "SeatWalls*"), ("runtime_tests", "SeatWalls*Tab")
SHEETS = ("runtime_tests", "SeatSheets*")
KERNEL, ROWS = ("runtime_tests", "*SeatKernel*"), ("runtime_tests", "ContactRows*")
FILES = ("runtime_tests", "*CInterface*")
WATCH = ("runtime_tests", "OutputWatch*:LatestValue*")
BYTES = ("formats_tests", "FileBytes*")
STREAM = ("runtime_tests", "Recording*")
RANGE = ("runtime_tests", "Ranges*")
TEXTS = ("command_tests", "Quantity*:ParseArguments*:Escaped*")
WRITERS = ("formats_tests", "AtomicFile*:Writers*:Path*")
FRAMES = ("fault_frames", "400000")
CLOCK = ("fault_clock", "24000")

GATE_FILE, STAGE, INPUT = ("runtime/loop/output_gate.cpp", "runtime/loop/output_stage.cpp",
                           "runtime/loop/input_source.cpp")
MODEL, TABLE_FILE, BULK = ("runtime/model/default_model.cpp", "formats/section_table.cpp",
                           "formats/bulk_checks.cpp")
RULE_FILE, SEAT_FILE = "runtime/guard/point_rule.cpp", "runtime/guard/seat_rule.cpp"
KERNEL_FILE, ROWS_FILE = "runtime/guard/seat_kernel.cpp", "runtime/model/contact_rows.cpp"
A = "formats/audit/"
RANGES = "runtime/run/ranges.cpp"

# group, file, text, planted text, what that means, tests that may notice
FAULTS = [
    ("gate", GATE_FILE, "gain_ = bad ? 0 : input.late_gain;", "gain_ = bad ? 0.1 : input.late_gain;",
     "a bad frame leaves a tenth of the force", [FRAMES, GATE]),
    ("gate", GATE_FILE, "    held_s_ = 0;\n    return gain_;", "    return gain_;",
     "no zero after a fault", [FRAMES, GATE]),
    ("gate", GATE_FILE, "was_bad_ ? 0 : kFall", "0 * kFall", "single bad frames fill no bucket", [GATE]),
    ("gate", GATE_FILE, "level_ - kFall * dt_s / kForgetS", "level_ - 5 * kFall * dt_s / kForgetS",
     "the bucket drains five times as fast", [GATE]),
    ("gate", GATE_FILE, "(state_ == GateState::kWaiting && input.lasting)", "false",
     "a waiting output never trips", [GATE]),
    ("gate", GATE_FILE, "if (state_ == GateState::kTripped && !limits_.rearm_alone) return false;", "",
     "a trip ends by itself", [GATE]),
    ("gate", GATE_FILE, "gain_ + dt_s / limits_.ramp_s", "gain_ + 2 * dt_s / limits_.ramp_s",
     "a ramp twice as steep", [FRAMES, GATE]),
    ("gate", GATE_FILE, "held_s_ + 0.5 * dt_s < limits_.zero_s", "held_s_ > 1e9", "no wait before a ramp",
     [FRAMES, GATE]),
    ("gate", GATE_FILE, "const bool over = level_ > 1 + kRounding;", "const bool over = level_ > 2;",
     "a bucket without a bottom", [GATE]),
    ("gate", STAGE, "clamped(wanted.force_n, limits_.max_force_n) * gain", "wanted.force_n * gain",
     "no force limit before the last check", [FRAMES, GATE]),
    ("gate", STAGE, "const double fraction = dt_s / limits_.slew_s;", "const double fraction = 3 * dt_s / limits_.slew_s;",
     "a slew three times as fast", [FRAMES, GATE]),
    ("gate", STAGE, "  if (allowed(last_)) return last_;\n", "  return last_;\n", "no last check", [GATE]),
    ("gate", STAGE, "if (frame.health.loop_late) return TripCause::kLoopLate;", "", "a late loop is nothing",
     [FRAMES, GATE]),
    ("gate", INPUT, "if (!sample.present) return InputTrouble::kDeviceLost;", "", "a lost device is nothing",
     [FRAMES, SERVO]),
    ("gate", INPUT, "if (age_s_ > limits_.stale_s) return", "if (age_s_ > 10 * limits_.stale_s) return",
     "readings may be ten times as old", [FRAMES, SERVO]),
    ("gate", INPUT, "if (!is_pose(pose) ||", "if (", "any numbers are a pose", [FRAMES, SERVO]),
    ("gate", INPUT, "(jumped(pose, dt_s) || claims_too_much(sample))",
     "((jumped(pose, dt_s) && false) || claims_too_much(sample))",
     "jumps are followed", [FRAMES, SERVO]),
    ("gate", INPUT, "(jumped(pose, dt_s) || claims_too_much(sample))", "jumped(pose, dt_s)",
     "claimed velocities are believed", [SERVO]),
    ("gate", STAGE, "frame.speed_mps > limits_.max_speed_mps || frame.turn_radps > limits_.max_turn_radps",
     "frame.speed_mps > limits_.max_speed_mps", "a wrist may turn as it likes", [SERVO]),
    ("watch", "runtime/devices/output_watch.h", "stale_s_(stale_s < kStaleCeilingS ? stale_s : kStaleCeilingS)",
     "stale_s_(stale_s)", "any stale limit is taken", [WATCH]),
    ("watch", "runtime/devices/output_watch.h", "if (!in_time) latch();", "",
     "a late wrench comes back by itself", [WATCH, CLOCK]),
    ("watch", "runtime/devices/output_watch.h", "if (latched_ && !(in_time && zero)) return {};",
     "if (latched_ && !in_time) return {};", "a force may follow a silence", [WATCH, CLOCK]),
    ("watch", "runtime/devices/output_watch.h", "return age_fraction < 1 ? (1 - age_fraction) / (1 - kLateGrace) : 0;",
     "return 1;", "no fade of late wrenches", [WATCH, CLOCK]),
    ("watch", "runtime/machine/latest_value.h", "broken_ |= found > (S::kNew | 2) || slot == 3 || slot == reading_;", "",
     "indices of the shared memory are believed", [WATCH]),
    ("watch", "formats/file/file_bytes.cpp", "if (got == 0) {", "if (got == 0) return {};\n    if (got < 0) {",
     "a file that is cut short is taken for a whole one", [BYTES]),
    ("watch", "formats/file/file_bytes.cpp", "at += piece.size();", "at += kPieceBytes + 1;",
     "a byte between two pieces is left out", [BYTES]),
    ("guard", RULE_FILE, "rounded_up(guard_distance_m(header))", "rounded_up(guard_distance_m(header) - 1e-6)",
     "the threshold is a micrometer too low", [RULE]),
    ("guard", RULE_FILE, "rounded_up(guard_distance_m(header))", "rounded_up(guard_distance_m(header) + 1e-6)",
     "the threshold is a micrometer too high", [RULE]),
    ("guard", RULE_FILE, "double{nearest} < value ? std::nextafter(nearest, kInfinity) : nearest;", "nearest;",
     "the threshold is rounded to the nearest float", [RULE]),
    ("guard", RULE_FILE, "rounded_down(free_distance_m(header))", "rounded_up(free_distance_m(header))",
     "the distance of free voxels is rounded up", [RULE]),
    ("guard", RULE_FILE, "!(proven_m >= threshold_m_)", "!(proven_m > threshold_m_)", "> for >=", [RULE]),
    ("guard", RULE_FILE, "!(proven_m >= threshold_m_)", "proven_m < threshold_m_",
     "a distance that is not a number is believed", [RULE]),
    ("guard", RULE_FILE, "!(proven_m >= threshold_m_)", "!(proven_m >= threshold_m_ * (1 - 0x1p-23f))",
     "one unit in the last place is let through", [RULE]),
    ("guard", RULE_FILE, "for (std::uint32_t i = 0; i < set.count; ++i) {", "for (std::uint32_t i = 0; i + 1 < set.count; ++i) {",
     "the last point is skipped", [RULE]),
    ("guard", RULE_FILE, "for (std::uint32_t i = 0; i < set.count; ++i) {", "for (std::uint32_t i = 1; i < set.count; ++i) {",
     "the first point is skipped", [RULE]),
    ("guard", RULE_FILE, "by_value_ && field::is_interior(set.value[i])", "false", "the interior is no bar", [RULE]),
    ("guard", RULE_FILE, "if (here.is_barred[at] == 0) return false;", "", "a newly barred point is accepted", [RULE]),
    ("guard", RULE_FILE, "here.point[at] != there.point[i]) return false;", "here.point[at] != there.point[i]) continue;",
     "a point from free space may be barred", [RULE]),
    ("guard", RULE_FILE, "for (std::uint32_t i = 0; i < there.count; ++i) {",
     "for (std::uint32_t i = 0; i + 1 < there.count; ++i) {", "the decision skips the last point", [RULE]),
    ("guard", RULE_FILE, "<= kMaxTravelVoxels * voxel_size_m;", "<= kMaxTravelVoxels * voxel_size_m + 1e-6;",
     "a motion may be a micrometer too long", [RULE]),
    ("guard", RULE_FILE, "<= kMaxTravelVoxels * voxel_size_m;", "< kMaxTravelVoxels * voxel_size_m;", "< for <=", [RULE]),
    ("guard", RULE_FILE, "return shift_m + radius_m * turn_rad", "return shift_m + 0.5 * radius_m * turn_rad",
     "a turn counts by half", [RULE]),
    ("guard", "formats/guard.h", "kGuardVoxels = 0.2;", "kGuardVoxels = 0.2002;",
     "the guard's distance is a micrometer less at 5 mm", [RULE]),
    ("guard", "runtime/field/distance_field.cpp", "scale_.mesh_code = static_cast<float>(h.distance_zero_code);",
     "scale_.mesh_code = static_cast<float>(h.distance_zero_code - 1);", "a code stands for one step more", [RULE]),
    ("guard", "runtime/guard/find_seat.cpp", "             step_m;", "             step_m - 1e-6f;",
     "a seat's floor is a micrometer too low", [RULE]),
    ("guard", KERNEL_FILE, "ints(hn::Lt(distance, floor))", "ints(hn::Lt(hn::Add(distance, hn::Set(kF, 1e-6f)), floor))",
     "a seated point may be a micrometer too deep", [RULE]),
    ("guard", KERNEL_FILE, "hn::Eq(there, hn::LoadU(kI, voxel[axis] + i))", "hn::Eq(there, there)",
     "a point keeps its nearest object in another voxel", [KERNEL]),
    ("guard", KERNEL_FILE, "hn::Or(against, faces)", "faces", "points that went against their side are not looked at", [KERNEL]),
    ("guard", KERNEL_FILE, "hn::And(is_zero(direction), hn::Gt(depth, zero))", "hn::And(is_zero(direction), hn::Lt(depth, depth))",
     "a point without a direction is pressed", [KERNEL]),
    ("guard", KERNEL_FILE, "i + kLanes <= later.count && at + kLanes <= earlier.count", "i + kLanes <= later.count",
     "points behind the end of the earlier set are paired", [KERNEL]),
    ("guard", ROWS_FILE, "0.5 * (to - from)", "0.25 * (to - from)", "contacts at the sides of a box push nothing", [ROWS]),
    ("guard", ROWS_FILE, "box.max_onset + kRounding * size + kTiny < least", "box.max_onset - kRounding * size < least",
     "a box is not larger by the rounding", [ROWS]),
    ("guard", "runtime/guard/find_seat.cpp", "kEarlyVoxels = 0.15f", "kEarlyVoxels = 0",
     "the force of a seat with a gap begins at the surface", [SEAT]),
    ("guard", "runtime/guard/find_seat.cpp", "std::min(object.between_m, object.contact_m)", "object.between_m",
     "edges push a part that lies nearer to their faces", [SEAT]),
    ("guard", "runtime/guard/between_points.cpp", "kGentleFall = 0.1f", "kGentleFall = 0.19f",
     "an edge is felt only where both of its faces are tilted", [SEAT]),
    ("guard", SEAT_FILE, "    later.is_barred[i] = field::ContactSet::kCrossed;", "", "sheets are crossed", [SEAT]),
    ("guard", SEAT_FILE, "return glm::dot(probe_.slope(i), probe_.normal(i)) < kClearSlope;",
     "return glm::dot(probe_.slope(i), probe_.normal(i)) < kClearSlope && !(probe_.query().shell().view().cone_cos[probe_.point(i)] < 0.8f);",
     "points with wide normal cones, as those of thin legs, are passed over", [TABS]),
    ("guard", SEAT_FILE, "if (!wall.is_known()) return std::nullopt;", "return std::nullopt;",
     "in the middle of a sheet the normal alone tells a point's side", [SHEETS]),
    ("guard", SEAT_FILE, "before > was_before && after", "after", "a point behind a sheet may not go away from it", [SHEETS]),
    ("guard", "runtime/guard/flush_walls.cpp", "{glm::ivec3(0), cell_at(0), cell_at(kBehindSurface)}", "{glm::ivec3(0)}",
     "a sheet is not seen from the cell before it", [SHEETS]),
    ("guard", "runtime/clearance/seat_stretch.cpp",
     "  parts_->probe->mark_crossings(parts_->earlier, glm::vec3(shift_m), parts_->contacts);", "",
     "a check by the files follows no point", [WALLS]),
    ("guard", "runtime/guard/pose_guard.cpp", "if (seat_open_) seat_.apply(out);", "", "a seat has no rule", [SEAT]),
    ("guard", MODEL, "const bool clear = guard::accepts_pose(here_, there_);", "const bool clear = true;",
     "no guard", [GUARD, FRAMES]),
    ("guard", MODEL, "for (double& component : motion.velocity) component *= limit_m / travel;", "",
     "points travel as far as they like", [GUARD]),
    ("guard", MODEL, "if (clear && affordable(", "if (affordable(", "a barred pose is kept", [GUARD, FRAMES]),
    ("guard", MODEL, "return rise_j <= state.allowance_j;", "return true;", "energy from nowhere", [GUARD, ("runtime_tests", "*Stability*:*Rest*:*Allowance*:*Sim*")]),
    ("files", "runtime/run/baked_files.cpp", "return audit_voxmap(map, name);",
     "static_cast<void>(audit_voxmap(map, name));\n  return {};",
     "opening for a run audits nothing", [FILES]),
    ("files", "formats/digest/file_digest.cpp", "if (expected.empty()) return {};", "return {};",
     "any digest is the expected one", [FILES]),
    ("files", TABLE_FILE, "if (bytes.size() != header.file_bytes) {", "if (bytes.size() < header.file_bytes) {",
     "bytes may follow", [DAMAGE]),
    ("files", TABLE_FILE, "if (checksum(front) != header.header_checksum) {", "if (false) {",
     "the header's checksum is not read", [DAMAGE]),
    ("files", TABLE_FILE, "if (entry.offset != aligned_offset(previous_end)) {",
     "if (entry.offset < aligned_offset(previous_end)) {", "sections may leave holes", [DAMAGE]),
    ("files", TABLE_FILE, "if (bytes[at] != std::byte{0}) {", "if (bytes[at] != std::byte{0} && bytes.empty()) {", "holes may hold anything", [DAMAGE]),
    ("files", TABLE_FILE, "entry.id <= table[placed.index - 1].id", "entry.id < table[placed.index - 1].id",
     "a section may stand twice", [DAMAGE]),
    ("files", BULK, "const bool bad_child = entry >= rule.child_count;", "const bool bad_child = entry > rule.child_count;",
     "a child beyond the last", [DAMAGE]),
    ("files", BULK, "(value > rule.max_value)", "(value > rule.max_value + 1)", "a value beyond the last", [DAMAGE]),
    ("files", BULK, "((rest & ~allowed) != 0)", "((rest & ~allowed & 0) != 0)", "reserved bits may be set", [DAMAGE]),
    ("files", BULK, "  return outside == 0;", "  return true;", "spheres need not hold their points", [DAMAGE]),
    ("files", BULK, "kUnitTolerance = 2e-6", "kUnitTolerance = 2e-1", "normals of any length", [DAMAGE]),
    ("files", BULK, "&& v.weight_m2[i] >= 0", "", "negative weights", [DAMAGE]),
    ("files", "formats/file/atomic_file.cpp", "if (Status sound = check(bytes, shown_.string()); !sound) {",
     "if (Status sound = check(bytes, shown_.string()); !sound && shown_.empty()) {",
     "what no reader takes is written", [WRITERS]),
    ("files", "formats/file/atomic_file.cpp", "  ::fchmod(descriptor_, old.st_mode & 0777);\n", "",
     "a new file has a mode of its own", [WRITERS]),
    ("files", "formats/path/path_file.cpp", "bool readable = row.time_s > last_s_ &&", "bool readable = row.time_s >= last_s_ &&",
     "two poses of one time are written", [WRITERS]),
    ("files", "runtime/stream/recording.cpp", "if (lost_frames > 0) return", "if (frames_ < 100'000) return",
     "recordings are not read back", [STREAM]),
    ("files", "runtime/stream/recording.cpp", "if (Status s = check_recorded(p); !s) {",
     "if (Status s = check_recorded(p); !s && s.error().where.empty()) {",
     "a recorded parameter may have any value", [STREAM]),
    ("files", "runtime/stream/recording.cpp", "p.model == Model::kPaper && p.force", "p.rate_hz < 0 && p.force",
     "any force goes with a recorded model", [STREAM]),
    ("door", "formats/command/quantity.cpp", "if (failure != std::errc{} || !std::isfinite(number)) return not_a_number(text);",
     "if (failure != std::errc{}) return not_a_number(text);", "a number need not be finite", [TEXTS]),
    ("door", "formats/command/quantity.cpp", "if (meters && std::abs(*meters) > kFarthestM) {", "if (meters && *meters > kFarthestM) {",
     "lengths have no bound below", [TEXTS]),
    ("door", "formats/command/quantity.cpp", "if (seconds && *seconds > kLongestS) {", "if (seconds && *seconds > 1e299) {",
     "times have no bound", [TEXTS]),
    ("door", RANGES, "value >= range.smallest && value <= range.largest", "!(value < range.smallest) && !(value > range.largest)",
     "a device may rate its force as NaN", [RANGE]),
    ("door", RANGES, "if (Status s = check_ratings(request.device); !s) return s;", "",
     "a device may rate its motors as it likes", [RANGE]),
    ("door", RANGES, "request.recorded ? check_recorded(*request.recorded) : Status{}", "Status{}",
     "a recorded model may have any numbers", [RANGE]),
    ("door", RANGES, "{\"motion_scale\", request.placement.motion_scale, kMotionScales},", "",
     "a motion may be scaled to nothing", [RANGE]),
    ("door", "formats/result.cpp", "(code >= 0x7f && code < 0xa0)", "code == 0x7f", "C1 reaches the terminal", [TEXTS]),
    ("door", "formats/result.cpp", "(code >= 0x202a && code <= 0x202e)", "code == 0x202a", "U+202E reaches the terminal", [TEXTS]),
    ("audit", A + "voxmap_audit.cpp", "if (said == counted) continue;", "continue;", "any counts", [AUDIT]),
    ("audit", A + "effort.h", "return left_ == 0;", "return false;", "strewn nodes and bricks are looked at to the end", [AUDIT]),
    ("audit", A + "brick_facts.cpp", "std::uint8_t depth = 0;", "std::uint8_t depth = 1;", "gaps too wide by one", [AUDIT]),
    ("audit", A + "distance_cube.cpp", "const int grown = smallest + edge;", "const int grown = smallest + edge + 1;",
     "distances grow too fast", [AUDIT]),
    ("audit", A + "distance_cube.h", "d == kCenter ? 0 : gaps[d] + 1", "d == kCenter ? 0 : gaps[d] + 2",
     "distances too large by one", [AUDIT]),
    ("audit", A + "clearances.cpp", "margin * edge_ + 1)", "Ring::kFar)", "clearances beyond the margin are believed", [AUDIT]),
    ("audit", A + "clearances.cpp", "grown(Span::cube(low, edge), clearance - 1)", "grown(Span::cube(low, edge), clearance - 2)",
     "a look that is one voxel short", [AUDIT]),
    ("audit", A + "clearances.cpp", "const bool known = is_known(reach);", "const bool known = true;",
     "clearances reach across cropped sides", [AUDIT]),
    ("audit", A + "layers.cpp", "contents_.node_gaps(around[d])[kDirections - 1 - d] < steps_", "false",
     "free nodes beside a wall are not looked at", [AUDIT]),
    ("audit", A + "node_rows.cpp", "below[i] >> (64 - step)", "below[i] >> 63 >> 1", "layers do not grow from node to node", [AUDIT]),
    ("audit", A + "code_rules.cpp", "if (max_lane(largest) > leap_[n]) return false;", "", "codes leap inside a brick", [AUDIT]),
    ("audit", A + "code_rules.cpp", "beside_value_[1][code] = smallest < radius;", "beside_value_[1][code] = true;",
     "any code in the interior", [AUDIT]),
    ("audit", A + "code_rules.cpp", "nearest_[a] > farthest_[b] + length", "nearest_[a] > farthest_[b] + length + 2",
     "codes may leap by three voxels", [AUDIT]),
    ("audit", "formats/bricks/packed_bricks.cpp", "> object_count)", "> object_count + 1)", "an object beyond the last", [AUDIT]),
]


def quiet(command, timeout=None, shell=False):
    try:
        return subprocess.run(command, cwd=BUILD, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=timeout, check=False, shell=shell)
    except subprocess.TimeoutExpired as late:
        return subprocess.CompletedProcess(command, 124, late.stdout or "", "")


@functools.lru_cache
def readers():
    """By file of the sources: the object files that are compiled from it."""
    found = {}
    for line in quiet(["ninja", "-t", "deps"]).stdout.splitlines():
        if line.startswith(" "):
            found.setdefault((BUILD / line.strip()).resolve(), []).append(compiled)
        elif line:
            compiled = line.split(":")[0]
    return found


@functools.lru_cache
def compile_commands():
    """By object file."""
    commands = json.loads((BUILD / "compile_commands.json").read_text())
    return {re.search(r" -o (\S+)", entry["command"]).group(1): entry for entry in commands}


@functools.lru_cache
def link_command(program):
    return quiet(["ninja", "-t", "commands", f"bin/{program}"]).stdout.splitlines()[-1]


def compile_planted(name, folder, program):
    """Compiles what `program` has of the file, as it is in `folder`. By old object file the new one."""
    compiled = {}
    for old in readers().get(ROOT / name, []):
        target = re.search(r"CMakeFiles/([^/]+)\.dir/", old).group(1)
        if f" {old} " not in link_command(program) and f"lib{target}.a" not in link_command(program):
            continue
        entry = compile_commands()[old]
        source = str(folder / name) if entry["file"] == str(ROOT / name) else entry["file"]
        compiled[old] = str(folder / f"{len(compiled)}.o")
        command = entry["command"].replace(f" -o {old} ", f" -o {compiled[old]} ").replace(
            f" -c {entry['file']}", f" -Wno-error -c {source}").replace(" -I", f" -I{folder} -I", 1)
        built = quiet(command, shell=True)
        if built.returncode:
            sys.exit(f"{name} cannot be compiled with its fault:\n{built.stdout}")
    if not compiled:
        sys.exit(f"{program} has nothing of {name}")
    return compiled


def link_planted(program, compiled, folder):
    """The program with the new object files: those of libraries stand before the libraries, whose own are left out."""
    command = link_command(program).replace(f" -o bin/{program} ", f" -o {folder / program} ")
    for old, new in compiled.items():
        if f" {old} " in command:
            command = command.replace(f" {old} ", f" {new} ")
        else:
            command = command.replace(" -o ", f" {new} -o ", 1)
    built = quiet(command, shell=True)
    if built.returncode:
        sys.exit(f"{program} cannot be linked with its fault:\n{built.stdout}")
    return folder / program


def notices(path, which):
    """The failures of a test of the program, or nothing."""
    program = path.name
    if which.isdigit():
        run = quiet([str(path), "--frames", which], timeout=600)
        return f"`{program}`: " + run.stdout.strip().splitlines()[0].split(": ", 1)[-1] if run.returncode else ""
    run = quiet([str(path), "--gtest_filter=" + which, "--gtest_fail_fast"], timeout=600)
    if run.returncode == 0:
        return ""
    failed = [line.split()[3].rstrip(",") for line in run.stdout.splitlines() if line.startswith("[  FAILED  ]")
              and len(line.split()) > 3 and "." in line.split()[3]]
    return "`" + failed[0].split("/")[0 if "." in failed[0].split("/")[0] else 1] + "`" if failed else f"`{program}` ends"


def plant(fault):
    """The test that notices; empty where none does."""
    _, name, text, planted, _, tests = fault
    whole = (ROOT / name).read_text()
    if whole.count(text) != 1:
        sys.exit(f"{name} has {whole.count(text)} times: {text}")
    with tempfile.TemporaryDirectory(dir=BUILD, prefix="planted") as folder:
        folder = pathlib.Path(folder)
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_text(whole.replace(text, planted))
        for program in dict.fromkeys(program for program, _ in tests):
            path = link_planted(program, compile_planted(name, folder, program), folder)
            for which in (which for of, which in tests if of == program):
                if found := notices(path, which):
                    return found
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", default=[""])
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    faults = [fault for fault in FAULTS
              if any(word in text for word in arguments.only for text in (fault[0], fault[1], fault[4]))]
    if arguments.list:
        for group, name, _, _, meaning, _ in faults:
            print(f"{group}: {name}: {meaning}")
        return 0
    programs = sorted({program for fault in faults for program, _ in fault[5]})
    subprocess.run(["nice", "-n", "5", "ninja", "-C", str(BUILD), *programs], stdout=subprocess.DEVNULL, check=True)
    unnoticed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for fault, found in zip(faults, pool.map(plant, faults)):
            unnoticed += not found
            print(f"{fault[1]}: {fault[4]}: {found or 'NOTHING NOTICED IT'}", flush=True)
    print(f"{len(faults)} planted, {unnoticed} unnoticed")
    return 1 if unnoticed else 0


if __name__ == "__main__":
    sys.exit(main())
