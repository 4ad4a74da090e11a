// SPDX-License-Identifier: MIT
// CLI11, which reads the command line. Its headers take seconds: sources include this one, headers
// cli11_forward.h.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
