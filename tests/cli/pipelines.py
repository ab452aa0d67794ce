"""Runs the pipelines of scripts/pipelines on a repository of CAD, and looks at what they say.

Usage: pipelines.py PIPELINE...      (in a scratch folder, with the commands in PATH)

What a host does around a pipeline's commands, its checkout, its cache and its artifacts, is done here. The commands are
those of the files, in their order.
"""

import glob
import hashlib
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import xml.etree.ElementTree as tree

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "sample_data"
PIPELINES = ROOT / "scripts/pipelines"
BRACKET = "bracket_left_2_forward"
# Past the brackets below a floor beam, 12 mm off; and above the floor.
PATHS = {"along_brackets": ["0,0.3,0.188,0.25", "4,-0.1,0.188,0.25"], "above_floor": ["0,0.28,0,0.5", "2,0.28,0,0.7"]}


def git(*words):
    subprocess.run(["git", "-C", "repository", "-c", "user.name=CAD", "-c", "user.email=cad@example.org", *words],
                   check=True, stdout=subprocess.DEVNULL)


def commit(message):
    git("add", ".")
    git("commit", "-m", message)


def make_repository():
    folder = pathlib.Path("repository")
    (folder / "paths").mkdir(parents=True)
    git("init", "--quiet")
    for name in ["bay.json", "part.obj"] + [part["mesh"] for part in json.loads((DATA / "bay.json").read_text())["parts"]]:
        shutil.copy(DATA / name, folder)
    save_path("along_brackets")
    commit("scene, part and a path")


def save_path(name):
    pathlib.Path(f"repository/paths/{name}.csv").write_text("\n".join(["t_s,x_m,y_m,z_m", *PATHS[name]]) + "\n")


def saved_paths():
    return sorted(path.stem for path in pathlib.Path("repository/paths").iterdir())


def move_bracket(y_m):
    """In structure.glb, a binary glTF: header, a chunk of JSON, a chunk of numbers."""
    path = pathlib.Path("repository/structure.glb")
    data = path.read_bytes()
    length, = struct.unpack_from("<I", data, 12)
    scene = json.loads(data[20:20 + length])
    node, = [node for node in scene["nodes"] if node["name"] == BRACKET]
    node["translation"][2] -= y_m  # glTF is y up: its z is the scene's -y
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    path.write_bytes(data[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text)) + b"JSON" + text + rest)


class Host:
    """A checkout, the pipeline's commands, the cache between its runs."""

    def __init__(self, file):
        self.path = PIPELINES / file
        self.words = yaml.safe_load(self.path.read_text()) if file.endswith(".yml") else None

    def run(self):
        """Runs the pipeline on the newest commit. Returns its status and all that it said."""
        self.folder = pathlib.Path("checkout").absolute()
        shutil.rmtree(self.folder, ignore_errors=True)
        subprocess.run(["git", "clone", "--quiet", "repository", self.folder], check=True)
        self.cache(restore=True)
        self.status, self.said = 0, ""
        self.call()
        self.cache(restore=False)
        return self.status

    def sh(self, script, environment, *shell):
        done = subprocess.run([*shell, script], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env={**os.environ, **environment}, timeout=600)
        self.said += done.stdout
        self.status = self.status or done.returncode

    def cache(self, restore):
        for path in self.cached():
            here, there = self.folder / path, pathlib.Path(f"cache-{self.path.stem}")
            source, target = (there, here) if restore else (here, there)
            if source.exists():
                shutil.copytree(source, target, dirs_exist_ok=True)

    def kept(self, pattern):
        return [pathlib.Path(path) for path in glob.glob(str(self.folder / pattern))]


class GitHub(Host):
    """The shell of a container's steps is `sh -e`; a step after one that failed runs only where it says so."""

    def job(self):
        job, = self.words["jobs"].values()
        assert job["runs-on"] and job["container"]
        return job

    def cached(self):
        return [step["with"]["path"] for step in self.job()["steps"] if step.get("uses", "").startswith("actions/cache@")]

    def call(self):
        for step in self.job()["steps"]:
            assert step.keys() <= {"name", "uses", "with", "run", "if"}, step
            assert step.get("if", "always()") == "always()", step
            if "uses" in step:
                action = step["uses"].split("@")[0]
                assert action in ("actions/checkout", "actions/cache", "actions/upload-artifact"), action
            elif self.status == 0 or "if" in step:
                self.sh(step["run"], self.job()["env"], "sh", "-e", "-c")
        for step in self.job()["steps"]:
            if step.get("uses", "").startswith("actions/upload-artifact@"):
                assert step["if"] == "always()" and self.kept(step["with"]["path"] + "/*")

    def check_red(self):
        line, = [line for line in self.said.splitlines() if line.startswith("::error ")]
        assert line.startswith("::error file=paths/along_brackets.csv,title=clearance::Does not keep the clearance, "), line
        assert "; 10 mm required)." in line and names_all(line), line


class GitLab(Host):
    """One shell, that ends with the first line that fails."""

    def job(self):
        job, = self.words.values()
        assert job["image"] and job.keys() == {"image", "variables", "cache", "script", "artifacts"}, job
        return job

    def cached(self):
        assert self.job()["cache"]["when"] == "always"
        return self.job()["cache"]["paths"]

    def call(self):
        job = self.job()
        self.sh("\n".join(["set -eo pipefail", *job["script"]]), job["variables"], "bash", "-c")
        kept = job["artifacts"]
        assert kept["when"] == "always" and all(self.kept(path) for path in kept["paths"])
        assert len(self.kept(kept["reports"]["codequality"])) == 1, "GitLab takes one file"
        assert len(self.kept(kept["reports"]["junit"])) == len(saved_paths())

    def check_red(self):
        quality = self.kept(self.job()["artifacts"]["reports"]["codequality"])[0]
        found, = json.loads(quality.read_text())
        assert found["location"]["path"] == "paths/along_brackets.csv", found
        assert names_all(found["location"]["path"] + found["description"]), found


class Slurm(Host):
    """The cluster is there: the script is run as a user does, in the checkout."""

    def cached(self):
        return ["bake-cache"]

    def call(self):
        self.sh(str(self.path), {}, "sh", "-e")

    def check_red(self):
        assert self.status == 6, self.status


HOSTS = {"github": (GitHub, "github.yml"), "gitlab": (GitLab, "gitlab.yml"), "slurm": (Slurm, "slurm.sh")}


def names_all(text):
    """Whether a line names the position along the path, the path, the object and the distance."""
    return all(word in text for word in (" mm; ", BRACKET, "paths/along_brackets.csv", " mm (measured to "))


def verdict(folder, name):
    report = json.loads((folder / f"verdicts/{name}.json").read_text())
    keys = ("verdict", "min_clearance", "violations", "poses", "required_clearance_m", "exact")
    return {key: report[key] for key in keys}


def digests(folder):
    return [hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in ("scene.vox", "part.pshell")]


def without_host():
    """Files and verdicts of the newest commit by the commands alone, without a cache and in one process each."""
    folder = pathlib.Path("alone").absolute()
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run(["git", "clone", "--quiet", "repository", folder], check=True)
    (folder / "verdicts").mkdir()
    call = lambda *words: subprocess.run([*words, "--quiet"], cwd=folder, stderr=subprocess.DEVNULL).returncode
    assert call("voxelize", "bay.json", "--voxel-size", "3mm", "-o", "scene.vox") == 0
    exact = ["--exact", "bay.json", "--part", "part.obj", "--part-units", "mm"]
    assert call("pointshell", "part.obj", "--units", "mm", "--voxel-size", "3mm", "-o", "part.pshell") == 0
    for name in saved_paths():
        assert call("voxcheck", "scene.vox", "part.pshell", f"paths/{name}.csv", "--clearance", "10mm", *exact,
                    "--json", f"verdicts/{name}.json") in (0, 6)
    return digests(folder), {name: verdict(folder, name) for name in saved_paths()}


def check_run(host, clear, alone):
    status = host.run()
    assert (status == 0) == clear, f"{host.path.name}: status {status}\n{host.said}"
    assert digests(host.folder) == alone[0], f"{host.path.name}: other bytes than without it"
    for name in saved_paths():
        assert verdict(host.folder, name) == alone[1][name], f"{host.path.name}: another verdict than without it"
        failures = tree.parse(host.folder / f"verdicts/{name}.xml").getroot().get("failures")
        assert (failures == "0") == (clear or name == "above_floor"), (name, failures)
        picture = host.folder / f"verdicts/{name}.png"
        assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 10000, picture
    return json.loads((host.folder / "verdicts/bake.json").read_text())


def check_reason(host):
    """A line on the terminal, and the reports, say what is wrong."""
    assert any(names_all(line) for line in host.said.splitlines()), host.said
    red = verdict(host.folder, "along_brackets")
    assert red["verdict"] == "not clear" and verdict(host.folder, "above_floor")["verdict"] == "clear"
    violation, = red["violations"]
    assert violation["object"].endswith("/" + BRACKET) and 2 < violation["t_s"] < 3, violation
    # 12 mm, less the 3 mm by which the bracket came nearer.
    assert abs(violation["exact_m"] - 0.009) < 1e-5 and violation["clearance_m"] <= violation["exact_m"], violation
    host.check_red()


def main(names):
    hosts = [HOSTS[name][0](HOSTS[name][1]) for name in names]
    make_repository()
    first = without_host()
    for host in hosts:
        check_run(host, True, first)
        print(f"{host.path.name}: green")
    move_bracket(-0.003)
    save_path("above_floor")
    commit("a bracket moved by 3 mm, and a path that it is not in the way of")
    moved = without_host()
    for host in hosts:
        report = check_run(host, False, moved)
        check_reason(host)
        baked = [part["name"] for part in report["parts"] if not part.get("from_cache")]
        assert "slurm" in host.path.name or len(baked) == 1 and baked[0].endswith(BRACKET), baked
        print(f"{host.path.name}: red: " + next(line for line in host.said.splitlines() if names_all(line)))
    git("revert", "--no-edit", "HEAD")
    assert without_host() == first
    for host in hosts:
        check_run(host, True, first)
        print(f"{host.path.name}: green again")


main(sys.argv[1:])
