// The step loop: Verlet's method, with velocities that State keeps half a step behind the positions.
//
// In a step come springs, runs with their inner nodes, what joins nodes, and then all other nodes. How many steps a
// call takes makes no difference to any bit.
#pragma once

#include "band.hpp"
#include "contacts.hpp"
#include "elements.hpp"
#include "sweep.hpp"
#include "team.hpp"

namespace RW_VARIANT {

enum Outcome : I64 { DONE, STOPPED, DIVERGED };

template <int AXES, bool VISCOUS>
struct Motion {
    const Model& m;
    const State& s;
    Workspace& w;
    const Team team;

    I64 advance(I64 steps, double dt, const volatile I32* stop, I64* done) {
        for (*done = 0; *done < steps; ++*done) {
            if (team.leads()) w.halted[0] = *stop != 0;
            if (team.leads() && !w.halted[0]) begin_step(dt);
            team.meet();
            if (w.halted[0]) return STOPPED;
            for (I64 part = team.thread; part < m.parts; part += team.threads) sweep_part(dt, part);
            team.meet();
            if (team.leads()) end_step(dt);
        }
        return !team.leads() || is_finite() ? DONE : DIVERGED;
    }

  private:
    // What concerns several parts, before any node is moved.
    void begin_step(double dt) {
        pull_springs();
        add_others();
        load_ends();
        press_contacts(s.lag[0] + 0.5 * dt);
        pull_bands(0, m.nodes, m.parts);
    }

    // Runs of a part and the bands inside it.
    void sweep_part(double dt, I64 part) {
        const double kick = s.lag[0] + 0.5 * dt;
        const Step step{kick, dt, 0.5 * dt / kick};
        const I64 last = part + 1 < m.parts ? m.part_run[part + 1] : m.runs;
        I64 band = 0;
        for (I64 run = m.part_run[part]; run < last; run++) {
            band = pull_bands(band, s.run_first[run] + s.run_links[run], part);
            if (m.run_curved[run])
                Sweep<AXES, VISCOUS, true>(m, s, w, step, run, part).run();
            else
                Sweep<AXES, VISCOUS, false>(m, s, w, step, run, part).run();
        }
        pull_bands(band, m.nodes, part);
    }

    // Nodes between and beyond runs.
    void end_step(double dt) {
        const double kick = s.lag[0] + 0.5 * dt;
        join(w.force, true);
        move_others(Step{kick, dt, 0.5 * dt / kick});
        join(s.position, false);
        join(s.velocity, false);
        if constexpr (VISCOUS) join(s.predicted, false);
        for (I64 k = 0; k < m.contacts; k++) s.contact_place[k] += dt * s.contact_speed[k];
        s.time[0] += dt;
        s.lag[0] = 0.5 * dt;
    }

    // Bands of a part, from this one on, that begin at a node or before it. Returns the next one.
    I64 pull_bands(I64 band, I64 node, I64 part) {
        for (; band < m.bands && (m.band_begin[band] <= node || m.band_end[band] <= node); band++)
            if (w.band_part[band] == part) pull_band<AXES, VISCOUS>(m, s, w, band);
        return band;
    }

    void pull_springs() {
        for (I64 k = 0; k < m.springs; k += WIDTH) {
            const I64 count = m.springs - k < WIDTH ? m.springs - k : WIDTH;
            Axial<Vector> p{load<Vector>(m.spring_stiffness.at(k, WIDTH)), load<Vector>(m.spring_length.at(k, WIDTH)),
                            load<Vector>(m.spring_damping.at(k, WIDTH)), Vector{}};
            p.preload = p.stiffness * p.preload;
            Vector c[AXES]{}, rate[AXES]{}, pull[AXES];
            for (int axis = 0; axis < AXES; axis++) {
                c[axis] = differences(s.position, axis, k, count);
                if constexpr (VISCOUS) rate[axis] = differences(s.predicted, axis, k, count);
            }
            for (I64 j = 0; j < count; j++) p.floor[j] = floor_of(m.spring_tension_only[k + j]);
            Straight<AXES>::template resist<VISCOUS>(p, c, rate, pull);
            for (int axis = 0; axis < AXES; axis++) {
                for (I64 j = 0; j < count; j++) {
                    w.force[axis * m.stride + m.spring_begin[k + j]] += pull[axis][j];
                    w.force[axis * m.stride + m.spring_end[k + j]] -= pull[axis][j];
                }
            }
        }
    }
    // From the first to the second nodes of springs k, k + 1 ...; 1 where there are no more.
    Vector differences(const View<double>& of, int axis, I64 k, I64 count) const {
        Vector values = Vector{} + 1.0;
        const I64 row = axis * m.stride;
        for (I64 j = 0; j < count; j++) values[j] = of[row + m.spring_end[k + j]] - of[row + m.spring_begin[k + j]];
        return values;
    }

    // Forces of elements without a loop of their own.
    void add_others() {
        visit_others<AXES>(m, s, [&]<class E>(const auto& p, const I64* nodes) {
            double x[E::UNKNOWNS], v[E::UNKNOWNS]{}, f[E::UNKNOWNS]{};
            gather<E, AXES>(s.position, m.stride, nodes, x);
            if constexpr (VISCOUS) gather<E, AXES>(s.predicted, m.stride, nodes, v);
            E::force(p, Context{s.time[0], 0.0}, x, v, f);
            scatter<E, AXES>(f, m.stride, nodes, w.force);
        });
    }

    // What nodes next to ends of runs weigh more than the others there.
    void load_ends() {
        for (I64 run = 0; run < m.runs; run++) {
            if (!w.run_loaded[run]) continue;
            visit_near_ends(s, run, [&](I64 i, I64 middle) {
                for (I64 row = 0; row < AXES * m.stride; row += m.stride)
                    w.force[row + i] += m.weight[row + i] - m.weight[row + middle];
            });
        }
    }

    // Find all contacts, and add their forces to those on nodes.
    void press_contacts(double kick) {
        using Element = Touch<AXES>;
        const Contacts<AXES> contacts{m, s, w};
        contacts.find();
        for (I64 k = 0; k < m.contacts; k++) {
            Record& r = contacts.record(k);
            I64 nodes[Contacts<AXES>::NODES_OF];
            double x[Element::UNKNOWNS], v[Element::UNKNOWNS], f[Element::UNKNOWNS]{};
            contacts.nodes_of(r, m.contact_body[k], nodes);
            gather<Element, AXES>(s.position, m.stride, nodes, x);
            if constexpr (VISCOUS) gather<Element, AXES>(s.predicted, m.stride, nodes, v);
            const auto all = Element::template answer<double>(r, x);
            Element::template apply<VISCOUS, double>(r, all, x, v, f);
            scatter<Element, AXES>(f, m.stride, nodes, w.force);
            Element::note(r, all, x);
            sum_work(r, k, kick);
        }
    }

    // Work of what moves a contact along, and of what makes its kink softer meanwhile.
    void sum_work(const Record& r, I64 k, double kick) {
        s.contact_work[k] += kick * r.push * r.speed;
        const double before = s.contact_bent[k];
        if (r.state == Touching::YES && before >= 0.0)
            s.contact_work[k] += 0.25 * (r.softer + s.contact_softer[k]) * (r.square - before);
        s.contact_bent[k] = r.state == Touching::YES ? r.square : -1.0;
        s.contact_softer[k] = r.softer;
        if (r.state == Touching::YES) s.contact_kink[k] = r.K;
    }

    // Add values of copies to those of the original nodes and clear them, or give copies the values of the originals.
    void join(const View<double>& values, bool adds) {
        for (I64 j = 0; j < m.joints; j++) {
            for (int axis = 0; axis < AXES; axis++) {
                double& copy = values[axis * m.stride + m.joint_copy[j]];
                double& original = values[axis * m.stride + m.joint_original[j]];
                if (adds) original += copy;
                copy = adds ? 0.0 : original;
            }
        }
    }

    // Nodes that are not inside a run: between the last node of each run and the first one of the next.
    void move_others(const Step& step) {
        I64 begin = 0;
        for (I64 run = 0; run < m.runs; run++) {
            move_nodes(step, begin, s.run_first[run] + 1);
            begin = s.run_first[run] + s.run_links[run];
        }
        move_nodes(step, begin, m.nodes);
    }
    void move_nodes(const Step& step, I64 begin, I64 end) {
        I64 i = begin;
        for (; i + WIDTH <= end; i += WIDTH) move_loaded<AXES, VISCOUS, Vector>(m, s, w, step, i);
        for (; i < end; i++) move_loaded<AXES, VISCOUS, double>(m, s, w, step, i);
    }

    bool is_finite() const {
        double sum = 0.0;
        for (int axis = 0; axis < AXES; axis++)
            for (I64 i = 0; i < m.nodes; i++) sum += s.position[axis * m.stride + i] * 0.0;
        return sum == 0.0;
    }
};

}  // namespace RW_VARIANT
