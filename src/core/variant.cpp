// Compiled once for each instruction set: -DRW_VARIANT=NAME, with the flags of that.
#include "variant.hpp"

#include "elementary.hpp"

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

extern const Variant functions;
constexpr Variant functions{&elementary};

}  // namespace RW_VARIANT
