// Functions of the core that exist once for each instruction set, as the interface calls them.
#pragma once

#include "types.hpp"

struct Variant {
    // Values (count,) of an elementary function by its number: exp, log, sin, cos, atan2, pow; the last two of x and y.
    void (*elementary)(I64 function, I64 count, const double* x, const double* y, double* values);
};
