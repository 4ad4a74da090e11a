// SPDX-License-Identifier: MIT
// The classes of CLI11 by name, for headers.
#pragma once

namespace CLI {
class App;
class Option;
}  // namespace CLI
