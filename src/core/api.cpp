// The interface of the core in plain C. Names begin with rw_; nothing is called back.
#include "variant.hpp"

namespace baseline {
extern const Variant functions;
}
#if defined(__x86_64__)
#include <cpuid.h>

namespace avx2 {
extern const Variant functions;
}
namespace avx512 {
extern const Variant functions;
}

// Whether the processor and the operating system have all of the features of a variant.
static bool has(I64 variant) {
    unsigned a, b, c, d;
    if (variant == 0) return true;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c >> 27 & 1)) return false;
    unsigned low, high;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return false;
    if (variant == 1) return (low & 6) == 6 && (b >> 5 & 1);
    return (low & 0xe6) == 0xe6 && (b >> 16 & 1) && (b >> 17 & 1) && (b >> 31 & 1);  // F, DQ and VL
}

static const Variant* const VARIANTS[] = {&baseline::functions, &avx2::functions, &avx512::functions};
constexpr I64 COUNT = 3;
#else
static bool has(I64) { return true; }
static const Variant* const VARIANTS[] = {&baseline::functions};
constexpr I64 COUNT = 1;
#endif

// Version of the interface: a library of another one is not used.
RW_EXPORT I64 rw_version() { return 1; }

// Number of the largest variant that runs here: 0 baseline, 1 AVX2, 2 AVX-512.
RW_EXPORT I64 rw_best_variant() {
    I64 variant = COUNT - 1;
    while (!has(variant)) variant--;
    return variant;
}

// Values of an elementary function; 0, or -1 where there is no such variant here.
RW_EXPORT I64 rw_elementary(I64 variant, I64 function, I64 count, const double* x, const double* y, double* values) {
    if (variant < 0 || variant >= COUNT || !has(variant)) return -1;
    VARIANTS[variant]->elementary(function, count, x, y, values);
    return 0;
}
