# SPDX-License-Identifier: MIT
# Completion for bash: what the programs' own help names.
_biteline() {
  local word=${COMP_WORDS[COMP_CWORD]} asked=("${COMP_WORDS[0]}") i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${COMP_WORDS[i]} in -*) break ;; [a-z]*) [ "${COMP_WORDS[0]##*/}" = biteline ] && asked+=("${COMP_WORDS[i]}") ;; esac
    [ ${#asked[@]} -lt 3 ] || break
  done
  local help words
  help=$("${asked[@]}" --help 2>/dev/null) || help=$("${asked[@]:0:2}" --help 2>/dev/null) || return 0
  words=$(sed -n -e 's/^  \(--[a-z-]*\).*/\1/p' -e 's/^  -[a-zA-Z],\(--[a-z-]*\).*/\1/p' -e '/^Subcommands:/,$s/^  \([a-z][a-z-]*\) .*/\1/p' <<<"$help")
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o default -F _biteline biteline biteline-host biteline-web biteline-gige biteline-uplink biteline-fleet
