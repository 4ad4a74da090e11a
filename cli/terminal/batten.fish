# SPDX-License-Identifier: MIT
# Completion of batten's commands, flags, choices and files in fish. The program itself says what can
# stand at the cursor. Installed as share/fish/vendor_completions.d/batten.fish; or:
#   batten completion fish | source
function __batten_complete
    set -l words (commandline -opc)
    set -l program (string replace -r '^~/' "$HOME/" -- $words[1])
    set -l answer ($program __complete $words[2..-1] (commandline -ct) 2>/dev/null)
    for word in $answer[2..-1]
        if test "$answer[1]" = files; and test -d (string replace -r '^~/' "$HOME/" -- $word)
            echo $word/
        else
            echo $word
        end
    end
end
complete -c batten -f -a '(__batten_complete)'
