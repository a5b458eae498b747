// Dual numbers: a value and its derivatives with respect to N unknowns.
#pragma once

#include "vector.hpp"

namespace RW_VARIANT {

template <int N>
struct Dual {
    double value;
    double slope[N];

    Dual() = default;
    Dual(double constant) : value(constant), slope{} {}
    // The unknown number i.
    Dual(double at, int i) : value(at), slope{} { slope[i] = 1.0; }
};

inline double value_of(double x) { return x; }
template <int N>
inline double value_of(const Dual<N>& x) {
    return x.value;
}

// value + a x' + b y'
template <int N>
inline Dual<N> combined(double value, double a, const Dual<N>& x, double b, const Dual<N>& y) {
    Dual<N> sum;
    sum.value = value;
    for (int i = 0; i < N; i++) sum.slope[i] = a * x.slope[i] + b * y.slope[i];
    return sum;
}
template <int N>
inline Dual<N> scaled(double value, double a, const Dual<N>& x) {
    Dual<N> product;
    product.value = value;
    for (int i = 0; i < N; i++) product.slope[i] = a * x.slope[i];
    return product;
}

template <int N>
inline Dual<N> operator+(const Dual<N>& x, const Dual<N>& y) {
    return combined(x.value + y.value, 1.0, x, 1.0, y);
}
template <int N>
inline Dual<N> operator-(const Dual<N>& x, const Dual<N>& y) {
    return combined(x.value - y.value, 1.0, x, -1.0, y);
}
template <int N>
inline Dual<N> operator*(const Dual<N>& x, const Dual<N>& y) {
    return combined(x.value * y.value, y.value, x, x.value, y);
}
template <int N>
inline Dual<N> operator/(const Dual<N>& x, const Dual<N>& y) {
    const double quotient = x.value / y.value, inverse = 1.0 / y.value;
    return combined(quotient, inverse, x, -quotient * inverse, y);
}
template <int N>
inline Dual<N> operator-(const Dual<N>& x) {
    return scaled(-x.value, -1.0, x);
}
template <int N>
inline Dual<N> operator+(const Dual<N>& x, double y) {
    return scaled(x.value + y, 1.0, x);
}
template <int N>
inline Dual<N> operator+(double x, const Dual<N>& y) {
    return y + x;
}
template <int N>
inline Dual<N> operator-(const Dual<N>& x, double y) {
    return scaled(x.value - y, 1.0, x);
}
template <int N>
inline Dual<N> operator-(double x, const Dual<N>& y) {
    return scaled(x - y.value, -1.0, y);
}
template <int N>
inline Dual<N> operator*(const Dual<N>& x, double y) {
    return scaled(x.value * y, y, x);
}
template <int N>
inline Dual<N> operator*(double x, const Dual<N>& y) {
    return y * x;
}
template <int N>
inline Dual<N> operator/(double x, const Dual<N>& y) {
    const double quotient = x / y.value;
    return scaled(quotient, -quotient * (1.0 / y.value), y);
}

template <int N>
inline Dual<N> root(const Dual<N>& x) {
    const double value = root(x.value);
    return scaled(value, 0.5 / value, x);
}
template <int N>
inline Dual<N> unless_below(const Dual<N>& test, double floor, const Dual<N>& x) {
    return test.value < floor ? Dual<N>(0.0) : x;
}
template <int N>
inline Dual<N> if_below(const Dual<N>& test, double limit, const Dual<N>& x, auto y) {
    return test.value < limit && -limit < test.value ? x : y();
}

}  // namespace RW_VARIANT
