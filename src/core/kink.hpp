// Compliance of a line where a load touches it, relative to the spline through its nodes.
//
// Links of finite length round off the kink that a point force makes. Its tip is d from the spline, across the line,
// and has the stiffness S = (T + EI/h^2)/(h kappa). kappa is the difference of the Green's functions of the line and of
// its links, far from the ends at zeta = (EI/h^2)/(T + EI/h^2) = r^2 and at the part f of a link
//
//     1/kappa = A(r) / ((1 + 0.0139 P(f)) E(x)),
//
// with E for places x near the ends of a line. A, P and E were fitted to the Green's functions
// (tests/core/test_kinks.py): errors of 1/kappa are 0.2 % at r < 0.7, and 5 % where bending bears nearly everything.
// S(T) is concave, as the least energy of all shapes of a kink is: else a kink and its tension had several equilibria.
#pragma once

#include "dual.hpp"

namespace RW_VARIANT {

// A: 1/kappa between two links, by powers of r.
constexpr double FIRMNESS[] = {4.758754846014848, 11.83115896,  0.62527728,   67.98685374,
                               -182.60585336,     218.41668783, -100.19629218};
// Of kappa in the first links of a line, at and between steps of an eighth of a link; cubic B-splines.
constexpr I64 END_STEPS = 24;
constexpr double END[END_STEPS + 3] = {0.670365, 0.084352, 0.527347, 0.895544, 1.096093, 1.199295, 1.221797,
                                       1.202950, 1.161188, 1.115613, 1.074809, 1.043883, 1.022759, 1.009842,
                                       1.002640, 0.999140, 0.997793, 0.997593, 0.997933, 0.998416, 0.998914,
                                       0.999257, 0.999610, 0.999662, 1.0,      1.0,      1.0};
// Factor of kappa of a kink that moves at these squares of its speed over that of transverse waves, beside
// 1/(1 - square). Beyond the last one links resolve no kink that is carried ahead of its waves.
constexpr double SQUARES[] = {0.0, 0.04, 0.16, 0.25, 0.36, 0.49, 0.64, 0.7225, 0.81, 0.9025};
constexpr double FACTORS[] = {1.0, 1.0017, 1.0077, 1.0133, 1.0222, 1.0373, 1.0669, 1.0954, 1.1483, 1.2802};
constexpr double FASTEST = 0.9025;

// A value and its derivative: of S with the tension, of a shape with a place.
template <class S>
struct Slope {
    S value, slope;
};

// E at x >= 0 links from an end, kept from falling below a quarter.
inline Slope<double> end_factor(double x) {
    const double u = x * 8.0;
    if (!(u < END_STEPS)) return {1.0, 0.0};
    const I64 i = static_cast<I64>(u);
    const double f = u - static_cast<double>(i), g = 1.0 - f;
    const double* const c = END + i;
    const double value = (c[0] * g * g * g + c[3] * f * f * f + c[1] * (4.0 - 6.0 * f * f + 3.0 * f * f * f) +
                          c[2] * (4.0 - 6.0 * g * g + 3.0 * g * g * g)) *
                         (1.0 / 6.0);
    const double slope = 0.5 * ((c[1] - c[0]) * g * g + (c[3] - c[2]) * f * f + (c[2] - c[1]) * (1.0 + 2.0 * f * g));
    return {value, 8.0 * slope};
}

// kappa of a string at x links along a line of n, over that between two links, and its change with x.
inline Slope<double> shape_of(double x, double n) {
    const bool is_far = x > 0.5 * n;
    const Slope<double> end = end_factor(is_far ? n - x : x);
    const double f = x - static_cast<double>(static_cast<I64>(x)), q = f * (1.0 - f), rate = 1.0 - 2.0 * f;
    constexpr double P = 0.013891178758798972, C = 10.045367, D = 14.911190;
    const double middle = 1.0 + P * q * q * (C * (1.0 + 2.0 * q) + D * q * q);
    const double slope = P * q * (C * (2.0 + 6.0 * q) + 4.0 * D * q * q) * rate;
    return {middle * end.value, slope * end.value + middle * (is_far ? -end.slope : end.slope)};
}

struct Kink {
    double bending;     // N, EI/h^2
    double firmness;    // 1/m, of S over A(r) (T + EI/h^2)
    double compliance;  // m/N, of the contact, in series
    double inertia;     // N, line mass times the square of the speed of the kink
};

// S and dS/dT of a kink at rest, without the compliance of the contact. In compression it goes on in a straight line.
template <class S>
inline Slope<S> bare_stiffness(const Kink& k, const S& T) {
    if (k.bending == 0.0) return {T * (FIRMNESS[0] * k.firmness), S(FIRMNESS[0] * k.firmness)};
    const bool is_pushed = value_of(T) <= 0.0;
    const S r = is_pushed ? S(1.0) : root(k.bending / (T + k.bending));
    S a = FIRMNESS[6], rate = 6.0 * FIRMNESS[6];  // and r dA/dr
    for (int i = 5; i >= 0; i--) {
        a = a * r + FIRMNESS[i];
        rate = i > 0 ? rate * r + i * FIRMNESS[i] : rate * r;
    }
    const S slope = (a - 0.5 * rate) * k.firmness;
    if (is_pushed) return {a * (k.bending * k.firmness) + T * slope, slope};
    return {(T + k.bending) * a * k.firmness, slope};
}

template <class S>
inline Slope<S> in_series(double compliance, const Slope<S>& bare) {
    if (compliance == 0.0 || !(value_of(bare.value) > 0.0)) return bare;
    const S part = 1.0 / (1.0 + compliance * bare.value);
    return {bare.value * part, bare.slope * part * part};
}

// Stiffness of a kink that moves along: it feels T - rho U^2.
template <class S>
inline S moving_stiffness(const Kink& k, const S& T) {
    const S whole = T + k.bending;
    if (k.inertia == 0.0 || !(value_of(whole) > 0.0)) return in_series(k.compliance, bare_stiffness(k, T)).value;
    const S moving = value_of(whole) * FASTEST < k.inertia ? FASTEST * whole : S(k.inertia);
    S less = T - moving;
    if (k.bending > 0.0 && value_of(less) < 0.0) less = value_of(T) < 0.0 ? T : S(0.0);
    const S square = moving / whole;
    int i = 0;
    while (i < 8 && value_of(square) > SQUARES[i + 1]) i++;
    const double slope = (FACTORS[i + 1] - FACTORS[i]) / (SQUARES[i + 1] - SQUARES[i]);
    S more = FACTORS[i] - 1.0 + slope * (square - SQUARES[i]);
    if (k.bending > 0.0) more = more * (less / (less + k.bending));
    const Slope<S> bare = bare_stiffness(k, less);
    return in_series(k.compliance, Slope<S>{bare.value / (1.0 + more), bare.slope}).value;
}

}  // namespace RW_VARIANT
