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

// Force f, stiffness K = -df/dx and damping C = -df/dv (unknown, unknown) of an element.
template <class E, class Parameters>
void linearise(const Parameters& p, const Context& c, const double* x, const double* v, double* f, double* K,
               double* C) {
    constexpr int N = E::UNKNOWNS;
    Dual<2 * N> at[N], rate[N], force[N];
    for (int i = 0; i < N; i++) {
        at[i] = Dual<2 * N>(x[i], i);
        rate[i] = Dual<2 * N>(v[i], N + i);
        force[i] = 0.0;
    }
    E::force(p, c, at, rate, force);
    for (int i = 0; i < N; i++) {
        f[i] = force[i].value;
        for (int j = 0; j < N; j++) {
            K[i * N + j] = -force[i].slope[j];
            C[i * N + j] = -force[i].slope[N + j];
        }
    }
}

}  // namespace RW_VARIANT
