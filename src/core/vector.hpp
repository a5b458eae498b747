// Vectors of doubles as wide as the instruction set of the variant, and functions that are written once over a scalar
// type S: a double, a vector, or a dual number.
#pragma once

#include "types.hpp"

namespace RW_VARIANT {

constexpr I64 WIDTH = RW_WIDTH;
typedef double Vector __attribute__((vector_size(8 * RW_WIDTH)));
typedef double Unaligned __attribute__((vector_size(8 * RW_WIDTH), aligned(8)));

template <class S>
inline S load(const double* from);
template <>
inline double load<double>(const double* from) {
    return *from;
}
template <>
inline Vector load<Vector>(const double* from) {
    return *reinterpret_cast<const Unaligned*>(from);
}

inline void store(double* to, double x) { *to = x; }
inline void store(double* to, Vector x) { *reinterpret_cast<Unaligned*>(to) = x; }

inline double root(double x) { return __builtin_sqrt(x); }
inline Vector root(Vector x) {
#if defined(__clang__)
    return __builtin_elementwise_sqrt(x);
#else
    Vector roots;
    for (int i = 0; i < RW_WIDTH; i++) roots[i] = __builtin_sqrt(x[i]);
    return roots;
#endif
}

// `x`, or 0 where `test` is below a floor. What is not a number stays so.
inline double unless_below(double test, double floor, double x) { return test < floor ? 0.0 : x; }
inline Vector unless_below(Vector test, Vector floor, Vector x) { return test < floor ? Vector{} : x; }
inline Vector unless_below(Vector test, double floor, Vector x) { return unless_below(test, Vector{} + floor, x); }

inline Vector larger(Vector x, Vector y) { return x < y ? y : x; }

// `x` where the size of `test` is below a limit, else what `y` returns.
inline double if_below(double test, double limit, double x, auto y) { return test < limit && -limit < test ? x : y(); }
inline Vector if_below(Vector test, double limit, Vector x, auto y) {
    const Vector edge = Vector{} + limit, other = y();
    return test < edge ? (-edge < test ? x : other) : other;
}

}  // namespace RW_VARIANT
