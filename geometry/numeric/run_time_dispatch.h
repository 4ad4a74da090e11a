// SPDX-License-Identifier: MIT
// One function compiled for several instruction sets, chosen when the program starts. Such a
// function takes plain pointers only: no Eigen type may cross its border, because Eigen's alignment
// depends on the instruction set. What it calls must be always_inline to be compiled with it.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define BATTEN_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BATTEN_CLONES
#endif

#define BATTEN_INLINE inline __attribute__((always_inline))
