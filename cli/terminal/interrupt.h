// SPDX-License-Identifier: MIT
// Ctrl-C, SIGTERM and a limit of time as wishes that work looks at.
#pragma once

namespace batten::internal {

// From here on Ctrl-C and SIGTERM do no more than make Interrupted() true; either stays ignored
// where it was. Writing past a limit on the size of files fails with EFBIG.
void CatchSignals();
bool Interrupted();

// From so many seconds from now on PastTimeLimit() is true, until the limit ends.
void BeginTimeLimit(double seconds);
void EndTimeLimit();
bool PastTimeLimit();

}  // namespace batten::internal
