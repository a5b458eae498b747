// Motion of a taut run over a step, in one pass: the force is a stencil of five nodes with constant numbers. Nodes are
// kicked block by block, and drift as soon as the nodes behind them have felt where they were.
#pragma once

#include "sweep.hpp"

namespace RW_VARIANT {

template <int AXES, bool VISCOUS>
class Taut {
    const Model& m;
    const State& s;
    Workspace& w;
    const Step& step;
    const bool is_pulled;
    const I64 row, first, links;  // row: of the axis that nodes move along
    const I64 typical;            // entry of a node that is like most
    const double tension, bending;
    const I64* odd;  // the next node with a mobility or weight of its own
    const I64* const odd_end;

  public:
    Taut(const Model& model, const State& state, Workspace& work, const Step& step_, I64 run)
        : m(model),
          s(state),
          w(work),
          step(step_),
          is_pulled(work.run_pulled[run]),
          row((AXES - 1) * model.stride),
          first(state.run_first[run]),
          links(state.run_links[run]),
          typical(row + typical_node(state, run)),
          tension(links_of(model, run).tension),
          bending(plain_moment(links_of(model, run))),
          odd(odd_of(work, run)),
          odd_end(work.odd.data + work.run_odd[run]) {}

    void run() {
        w.force[row + first] += tension * (z(1) - z(0)) - moment(1);
        w.force[row + first + links] -= tension * (z(links) - z(links - 1)) + moment(links - 1);
        I64 drifted = 1;
        for (I64 a = 1; a < links; a += BLOCK) {
            const I64 end = a + BLOCK < links ? a + BLOCK : links;
            kick_nodes(a, end);
            drift_nodes(drifted, end < links ? end - 2 : end);
            drifted = end - 2;
        }
    }

  private:
    double z(I64 i) const { return s.position[row + first + i]; }
    double moment(I64 i) const { return i > 0 && i < links ? bending * ((z(i + 1) - z(i)) - (z(i) - z(i - 1))) : 0.0; }

    // What the force and the kick are made of, in registers.
    struct Numbers {
        double beside, here, beyond, gain, weight;
    };

    // Forces on nodes i, i + 1 ...; the one next to an end, where moments are zero, comes alone.
    template <class S>
    S force(const Numbers& by, I64 i) const {
        const double* const at = s.position.at(row + first + i, 1);
        const S beside = load<S>(at - 1) + load<S>(at + 1), beyond = load<S>(at - 2) + load<S>(at + 2);
        return by.beside * beside - (by.here * load<S>(at) + by.beyond * beyond);
    }
    double force_near_end(I64 i) const {
        const double here = moment(i), others = (moment(i - 1) - here) + (moment(i + 1) - here);
        return tension * ((z(i + 1) - z(i)) - (z(i) - z(i - 1))) - others;
    }

    template <class S>
    void kick(const Numbers& by, I64 i, S force) {
        const I64 at = row + first + i, count = sizeof(S) / sizeof(double);
        if (is_pulled) force += others<S>(at, count);
        const S gain = by.gain * (force + by.weight);
        const S v = load<S>(s.velocity.at(at, count)) + gain;
        store(s.velocity.at(at, count), v);
        if constexpr (VISCOUS) store(s.predicted.at(at, count), v + step.lead * gain);
    }
    // What else acts on nodes; nothing moves them along other axes.
    template <class S>
    S others(I64 at, I64 count) {
        const S force = load<S>(w.force.at(at, count));
        for (int axis = 0; axis < AXES; axis++) store(w.force.at(at - axis * m.stride, count), S{});
        return force;
    }
    void kick_alone(Numbers by, I64 i, double force) {
        const I64 at = row + first + i;
        if (odd != odd_end && *odd == first + i) odd++, by.gain = step.kick * m.mobility[at], by.weight = m.weight[at];
        kick(by, i, force);
    }
    void kick_nodes(I64 i, I64 end) {
        const Numbers by{tension + 4.0 * bending, 2.0 * tension + 6.0 * bending, bending,
                         step.kick * m.mobility[typical], m.weight[typical]};
        if (i == 1) kick_alone(by, 1, force_near_end(1)), i++;
        const I64 inside = end == links && end > 2 ? end - 1 : end;
        while (i < inside) {
            const bool is_odd = odd != odd_end && *odd < first + inside;
            const I64 stop = is_odd ? *odd - first : inside;
            for (; i + WIDTH <= stop; i += WIDTH) kick(by, i, force<Vector>(by, i));
            for (; i < stop; i++) kick(by, i, force<double>(by, i));
            if (is_odd) kick_alone(by, i, force<double>(by, i)), i++;
        }
        if (i < end) kick_alone(by, i, force_near_end(i));
    }

    void drift_nodes(I64 i, I64 end) {
        const double drift = step.drift;
        double* const to = s.position.at(row + first, links + 1);
        const double* const v = s.velocity.at(row + first, links + 1);
        for (; i + WIDTH <= end; i += WIDTH) store(to + i, load<Vector>(to + i) + drift * load<Vector>(v + i));
        for (; i < end; i++) to[i] += drift * v[i];
    }
};

}  // namespace RW_VARIANT
