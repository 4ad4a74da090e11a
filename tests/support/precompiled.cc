// SPDX-License-Identifier: MIT
// A program that does nothing: the test programs share the headers that are precompiled for it.
int main() {}
