// The contract of elements. An element E has
//
//   E::UNKNOWNS                    number of its unknowns
//   E::force(p, c, x, v, f)        f += force on its unknowns at x, v; over any scalar type
//   E::energy(p, c, x)             optional: its gradient is -force(v = 0); over any scalar type
//
// where p are its parameters. Forces in a step, stiffness and damping matrices come from `force` alone.
#pragma once

#include "dual.hpp"

namespace RW_VARIANT {

struct Context {
    double time, step;
};

// Force f, stiffness K = -df/dx and damping C = -df/dv (unknown, unknown) of an element. Derivatives with respect to
// some unknowns at a time, so that dual numbers of large elements stay small.
template <class E, class Parameters>
void linearise(const Parameters& p, const Context& c, const double* x, const double* v, double* f, double* K,
               double* C) {
    constexpr int N = E::UNKNOWNS, SOME = 2 * N < 24 ? 2 * N : 24;
    for (int begin = 0; begin < 2 * N; begin += SOME) {
        Dual<SOME> at[N], rate[N], force[N];
        for (int i = 0; i < N; i++) at[i] = x[i], rate[i] = v[i], force[i] = 0.0;
        for (int j = 0; j < SOME && begin + j < 2 * N; j++)
            (begin + j < N ? at[begin + j] : rate[begin + j - N]).slope[j] = 1.0;
        E::force(p, c, at, rate, force);
        for (int i = 0; i < N; i++) {
            f[i] = force[i].value;
            for (int j = begin; j < begin + SOME && j < 2 * N; j++)
                (j < N ? K[i * N + j] : C[i * N + j - N]) = -force[i].slope[j - begin];
        }
    }
}

}  // namespace RW_VARIANT
