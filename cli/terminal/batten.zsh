#compdef batten
# SPDX-License-Identifier: MIT
# Completion of batten's commands, flags, choices and files in zsh. The program itself says what can
# stand at the cursor. Installed as _batten in a folder of $fpath; or, after compinit:
#   source <(batten completion zsh)
_batten() {
    local program=${(Q)words[1]} kind
    local -a answer
    [[ $program == '~'/* ]] && program=$HOME/${program#'~'/}
    answer=("${(@f)$("$program" __complete "${(@)words[2,CURRENT-1]}" "$PREFIX" 2>/dev/null)}")
    kind=$answer[1]
    answer=("${(@)answer[2,-1]}")
    (( $#answer )) || return 1
    case $kind in
        files)
            answer=("${(@q)answer}")
            [[ $PREFIX == '~/'* ]] && answer=("${(@)answer#\\}")
            compadd -Q -f -- "${(@)answer}" ;;
        open) compadd -S '' -- "${(@)answer}" ;;
        *) compadd -- "${(@)answer}" ;;
    esac
}
if [[ $funcstack[1] == _batten ]]; then
    _batten "$@"
else
    compdef _batten batten
fi
