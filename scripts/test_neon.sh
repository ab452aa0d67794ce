#!/usr/bin/env bash
# Compiles the contact query, the level and distance fields and their property tests for 64-bit ARM and
# runs them in an emulator, on any machine: NEON and scalar must find what the twins find. Takes some
# minutes.
# Needs g++-aarch64-linux-gnu and qemu-user-static; ARM's own libraries are fetched with apt into
# build/neon and unpacked there, nothing is installed. Arguments go to the tests.
source "$(dirname "$0")/common.sh"

out="$root/build/neon"
mkdir -p "$out/lists/partial" "$out/archives/partial" "$out/include" "$out/objects"
for tool in aarch64-linux-gnu-g++ qemu-aarch64-static; do
  command -v $tool >/dev/null || {
    echo "$tool is missing: apt-get install g++-aarch64-linux-gnu qemu-user-static" >&2
    exit 1
  }
done

if [ ! -e "$out/system/usr/lib/aarch64-linux-gnu/libhwy.so.1" ]; then
  say "fetching Highway and GoogleTest for ARM"
  touch "$out/status"
  apt=(apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User=root
       -o Dir::State="$out" -o Dir::State::status="$out/status" -o Dir::Cache="$out")
  "${apt[@]}" update
  (cd "$out/archives" && "${apt[@]}" download libhwy1 libgtest-dev)
  for package in "$out"/archives/*.deb; do dpkg -x "$package" "$out/system"; done
fi
for header in hwy glm gtest xxhash.h; do ln -sfn "/usr/include/$header" "$out/include/$header"; done

say "compiling for ARM"  # with the option that runtime/CMakeLists.txt gives the kernels there
runtime=(query/contact_query query/query_kernel query/query_workers query/block_skipper field/brick_cache
         field/level_field field/level_field_kernel field/distance_field field/distance_field_kernel
         field/force_field field/tangent_plane coupling/coupling machine/real_time
         machine/step_arithmetic)
tests=(property/runtime_contact_query property/runtime_query_variants property/runtime_level_field
       property/runtime_distance_field)
{
  for name in "${runtime[@]}"; do echo "runtime/$name"; done
  (cd "$root" && ls formats/*.cpp formats/file/*.cpp) | sed 's/[.]cpp$//'
  for name in "${tests[@]}"; do echo "tests/$name"; done
} >"$out/sources"
(cd "$root" && xargs -P "$(nproc)" -I{} sh -c \
  'o="$1/objects/$(echo "$2" | tr / _).o"; [ "$o" -nt "$2.cpp" ] || aarch64-linux-gnu-g++ -std=c++20 -march=armv8-a+crypto -O2 -g0 \
   -ffp-contract=off -Wall -Wno-psabi -DFORCELAYER_VERSION=\"neon\" -I. -Iruntime -isystem "$1/include" -c "$2.cpp" -o "$o"' \
  sh "$out" {} <"$out/sources")

library="$out/system/usr/lib/aarch64-linux-gnu"
aarch64-linux-gnu-g++ "$out"/objects/*.o "$library/libgtest.a" "$library/libgtest_main.a" "$library/libhwy.so.1" \
  -lpthread -o "$out/runtime_tests_arm"
say "running in the emulator"
# A processor without SVE, which the kernels do not use: the tests would ask for it.
qemu-aarch64-static -cpu cortex-a72 -E LD_LIBRARY_PATH="$library" -L /usr/aarch64-linux-gnu "$out/runtime_tests_arm" "$@"
