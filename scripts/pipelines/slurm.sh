#!/bin/sh
# Bakes a scene in shards on many nodes, and proves on as many that the part keeps its clearance along every saved path.
# Run it in the repository's folder, on a file system that all nodes share; docs/ci.md says what to change.
# It waits for its jobs; status 0: every path is clear, 6: one is not.
set -eu

SCENE=bay.json
PART=part.obj
PART_UNITS=mm
VOXEL_SIZE=3mm
CLEARANCE=10mm
SHARDS=4

case ${1:-submit} in
  submit)
    rm -rf verdicts
    mkdir verdicts
    paths=$(ls paths/*.csv | wc -l)
    shards=$(sbatch --parsable --array=1-$SHARDS --output=verdicts/shard-%a.log "$0" shard)
    bake=$(sbatch --parsable --dependency=afterok:"$shards" --kill-on-invalid-dep=yes --output=verdicts/bake.log "$0" bake)
    status=0
    sbatch --wait --quiet --dependency=afterok:"$bake" --kill-on-invalid-dep=yes --array=1-"$paths" \
      --output=verdicts/check-%a.log "$0" check || status=$?
    cat verdicts/*.log
    exit $status
    ;;
  shard)
    voxelize "$SCENE" --voxel-size "$VOXEL_SIZE" --cache bake-cache --shard "$SLURM_ARRAY_TASK_ID/$SHARDS"
    ;;
  bake)
    voxelize "$SCENE" --voxel-size "$VOXEL_SIZE" --cache bake-cache -o scene.vox --json verdicts/bake.json
    pointshell "$PART" --units "$PART_UNITS" --voxel-size "$VOXEL_SIZE" -o part.pshell
    ;;
  check)
    path=$(ls paths/*.csv | sed -n "${SLURM_ARRAY_TASK_ID}p")
    verdict=verdicts/$(basename "$path" .csv)
    voxcheck scene.vox part.pshell "$path" --clearance "$CLEARANCE" \
      --exact "$SCENE" --part "$PART" --part-units "$PART_UNITS" --report "picture:$verdict.png" \
      --json "$verdict.json" --report "junit:$verdict.xml"
    ;;
esac
