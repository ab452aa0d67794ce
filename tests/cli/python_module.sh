#!/usr/bin/env bash
# The Python package: doctests, type stubs, the examples of its page, and its answers beside those of the commands.
set -euo pipefail
python=/usr/bin/python3
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
bin=$FORCELAYER_BIN_DIR
data=$FORCELAYER_SOURCE_DIR/sample_data
export PYTHONPATH=$FORCELAYER_BUILD_DIR/python
skip_without pybind11-dev test -e "$PYTHONPATH/forcelayer/__init__.py"
skip_without python3-numpy "$python" -c 'import numpy'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$bin/voxelize" "$data/bay.json" --voxel-size 5mm -o bay.vox --quiet
"$bin/voxelize" "$data/bay.json" --voxel-size 5mm --kind lean -o lean.vox --quiet
"$bin/voxelize" "$data/bay.json" --voxel-size 5mm --roi 0,-0.3m,0.2m,0.4m,0.3m,0.5m -o cropped.vox --quiet
"$bin/pointshell" "$data/part.obj" --units mm --voxel-size 5mm -o part.pshell --quiet
"$bin/voxrun" bay.vox part.pshell --motion "$data/press.csv" --as-fast-as-possible --quiet \
  --record run.flr --trace run.csv --json run.json
export FORCELAYER_BIN_DIR
"$python" -B "$FORCELAYER_SOURCE_DIR/tests/cli/python_module_check.py"

# The notebook, and the ten lines of the page.
if "$python" -c 'import matplotlib' 2>/dev/null; then
  export MPLBACKEND=Agg
  "$python" -B "$FORCELAYER_SOURCE_DIR/runtime/examples/clearance_study.py" >study.txt
  grep -q '^least clearance 12.10 mm to structure/bay_structure/floor/floor_beam_left at 1.808 s$' study.txt
  grep -q '; 0 penetration frames$' study.txt
  [ -s plane.png ] && [ -s clearance.png ]
  sed -n 's/^    //p' "$FORCELAYER_SOURCE_DIR/docs/python.md" >lines.py
  [ "$(grep -c . lines.py)" -le 10 ]
  "$python" -B lines.py
  grep -q 'proven clearance' clearance.svg
fi

# The wheel, whose extension this build has made already: built and installed with no index to ask.
if "$python" -m pip --version >/dev/null 2>&1 && "$python" -c 'import setuptools, wheel' 2>/dev/null; then
  mkdir -p tree/runtime/python
  cp "$FORCELAYER_SOURCE_DIR"/{pyproject.toml,setup.py,CMakeLists.txt} tree
  cp -r "$FORCELAYER_SOURCE_DIR/runtime/python/forcelayer" tree/runtime/python
  FORCELAYER_BUILT=$FORCELAYER_BUILD_DIR "$python" -m pip wheel --quiet --no-index --no-build-isolation ./tree -w wheels
  "$python" -m pip install --quiet --no-index --target site wheels/forcelayer-*.whl
  PYTHONPATH=$folder/site "$python" -B - "$folder/site" <<'END'
import pathlib, sys
import forcelayer
here = pathlib.Path(forcelayer.__file__)
assert str(here).startswith(sys.argv[1] + "/"), here
assert {"__init__.pyi", "py.typed"} <= {file.name for file in here.parent.iterdir()}
assert forcelayer.__version__ in next(pathlib.Path(sys.argv[1]).glob("*.dist-info")).name
assert forcelayer.Scene("bay.vox").clearance(forcelayer.Part("part.pshell"), [[0.0, 0, 0, 1, 0, 0, 0]]).shape == (1,)
END
  # Without the system's packages there is no numpy.
  PYTHONPATH=$folder/site "$python" -B -S -c 'import forcelayer' 2>no_numpy.txt && exit 1
  tail -n 1 no_numpy.txt | grep -q '^ImportError: forcelayer needs numpy: install python3-numpy'
else
  skip "needs python3-pip, python3-setuptools and python3-wheel of scripts/packages.txt"
fi
echo "all good"
