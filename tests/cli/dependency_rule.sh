#!/usr/bin/env bash
# The lean side never sees the offline libraries, by source (README, "Layout"). cli/lean.sh looks at what is linked.
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

mapfile -t runtime < <(sources runtime)
mapfile -t formats < <(sources formats -not -path 'formats/mesh/*' -not -path 'formats/command/*' \
                       -not -path 'formats/voxinfo/*')
mapfile -t voxelize < <(sources voxelize)
mapfile -t pointshell < <(sources pointshell)
[ ${#runtime[@]} -gt 5 ] && [ ${#formats[@]} -gt 5 ] && [ ${#voxelize[@]} -gt 3 ] &&
  [ ${#pointshell[@]} -gt 3 ] || { echo "FAILED: sources not found" >&2; exit 1; }

offline='#include *[<"](openvdb|OpenMesh|draco|tbb|oneapi|vtk|fcl|ompl|formats/mesh|voxelize/|pointshell/|workbench/)'
refuse "runtime sees an offline library" "$offline" "${runtime[@]}"
refuse "formats sees more than the standard library and a checksum" \
  '#include *[<"](glm|openvdb|OpenMesh|draco|tbb|oneapi|CLI|nlohmann|hwy|hidapi|runtime/|voxelize/|pointshell/|workbench/|formats/(mesh|command)/)' "${formats[@]}"
refuse "voxelize sees pointshell, runtime or workbench" '#include *[<"](pointshell|runtime|workbench)/' "${voxelize[@]}"
refuse "pointshell sees voxelize, runtime or workbench" '#include *[<"](voxelize|runtime|workbench)/' "${pointshell[@]}"

# Rooms. A file of ROOM includes files of ROOM and of the rooms behind it, and no others of this project. A room
# stands below those that it includes, so that none include each other in a circle. formats/bricks and formats/file are
# of the room formats.
rooms='
formats:
formats/lattice:
formats/audit:          formats
formats/path:           formats
formats/digest:         formats
formats/command/spelling:
formats/command:        formats formats/command/spelling
formats/command/verdict: formats formats/command
runtime/forcelayer:     formats
runtime/machine:        formats
voxelize/masks:         formats/lattice
formats/mesh/checks:    formats
formats/mesh:           formats formats/command formats/command/spelling formats/mesh/checks
runtime/coupling:       runtime/forcelayer
runtime/examples:       runtime/forcelayer
runtime/query:          formats runtime/forcelayer runtime/machine
workbench/viewer/surface: formats formats/command
voxelize/fill:          formats/lattice voxelize/masks
formats/mesh/writers:   formats formats/command formats/mesh
formats/voxinfo:        formats formats/audit formats/command formats/digest formats/path formats/mesh/writers
formats/mesh/sandbox:   formats formats/command formats/mesh
formats/mesh/step/entities: formats formats/mesh
formats/mesh/step/iges: formats formats/mesh formats/mesh/step/entities
formats/mesh/step/cost: formats
formats/mesh/step:      formats formats/mesh formats/mesh/checks formats/mesh/step/cost formats/mesh/step/entities formats/mesh/step/iges
formats/mesh/readers/gltf: formats formats/mesh formats/mesh/checks
formats/mesh/readers:   formats formats/mesh formats/mesh/checks formats/mesh/readers/gltf
pointshell/part:        formats formats/mesh formats/mesh/checks formats/mesh/sandbox
runtime/field:          formats runtime/forcelayer runtime/query
voxelize/scan:          formats formats/lattice formats/mesh voxelize/masks
pointshell/certificate: formats pointshell/part
runtime/guard:          formats runtime/field runtime/forcelayer runtime/query
runtime/model:          formats runtime/coupling runtime/field runtime/forcelayer runtime/guard runtime/machine runtime/query
voxelize/limits:        formats formats/lattice voxelize/masks voxelize/scan
voxelize/distance:      formats formats/lattice voxelize/masks voxelize/scan
pointshell/sample:      formats formats/lattice pointshell/certificate pointshell/part
runtime/clearance:      formats formats/path runtime/coupling runtime/field runtime/forcelayer runtime/guard runtime/query
runtime/devices:        formats formats/path runtime/coupling runtime/forcelayer runtime/model
voxelize/cache:         formats formats/lattice formats/mesh formats/mesh/sandbox voxelize/distance voxelize/fill voxelize/masks voxelize/scan
pointshell/normals:     formats pointshell/part pointshell/sample
runtime/devices/hid:    formats runtime/coupling runtime/devices runtime/forcelayer runtime/machine
runtime/devices/plugin: formats runtime/devices runtime/forcelayer runtime/machine
runtime/loop:           runtime/coupling runtime/devices runtime/forcelayer runtime/machine runtime/model
voxelize/sweep:         formats formats/lattice formats/mesh formats/path voxelize/cache voxelize/fill voxelize/limits voxelize/masks voxelize/scan
voxelize/tree:          formats formats/lattice voxelize/cache voxelize/distance voxelize/masks
pointshell:             formats formats/command formats/mesh formats/mesh/sandbox pointshell/certificate pointshell/normals pointshell/part pointshell/sample
runtime/run:            formats formats/audit formats/digest runtime/field runtime/forcelayer runtime/loop runtime/machine runtime/model runtime/query
runtime/stream:         formats runtime/forcelayer runtime/loop runtime/machine runtime/model
voxelize:               formats formats/command formats/mesh formats/mesh/sandbox formats/path voxelize/cache voxelize/distance voxelize/fill voxelize/limits voxelize/masks voxelize/scan voxelize/sweep voxelize/tree
runtime/python:         formats formats/path runtime/clearance runtime/field runtime/forcelayer runtime/guard runtime/loop runtime/machine runtime/model runtime/query runtime/run runtime/stream
workbench/viewer/run:    formats formats/path runtime/coupling runtime/field runtime/forcelayer runtime/guard runtime/model runtime/stream
runtime/doctor:         formats formats/command runtime/loop runtime/machine runtime/query
runtime/voxrun:         formats formats/command formats/command/verdict formats/digest formats/path runtime/devices runtime/devices/hid runtime/devices/plugin runtime/forcelayer runtime/guard runtime/loop runtime/machine runtime/model runtime/query runtime/run runtime/stream
runtime/voxcheck:       formats formats/command formats/command/spelling formats/command/verdict formats/path runtime/clearance runtime/forcelayer runtime/model runtime/query runtime/run runtime/stream
workbench/pairs/rules:   formats formats/command formats/command/spelling formats/mesh formats/path
workbench/exact/surface: formats formats/command formats/mesh formats/mesh/sandbox formats/mesh/writers formats/path pointshell pointshell/certificate pointshell/part runtime/clearance runtime/forcelayer runtime/voxcheck workbench/pairs/rules
workbench/exact:         formats formats/command formats/mesh formats/mesh/sandbox formats/path pointshell/certificate pointshell/normals pointshell/part runtime/clearance runtime/forcelayer runtime/run runtime/voxcheck workbench/exact/surface
workbench/exact/map:     formats/command formats/mesh/writers pointshell/part runtime/clearance runtime/voxcheck workbench/exact workbench/exact/surface
workbench/exact/program: formats/mesh/sandbox runtime/voxcheck workbench/exact workbench/exact/map
workbench/voxplan/nearest: formats runtime/forcelayer runtime/query
workbench/voxplan/check: formats formats/path runtime/clearance runtime/coupling runtime/forcelayer workbench/exact
workbench/voxplan/smooth: formats runtime/coupling workbench/voxplan/check
workbench/voxplan:       formats formats/command formats/command/verdict formats/mesh/sandbox formats/path runtime/clearance runtime/coupling runtime/field runtime/forcelayer runtime/model runtime/run runtime/voxcheck workbench/exact workbench/voxplan/nearest workbench/voxplan/check workbench/voxplan/smooth
workbench/pairs:         formats formats/command formats/command/spelling formats/command/verdict formats/mesh formats/mesh/sandbox formats/path workbench/exact workbench/exact/surface workbench/pairs/rules
workbench/disassembly:   formats formats/command formats/command/verdict formats/digest formats/mesh formats/mesh/sandbox formats/path runtime/clearance runtime/forcelayer workbench/exact workbench/exact/surface workbench/pairs workbench/pairs/rules
workbench/study:         formats formats/command formats/command/spelling formats/command/verdict formats/digest formats/path workbench/disassembly workbench/pairs workbench/pairs/rules
workbench/viewer/plan:   formats formats/command formats/command/spelling formats/mesh formats/mesh/sandbox formats/path runtime/forcelayer runtime/stream workbench/viewer/run workbench/viewer/surface
workbench/viewer/vtk:    formats formats/command runtime/forcelayer workbench/viewer/plan workbench/viewer/run workbench/viewer/surface
workbench/viewer:        formats formats/command formats/mesh/sandbox workbench/viewer/plan workbench/viewer/run workbench/viewer/vtk
'
find_other() { case $1 in forcelayer) other=runtime/forcelayer ;; formats/bricks | formats/file) other=formats ;; *) other=$1 ;; esac }  # FOLDER: its room
above=
while IFS=: read -r room allowed; do
  [ -n "$room" ] || continue
  for other in $allowed; do
    case "$above " in *" $other "*) ;; *) echo "FAILED: room $room stands above $other" >&2; fail=1 ;; esac
  done
  above+=" $room"
  folders=("$room")
  [ "$room" != formats ] || folders+=(formats/bricks formats/file)
  mapfile -t files < <(find "${folders[@]}" -maxdepth 1 \( -name '*.h' -o -name '*.cpp' -o -name '*.c' \))
  [ ${#files[@]} -gt 0 ] || { echo "FAILED: no files in room $room" >&2; fail=1; continue; }
  count=$(printf '%s\n' "${files[@]}" | grep -cE "^$room/[^/]+$")
  [ "$count" -le 25 ] || { echo "FAILED: $count files in room $room: it is two" >&2; fail=1; }
  while read -r file included; do
    find_other "${included%/*}"
    case " $room $allowed " in *" $other "*) continue ;; esac
    echo "FAILED: $file includes $included: room $room does not include room $other" >&2
    fail=1
  done < <(grep -HoE '^#include "[^"]+/[^"]+"' "${files[@]}" | sed -E 's/:#include "(.*)"/ \1/')
done <<<"$rooms"
# Each folder with sources is a room of the table.
while read -r folder; do
  find_other "$folder"
  case "$above " in *" $other "*) ;; *) echo "FAILED: $folder is no room of the table" >&2; fail=1 ;; esac
done < <(sources formats voxelize pointshell runtime workbench | grep -v /firmware/ | xargs -n1 dirname | sort -u)

hidapi_users=$(sources runtime | xargs grep -lE '#include *[<"](hidapi/)?hidapi' | wc -l) || true
[ "$hidapi_users" -le 1 ] || { echo "FAILED: $hidapi_users files include hidapi.h" >&2; fail=1; }

# Comments and docstrings say what a thing is, as a sentence or a noun phrase.
refuse 'a comment begins with "What" or "Of"' '(^|[[:space:]])(//+<?|#+|\*|/\*+<?|""")[[:space:]]*(What|Of)\b' -r \
  --include=\*.{h,cpp,c,py,sh,bash,cmake,map,txt,yml} formats pointshell runtime scripts tests voxelize workbench *.txt *.py

exit $fail
