// Elementary functions that give the same bits on every platform: no libm, no fused operations, no tables of a
// processor.
//
// Errors are below 2 units in the last place (tests/core/test_elementary.py). Methods: Cody and Waite, Software Manual
// for the Elementary Functions, 1980 (reductions); Payne and Hanek, SIGNUM Newsletter 18, 1983 (angles of any size);
// Dekker, Numerische Mathematik 18, 1971 (products and sums of two numbers).
#pragma once

#include "types.hpp"

namespace RW_VARIANT {

// -- Bits
// --------------------------------------------------------------------------------------------------------------

inline U64 bits_of(double x) { return __builtin_bit_cast(U64, x); }
inline double number_of(U64 bits) { return __builtin_bit_cast(double, bits); }
inline double absolute(double x) { return number_of(bits_of(x) & ~(1ull << 63)); }
inline bool is_negative(double x) { return bits_of(x) >> 63; }
inline bool is_nan(double x) { return x != x; }

// 2 to the power k, for -1022 <= k <= 1023.
inline double power_of_two(I64 k) { return number_of(static_cast<U64>(k + 1023) << 52); }

// x 2^k, also where 2^k or the product is subnormal or too large.
inline double scaled(double x, I64 k) {
    if (k > 1023) return x * power_of_two(1023) * power_of_two(k - 1023 > 1023 ? 1023 : k - 1023);
    if (k < -1022) return x * power_of_two(k + 1022 < -1022 ? -1022 : k + 1022) * power_of_two(-1022);
    return x * power_of_two(k);
}

// Nearest whole number, for |x| < 2^51.
inline double rounded(double x) {
    constexpr double SHIFT = 0x1.8p52;
    return (x + SHIFT) - SHIFT;
}

// -- Numbers of twice the precision
// ------------------------------------------------------------------------------------

struct Pair {
    double high, low;
};

inline Pair two_sum(double a, double b) {
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

inline Pair halves_of(double a) {
    constexpr double SPLIT = 0x1p27 + 1.0;
    const double large = SPLIT * a;
    const double high = large - (large - a);
    return {high, a - high};
}

inline Pair two_product(double a, double b) {
    const double product = a * b;
    const Pair x = halves_of(a), y = halves_of(b);
    return {product, ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low};
}

// -- Exponential and logarithm
// -----------------------------------------------------------------------------------------

constexpr double LN2_HIGH = 0x1.62e42ff000000p-1, LN2_LOW = -0x1.718432a1b0e26p-35;

// exp(high + low), where low is a small correction.
inline double exponential(double high, double low) {
    if (is_nan(high)) return high;
    if (high > 709.79) return INFINITE;
    if (high < -745.14) return 0.0;
    const double k = rounded(high * 0x1.71547652b82fep0);  // 1 / ln 2
    const double r = high - k * LN2_HIGH;                  // exact: LN2_HIGH has 32 bits
    const double t = low - k * LN2_LOW;
    const double x = r + t;
    const double lost = (r - x) + t;
    constexpr double C[] = {1.0 / 6227020800.0, 1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0,
                            1.0 / 362880.0,     1.0 / 40320.0,     1.0 / 5040.0,     1.0 / 720.0,
                            1.0 / 120.0,        1.0 / 24.0,        1.0 / 6.0,        0.5};
    double series = C[0];
    for (int i = 1; i < 12; i++) series = series * x + C[i];
    const double rest = x * x * series + (lost + lost * x);
    const Pair sum = two_sum(1.0, x);
    return scaled(sum.high + (sum.low + rest), static_cast<I64>(k));
}

inline double exp(double x) { return exponential(x, 0.0); }

struct Binary {
    double fraction;
    I64 exponent;
};

// x = fraction 2^exponent with a fraction in [0.7, 1.41), for positive finite x.
inline Binary binary_of(double x) {
    I64 exponent = 0;
    if (bits_of(x) >> 52 == 0) {  // subnormal
        x *= 0x1p54;
        exponent = -54;
    }
    const U64 bits = bits_of(x);
    exponent += static_cast<I64>(bits >> 52) - 1023;
    double fraction = number_of((bits & ((1ull << 52) - 1)) | (1023ull << 52));
    if (fraction > 1.4142135623730951) {
        fraction *= 0.5;
        exponent += 1;
    }
    return {fraction, exponent};
}

// Where the logarithm of x is no finite number, that; else 0.
inline double limit_of_log(double x) {
    if (is_nan(x) || x < 0.0) return NOT_A_NUMBER;
    if (x == 0.0) return -INFINITE;
    return x == INFINITE ? INFINITE : 0.0;
}

// ln((1 + s) / (1 - s)) - 2 s, for |s| < 0.172.
inline double tail_of_log(double s) {
    const double z = s * s;
    double series = 2.0 / 25.0;
    for (int n = 23; n >= 3; n -= 2) series = series * z + 2.0 / n;
    return s * z * series;
}

inline double log(double x) {
    if (const double limit = limit_of_log(x); limit != 0.0) return limit;
    const auto [m, e] = binary_of(x);
    const double f = m - 1.0, k = static_cast<double>(e);
    const double s = f / (2.0 + f), half = 0.5 * f * f;
    // ln(1 + f) = 2 s + tail = f - f^2/2 + s (f^2/2) + tail, since f - s f = 2 s
    return k * LN2_HIGH - ((half - (s * half + tail_of_log(s) + k * LN2_LOW)) - f);
}

// Logarithms of 22/32, 23/32 ... 46/32: 42 bits, and what is left.
constexpr Pair LOGARITHMS[] = {
    {-0x1.7fafa3bd81800p-2, 0x1.72090c812566ap-45},
    {-0x1.522ae0738a000p-2, -0x1.ebe708164c759p-45},
    {-0x1.269621134d800p-2, -0x1.c93c1df5bb3b6p-45},
    {-0x1.f991c6cb3b000p-3, -0x1.bcbecca0cdf30p-46},
    {-0x1.a93ed3c8ad800p-3, -0x1.e36f2bea77a5dp-47},
    {-0x1.5bf406b544000p-3, 0x1.27023eb68981cp-46},
    {-0x1.1178e8227e800p-3, 0x1.c210e63a5f01cp-46},
    {-0x1.9335e5d594800p-4, -0x1.88ae1d5ea3ecdp-48},
    {-0x1.08598b59e3800p-4, -0x1.034451fecdfa8p-47},
    {-0x1.0415d89e74800p-5, 0x1.ddc7f461c5159p-48},
    {0x0.0p+0, 0x0.0p+0},
    {0x1.f829b0e783000p-6, 0x1.80267c7e09e3ep-49},
    {0x1.f0a30c0116000p-5, 0x1.5330be64b8b77p-48},
    {0x1.6f0d28ae56800p-4, 0x1.a5cdf24cdcf69p-47},
    {0x1.e27076e2af000p-4, 0x1.72f4f543fff10p-47},
    {0x1.29552f81ff800p-3, -0x1.6e59fd11c77f0p-46},
    {0x1.5ff3070a79000p-3, 0x1.e9e439f105039p-46},
    {0x1.9525a9cf45800p-3, -0x1.4b89becf8ac74p-47},
    {0x1.c8ff7c79a9800p-3, 0x1.10d612ec0f798p-46},
    {0x1.fb9186d5e4000p-3, -0x1.d572aab993c87p-47},
    {0x1.1675cababa800p-2, -0x1.f1fc63382a8f0p-46},
    {0x1.2e8e2bae12000p-2, -0x1.67b1e99b72bd8p-45},
    {0x1.4618bc21c6000p-2, -0x1.3d82f484c84ccp-46},
    {0x1.5d1bdbf580800p-2, 0x1.ca508d8e0f720p-46},
    {0x1.739d7f6bbd000p-2, 0x1.a7389314feb50p-52},
};

// ln x to 2^-66 of its size or 2^-68 for positive finite x: of x over the nearest 32nd, plus a logarithm from the
// table.
inline Pair precise_log(double x) {
    const auto [m, e] = binary_of(x);
    const double place = rounded(32.0 * m), c = place / 32.0, k = static_cast<double>(e);
    const Pair tabulated = LOGARITHMS[static_cast<int>(place) - 22];
    const double difference = m - c;  // exact
    const Pair sum = two_sum(m, c);
    const double s = difference / sum.high;
    const Pair product = two_product(s, sum.high);
    const double lost = ((difference - product.high) - product.low - s * sum.low) / sum.high;
    const Pair a = two_sum(k * 0x1.62e42fefa3800p-1, tabulated.high);
    const Pair b = two_sum(a.high, 2.0 * s);
    const double low = k * 0x1.ef35793c76730p-45 + tabulated.low + a.low + b.low + 2.0 * lost + tail_of_log(s);
    return two_sum(b.high, low);
}

// x to the power y; of negative x for whole y only, else not a number.
inline double pow(double x, double y) {
    if (y == 0.0 || x == 1.0) return 1.0;
    if (is_nan(x) || is_nan(y)) return NOT_A_NUMBER;
    const double size = absolute(y);
    const bool is_whole = size >= 0x1p52 || rounded(size) == size;
    const bool is_odd = is_whole && size < 0x1p53 && (static_cast<U64>(size) & 1);
    const bool flips = is_negative(x) && is_odd;
    const double base = absolute(x);
    if (x < 0.0 && !is_whole && base != INFINITE) return NOT_A_NUMBER;
    double value;
    if (base == 1.0) {
        value = 1.0;
    } else if (base == 0.0 || base == INFINITE || size == INFINITE) {
        value = (base > 1.0) == (y > 0.0) ? INFINITE : 0.0;
    } else {
        const Pair log_of = precise_log(base);
        if (absolute(log_of.high) * size > 1e3 || size > 1e300) {
            value = (log_of.high > 0.0) == (y > 0.0) ? INFINITE : 0.0;
        } else {
            const Pair product = two_product(log_of.high, y);
            const Pair exponent = two_sum(product.high, product.low + log_of.low * y);
            value = exponential(exponent.high, exponent.low);
        }
    }
    return flips ? -value : value;
}

// -- Sine, cosine, arc tangent
// -----------------------------------------------------------------------------------------

// An angle less the nearest multiple of pi/2, in [-pi/4, pi/4], and that multiple modulo 4.
struct Reduced {
    Pair angle;
    int quarter;
};

constexpr U64 TWO_OVER_PI[] = {
    // after the point, with 64 zeros in front
    0,
    0xa2f9836e4e441529,
    0xfc2757d1f534ddc0,
    0xdb6295993c439041,
    0xfe5163abdebbc561,
    0xb7246e3a424dd2e0,
    0x6492eea09d1921c,
    0xfe1deb1cb129a73e,
    0xe88235f52ebb4484,
    0xe99c7026b45f7e41,
    0x3991d639835339f4,
    0x9c845f8bbdf9283b,
    0x1ff897ffde05980f,
    0xef2f118b5a0a6d1f,
    0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b,
    0x3d0739f78a5292ea,
    0x6bfb5fb11f8d5d08,
    0x56033046fc7b6bab,
    0xf0cfbc209af4361d,
};
constexpr Pair HALF_PI = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

// Angles of 2^20 and more: x 2/pi modulo 4 to 192 bits, of which cancellation leaves more than 70.
inline Reduced reduce_large(double x) {
    const U64 bits = bits_of(x);
    const U64 mantissa = (bits & ((1ull << 52) - 1)) | (1ull << 52);
    const I64 first = static_cast<I64>(bits >> 52 & 2047) - 1075 - 2 + 64;  // bit of the table that weighs 4 / mantissa
    const I64 word = first / 64, shift = first % 64;
    U64 part[3];
    for (int i = 0; i < 3; i++) {
        const U64 here = TWO_OVER_PI[word + i], next = TWO_OVER_PI[word + i + 1];
        part[i] = shift ? here << shift | next >> (64 - shift) : here;
    }
    const U128 low = static_cast<U128>(part[2]) * mantissa;
    const U128 middle = static_cast<U128>(part[1]) * mantissa + static_cast<U64>(low >> 64);
    const U64 top = part[0] * mantissa + static_cast<U64>(middle >> 64);
    const int quarter = static_cast<int>((top + (1ull << 61)) >> 62) & 3;
    U64 high = top << 2 | static_cast<U64>(middle) >> 62,
        rest = static_cast<U64>(middle) << 2 | static_cast<U64>(low) >> 62;
    const bool is_below = high >> 63;  // less than the multiple
    if (is_below) {
        rest = ~rest;
        high = ~high;
    }
    const int zeros = high ? __builtin_clzll(high) : 64 + (rest ? __builtin_clzll(rest) : 63);
    const U128 fraction = (static_cast<U128>(high) << 64 | rest) << zeros;
    const double a = static_cast<double>(static_cast<U64>(fraction >> 75)) * 0x1p-53;  // 53 bits
    const double b = static_cast<double>(static_cast<U64>(fraction >> 22 & ((1ull << 53) - 1))) * 0x1p-106;
    const Pair product = two_product(a, HALF_PI.high);
    const double scale = power_of_two(-zeros), correction = product.low + a * HALF_PI.low + b * HALF_PI.high;
    const Pair angle = two_sum(product.high, correction);
    const double sign = is_below ? -scale : scale;
    return {{sign * angle.high, sign * angle.low}, quarter};
}

inline Reduced reduce(double x) {  // of x >= 0
    if (x >= 0x1p20) return reduce_large(x);
    const double k = rounded(x * 0x1.45f306dc9c883p-1);
    constexpr double PART[] = {0x1.921fb54400000p+0, 0x1.0b4611a600000p-34, 0x1.3198a2e000000p-69};  // 33 bits each
    const double a = x - k * PART[0];                                                                // exact
    const Pair b = two_sum(a, -k * PART[1]);
    const Pair c = two_sum(b.high, -k * PART[2]);
    const Pair angle = two_sum(c.high, c.low + b.low - k * 0x1.b839a252049c1p-104);
    return {angle, static_cast<int>(static_cast<I64>(k) & 3)};
}

inline double sine_near_zero(Pair angle) {
    const double x = angle.high, z = x * x;
    constexpr double C[] = {-1.0 / 121645100408832000.0,
                            1.0 / 355687428096000.0,
                            -1.0 / 1307674368000.0,
                            1.0 / 6227020800.0,
                            -1.0 / 39916800.0,
                            1.0 / 362880.0,
                            -1.0 / 5040.0,
                            1.0 / 120.0,
                            -1.0 / 6.0};
    double series = C[0];
    for (int i = 1; i < 9; i++) series = series * z + C[i];
    return x + (x * z * series + angle.low * (1.0 - 0.5 * z));
}

inline double cosine_near_zero(Pair angle) {
    const double x = angle.high, z = x * x;
    constexpr double C[] = {1.0 / 6402373705728000.0 * -1.0,
                            1.0 / 20922789888000.0,
                            -1.0 / 87178291200.0,
                            1.0 / 479001600.0,
                            -1.0 / 3628800.0,
                            1.0 / 40320.0,
                            -1.0 / 720.0,
                            1.0 / 24.0};
    double series = C[0];
    for (int i = 1; i < 8; i++) series = series * z + C[i];
    const Pair sum = two_sum(1.0, -0.5 * z);
    return sum.high + (sum.low + (z * z * series - x * angle.low));
}

// Sine of x plus as many quarters of a turn.
inline double sine_and(double x, int quarters) {
    if (is_nan(x) || absolute(x) == INFINITE) return NOT_A_NUMBER;
    const Reduced reduced = reduce(absolute(x));
    const bool backwards = is_negative(x);
    const Pair angle = backwards ? Pair{-reduced.angle.high, -reduced.angle.low} : reduced.angle;
    const int quarter = ((backwards ? -reduced.quarter : reduced.quarter) + quarters) & 3;
    const double value = quarter & 1 ? cosine_near_zero(angle) : sine_near_zero(angle);
    return quarter & 2 ? -value : value;
}

inline double sin(double x) { return x == 0.0 ? x : sine_and(x, 0); }
inline double cos(double x) { return sine_and(x, 1); }

// Arc tangents of 0, 1/8 ... 1.
constexpr Pair ARC_TANGENTS[] = {
    {0x0.0p+0, 0x0.0p+0},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};

// Angle of the point (x, y) to the x axis, from -pi to pi.
inline double atan2(double y, double x) {
    if (is_nan(x) || is_nan(y)) return NOT_A_NUMBER;
    double a = absolute(y), b = absolute(x);
    const bool is_steep = a > b, is_behind = is_negative(x);
    if (is_steep) {
        const double kept = a;
        a = b;
        b = kept;
    }
    Pair angle{0.0, 0.0};
    if (a == b && b != 0.0) {
        angle = ARC_TANGENTS[8];
    } else if (a != 0.0 && b != INFINITE) {
        if (b > 0x1p1000) a *= 0x1p-100, b *= 0x1p-100;
        if (a < 0x1p-900) a *= 0x1p100, b *= b < 0x1p900 ? 0x1p100 : 1.0;
        const double ratio = a / b, place = rounded(8.0 * ratio), c = place / 8.0;
        const double below = a - c * b;  // exact but for the last bits of c b, which are small beside the angle
        const double u = place == 0.0 ? ratio : below / (b + c * a), z = u * u;
        double series = -1.0 / 15.0;
        for (int n = 13; n >= 3; n -= 2) series = series * z + ((n & 2) ? -1.0 : 1.0) / n;
        const Pair base = ARC_TANGENTS[static_cast<int>(place)];
        const Pair sum = two_sum(base.high, u);
        angle = two_sum(sum.high, sum.low + base.low + u * z * series);
    }
    if (is_steep) {
        const Pair rest = two_sum(HALF_PI.high, -angle.high);
        angle = {rest.high, rest.low + HALF_PI.low - angle.low};
    }
    if (is_behind) {
        const Pair rest = two_sum(2.0 * HALF_PI.high, -angle.high);
        angle = {rest.high, rest.low + 2.0 * HALF_PI.low - angle.low};
    }
    const double size = angle.high + angle.low;
    return is_negative(y) ? -size : size;
}

}  // namespace RW_VARIANT
