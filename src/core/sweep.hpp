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

template <int AXES, bool VISCOUS, bool CURVED>
struct Sweep {
    const Model& m;
    const State& s;
    Workspace& w;
    const Step& step;
    Links p;
    I64 part;
    I64 first, links;  // of the run
    bool is_pulled, is_uniform;

    Sweep(const Model& model, const State& state, Workspace& work, const Step& step_, I64 run, I64 part_)
        : m(model), s(state), w(work), step(step_), p(links_of(model, run)), part(part_) {
        first = s.run_first[run], links = s.run_links[run];
        is_pulled = w.run_pulled[run], is_uniform = w.run_uniform[run];
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
        }
    }
    void clear(Row which, I64 k) {
        for (int axis = 0; axis < AXES; axis++) row(which, axis)[k] = 0.0;
    }

    // Second differences of positions at nodes 1 ... count behind node a.
    void find_bends(I64 a, I64 count) {
        for (int axis = 0; axis < AXES; axis++) {
            const double* const x = positions(axis, a);
            double* const bend = row(BEND, axis);
            for (I64 k = 1; k <= count; k += WIDTH) {
                const Vector here = load<Vector>(x + k);
                store(bend + k, (load<Vector>(x + k + 1) - here) - (here - load<Vector>(x + k - 1)));
            }
        }
    }

    // Forces and moments of so many links behind node a.
    void find_forces(I64 a, I64 count) {
        for (I64 k = 0; k < count; k += WIDTH) {
            Vector c[AXES], rate[AXES], near[AXES], far[AXES], pull[AXES], against_near[AXES], against_far[AXES];
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
                Curved<AXES>::template resist<VISCOUS>(p, c, rate, near, far, pull, against_near, against_far);
            else
                Straight<AXES>::template resist<VISCOUS>(p.axial, c, rate, pull);
            for (int axis = 0; axis < AXES; axis++) {
                store(row(PULL, axis) + k, pull[axis]);
                if constexpr (CURVED) store(row(NEAR, axis) + k, against_near[axis]);
                if constexpr (CURVED) store(row(FAR, axis) + k, against_far[axis]);
            }
        }
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
        if constexpr (!CURVED) return pulled;
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
            if constexpr (CURVED) last += row(MOMENT, axis)[n - 1];
            w.force[axis * m.stride + first + links] -= last;
        }
    }

    template <class S>
    void move_node(const auto& inertia, I64 a, I64 k) {
        S forces[AXES];
        for (int axis = 0; axis < AXES; axis++) {
            forces[axis] = force<S>(axis, k);
            if (is_pulled) {
                double* const others = w.force.at(axis * m.stride + first + a + k, sizeof(S) / sizeof(double));
                forces[axis] += load<S>(others);
                store(others, S{});
            }
        }
        move<AXES, VISCOUS>(m, s, step, inertia, first + a + k, forces);
    }
    void move_nodes(I64 a, I64 begin, I64 end) {
        if (is_uniform)
            move_nodes(Uniform<AXES>(m, first + links / 2), a, begin, end);
        else
            move_nodes(Various{m}, a, begin, end);
    }
    void move_nodes(const auto& inertia, I64 a, I64 begin, I64 end) {
        I64 k = begin;
        for (; k + WIDTH <= end; k += WIDTH) move_node<Vector>(inertia, a, k);
        for (; k < end; k++) move_node<double>(inertia, a, k);
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
        }
    }
};

}  // namespace RW_VARIANT
