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

# Rooms. A file of ROOM includes files of ROOM and of the rooms behind it, and no others of this project.
rooms='
formats/lattice:
voxelize/masks:     formats/lattice
voxelize/scan:      formats formats/lattice formats/mesh voxelize/masks
voxelize/fill:      formats/lattice voxelize/masks
voxelize/distance:  formats/lattice voxelize/masks voxelize/scan
voxelize/cache:     formats formats/file formats/lattice formats/mesh voxelize/masks voxelize/fill voxelize/distance
voxelize/tree:      formats formats/lattice voxelize/masks voxelize/distance voxelize/cache
voxelize:           formats formats/command formats/mesh voxelize/masks voxelize/scan voxelize/fill voxelize/distance voxelize/cache voxelize/tree
'
while IFS=: read -r room allowed; do
  [ -n "$room" ] || continue
  mapfile -t files < <(find "$room" -maxdepth 1 \( -name '*.h' -o -name '*.cpp' \))
  [ ${#files[@]} -gt 0 ] || { echo "FAILED: no files in room $room" >&2; fail=1; continue; }
  while read -r file included; do
    other=$(dirname "$included")
    case " $room $allowed " in *" $other "*) continue ;; esac
    echo "FAILED: $file includes $included: room $room does not include room $other" >&2
    fail=1
  done < <(grep -HoE '^#include "[^"]+/[^"]+"' "${files[@]}" | sed -E 's/:#include "(.*)"/ \1/')
done <<<"$rooms"

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
