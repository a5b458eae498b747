// Functions of the core that exist once for each instruction set, as the interface calls them.
#pragma once

#include "types.hpp"

struct Variant {
    // Values (count,) of an elementary function by its number: exp, log, sin, cos, atan2, pow; the last two of x and y.
    void (*elementary)(I64 function, I64 count, const double* x, const double* y, double* values);
    // Take so many steps of dt, less if `stop` is set, as one of some threads; returns an Outcome and how many were
    // taken.
    I64 (*advance)(char* const* bases, I64 thread, I64 threads, I64 steps, double dt, const volatile I32* stop,
                   I64* done);
};
