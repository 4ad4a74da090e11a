// SPDX-License-Identifier: MIT
// Nothing: the object whose precompiled headers the test programs share.
