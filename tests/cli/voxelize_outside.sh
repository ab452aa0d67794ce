#!/usr/bin/env bash
# The files that a manifest or a glTF file names stay under its folder, unless --allow-outside.
# Files that the commands create have the mode that the user's umask leaves.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

mkdir -p scene/parts outside elsewhere
python3 - <<'PYTHON' || exit 1
import base64, json, struct
corners = [(x, y, z) for z in (0, 10) for y in (0, 10) for x in (0, 10)]
faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"]
obj = "".join("v %g %g %g\n" % c for c in corners) + "".join("f %s\n" % f for f in faces)
for name in ("scene/parts/cube.obj", "scene/cube.obj", "outside/cube.obj"):
    open(name, "w").write(obj)
# A glTF tetrahedron whose buffer lies where the URI says.
points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
indices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]
buffer = struct.pack("<12f", *[c for p in points for c in p]) + struct.pack("<12H", *indices)
for name in ("scene/b.bin", "outside/b.bin"):
    open(name, "wb").write(buffer)
for name, uri in (("in", "b.bin"), ("up", "../outside/b.bin"), ("coded", "%2e%2e/outside/b.bin"),
                  ("round", "parts/../b.bin")):
    json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
               "nodes": [{"mesh": 0}],
               "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
               "buffers": [{"uri": uri, "byteLength": len(buffer)}],
               "bufferViews": [{"buffer": 0, "byteLength": 48},
                               {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
               "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                             {"bufferView": 1, "componentType": 5123, "count": 12,
                              "type": "SCALAR"}]}, open("scene/%s.gltf" % name, "w"))
PYTHON
ln -s ../../outside/cube.obj scene/parts/link.obj
ln -s ../outside scene/folder
ln -s parts scene/inner
ln -s "$work/scene/scene.json" elsewhere/scene.json

bake() {  # bake MESH OPTIONS...: a manifest of that one mesh
  printf '{"voxel_size": "1mm", "parts": [{"mesh": "%s", "units": "mm"}]}' "$1" >scene/scene.json
  shift
  rm -f out.vox
  "$bin/voxelize" scene/scene.json -o out.vox --quiet "$@" 2>err
}
inside() { bake "$1" || fail "$1 was refused: $(cat err)"; }
outside() {
  bake "$1"
  [ $? = 3 ] || fail "$1 was not refused"
  [ "$(wc -l <err)" = 1 ] && grep -q 'parts\[0\].mesh: lies outside the folder.*--allow-outside' err ||
    fail "$1: $(cat err)"
  [ ! -e out.vox ] || fail "$1: a file was written"
  bake "$1" --allow-outside || fail "$1 was refused with --allow-outside: $(cat err)"
}
for path in cube.obj parts/cube.obj parts/../cube.obj ./parts/./cube.obj inner/cube.obj "$work/scene/cube.obj" \
  ../scene/cube.obj; do
  inside "$path"
done
for path in ../outside/cube.obj "$work/outside/cube.obj" parts/link.obj folder/cube.obj \
  parts/../../outside/cube.obj inner/../../outside/cube.obj; do
  outside "$path"
done
# Named by a path of another form, from another working folder, the same holds.
bake cube.obj
(cd scene && "$bin/voxelize" scene.json -o ../out.vox --quiet) || fail "from inside the folder"
(cd scene/parts && "$bin/voxelize" ../scene.json -o "$work/out.vox" --quiet) || fail "from below"
"$bin/voxelize" "$work/scene/../scene/scene.json" -o out.vox --quiet || fail "by a crooked path"
# A link to a manifest is a manifest where the link lies.
"$bin/voxelize" elsewhere/scene.json -o out.vox --quiet 2>err && fail "a mesh beside the link's target"
# An absent file is missing, not forbidden; where the file would be does matter.
bake none.obj
[ $? = 1 ] && grep -q 'no such file' err || fail "missing: $(cat err)"
bake ../none.obj
[ $? = 3 ] && grep -q 'lies outside' err || fail "missing outside: $(cat err)"
bake none/../../outside/cube.obj
[ $? = 3 ] || fail "over a folder that does not exist: $(cat err)"
# A shard of another machine does not open what is not ours: it is refused there too.
printf '{"voxel_size": "1mm", "parts": [{"mesh": "cube.obj", "units": "mm"}, {"mesh": "../outside/cube.obj", "units": "mm"}]}' >scene/scene.json
"$bin/voxelize" scene/scene.json --cache cache --shard 1/2 --quiet 2>err && fail "shard 1 of a scene that lies outside"

# Buffers of glTF.
for name in in round; do
  "$bin/voxelize" "scene/$name.gltf" --voxel-size 50mm -o out.vox --quiet 2>err || fail "$name.gltf: $(cat err)"
  "$bin/voxelize" "scene/$name.gltf" --voxel-size 50mm -o out.vox --quiet --sandbox || fail "$name.gltf in the sandbox"
done
for name in up coded; do
  rm -f out.vox
  for more in "" --sandbox; do
    "$bin/voxelize" "scene/$name.gltf" --voxel-size 50mm -o out.vox --quiet $more 2>err
    [ $? = 3 ] && grep -q 'buffers\[0\].*lies outside' err || fail "$name.gltf $more: $(cat err)"
    [ ! -e out.vox ] || fail "$name.gltf: a file was written"
  done
  "$bin/pointshell" "scene/$name.gltf" --voxel-size 50mm -o out.pshell --quiet 2>err
  [ $? = 3 ] && grep -q 'lies outside' err || fail "pointshell $name.gltf: $(cat err)"
  "$bin/voxelize" "scene/$name.gltf" --voxel-size 50mm -o out.vox --quiet --allow-outside || fail "$name.gltf allowed"
  "$bin/voxelize" "scene/$name.gltf" --voxel-size 50mm -o out.vox --quiet --allow-outside --sandbox ||
    fail "$name.gltf allowed in the sandbox"
  "$bin/pointshell" "scene/$name.gltf" --voxel-size 50mm -o out.pshell --quiet --allow-outside --method fast ||
    fail "pointshell $name.gltf allowed"
done

# The umask holds for every file and folder that a bake leaves, in the cache too.
for mask in 077 027 022; do
  rm -rf made && mkdir made
  (umask $mask && "$bin/voxelize" scene/cube.obj --units mm --voxel-size 1mm --quiet -o made/out.vox --json made/report.json --cache made/cache &&
    "$bin/pointshell" scene/cube.obj --units mm --voxel-size 1mm --quiet --method fast -o made/out.pshell --json made/part.json) || fail "umask $mask"
  files=$(find made -mindepth 1 -type f | wc -l)
  [ "$files" -ge 6 ] || fail "umask $mask: only $files files"
  [ -z "$(find made -mindepth 1 -type f -not -perm $(printf %o $((0666 & ~0$mask))))" ] || fail "umask $mask: files $(find made -ls)"
  [ -z "$(find made -mindepth 1 -type d -not -perm $(printf %o $((0777 & ~0$mask))))" ] || fail "umask $mask: folders $(find made -ls)"
done

finish
