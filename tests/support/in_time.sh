# Sourced by the tests of runs by the clock. A machine with more to do holds a loop, a plugin or its
# device up for longer than the stale limit. They stand at zero then, as they should, and the run shows
# nothing: it is made again. A test may say "held up: ..." there itself.
held_up='the loop was late|to zero by itself|no fresh reading|held up: '

# in_time FILE COMMAND...: until COMMAND passes. Fails at once where FILE, what the run says, has nothing of the kind.
in_time() {
  local try
  for try in {1..20}; do
    "${@:2}" && return
    grep -qE "$held_up" "$1" || return 1
    sleep $((try / 2))  # what keeps the machine busy may go on for a while
  done
  return 1
}
