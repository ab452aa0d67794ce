"""Builds the extension of the Python package with the project's own CMake files, and takes the version from there."""

import os
import pathlib
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
VERSION = re.search(r"project\(forcelayer VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        built_already = os.environ.get("FORCELAYER_BUILT")  # a build folder: the test takes its extension
        build = pathlib.Path(built_already or pathlib.Path(self.build_temp).resolve() / "cmake")
        if not built_already:
            subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            "-DFORCELAYER_OFFLINE_TOOLS=OFF", "-DFORCELAYER_VIEWER=OFF", "-DFORCELAYER_TESTS=OFF",
                            f"-DPython_EXECUTABLE={sys.executable}"], check=True)
            subprocess.run(["cmake", "--build", build, "--target", "forcelayer_python"], check=True)
        built, = (build / "python/forcelayer").glob("_forcelayer*.so")
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        self.copy_file(str(built), str(target))


setup(version=VERSION, ext_modules=[Extension("forcelayer._forcelayer", [])], cmdclass={"build_ext": BuildByCMake})
