#!/usr/bin/env bash
# The examples of --help, of the commands that bake, run and check, are run as they stand there. Pictures and studies
# are made by tests of their own, and these examples too by scripts/try_packages.sh.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
export PATH=$bin:$PATH
commands=(voxelize pointshell voxinfo voxrun voxcheck)
[ ! -x "$bin/voxplan" ] || commands+=(voxplan)
bash "$FORCELAYER_SOURCE_DIR/tests/support/help_examples.sh" "$data" "${commands[@]}" || fail "an example"
finish
