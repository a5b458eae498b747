// Forces on the nodes of a run and their motion over a step, in one pass over blocks of nodes: positions, velocities
// and forces go through memory once.
//
// Links are evaluated when the block of their first node comes. Nodes behind a block have been moved then, so what the
// block needs of them is carried: second difference, force and moment of the last link. Nodes at the ends of a run are
// not moved here: forces on them are added to Workspace::force.
#pragma once

#include "link.hpp"

namespace RW_VARIANT {

// A step of Verlet's method. Velocities are kicked from `lag` before the positions to half a step behind them.
struct Step {
    double kick, drift;
    double lead;  // of predicted velocities: what is left to the new positions, over the kick
};

// Inverse masses and weights of nodes: of each its own, or of all inner nodes of a run the same.
struct Various {
    const Model& m;
    template <class S>
    S mobility(int, I64 at) const {
        return load<S>(m.mobility.at(at, sizeof(S) / sizeof(double)));
    }
    template <class S>
    S weight(int, I64 at) const {
        return load<S>(m.weight.at(at, sizeof(S) / sizeof(double)));
    }
};
template <int AXES>
struct Uniform {
    double mobilities[AXES], weights[AXES];
    Uniform(const Model& m, I64 node) {
        for (int axis = 0; axis < AXES; axis++) {
            mobilities[axis] = m.mobility[axis * m.stride + node];
            weights[axis] = m.weight[axis * m.stride + node];
        }
    }
    template <class S>
    S mobility(int axis, I64) const {
        return S{} + mobilities[axis];
    }
    template <class S>
    S weight(int axis, I64) const {
        return S{} + weights[axis];
    }
};

// Kick and drift nodes i, i + 1 ... under forces that act besides weights.
template <int AXES, bool VISCOUS, class S>
inline void move(const Model& m, const State& s, const Step& step, const auto& inertia, I64 i, const S* force) {
    constexpr I64 COUNT = sizeof(S) / sizeof(double);
    for (int axis = 0; axis < AXES; axis++) {
        const I64 at = axis * m.stride + i;
        const S mobility = inertia.template mobility<S>(axis, at), weight = inertia.template weight<S>(axis, at);
        const S gain = (step.kick * mobility) * (force[axis] + weight);
        const S v = load<S>(s.velocity.at(at, COUNT)) + gain;
        store(s.velocity.at(at, COUNT), v);
        store(s.position.at(at, COUNT), load<S>(s.position.at(at, COUNT)) + step.drift * v);
        if constexpr (VISCOUS) store(s.predicted.at(at, COUNT), v + step.lead * gain);
    }
}

// The same with the forces of Workspace::force, which are cleared.
template <int AXES, bool VISCOUS, class S>
inline void move_loaded(const Model& m, const State& s, Workspace& w, const Step& step, I64 i) {
    constexpr I64 COUNT = sizeof(S) / sizeof(double);
    S force[AXES];
    for (int axis = 0; axis < AXES; axis++) {
        double* const from = w.force.at(axis * m.stride + i, COUNT);
        force[axis] = load<S>(from);
        store(from, S{});
    }
    move<AXES, VISCOUS>(m, s, step, Various{m}, i, force);
}

// The nodes of a run that differ from the others.
inline const I64* odd_of(const Workspace& w, I64 run) { return w.odd.data + (run > 0 ? w.run_odd[run - 1] : 0); }

template <int AXES, bool VISCOUS, Kind KIND>
struct Sweep {
    static constexpr bool CURVED = KIND == Kind::CURVED, PLAIN = KIND == Kind::PLAIN;

    const Model& m;
    const State& s;
    Workspace& w;
    const Step& step;
    Links p;
    I64 part, number;
    I64 first, links;  // of the run
    bool is_pulled;
    const I64* odd;  // the next of its nodes with a mobility or weight of their own
    const I64* odd_end;
    Uniform<AXES> others;  // of the others

    Sweep(const Model& model, const State& state, Workspace& work, const Step& step_, I64 run, I64 part_)
        : m(model),
          s(state),
          w(work),
          step(step_),
          p(links_of(model, run)),
          part(part_),
          number(run),
          others(model, typical_node(state, run)) {
        first = s.run_first[run], links = s.run_links[run];
        is_pulled = w.run_pulled[run];
        odd = odd_of(w, run), odd_end = w.odd.data + w.run_odd[run];
    }

    void run() {
        for (I64 a = 0; a < links; a += BLOCK) {
            const I64 rest = links - a;
            block(a, rest < BLOCK ? rest : BLOCK);
        }
    }

  private:
    enum Row { BEND, PULL, NEAR, FAR, MOMENT };  // of the scratch space, for each axis: numbers of nodes and links

    double* row(Row which, int axis) const {
        return w.scratch.at(part * stride_of(SCRATCH_SIZE) + (which * AXES + axis) * SCRATCH_ROW, SCRATCH_ROW) + MARGIN;
    }
    const double* positions(int axis, I64 a) const { return s.position.at(axis * m.stride + first + a, 1); }

    // Nodes a, a + 1 ... a + n - 1 of the run.
    void block(I64 a, I64 n) {
        const I64 rest = links - a;  // number of the last node from here
        const bool ends = n == rest;
        if (a == 0) begin();
        if constexpr (CURVED) {
            find_bends(a, n + 1);
            if (rest <= n + 1) clear(BEND, rest);
            find_forces(a, ends ? n : n + 1);
            find_moments(n + 1);
            if (a == 0) clear(MOMENT, 0);
            if (ends) clear(MOMENT, n);
        } else {
            if constexpr (PLAIN) find_moments(a, n, rest);
            find_forces(a, n);
        }
        if (a == 0) add_to_first_node();
        move_nodes(a, a == 0, n);
        if (ends) add_to_last_node(n);
        carry(n);
    }

    // Nothing is before the first link.
    void begin() {
        for (int axis = 0; axis < AXES; axis++) {
            row(PULL, axis)[-1] = 0.0;
            if constexpr (CURVED) row(BEND, axis)[0] = row(FAR, axis)[-1] = row(MOMENT, axis)[-1] = 0.0;
            if constexpr (PLAIN) row(MOMENT, axis)[-1] = row(MOMENT, axis)[0] = 0.0;
        }
    }
    void clear(Row which, I64 k) {
        for (int axis = 0; axis < AXES; axis++) row(which, axis)[k] = 0.0;
    }

    // Second differences of positions at nodes k, k + 1 ... behind node a.
    Vector bend_at(int axis, I64 a, I64 k) const {
        const double* const x = positions(axis, a) + k;
        const Vector here = load<Vector>(x);
        return (load<Vector>(x + 1) - here) - (here - load<Vector>(x - 1));
    }
    // The same at nodes 1 ... count.
    void find_bends(I64 a, I64 count) {
        for (int axis = 0; axis < AXES; axis++)
            for (I64 k = 1; k <= count; k += WIDTH) store(row(BEND, axis) + k, bend_at(axis, a, k));
    }
    // Plain moments at nodes 1 ... n of a block, after which so many links follow its first node.
    void find_moments(I64 a, I64 n, I64 rest) {
        const double stiffness = plain_moment(p);
        for (int axis = 1; axis < AXES; axis++)
            for (I64 k = 1; k <= n; k += WIDTH) store(row(MOMENT, axis) + k, stiffness * bend_at(axis, a, k));
        if (rest == n) clear(MOMENT, n);
    }

    // Forces and moments of so many links behind node a: with the series for small strains if all are small. Both ways
    // give the same bits; the one that served last is tried first.
    void find_forces(I64 a, I64 count) {
        const Links links = p;  // in registers
        Vector largest{};
        I64 k = 0;
        if (!w.run_stretched[number]) {
            for (; k + WIDTH <= count; k += WIDTH) largest = larger(largest, find_forces_at<true>(links, a, k));
            if (are_small(largest)) return find_last_forces(links, a, k, count);
        }
        for (k = 0; k + WIDTH <= count; k += WIDTH) largest = larger(largest, find_forces_at<false>(links, a, k));
        w.run_stretched[number] = !are_small(largest);
        find_last_forces(links, a, k, count);
    }
    static bool are_small(const Vector& strains) {
        for (I64 i = 0; i < WIDTH; i++)
            if (!(strains[i] < SMALL)) return false;
        return true;
    }
    // Those that do not fill a vector.
    void find_last_forces(const Links& links, I64 a, I64 k, I64 count) {
        for (; k < count; k += WIDTH) find_forces_at<false>(links, a, k);
    }
    // Of links k, k + 1 ... of the block; returns by how much their squared lengths are off 1.
    template <bool SURE>
    Vector find_forces_at(const Links& p, I64 a, I64 k) {
        Vector c[AXES], rate[AXES]{}, near[AXES], far[AXES], pull[AXES], against_near[AXES], against_far[AXES], square;
        for (int axis = 0; axis < AXES; axis++) {
            const double* const x = positions(axis, a) + k;
            c[axis] = load<Vector>(x + 1) - load<Vector>(x);
            if constexpr (VISCOUS) {
                const double* const v = s.predicted.at(axis * m.stride + first + a + k, WIDTH + 1);
                rate[axis] = load<Vector>(v + 1) - load<Vector>(v);
            }
            if constexpr (CURVED) {
                near[axis] = load<Vector>(row(BEND, axis) + k);
                far[axis] = load<Vector>(row(BEND, axis) + k + 1);
            }
        }
        if constexpr (CURVED)
            square =
                Curved<AXES>::template resist<VISCOUS, SURE>(p, c, rate, near, far, pull, against_near, against_far);
        else
            square = Straight<AXES>::template resist<VISCOUS, SURE>(p.axial, c, rate, pull);
        for (int axis = 0; axis < AXES; axis++) {
            store(row(PULL, axis) + k, pull[axis]);
            if constexpr (CURVED) store(row(NEAR, axis) + k, against_near[axis]);
            if constexpr (CURVED) store(row(FAR, axis) + k, against_far[axis]);
        }
        const Vector off = square * p.axial.scale - 1.0;
        return larger(off, -off);
    }

    // Of each node what acts against its second difference: parts of both of its links.
    void find_moments(I64 count) {
        for (int axis = 0; axis < AXES; axis++) {
            const double *const near = row(NEAR, axis), *const far = row(FAR, axis);
            double* const moment = row(MOMENT, axis);
            for (I64 k = 0; k < count; k += WIDTH)
                store(moment + k, load<Vector>(near + k) + load<Vector>(far + k - 1));
        }
    }

    // Force of the links on nodes k, k + 1 ... of the block.
    template <class S>
    S force(int axis, I64 k) const {
        const double* const t = row(PULL, axis) + k;
        const S pulled = load<S>(t) - load<S>(t - 1);
        if (!CURVED && !(PLAIN && axis > 0)) return pulled;
        const double* const moment = row(MOMENT, axis) + k;
        const S here = load<S>(moment);
        return pulled - ((load<S>(moment - 1) - here) + (load<S>(moment + 1) - here));
    }

    void add_to_first_node() {
        for (int axis = 0; axis < AXES; axis++) w.force[axis * m.stride + first] += force<double>(axis, 0);
    }
    void add_to_last_node(I64 n) {
        for (int axis = 0; axis < AXES; axis++) {
            double last = row(PULL, axis)[n - 1];
            if (CURVED || (PLAIN && axis > 0)) last += row(MOMENT, axis)[n - 1];
            w.force[axis * m.stride + first + links] -= last;
        }
    }

    template <class S>
    void move_node(const auto& inert, const Step& by, I64 a, I64 k) {
        S forces[AXES];
        for (int axis = 0; axis < AXES; axis++) {
            forces[axis] = force<S>(axis, k);
            if (is_pulled) {
                double* const others = w.force.at(axis * m.stride + first + a + k, sizeof(S) / sizeof(double));
                forces[axis] += load<S>(others);
                store(others, S{});
            }
        }
        move<AXES, VISCOUS>(m, s, by, inert, first + a + k, forces);
    }
    void move_nodes(I64 a, I64 k, I64 end) {
        const Uniform<AXES> inertia = others;  // in registers
        const Step by = step;
        while (k < end) {
            const bool is_odd = odd != odd_end && *odd < first + a + end;
            const I64 stop = is_odd ? *odd - first - a : end;
            for (; k + WIDTH <= stop; k += WIDTH) move_node<Vector>(inertia, by, a, k);
            for (; k < stop; k++) move_node<double>(inertia, by, a, k);
            if (is_odd) odd++, move_node<double>(Various{m}, by, a, k++);
        }
    }

    // What the next block needs of this one.
    void carry(I64 n) {
        for (int axis = 0; axis < AXES; axis++) {
            row(PULL, axis)[-1] = row(PULL, axis)[n - 1];
            if constexpr (CURVED) {
                row(BEND, axis)[0] = row(BEND, axis)[n];
                row(FAR, axis)[-1] = row(FAR, axis)[n - 1];
                row(MOMENT, axis)[-1] = row(MOMENT, axis)[n - 1];
            }
            if constexpr (PLAIN)
                row(MOMENT, axis)[-1] = row(MOMENT, axis)[n - 1], row(MOMENT, axis)[0] = row(MOMENT, axis)[n];
        }
    }
};

}  // namespace RW_VARIANT
