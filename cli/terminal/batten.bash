# SPDX-License-Identifier: MIT
# Completion of batten's commands, flags, choices and files in bash. The program itself says what
# can stand at the cursor. Installed as share/bash-completion/completions/batten; or:
#   source <(batten completion bash)
_batten() {
    local program=${COMP_WORDS[0]} answer
    [[ $program == '~'/* ]] && program=$HOME/${program:2}
    mapfile -t answer < <("$program" __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
    COMPREPLY=("${answer[@]:1}")
    case ${answer[0]} in
        files) compopt -o filenames 2>/dev/null ;;
        open) compopt -o nospace 2>/dev/null ;;
    esac
}
complete -F _batten batten
