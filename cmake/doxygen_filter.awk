# SPDX-License-Identifier: MIT
# batten's headers as Doxygen reads them: what stands before #pragma once is of the file, comments before a declaration are
# of it, those after one on its line too. What Doxygen would read as commands or tags is text.
function text(t) {
  gsub(/\\/, "\\\\", t)
  gsub(/[<>@#&%"]/, "\\\\&", t)
  return t
}
NR == 1 { print; next }
/^#pragma once/ { head = 1; print; next }
!head && /^\/\/ / { print (filed++ ? "/// " : "/// \\file\n/// ") text(substr($0, 4)); next }
/^ *\/\/ / {
  match($0, /\/\//)
  indent = substr($0, 1, RSTART - 1)
  rest = substr($0, RSTART + 3)
  # A comment that goes on below one at the end of a line.
  print indent (trailing && RSTART > column - 3 && RSTART > 8 ? "///< " : "/// ") text(rest)
  next
}
/[;,{}] *\/\/ / {
  at = match($0, /\/\/ /)
  trailing = 1
  column = RSTART
  print substr($0, 1, RSTART - 1) "///< " text(substr($0, RSTART + 3))
  next
}
{ trailing = 0; print }
