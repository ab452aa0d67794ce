#!/usr/bin/env bash
# The lean side never sees the offline libraries, by source and by link (README, "Layout").
set -euo pipefail
cd "$FORCELAYER_SOURCE_DIR"

fail=0
refuse() {  # WHAT PATTERN FILES...
  local what=$1 pattern=$2
  shift 2
  if grep -nE "$pattern" "$@"; then
    echo "FAILED: $what" >&2
    fail=1
  fi
}
sources() { find "$@" \( -name '*.h' -o -name '*.cpp' -o -name '*.c' \) ; }

mapfile -t runtime < <(sources runtime -not -path 'runtime/viewer/*')
mapfile -t formats < <(sources formats -not -path 'formats/mesh/*' -not -path 'formats/command/*' \
                       -not -path 'formats/voxinfo/*')
mapfile -t voxelize < <(sources voxelize)
mapfile -t pointshell < <(sources pointshell)
[ ${#runtime[@]} -gt 5 ] && [ ${#formats[@]} -gt 5 ] && [ ${#voxelize[@]} -gt 3 ] &&
  [ ${#pointshell[@]} -gt 3 ] || { echo "FAILED: sources not found" >&2; exit 1; }

offline='#include *[<"](openvdb|OpenMesh|draco|tbb|oneapi|vtk|formats/mesh|voxelize/|pointshell/)'
refuse "runtime sees an offline library" "$offline" "${runtime[@]}"
refuse "formats sees more than the standard library and a checksum" \
  '#include *[<"](glm|openvdb|OpenMesh|draco|tbb|oneapi|CLI|nlohmann|hwy|hidapi|runtime/|voxelize/|pointshell/|formats/(mesh|command)/)' "${formats[@]}"
refuse "voxelize sees pointshell or runtime" '#include *[<"](pointshell|runtime)/' "${voxelize[@]}"
refuse "pointshell sees voxelize or runtime" '#include *[<"](voxelize|runtime)/' "${pointshell[@]}"

hidapi_users=$(sources runtime | xargs grep -lE '#include *[<"](hidapi/)?hidapi' | wc -l) || true
[ "$hidapi_users" -le 1 ] || { echo "FAILED: $hidapi_users files include hidapi.h" >&2; fail=1; }

for command in voxrun voxinfo; do
  binary=$FORCELAYER_BIN_DIR/$command
  [ -x "$binary" ] || { echo "FAILED: $binary is missing" >&2; exit 1; }
done
refuse_linked() { ldd "$1" | grep -E 'openvdb|OpenMesh|draco|libtbb|vtk|boost' && {
  echo "FAILED: $1 links an offline library" >&2; fail=1; } || true; }
refuse_linked "$FORCELAYER_BIN_DIR/voxrun"
exit $fail
