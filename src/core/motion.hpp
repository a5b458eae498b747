// The step loop: Verlet's method, with velocities that State keeps half a step behind the positions.
//
// In a step come springs, runs with their inner nodes, what joins nodes, and then all other nodes. How many steps a
// call takes makes no difference to any bit.
#pragma once

#include "band.hpp"
#include "collector.hpp"
#include "contacts.hpp"
#include "elements.hpp"
#include "sheaves.hpp"
#include "sweep.hpp"
#include "taut.hpp"
#include "team.hpp"

namespace RW_VARIANT {

enum Outcome : I64 { DONE, STOPPED, DIVERGED, ENDED };

template <int AXES, bool VISCOUS>
struct Motion {
    const Model& m;
    const State& s;
    Workspace& w;
    const Team team;
    char* const* bases;  // of the blocks
    bool ended = false;
    I64 now = 0;  // number of the step of this call

    // Springs and loads kick once in a step; runs and joints follow by the inner steps of the Model, if it has any.
    I64 advance(I64 steps, double dt, const volatile I32* stop, I64* done) {
        const I64 inner = m.inner_steps[0] > 1 ? m.inner_steps[0] : 1;
        const double part = inner > 1 ? dt / static_cast<double>(inner) : dt;
        for (*done = 0; *done < steps; ++*done) {
            if (team.leads()) w.halted[0] = *stop != 0 || ended;
            if (team.leads() && !w.halted[0]) record(*done), begin_step(dt, part, inner);
            for (I64 i = 0; i < inner; i++) {
                if (team.leads() && !w.halted[0]) pull_bands(0, m.nodes, m.parts);
                team.meet();
                if (w.halted[0]) return team.leads() && !is_finite() ? DIVERGED : (ended ? ENDED : STOPPED);
                // behind the meeting: the first thread has ended the step before
                const double kick = i == 0 ? s.lag[0] + 0.5 * part : part;
                const Step step{kick, part, 0.5 * part / kick};
                for (I64 k = team.thread; k < m.parts; k += team.threads) sweep_part(step, k);
                team.meet();
                if (team.leads()) move_rest(step);
            }
            if (team.leads()) end_step(dt, part, inner);
        }
        if (team.leads() && !is_finite()) return DIVERGED;
        return ended ? ENDED : (*done < steps ? STOPPED : DONE);
    }

  private:
    // What concerns several parts, before any node is moved.
    void begin_step(double dt, double part, I64 inner) {
        const double kick = s.lag[0] + 0.5 * part, slow_kick = inner > 1 ? s.slow_lag[0] + 0.5 * dt : kick;
        pull_springs();
        add_others();
        press_contacts(slow_kick);
        rub(slow_kick);
        press_collectors();
        if (VISCOUS && inner > 1)
            for (I64 i = 0; i < AXES * m.stride; i++) w.slow[i] = w.force[i];
        kick_few(slow_kick);
        if (inner > 1)
            for (I64 i = 0; i < AXES * m.stride; i++) w.force[i] *= slow_kick / kick;
    }

    void end_step(double dt, double part, I64 inner) {
        if (VISCOUS && inner > 1)
            for (I64 i = 0; i < AXES * m.stride; i++) s.predicted[i] += (0.5 * dt * m.mobility[i]) * w.slow[i];
        for (I64 k = 0; k < m.contacts; k++) s.contact_place[k] += dt * s.contact_speed[k];
        s.time[0] += dt;
        s.lag[0] = 0.5 * part, s.slow_lag[0] = 0.5 * dt;
        ended = m.sheaves && baseline::pass_nodes(bases) < 0;
    }

    // Runs of a part and the bands inside it.
    void sweep_part(const Step& step, I64 part) {
        const I64 last = part + 1 < m.parts ? m.part_run[part + 1] : m.runs;
        I64 band = 0;
        for (I64 run = m.part_run[part]; run < last; run++) {
            band = pull_bands(band, s.run_first[run] + s.run_links[run], part);
            if (VISCOUS && w.run_damped[run])
                move_run<VISCOUS>(step, run, part);
            else
                move_run<false>(step, run, part);
        }
        pull_bands(band, m.nodes, part);
    }

    // Nodes between and beyond runs.
    void move_rest(const Step& step) {
        join(w.force, true);
        move_others(step);
        join(s.position, false);
        join(s.velocity, false);
        if constexpr (VISCOUS) join(s.predicted, false);
    }

    // Record heights at the start of step i of a call. Forces of collectors follow within the step.
    void record(I64 i) {
        now = i;
        if (i >= m.counts[SAMPLES]) return;
        for (I64 k = 0; k < m.counts[WATCHED]; k++)
            w.recorded_height[k * stride_of(m.counts[SAMPLES]) + i] = s.position[(AXES - 1) * m.stride + m.watched[k]];
        for (I64 k = 0; k < m.collectors; k++) w.recorded_force[k * stride_of(m.counts[SAMPLES]) + i] = 0.0;
    }

    void press_collectors() {
        for (I64 k = 0; k < m.collectors; k++) w.collector_first[k] = m.collector_body[k];
        visit_collectors<AXES>(m, s, [&](const Collector<AXES>& p, const I64* nodes, I64 k) {
            double x[Collector<AXES>::UNKNOWNS], f[Collector<AXES>::UNKNOWNS]{};
            gather<Collector<AXES>, AXES>(s.position, m.stride, nodes, x);
            Collector<AXES>::force(p, Context{s.time[0], 0.0}, x, x, f);
            scatter<Collector<AXES>, AXES>(f, m.stride, nodes, w.force);
            w.collector_first[k] = nodes[0];
            const double push = -f[Collector<AXES>::UNKNOWNS - 1];
            if (now < m.counts[SAMPLES]) w.recorded_force[k * stride_of(m.counts[SAMPLES]) + now] = push;
        });
    }

    template <bool DAMPED>
    void move_run(const Step& step, I64 run, I64 part) {
        switch (kind_of(m, run)) {
            case Kind::STRAIGHT: Sweep<AXES, DAMPED, Kind::STRAIGHT>(m, s, w, step, run, part).run(); break;
            case Kind::CURVED: Sweep<AXES, DAMPED, Kind::CURVED>(m, s, w, step, run, part).run(); break;
            case Kind::PLAIN: Sweep<AXES, DAMPED, Kind::PLAIN>(m, s, w, step, run, part).run(); break;
            case Kind::TAUT: Taut<AXES, DAMPED>(m, s, w, step, run).run();
        }
    }

    // Forces on nodes of runs where others than links act on few of them: these are kicked alone, and the run is moved
    // as if nothing acted on it.
    void kick_few(double kick) {
        for (I64 i = 0; i < w.kicks[0]; i++) kick_node(kick, w.kicked[i]);
        for (I64 k = 0; k < m.collectors; k++) kick_shared(kick, m.collector_run[k], w.collector_first[k]);
    }
    void kick_shared(double kick, I64 run, I64 node) {
        const I64 first = s.run_first[run], last = first + s.run_links[run];
        for (I64 end = node + SHARED; !w.run_pulled[run] && node < end; node++)
            if (node > first && node < last) kick_node(kick, node);
    }
    void kick_node(double kick, I64 node) {
        for (I64 at = node; at < AXES * m.stride; at += m.stride) {
            s.velocity[at] += (kick * m.mobility[at]) * w.force[at];
            w.force[at] = 0.0;
        }
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
                pull[axis] -= load<Vector>(m.spring_steady.at(axis * stride_of(m.springs) + k, WIDTH));
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

    // Friction at sheaves stops the rope there, or bears what it can; its work is that of its mean velocity in the
    // kick.
    void rub(double kick) {
        visit_sheaves<AXES>(m, s, [&]<class E>(I64 q, const Pieces& p, const I64* nodes) {
            double x[E::UNKNOWNS];
            gather<E, AXES>(s.position, m.stride, nodes, x);
            const double most = at_sheave<AXES>(p, m.sheave_friction[q], x).most, mobility = m.mobility[nodes[3]];
            if (!(most > 0.0 && mobility > 0.0)) return;
            double& force = w.force[nodes[3]];
            const double v = s.velocity[nodes[3]], stop = -(v / (kick * mobility) + force);
            const double friction = stop > most ? most : (stop < -most ? -most : stop);
            force += friction;
            s.sheave_loss[q] -= friction * kick * (v + 0.5 * kick * mobility * force);
        });
    }

    // Find all contacts, and add their forces to those on nodes.
    void press_contacts(double kick) {
        using Element = Touch<AXES>;
        const Contacts<AXES> contacts{m, s, w};
        const bool shares = contacts.locate_all();
        if (shares)
            contacts.find_kinks(shares);
        else
            contacts.release(shares);
        for (I64 k = 0; k < m.contacts; k++) {
            Record& r = contacts.record(k);
            I64 nodes[Contacts<AXES>::NODES_OF];
            double x[Element::UNKNOWNS], v[Element::UNKNOWNS], f[Element::UNKNOWNS]{};
            contacts.nodes_of(r, m.contact_body[k], nodes);
            gather<Element, AXES>(s.position, m.stride, nodes, x);
            if constexpr (VISCOUS) gather<Element, AXES>(s.predicted, m.stride, nodes, v);
            const auto all = shares ? Element::template answer<double>(r, x) : Element::find(r, x);
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
        if (r.state != Touching::YES) return;
        const double change = before >= 0.0 ? r.K - s.contact_kink[k] : 0.0;
        s.contact_kink_bend[k] = change - s.contact_kink_change[k];
        s.contact_kink_change[k] = change;
        s.contact_kink[k] = r.K;
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
