#pragma once
/// @file wide.hpp  TARN_WIDE: a function that exists twice, for processors with 256-bit integer
/// units (chosen
///                 when the program starts) and for all others. For simple loops that the compiler
///                 vectorises.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__)
#define TARN_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define TARN_WIDE
#endif
