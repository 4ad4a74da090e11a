// SPDX-License-Identifier: MIT
// Ctrl-C and SIGTERM as a wish that work looks at.
#pragma once

namespace batten::internal {

// From here on Ctrl-C and SIGTERM do no more than make Interrupted() true; either stays ignored
// where it was. Writing past a limit on the size of files fails with EFBIG.
void CatchSignals();
bool Interrupted();

}  // namespace batten::internal
