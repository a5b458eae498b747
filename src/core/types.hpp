// Names of the basic types, and of the variant that is being compiled: one for each instruction set, in a namespace of
// its own, or the linker would keep one copy of a template for all of them.
#pragma once

#ifndef RW_VARIANT
#define RW_VARIANT baseline
#define RW_WIDTH 2
#endif

#if defined(_WIN32)
#define RW_EXPORT extern "C" __attribute__((dllexport))
#else
#define RW_EXPORT extern "C" __attribute__((visibility("default")))
#endif

using Size = decltype(sizeof 0);
using I32 = __INT32_TYPE__;
using I64 = __INT64_TYPE__;
using U64 = __UINT64_TYPE__;
using U128 = unsigned __int128;

constexpr double INFINITE = __builtin_inf();
constexpr double NOT_A_NUMBER = __builtin_nan("");
