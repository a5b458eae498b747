// Bands: equal springs from the nodes of one row to those of another, such as links across a net between two threads.
// Nodes follow each other on both sides, so that nothing is gathered. A band is evaluated shortly before the run of its
// first node is moved, while both rows are in the cache.
#pragma once

#include "link.hpp"

namespace RW_VARIANT {

// Add the forces of springs between nodes a and b, a + 1 and b + 1 ...
template <int AXES, bool VISCOUS, class S>
inline void pull_nodes(const Model& m, const State& s, Workspace& w, const Axial<double>& p, I64 a, I64 b) {
    constexpr I64 COUNT = sizeof(S) / sizeof(double);
    S c[AXES], rate[AXES]{}, first[AXES];
    const auto difference = [&](const View<double>& of, I64 row) {
        return load<S>(of.at(row + b, COUNT)) - load<S>(of.at(row + a, COUNT));
    };
    for (int axis = 0; axis < AXES; axis++) {
        c[axis] = difference(s.position, axis * m.stride);
        if constexpr (VISCOUS) rate[axis] = difference(s.predicted, axis * m.stride);
    }
    Straight<AXES>::template resist<VISCOUS>(p, c, rate, first);
    for (int axis = 0; axis < AXES; axis++) {
        double *const at_a = w.force.at(axis * m.stride + a, COUNT), *const at_b =
                                                                         w.force.at(axis * m.stride + b, COUNT);
        store(at_a, load<S>(at_a) + first[axis]);
        store(at_b, load<S>(at_b) - first[axis]);
    }
}

// Add the forces of a band. Its sides are apart, so that the order of the sums is that of single springs.
template <int AXES, bool VISCOUS>
inline void pull_band(const Model& m, const State& s, Workspace& w, I64 band) {
    const Axial<double> p = springs_of(m, band);
    const I64 a = m.band_begin[band], b = m.band_end[band], springs = m.band_springs[band];
    I64 k = 0;
    for (; k + WIDTH <= springs; k += WIDTH) pull_nodes<AXES, VISCOUS, Vector>(m, s, w, p, a + k, b + k);
    for (; k < springs; k++) pull_nodes<AXES, VISCOUS, double>(m, s, w, p, a + k, b + k);
}

}  // namespace RW_VARIANT
