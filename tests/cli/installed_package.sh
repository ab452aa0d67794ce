#!/usr/bin/env bash
# Installs the build into an empty prefix, builds an outside project against it with
# find_package(forcelayer), one in C with pkg-config, runs them on the golden files, and looks at which headers are
# installed, what libforcelayer.so.0 exports, and what the installed voxrun links.
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

# In C, by pkg-config: the shared library alone, with what was promised of its ABI.
PKG_CONFIG_PATH=$(dirname "$(find "$scratch/prefix" -name forcelayer.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046,SC2086  # flags are words
"$(cache_entry CMAKE_C_COMPILER)" $(cache_entry CMAKE_C_FLAGS) -std=c11 -Wall -Wextra -Wpedantic -Werror \
  "$FORCELAYER_SOURCE_DIR"/tests/consumer/{main,abi}.c $(pkg-config --cflags --libs forcelayer) -o "$scratch/consumer_so"
library=$(find "$scratch/prefix" -name libforcelayer.so.0)
LD_LIBRARY_PATH=$(dirname "$library") "$scratch/consumer_so" "$golden/v2.vox" "$golden/v2.pshell"
[ "$(pkg-config --modversion forcelayer)" = "$("$scratch/prefix/bin/voxrun" --version | cut -d' ' -f2)" ]

# It exports the functions of the C header, as the list says: no more, no less.
in_header=$("$(cache_entry CMAKE_C_COMPILER)" -E -P "$FORCELAYER_SOURCE_DIR/runtime/forcelayer/forcelayer.h" |
  grep -oE '\bforcelayer_[a-z_]+ *\(' | tr -d ' (' | sort)
in_list=$(sed -n 's/^ *\(forcelayer_[a-z_]*\);$/\1/p' "$FORCELAYER_SOURCE_DIR/runtime/run/libforcelayer.map" | sort)
in_library=$(nm -D --defined-only "$library" | sed -n 's/.* [^A] \([^@]*\)@.*/\1/p' | sort)
if ! diff <(echo "$in_header") <(echo "$in_list") || ! diff <(echo "$in_list") <(echo "$in_library"); then
  echo "FAILED: header, list (<) and library (>) do not name the same functions" >&2
  exit 1
fi
nm -D --defined-only "$library" | grep -v '@FORCELAYER_0$' | grep -v ' A FORCELAYER_0$' &&
  { echo "FAILED: libforcelayer.so.0 exports that beside the C interface" >&2; exit 1; }

# Public headers alone: those of runtime/forcelayer, and the ones of formats that they include.
headers=$(cd "$scratch/prefix/include" && find . -name '*.h' | sort)
expected=$(cd "$FORCELAYER_SOURCE_DIR/runtime" && find ./forcelayer -name '*.h'
  cd ../formats && printf './forcelayer/formats/%s\n' {result,voxmap,voxmap_format,pshell,pshell_format,surface_distance,file_format}.h \
    bricks/packed_bricks.h file/file_bytes.h)
if ! diff <(echo "$headers") <(sort <<<"$expected"); then
  echo "FAILED: other headers are installed than the public ones" >&2
  exit 1
fi

# voxrun and voxcheck load libc and its parts, Highway, Nettle, hidapi and what that needs, nothing else.
if [ "$(cache_entry CMAKE_BUILD_TYPE)" = Release ]; then
  allowed='^(linux-vdso|ld-linux-.*|libc|libm|libstdc\+\+|libgcc_s|libhwy|libhidapi-hidraw|libudev|libnettle)$'
  for command in voxrun voxcheck; do
    if ldd "$scratch/prefix/bin/$command" | sed 's/^[[:space:]]*//; s/ .*//; s|.*/||; s/\.so.*//' |
      grep -vE "$allowed"; then
      echo "FAILED: the installed $command loads that" >&2
      exit 1
    fi
  done
fi
"$scratch/prefix/bin/voxrun" --version
