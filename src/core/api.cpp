// The interface of the core in plain C. Names begin with rw_; nothing is called back.
#include "assembly.hpp"
#include "sheaves.hpp"
#include "variant.hpp"

#ifndef RW_LINKED
#define RW_LINKED 7  // a bit for each variant that is linked
#endif

namespace baseline {
extern const Variant functions;
}
#if defined(__x86_64__)
#include <cpuid.h>

namespace avx2 {
extern const Variant functions;
}
namespace avx512 {
extern const Variant functions;
}

static const Variant* const VARIANTS[] = {RW_LINKED & 1 ? &baseline::functions : nullptr,
                                          RW_LINKED & 2 ? &avx2::functions : nullptr,
                                          RW_LINKED & 4 ? &avx512::functions : nullptr};
constexpr I64 COUNT = 3;

// Whether the processor and the operating system have all of the features of a variant.
static bool has(I64 variant) {
    unsigned a, b, c, d;
    if (variant == 0) return true;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c >> 27 & 1)) return false;
    unsigned low, high;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return false;
    if (variant == 1) return (low & 6) == 6 && (b >> 5 & 1);
    return (low & 0xe6) == 0xe6 && (b >> 16 & 1) && (b >> 17 & 1) && (b >> 31 & 1);  // F, DQ and VL
}
#else
static bool has(I64) { return true; }
static const Variant* const VARIANTS[] = {&baseline::functions};
constexpr I64 COUNT = 1;
#endif

// Version of the interface: a library of another one is not used.
RW_EXPORT I64 rw_version() { return 3; }

// Whether a variant is linked and runs here: 0 baseline, 1 AVX2, 2 AVX-512.
RW_EXPORT I64 rw_has_variant(I64 variant) {
    return variant >= 0 && variant < COUNT && VARIANTS[variant] && has(variant);
}

// Values of an elementary function; 0, or -1 where there is no such variant here.
RW_EXPORT I64 rw_elementary(I64 variant, I64 function, I64 count, const double* x, const double* y, double* values) {
    if (!rw_has_variant(variant)) return -1;
    VARIANTS[variant]->elementary(function, count, x, y, values);
    return 0;
}

// The table of fields.def, a line for each dimension and field.
RW_EXPORT const char* rw_fields() { return baseline::TABLE; }

// Complete the counts of a structure (one for each dimension) and return the bytes of the block of a part and its seal;
// 0 bytes if the counts are none of a structure.
RW_EXPORT I64 rw_layout(I64 part, I64* counts, U64* seal) {
    *seal = baseline::seal_of(baseline::TABLE);
    return baseline::complete(counts) ? baseline::bytes_of(static_cast<baseline::Part>(part), counts) : 0;
}

static baseline::Blocks blocks_of(char* const* bases) { return {{bases[0]}, {bases[1]}, {bases[2]}}; }

// Check Model, State and Workspace (three addresses, three sizes); finding: fault, field and entry, faults as in Fault.
RW_EXPORT I64 rw_bind(char* const* bases, const I64* bytes, I64* finding) {
    const Finding found = baseline::bind(blocks_of(bases), bytes);
    finding[0] = static_cast<I64>(found.fault), finding[1] = found.field, finding[2] = found.entry;
    return finding[0];
}

// Functions below return -1 if blocks have not been bound, or there is no such variant here.

// Take steps of dt s as the only thread, or as one of as many as the structure has parts, which all call at once;
// returns 0, 1 if `stop` was set, 2 if positions are no numbers any more and 3 if a rope has come to its end at a
// sheave.
RW_EXPORT I64 rw_advance(I64 variant, char* const* bases, I64 thread, I64 threads, I64 steps, double dt,
                         const volatile I32* stop, I64* done) {
    if (!rw_has_variant(variant) || !baseline::are_bound(blocks_of(bases))) return -1;
    const I64 parts = blocks_of(bases).model.header().counts[baseline::PARTS];
    if ((threads != 1 && threads != parts) || thread < 0 || thread >= threads) return -1;
    return VARIANTS[variant]->advance(bases, thread, threads, steps, dt, stop, done);
}

RW_EXPORT I64 rw_forces(char* const* bases, const double* velocities, double* forces) {
    if (!baseline::are_bound(blocks_of(bases))) return -1;
    baseline::add_forces(blocks_of(bases), velocities, forces);
    return 0;
}

RW_EXPORT I64 rw_energies(char* const* bases, double* energies) {
    if (!baseline::are_bound(blocks_of(bases))) return -1;
    baseline::sum_energies(blocks_of(bases), energies);
    return 0;
}

// Of each sheave: tension before and behind it, angle, largest friction (4, sheave).
RW_EXPORT I64 rw_sheaves(char* const* bases, double* values) {
    if (!baseline::are_bound(blocks_of(bases))) return -1;
    baseline::evaluate_sheaves(blocks_of(bases), values);
    return 0;
}

// Let nodes that are close to a sheave pass it, as a step does; returns how many did.
RW_EXPORT I64 rw_pass(char* const* bases) {
    if (!baseline::are_bound(blocks_of(bases))) return -1;
    const I64 count = baseline::pass_nodes(bases);
    return count < 0 ? 0 : count;
}

// Of contacts, at the positions of the State: (row, contact) of force on the run (axis), point of the load (axis), and
// the change of all energy with the place.
RW_EXPORT I64 rw_contacts(char* const* bases, double* values) {
    if (!baseline::are_bound(blocks_of(bases))) return -1;
    baseline::evaluate_contacts(blocks_of(bases), values);
    return 0;
}

RW_EXPORT I64 rw_entries(char* const* bases) {
    return baseline::are_bound(blocks_of(bases)) ? baseline::count_entries(blocks_of(bases)) : -1;
}

RW_EXPORT I64 rw_linearise(char* const* bases, const double* velocities, double* forces, I64* rows, I64* columns,
                           double* K, double* C) {
    if (!baseline::are_bound(blocks_of(bases))) return -1;
    baseline::linearise_all(blocks_of(bases), velocities, forces, rows, columns, K, C);
    return 0;
}
