# Completes the options, subcommands and choices of Forcelayer's commands in bash, from their own --help.
# Installed for each command under share/bash-completion/completions; `source scripts/completion.bash` does it for a shell.
_forcelayer_complete() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} help choices
  local asked=("${COMP_WORDS[0]}")
  help=$("${asked[@]}" --help 2>/dev/null) || return 0
  # A subcommand has a help of its own.
  if [[ $COMP_CWORD -gt 1 && ${COMP_WORDS[1]} =~ ^[a-z]+$ && ! -e ${COMP_WORDS[1]} ]]; then
    help=$("${asked[@]}" "${COMP_WORDS[1]}" --help 2>/dev/null) || return 0
  fi
  COMPREPLY=()
  if [[ $before == -* ]]; then
    choices=$(sed -nE "s/^  (.*,)?$before ([a-z-]+(\|[a-z-]+)+).*/\2/p" <<<"$help")
    [[ -z $choices ]] || mapfile -t COMPREPLY < <(compgen -W "${choices//|/ }" -- "$word")
    [[ -z $choices ]] || return 0
  fi
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(grep -oE '^  -[^ ]*' <<<"$help" | tr ', ' '\n\n' | grep '^-')" -- "$word")
  elif [[ $COMP_CWORD -eq 1 && $word =~ ^[a-z]+$ ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(sed -nE '/^Subcommands:/,/^$/s/^  ([a-z]+) .*/\1/p; s/^vox[a-z]+ ([a-z]+) lists .*/\1/p' <<<"$help")" -- "$word")
  fi
}
complete -o bashdefault -o default -F _forcelayer_complete voxelize pointshell voxinfo voxrun voxcheck voxplan voxview forcelayer
