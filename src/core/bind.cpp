#include "bind.hpp"

#include "elementary.hpp"
#include "elements.hpp"
#include "stencil.hpp"

namespace RW_VARIANT {

constexpr U64 SEAL = seal_of(TABLE);
constexpr I64 LARGEST = 1ll << 31;
constexpr I64 FEW = 8;  // links or more for each pulled node of a run: these are few

bool complete(I64* counts) {
    counts[ONE] = 1, counts[SCRATCH] = SCRATCH_SIZE, counts[RECORD] = RECORD_SIZE;
    for (int i = 0; i < DIMENSIONS; i++)
        if (counts[i] < 0 || counts[i] > LARGEST) return false;
    if (counts[PARTS] == 0) counts[PARTS] = 1;
    const bool is_viscous = counts[VISCOUS] == counts[NODES];
    return (counts[AXES] == 2 || counts[AXES] == 3) && counts[NODES] > 0 && (is_viscous || counts[VISCOUS] == 0);
}

I64 bytes_of(Part part, const I64* counts) {
    I64 bytes = HEADER;
    for (const Field& field : FIELDS)
        if (field.part == part) bytes += 8 * size_of(field, counts);
    return bytes;
}

static bool is_block(Arena arena, Part part, I64 bytes) {
    if (!arena.base || reinterpret_cast<Size>(arena.base) % LINE || bytes < HEADER) return false;
    Header& header = arena.header();
    I64 counts[DIMENSIONS];
    for (int i = 0; i < DIMENSIONS; i++) counts[i] = header.counts[i];
    if (header.seal != SEAL || header.part != part || header.bytes != bytes || !complete(counts)) return false;
    for (int i = 0; i < DIMENSIONS; i++)
        if (counts[i] != header.counts[i]) return false;
    return bytes_of(part, counts) == bytes;
}

static bool admits(Values values, double x) {
    if (is_nan(x) || absolute(x) == INFINITE) return false;
    return values == Values::FINITE || (values == Values::NOT_NEGATIVE ? x >= 0.0 : x > 0.0);
}
static Fault fault_of(const Field& field, const char* at, const I64* counts) {
    if (!field.is_index) {
        return admits(field.values, *reinterpret_cast<const double*>(at)) ? Fault::NONE : Fault::VALUE;
    }
    const I64 x = *reinterpret_cast<const I64*>(at);
    if (field.values == Values::NODE) return x >= 0 && x < counts[NODES] ? Fault::NONE : Fault::INDEX;
    if (field.values == Values::OPTION) return x >= -1 && x < counts[NODES] ? Fault::NONE : Fault::INDEX;
    if (field.values == Values::RUN) return x >= 0 && x < counts[RUNS] ? Fault::NONE : Fault::INDEX;
    const I64 most = field.values == Values::FLAG ? 1 : field.values == Values::FEW ? 1000 : LARGEST;
    return x >= 0 && x <= most ? Fault::NONE : Fault::VALUE;
}

// The first entry of a block that its field does not admit.
static Finding check_values(Arena arena) {
    const Header& header = arena.header();
    const char* at = arena.base + HEADER;
    for (I64 number = 0; number < FIELD_COUNT; number++) {
        const Field& field = FIELDS[number];
        if (field.part != header.part) continue;
        const I64 columns = header.counts[field.columns], stride = stride_of(columns);
        for (I64 row = 0; row < header.counts[field.rows]; row++, at += 8 * stride)
            for (I64 i = 0; i < columns; i++)
                if (const Fault fault = fault_of(field, at + 8 * i, header.counts); fault != Fault::NONE)
                    return {fault, number, row * columns + i};
    }
    return {Fault::NONE, 0, 0};
}

// Numbers of fields.
enum Number : I64 {
#define DIMENSION(...)
#define MODEL(name, ...) number_of_##name,
#define STATE(name, ...) number_of_##name,
#define WORK(name, ...) number_of_##name,
#include "fields.def"
};

static Finding check_runs(const Model& m, const State& s) {
    I64 begin = 0;
    for (I64 r = 0; r < m.runs; r++) {
        if (s.run_first[r] < begin) return {Fault::RUN, number_of_run_first, r};
        if (s.run_links[r] < 1 || s.run_links[r] >= m.nodes - s.run_first[r])
            return {Fault::RUN, number_of_run_links, r};
        begin = s.run_first[r] + s.run_links[r] + 1;
        if (!m.viscous && m.axial_damping[r] > 0.0) return {Fault::UNDAMPED, number_of_axial_damping, r};
    }
    return {Fault::NONE, 0, 0};
}

// Nodes inside taut runs move along the last axis only.
static Finding check_taut_runs(const Model& m, const State& s) {
    for (I64 r = 0; r < m.runs; r++) {
        for (I64 axis = 0; m.run_taut[r] && axis < m.axes - 1; axis++) {
            for (I64 i = s.run_first[r] + 1; i < s.run_first[r] + s.run_links[r]; i++) {
                const I64 at = axis * m.stride + i, entry = axis * m.nodes + i;
                if (m.mobility[at] != 0.0) return {Fault::TAUT, number_of_mobility, entry};
                if (s.velocity[at] != 0.0) return {Fault::TAUT, number_of_velocity, entry};
            }
        }
    }
    return {Fault::NONE, 0, 0};
}

static Finding check_springs(const Model& m) {
    for (I64 k = 0; k < m.springs; k++) {
        if (m.spring_begin[k] == m.spring_end[k]) return {Fault::SPRING, number_of_spring_end, k};
        if (!m.viscous && m.spring_damping[k] > 0.0) return {Fault::UNDAMPED, number_of_spring_damping, k};
    }
    for (I64 k = 0; k < m.counts[PLAYS]; k++)
        if (m.play_begin[k] == m.play_end[k]) return {Fault::SPRING, number_of_play_end, k};
    return {Fault::NONE, 0, 0};
}

static Finding check_bands(const Model& m) {
    I64 before = 0;
    for (I64 k = 0; k < m.bands; k++) {
        const I64 begin = m.band_begin[k], end = m.band_end[k], springs = m.band_springs[k];
        const I64 low = begin < end ? begin : end, high = begin < end ? end : begin;
        if (springs < 1 || springs > m.nodes - high || springs > high - low)
            return {Fault::BAND, number_of_band_springs, k};
        if (low < before) return {Fault::BAND, number_of_band_begin, k};
        if (!m.viscous && m.band_damping[k] > 0.0) return {Fault::UNDAMPED, number_of_band_damping, k};
        before = low;
    }
    return {Fault::NONE, 0, 0};
}

static Finding check_parts(const Model& m) {
    for (I64 part = 0; part < m.parts; part++)
        if (m.part_run[part] < (part ? m.part_run[part - 1] : 0) || m.part_run[part] > (part ? m.runs : 0))
            return {Fault::PART, number_of_part_run, part};
    return {Fault::NONE, 0, 0};
}

// The part that a band is inside of, or the number of parts. A part reaches to the first node of the next one.
static I64 part_of(const Model& m, const State& s, I64 band) {
    const I64 begin = m.band_begin[band], end = m.band_end[band], springs = m.band_springs[band];
    for (I64 part = 0; part < m.parts; part++) {
        const auto border = [&](I64 run) { return run < m.runs ? s.run_first[run] : m.nodes; };
        const I64 low = part ? border(m.part_run[part]) : 0;
        const I64 high = part + 1 < m.parts ? border(m.part_run[part + 1]) : m.nodes;
        if (begin >= low && end >= low && begin + springs <= high && end + springs <= high) return part;
    }
    return m.parts;
}

// Number of the run that a node is inside of, or -1. Runs are in order.
static I64 run_around(const Model& m, const State& s, I64 node) {
    I64 low = 0, high = m.runs;
    while (low < high) {
        const I64 middle = (low + high) / 2;
        if (s.run_first[middle] < node)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 && node < s.run_first[low - 1] + s.run_links[low - 1] ? low - 1 : -1;
}

// Copies are marked in the Workspace while joints are checked.
static Finding check_joints(const Model& m, const State& s, Workspace& w) {
    for (I64 j = 0; j < m.joints; j++) {
        const I64 copy = m.joint_copy[j];
        if (w.force[copy] != 0.0 || run_around(m, s, copy) >= 0) return {Fault::JOINT, number_of_joint_copy, j};
        w.force[copy] = 1.0;
    }
    for (I64 j = 0; j < m.joints; j++) {
        const I64 copy = m.joint_copy[j], original = m.joint_original[j];
        if (w.force[original] != 0.0 || run_around(m, s, original) >= 0)
            return {Fault::JOINT, number_of_joint_original, j};
        for (I64 axis = 0; axis < m.axes; axis++) {
            const I64 row = axis * m.stride, entry = axis * m.nodes + copy;
            if (m.mobility[row + copy] != 0.0) return {Fault::JOINT, number_of_mobility, entry};
            if (m.weight[row + copy] != 0.0) return {Fault::JOINT, number_of_weight, entry};
            if (s.position[row + copy] != s.position[row + original]) return {Fault::JOINT, number_of_position, entry};
            if (s.velocity[row + copy] != s.velocity[row + original]) return {Fault::JOINT, number_of_velocity, entry};
        }
    }
    return {Fault::NONE, 0, 0};
}

// Call visit(node) for all nodes that anything but runs acts on.
template <class Visit>
static void visit_attached(const Model& m, const State& s, Visit visit) {
    for (I64 k = 0; k < m.springs; k++) visit(m.spring_begin[k]), visit(m.spring_end[k]);
    for (I64 band = 0; band < m.bands; band++)
        for (I64 k = 0; k < m.band_springs[band]; k++) visit(m.band_begin[band] + k), visit(m.band_end[band] + k);
    for (I64 j = 0; j < m.joints; j++) visit(m.joint_copy[j]), visit(m.joint_original[j]);
    for (I64 q = 0; q < m.sheaves; q++) visit(m.sheave_node[q]);
    for (I64 k = 0; k < m.contacts; k++) visit(m.contact_body[k]);
    for (I64 k = 0; k < m.collectors; k++) visit(m.collector_body[k]);
    visit_others<2>(m, s, [&]<class E>(const auto&, const I64* nodes) {
        if constexpr (!__is_same(E, OverSheave<2>))
            for (int i = 0; i < E::UNKNOWNS / 2; i++) visit(nodes[i]);
    });
}

// Whether a node may pass a sheave: it is in a run next to it, and not where the rope has its other ends.
static bool may_pass(const Model& m, const State& s, I64 node) {
    for (I64 q = 0; q < m.sheaves; q++) {
        const I64 run = m.sheave_run[q], end = s.run_first[run + 1] + s.run_links[run + 1];
        if (node > s.run_first[run] && node < end) return true;
    }
    return false;
}

// Whether rows of an array have the same numbers at two nodes.
static bool are_same(const Model& m, const View<const double>& of, I64 node, I64 other) {
    for (I64 row = 0; row < m.axes * m.stride; row += m.stride)
        if (of[row + node] != of[row + other]) return false;
    return true;
}

// A rope is two runs of the same properties, whose nodes follow each other and are all the same, as they change places.
static Finding check_rope(const Model& m, const State& s, I64 q) {
    const I64 run = m.sheave_run[q], next = run + 1;
    const Finding found{Fault::SHEAVE, number_of_sheave_run, q};
    if (next >= m.runs || (q > 0 && m.sheave_run[q - 1] >= run)) return found;
    const I64 last = s.run_first[run] + s.run_links[run], end = s.run_first[next] + s.run_links[next];
    if (s.run_first[next] != last + 1 || !(m.axial_stiffness[run] > 0.0)) return found;
    const auto differ = [&](const View<const double>& of) { return of[run] != of[next]; };
    if (differ(m.link_length) || differ(m.axial_stiffness) || differ(m.axial_damping) || differ(m.line_mass))
        return found;
    if (m.run_tension_only[run] != m.run_tension_only[next] || m.run_taut[run] || m.run_taut[next]) return found;
    for (I64 i = s.run_first[run] + 1; i < end; i++) {
        if (!(m.mobility[i] > 0.0 && are_same(m, m.mobility, i, last))) return {Fault::SHEAVE, number_of_mobility, i};
        if (!are_same(m, m.weight, i, last)) return {Fault::SHEAVE, number_of_weight, i};
    }
    return {Fault::NONE, 0, 0};
}

// The split is a node that nothing else uses, which moves along its first axis.
static Finding check_split(const Model& m, const State& s, Workspace& w, I64 q) {
    const I64 split = m.sheave_split[q];
    const Finding found{Fault::SHEAVE, number_of_sheave_split, q};
    if (w.force[split] != 0.0 || run_around(m, s, split) >= 0) return found;
    for (I64 r = 0; r < m.runs; r++)
        if (split == s.run_first[r] || split == s.run_first[r] + s.run_links[r]) return found;
    for (I64 axis = 0; axis < m.axes; axis++) {
        if (m.weight[axis * m.stride + split] != 0.0) return found;
        if (axis > 0 && m.mobility[axis * m.stride + split] != 0.0) return found;
    }
    const double x = s.position[split];
    if (!(x > 0.0 && x < 2.0 * m.link_length[m.sheave_run[q]])) return {Fault::SHEAVE, number_of_position, split};
    w.force[split] = 2.0;
    return {Fault::NONE, 0, 0};
}

// Splits are marked in the Workspace, as copies are.
static Finding check_sheaves(const Model& m, const State& s, Workspace& w) {
    for (I64 q = 0; q < m.sheaves; q++) {
        if (const Finding found = check_rope(m, s, q); found.fault != Fault::NONE) return found;
        if (const Finding found = check_split(m, s, w, q); found.fault != Fault::NONE) return found;
    }
    for (I64 q = 0; q < m.sheaves; q++)
        if (w.force[m.sheave_node[q]] != 0.0) return {Fault::SHEAVE, number_of_sheave_node, q};
    I64 used = -1;
    visit_attached(m, s, [&](I64 node) {
        used = used < 0 && node >= 0 && (may_pass(m, s, node) || w.force[node] == 2.0) ? node : used;
    });
    for (I64 k = 0; k < m.contacts; k++) {
        I64 run = first_run_of(m, m.contact_run[k]);
        for (bool goes = true; goes; goes = goes_on(m, run), run++)
            for (I64 q = 0; q < m.sheaves; q++)
                if (run == m.sheave_run[q] || run == m.sheave_run[q] + 1)
                    return {Fault::SHEAVE, number_of_contact_run, k};
    }
    for (I64 k = 0; k < m.collectors; k++)
        for (I64 q = 0; q < m.sheaves; q++)
            if (m.collector_run[k] == m.sheave_run[q] || m.collector_run[k] == m.sheave_run[q] + 1)
                return {Fault::SHEAVE, number_of_collector_run, k};
    return used < 0 ? Finding{Fault::NONE, 0, 0} : Finding{Fault::SHEAVE, number_of_mobility, used};
}

// Whether a node has another mobility or weight than a second one.
static bool differs(const Model& m, I64 i, I64 j) {
    for (I64 row = 0; row < m.axes * m.stride; row += m.stride)
        if (m.mobility[row + i] != m.mobility[row + j] || m.weight[row + i] != m.weight[row + j]) return true;
    return false;
}

// List the nodes inside runs that differ from the typical node of their run.
static void find_odd_nodes(const Model& m, const State& s, Workspace& w) {
    I64 count = 0;
    for (I64 r = 0; r < m.runs; r++) {
        const I64 first = s.run_first[r], typical = typical_node(s, r);
        for (I64 i = first + 1; i < first + s.run_links[r]; i++)
            if (differs(m, i, typical)) w.odd[count++] = i;
        w.run_odd[r] = count;
    }
}

// Find what else than links acts on nodes inside runs; where these are few they are listed.
static void find_pulled_runs(const Model& m, const State& s, Workspace& w) {
    for (I64 r = 0; r < m.runs; r++)
        w.run_pulled[r] = w.run_stretched[r] = 0, w.run_damped[r] = m.axial_damping[r] > 0.0;
    const auto pull = [&](I64 node, bool damps, I64 count) {
        if (const I64 run = run_around(m, s, node); run >= 0) w.run_pulled[run] += count, w.run_damped[run] |= damps;
    };
    for (I64 k = 0; k < m.springs; k++) {
        const bool damps = m.spring_damping[k] > 0.0;
        pull(m.spring_begin[k], damps, 1), pull(m.spring_end[k], damps, 1);
    }
    for (I64 band = 0; band < m.bands; band++)
        for (I64 k = 0; k < m.band_springs[band]; k++) {
            pull(m.band_begin[band] + k, m.band_damping[band] > 0.0, m.nodes);
            pull(m.band_end[band] + k, m.band_damping[band] > 0.0, m.nodes);
        }
    visit_others<2>(m, s, [&]<class E>(const auto&, const I64* nodes) {
        for (int i = 0; i < E::UNKNOWNS / 2; i++) pull(nodes[i], true, 1);
    });
    for (I64 k = 0; k < m.contacts; k++) {
        I64 run = first_run_of(m, m.contact_run[k]);
        for (; w.run_pulled[run] += m.nodes, goes_on(m, run); run++) continue;
        pull(m.contact_body[k], false, m.nodes);
    }
    for (I64 r = 0; r < m.runs; r++) w.run_pulled[r] = w.run_damped[r] || FEW * w.run_pulled[r] > s.run_links[r];
}

// List the nodes on which springs and others act, but where a whole run is moved with their forces.
static void find_kicked_nodes(const Model& m, const State& s, Workspace& w) {
    w.kicks[0] = 0;
    const auto list = [&](I64 node) {
        const I64 run = run_around(m, s, node);
        if (run < 0 || w.run_pulled[run] || w.force[node] != 0.0) return;
        w.kicked[w.kicks[0]++] = node, w.force[node] = 1.0;
    };
    for (I64 k = 0; k < m.springs; k++) list(m.spring_begin[k]), list(m.spring_end[k]);
    visit_others<2>(m, s, [&]<class E>(const auto&, const I64* nodes) {
        for (int i = 0; i < E::UNKNOWNS / 2; i++) list(nodes[i]);
    });
    for (I64 i = 0; i < w.kicks[0]; i++) w.force[w.kicked[i]] = 0.0;
}

static void prepare(const Model& m, const State& s, Workspace& w) {
    for (I64 i = 0; i < m.axes * m.stride; i++) w.force[i] = 0.0;
    for (I64 i = 0; i < m.parts * stride_of(SCRATCH_SIZE); i++) w.scratch[i] = 0.0;
    for (I64 part = 0; part < m.parts; part++) w.arrived[part * stride_of(1)] = 0;
    for (I64 band = 0; band < m.bands; band++) w.band_part[band] = part_of(m, s, band);
    find_odd_nodes(m, s, w);
    find_pulled_runs(m, s, w);
    find_kicked_nodes(m, s, w);
    for (I64 k = 0; k < m.collectors; k++) w.collector_first[k] = m.collector_body[k];
    for (I64 i = 0; i < m.nodes; i++) w.link_kink[i] = 0.0, w.link_contacts[i] = 0;
}

Finding bind(const Blocks& blocks, const I64* bytes) {
    const Arena arenas[] = {blocks.model, blocks.state, blocks.work};
    for (I64 i = 0; i < 3; i++)
        if (!is_block(arenas[i], static_cast<Part>(i), bytes[i])) return {Fault::BLOCK, i, 0};
    for (I64 i = 0; i < DIMENSIONS; i++)
        for (const Arena& arena : arenas)
            if (arena.header().counts[i] != blocks.model.header().counts[i]) return {Fault::SIZES, i, 0};
    blocks.work.header().is_bound = 0;
    for (I64 i = 0; i < 2; i++)
        if (const Finding found = check_values(arenas[i]); found.fault != Fault::NONE) return found;
    const Model m(blocks.model);
    const State s(blocks.state);
    Workspace w(blocks.work);
    for (I64 i = 0; i < m.nodes; i++) w.force[i] = 0.0;
    if (const Finding found = check_runs(m, s); found.fault != Fault::NONE) return found;
    if (const Finding found = check_taut_runs(m, s); found.fault != Fault::NONE) return found;
    if (const Finding found = check_springs(m); found.fault != Fault::NONE) return found;
    if (const Finding found = check_bands(m); found.fault != Fault::NONE) return found;
    if (const Finding found = check_parts(m); found.fault != Fault::NONE) return found;
    if (const Finding found = check_joints(m, s, w); found.fault != Fault::NONE) return found;
    if (const Finding found = check_sheaves(m, s, w); found.fault != Fault::NONE) return found;
    prepare(m, s, w);
    blocks.work.header().is_bound = 1;
    return {Fault::NONE, 0, 0};
}

bool are_bound(const Blocks& blocks) {
    const Header& model = blocks.model.header();
    if (blocks.work.header().is_bound != 1) return false;
    const Arena arenas[] = {blocks.model, blocks.state, blocks.work};
    for (const Arena& arena : arenas) {
        const Header& header = arena.header();
        if (header.seal != SEAL) return false;
        for (int i = 0; i < DIMENSIONS; i++)
            if (header.counts[i] != model.counts[i]) return false;
    }
    return true;
}

}  // namespace RW_VARIANT
