// Compiled once for each instruction set: -DRW_VARIANT=NAME, with the flags of that.
#include "variant.hpp"

#include "elementary.hpp"
#include "motion.hpp"

namespace RW_VARIANT {

static void elementary(I64 function, I64 count, const double* x, const double* y, double* values) {
    for (I64 i = 0; i < count; i++) {
        switch (function) {
            case 0: values[i] = exp(x[i]); break;
            case 1: values[i] = log(x[i]); break;
            case 2: values[i] = sin(x[i]); break;
            case 3: values[i] = cos(x[i]); break;
            case 4: values[i] = atan2(x[i], y[i]); break;
            case 5: values[i] = pow(x[i], y[i]); break;
            default: values[i] = NOT_A_NUMBER;
        }
    }
}

static I64 advance(char* const* bases, I64 thread, I64 threads, I64 steps, double dt, const volatile I32* stop,
                   I64* done) {
    const Model m(Arena{bases[0]});
    const State s(Arena{bases[1]});
    Workspace w(Arena{bases[2]});
    const Team team{thread, threads, w};
    if (m.axes == 2 && m.viscous) return Motion<2, true>{m, s, w, team, bases}.advance(steps, dt, stop, done);
    if (m.axes == 2) return Motion<2, false>{m, s, w, team, bases}.advance(steps, dt, stop, done);
    if (m.viscous) return Motion<3, true>{m, s, w, team, bases}.advance(steps, dt, stop, done);
    return Motion<3, false>{m, s, w, team, bases}.advance(steps, dt, stop, done);
}

extern const Variant functions;
constexpr Variant functions{&elementary, &advance};

}  // namespace RW_VARIANT
