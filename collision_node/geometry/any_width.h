/// Functions that the compiler writes once for any 64-bit machine and once for newer registers and
/// instructions; the loader picks. No product is ever fused with a sum, so both give the same bits.
#pragma once

/// COLLISION_NODE_WITH_CALLS: what such a function calls of its own file is written into it, for its width.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define COLLISION_NODE_ANY_WIDTH __attribute__((target_clones("avx2", "default")))
#define COLLISION_NODE_WITH_CALLS __attribute__((flatten))
#else
#define COLLISION_NODE_ANY_WIDTH
#define COLLISION_NODE_WITH_CALLS
#endif
