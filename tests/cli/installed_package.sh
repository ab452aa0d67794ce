#!/usr/bin/env bash
# Installs the build into an empty prefix, builds an outside project against it with
# find_package(forcelayer), runs it on the golden files, and looks at which headers are installed and
# at what the installed voxrun links.
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cache_entry() { sed -n "s/^$1:[A-Z]*=//p" "$FORCELAYER_BUILD_DIR/CMakeCache.txt"; }

cmake --install "$FORCELAYER_BUILD_DIR" --prefix "$scratch/prefix" >"$scratch/install.log"
cmake -S "$FORCELAYER_SOURCE_DIR/tests/consumer" -B "$scratch/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_COMPILER="$(cache_entry CMAKE_CXX_COMPILER)" \
  -DCMAKE_CXX_FLAGS="$(cache_entry CMAKE_CXX_FLAGS)" >"$scratch/configure.log" ||
  { cat "$scratch/configure.log"; exit 1; }
cmake --build "$scratch/build"

golden=$FORCELAYER_SOURCE_DIR/tests/golden
"$scratch/build/consumer" "$golden/v2.vox" "$golden/v2.pshell" >"$scratch/consumer.txt" 2>&1 && said=0 || said=$?
cat "$scratch/consumer.txt"
[ "$said" -eq 0 ] && grep -q 'model default, 10 frames' "$scratch/consumer.txt" || { echo FAILED >&2; exit 1; }
"$scratch/build/consumer_c" "$golden/v2.vox" "$golden/v2.pshell"

# Public headers alone: those of runtime/forcelayer, and the ones of formats that they include.
headers=$(cd "$scratch/prefix/include" && find . -name '*.h' | sort)
expected=$(cd "$FORCELAYER_SOURCE_DIR/runtime" && find ./forcelayer -name '*.h'
  cd ../formats && printf './forcelayer/formats/%s\n' {result,voxmap,voxmap_format,pshell,pshell_format,surface_distance,file_format}.h \
    file/{mapped_file,descriptor}.h)
if ! diff <(echo "$headers") <(sort <<<"$expected"); then
  echo "FAILED: other headers are installed than the public ones" >&2
  exit 1
fi

# What voxrun and voxcheck load: libc and its parts, Highway, Nettle, hidapi and what that needs, nothing else; small.
if [ "$(cache_entry CMAKE_BUILD_TYPE)" = Release ]; then
  allowed='^(linux-vdso|ld-linux-.*|libc|libm|libstdc\+\+|libgcc_s|libhwy|libhidapi-hidraw|libudev|libnettle)$'
  for command in voxrun voxcheck; do
    if ldd "$scratch/prefix/bin/$command" | sed 's/^[[:space:]]*//; s/ .*//; s|.*/||; s/\.so.*//' |
      grep -vE "$allowed"; then
      echo "FAILED: the installed $command loads that" >&2
      exit 1
    fi
  done
  strip -o "$scratch/voxrun" "$scratch/prefix/bin/voxrun"
  bytes=$(stat -c %s "$scratch/voxrun")
  echo "voxrun: $bytes bytes stripped"
  [ "$bytes" -lt 1000000 ] || { echo "FAILED: voxrun is not below 1 MB" >&2; exit 1; }
fi
"$scratch/prefix/bin/voxrun" --version
