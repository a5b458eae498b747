#include "assembly.hpp"

#include "collector.hpp"
#include "contacts.hpp"
#include "elements.hpp"

namespace RW_VARIANT {

// Call visit<E>(parameters, nodes) for every element E of a model.
template <int AXES, class Visit>
static void visit_elements(const Model& m, const State& s, Visit visit) {
    for (I64 r = 0; r < m.runs; r++) {
        Links p = links_of(m, r);
        const I64 first = s.run_first[r], last = first + s.run_links[r];
        const Kind kind = kind_of(m, r);
        for (I64 i = first; i < last; i++) {
            p.begins = i == first, p.ends = i + 1 == last;
            const I64 nodes[] = {p.begins ? i : i - 1, i, i + 1, p.ends ? i + 1 : i + 2};
            switch (kind) {
                case Kind::STRAIGHT: visit.template operator()<Straight<AXES>>(p.axial, nodes + 1); break;
                case Kind::CURVED: visit.template operator()<Curved<AXES>>(p, nodes); break;
                case Kind::PLAIN: visit.template operator()<Plain<AXES, false>>(p, nodes); break;
                case Kind::TAUT: visit.template operator()<Plain<AXES, true>>(p, nodes);
            }
        }
    }
    for (I64 k = 0; k < m.springs; k++) {
        const double stiffness = m.spring_stiffness[k];
        const Axial<double> p{stiffness, stiffness * m.spring_length[k], m.spring_damping[k],
                              floor_of(m.spring_tension_only[k])};
        const I64 nodes[] = {m.spring_begin[k], m.spring_end[k]};
        visit.template operator()<Straight<AXES>>(p, nodes);
    }
    for (I64 band = 0; band < m.bands; band++) {
        const Axial<double> p = springs_of(m, band);
        for (I64 k = 0; k < m.band_springs[band]; k++) {
            const I64 nodes[] = {m.band_begin[band] + k, m.band_end[band] + k};
            visit.template operator()<Straight<AXES>>(p, nodes);
        }
    }
    visit_others<AXES>(m, s, visit);
    visit_collectors<AXES>(m, s, [&](const Collector<AXES>& p, const I64* nodes, I64) {
        visit.template operator()<Collector<AXES>>(p, nodes);
    });
}

static void set_weights(const Model& m, double* forces) {
    for (I64 axis = 0; axis < m.axes; axis++)
        for (I64 i = 0; i < m.nodes; i++) forces[axis * m.nodes + i] = m.weight[axis * m.stride + i];
    for (I64 axis = 0; axis < m.axes; axis++) {
        for (I64 k = 0; k < m.springs; k++) {
            const double steady = m.spring_steady[axis * stride_of(m.springs) + k];
            forces[axis * m.nodes + m.spring_begin[k]] -= steady;
            forces[axis * m.nodes + m.spring_end[k]] += steady;
        }
    }
}

template <int AXES>
struct Assembly {
    const Model m;
    const State s;
    mutable Workspace w;
    const Context c;

    explicit Assembly(const Blocks& blocks) : m(blocks.model), s(blocks.state), w(blocks.work), c{s.time[0], 0.0} {}

    // Elements of links, springs and contacts; these are found first.
    void visit(auto call) const {
        visit_elements<AXES>(m, s, call);
        const Contacts<AXES> contacts{m, s, w};
        contacts.find();
        for (I64 k = 0; k < m.contacts; k++) {
            I64 nodes[Contacts<AXES>::NODES_OF];
            contacts.nodes_of(contacts.record(k), m.contact_body[k], nodes);
            call.template operator()<Touch<AXES>>(contacts.record(k), nodes);
        }
    }

    void evaluate(double* values) const {
        const Contacts<AXES> contacts{m, s, w};
        contacts.find();
        for (I64 k = 0; k < m.contacts; k++) {
            Record& r = contacts.record(k);
            double x[Touch<AXES>::UNKNOWNS];
            contacts.gather_at(r, k, s.position, x);
            Touch<AXES>::note(r, Touch<AXES>::template answer<double>(r, x), x);
            for (I64 axis = 0; axis < AXES; axis++) {
                values[axis * m.contacts + k] = r.force[axis];
                values[(AXES + axis) * m.contacts + k] = r.tip[axis];
            }
            values[(AXES + AXES) * m.contacts + k] = r.push;
        }
    }

    void forces(const double* velocities, double* forces) const {
        set_weights(m, forces);
        visit([&]<class E>(const auto& p, const I64* nodes) {
            double x[E::UNKNOWNS], v[E::UNKNOWNS], f[E::UNKNOWNS]{};
            gather<E, AXES>(s.position, m.stride, nodes, x);
            gather<E, AXES>(velocities, m.nodes, nodes, v);
            E::force(p, c, x, v, f);
            scatter<E, AXES>(f, m.nodes, nodes, forces);
        });
    }

    void energies(double* energies) const {
        energies[0] = energies[1] = 0.0;
        visit([&]<class E>(const auto& p, const I64* nodes) {
            double x[E::UNKNOWNS];
            gather<E, AXES>(s.position, m.stride, nodes, x);
            energies[0] += E::energy(p, c, x);
        });
        for (I64 axis = 0; axis < AXES; axis++)
            for (I64 i = axis * m.stride; i < axis * m.stride + m.nodes; i++)
                energies[1] -= m.weight[i] * s.position[i];
        for (I64 axis = 0; axis < AXES; axis++)
            for (I64 k = 0; k < m.springs; k++)
                energies[1] +=
                    m.spring_steady[axis * stride_of(m.springs) + k] *
                    (s.position[axis * m.stride + m.spring_begin[k]] - s.position[axis * m.stride + m.spring_end[k]]);
    }

    void at_sheaves(double* values) const {
        visit_sheaves<AXES>(m, s, [&]<class E>(I64 q, const Pieces& p, const I64* nodes) {
            double x[E::UNKNOWNS];
            gather<E, AXES>(s.position, m.stride, nodes, x);
            const AtSheave at = at_sheave<AXES>(p, m.sheave_friction[q], x);
            values[q] = at.before, values[m.sheaves + q] = at.behind;
            values[2 * m.sheaves + q] = at.angle, values[3 * m.sheaves + q] = at.most;
        });
    }

    I64 entries() const {
        I64 count = 0;
        visit([&]<class E>(const auto&, const I64*) { count += static_cast<I64>(E::UNKNOWNS) * E::UNKNOWNS; });
        return count;
    }

    void matrices(const double* velocities, double* forces, I64* rows, I64* columns, double* K, double* C) const {
        set_weights(m, forces);
        visit([&]<class E>(const auto& p, const I64* nodes) {
            constexpr int N = E::UNKNOWNS;
            double x[N], v[N], f[N];
            gather<E, AXES>(s.position, m.stride, nodes, x);
            gather<E, AXES>(velocities, m.nodes, nodes, v);
            linearise<E>(p, c, x, v, f, K, C);
            scatter<E, AXES>(f, m.nodes, nodes, forces);
            for (int i = 0; i < N; i++) {
                for (int j = 0; j < N; j++) {
                    rows[i * N + j] = i % AXES * m.nodes + nodes[i / AXES];
                    columns[i * N + j] = j % AXES * m.nodes + nodes[j / AXES];
                }
            }
            constexpr I64 SIZE = static_cast<I64>(N) * N;
            rows += SIZE, columns += SIZE, K += SIZE, C += SIZE;
        });
    }
};

// Call a function with the Assembly of as many axes as a model has.
template <class Call>
static auto with_assembly(const Blocks& blocks, Call call) {
    return blocks.model.header().counts[AXES] == 2 ? call(Assembly<2>(blocks)) : call(Assembly<3>(blocks));
}

void add_forces(const Blocks& blocks, const double* velocities, double* forces) {
    with_assembly(blocks, [&](const auto& all) { all.forces(velocities, forces); });
}

void sum_energies(const Blocks& blocks, double* energies) {
    with_assembly(blocks, [&](const auto& all) { all.energies(energies); });
}

void evaluate_sheaves(const Blocks& blocks, double* values) {
    with_assembly(blocks, [&](const auto& all) { all.at_sheaves(values); });
}

void evaluate_contacts(const Blocks& blocks, double* values) {
    with_assembly(blocks, [&](const auto& all) { all.evaluate(values); });
}

I64 count_entries(const Blocks& blocks) {
    return with_assembly(blocks, [](const auto& all) { return all.entries(); });
}

void linearise_all(const Blocks& blocks, const double* velocities, double* forces, I64* rows, I64* columns, double* K,
                   double* C) {
    with_assembly(blocks, [&](const auto& all) { all.matrices(velocities, forces, rows, columns, K, C); });
}

}  // namespace RW_VARIANT
