// Contacts of loads and bodies with runs: where they are, and what acts there.
#pragma once

#include "elements.hpp"
#include "stencil.hpp"
#include "touch.hpp"

namespace RW_VARIANT {

template <int AXES>
struct Contacts {
    using Element = Touch<AXES>;
    static constexpr I64 NODES_OF = Element::UNKNOWNS / AXES;

    const Model& m;
    const State& s;
    Workspace& w;

    Record& record(I64 k) const {
        return *reinterpret_cast<Record*>(w.contact_record.at(k * stride_of(RECORD_SIZE), RECORD_SIZE));
    }

    // Locate all contacts, and find their kinks.
    void find() const { find_kinks(locate_all()); }

    // Whether any link is lengthened by two contacts, or by one that has left its line.
    bool locate_all() const {
        bool shares = false;
        for (I64 k = 0; k < m.contacts; k++) {
            locate_contact(k);
            count_links(record(k));
        }
        for (I64 k = 0; k < m.contacts; k++)
            shares = shares || is_sharing(record(k)) || record(k).state == Touching::LEFT;
        return shares;
    }
    // Contacts that share links lengthen these together.
    void find_kinks(bool shares) const {
        for (I64 k = 0; k < m.contacts; k++) find_kink(k);
        for (int round = 0; shares && round < 40; round++) {
            bool has_moved = false;
            for (I64 k = 0; k < m.contacts; k++) {
                const double before = record(k).K;
                if (is_sharing(record(k))) find_kink(k);
                const double change = record(k).K - before;
                has_moved = has_moved || (change > 0.0 ? change : -change) > 1e-12 * before;
            }
            if (!has_moved) break;
        }
        release(shares);
    }

    // Nodes of a contact in the order of its unknowns: those that share its point, body, four for each link.
    void nodes_of(const Record& r, I64 body, I64* nodes) const {
        for (I64 j = 0; j < SHARED; j++) nodes[j] = r.first + (j < r.count ? j : 0);
        nodes[SHARED] = body < 0 ? r.first : body;
        for (I64 j = 0; j < BELOW; j++) {
            const I64 i = r.link[j];
            const I64 four[] = {r.links[j].begins ? i : i - 1, i, i + 1, r.links[j].ends ? i + 1 : i + 2};
            for (I64 k = 0; k < 4; k++) nodes[SHARED + 1 + 4 * j + k] = four[k];
        }
    }
    // Values of an array (axis, node) at all of them.
    void gather_at(const Record& r, I64 k, const auto& from, double* values) const {
        I64 nodes[NODES_OF];
        nodes_of(r, m.contact_body[k], nodes);
        gather<Element, AXES>(from, m.stride, nodes, values);
    }

  private:
    void locate_contact(I64 k) const {
        Record& r = record(k);
        I64 run = m.contact_run[k];
        double place = s.contact_place[k], kept = s.contact_kink[k];
        for (; place < 0.0 && run > 0 && m.run_continues[run - 1]; run--) place += length_of(run - 1);
        for (; place > length_of(run) && goes_on(m, run); run++) place -= length_of(run);
        const double h = m.link_length[run], last = length_of(run), beyond = place < 0.0 ? -place : place - last;
        const I64 n = s.run_links[run];
        r.run = run, r.length = h, r.speed = s.contact_speed[k], r.K = kept;
        for (I64 j = 0; j < BELOW; j++) r.others[j] = r.before[j] = r.own[j] = 0.0;
        r.state = Touching::YES;
        const double ahead = kept + (s.contact_kink_change[k] + s.contact_kink_bend[k]);
        if (ahead > 0.5 * kept) r.K = ahead;
        if (beyond > 0.0) {  // its kink grows straight over a quarter of a link
            r.state = kept > 0.0 && 4.0 * beyond < h ? Touching::LEFT : Touching::NO;
            place = place < 0.0 ? 0.0 : last;
            r.K = kept * (1.0 - 4.0 * beyond / h);
        }
        if (r.state == Touching::NO) r.K = 0.0;
        const double at = place / h, x = at < static_cast<double>(n) ? at : static_cast<double>(n);
        const Cell cell = locate(n, x);
        share(r, cell, x);
        find_links(r, cell.link, x);
        if (r.state == Touching::LEFT)
            for (I64 j = 0; j < BELOW; j++)
                r.change[j] = r.part[j] * (place > 0.0 ? -4.0 : 4.0) / (h * (1.0 - 4.0 * beyond / h));
        find_stiffness(r, k, x);
    }
    double length_of(I64 run) const { return m.link_length[run] * static_cast<double>(s.run_links[run]); }

    void share(Record& r, const Cell& cell, double x) const {
        const double per_length = 1.0 / r.length;
        weigh(cell, x, r.weight, r.slope, r.second);
        for (I64 j = 0; j < SHARED; j++) {
            r.slope[j] *= per_length;
            r.second[j] *= per_length * per_length;
        }
        r.first = s.run_first[r.run] + cell.first;
        r.count = cell.links + 1 - cell.first < SHARED ? cell.links + 1 - cell.first : SHARED;
    }

    // The links below, with their parts: a quadratic B-spline over their middles. Parts beyond the line go to its end.
    void find_links(Record& r, I64 link, double x) const {
        const double f = x - static_cast<double>(link) - 0.5, per_length = 1.0 / r.length;
        const I64 n = s.run_links[r.run], first = s.run_first[r.run];
        r.part[0] = 0.5 * (0.5 - f) * (0.5 - f), r.part[1] = 0.75 - f * f, r.part[2] = 0.5 * (0.5 + f) * (0.5 + f);
        r.change[0] = (f - 0.5) * per_length, r.change[1] = -2.0 * f * per_length, r.change[2] = (f + 0.5) * per_length;
        const Links own = links_of(m, r.run);
        for (I64 j = 0; j < BELOW; j++) {
            I64 run = r.run, i = link - 1 + j;
            if (i < 0 && run > 0 && m.run_continues[run - 1])
                run--, i = s.run_links[run] - 1;
            else if (i >= n && goes_on(m, run))
                run++, i = 0;
            if (run == r.run && (i < 0 || i >= n)) {
                r.part[1] += r.part[j], r.change[1] += r.change[j];
                r.part[j] = r.change[j] = 0.0;
                i = link;
            }
            r.link[j] = (run == r.run ? first : s.run_first[run]) + i;
            r.links[j] = run == r.run ? own : links_of(m, run);
            r.links[j].begins = i == 0 || !m.run_curved[run];
            r.links[j].ends = i == s.run_links[run] - 1 || !m.run_curved[run];
        }
    }

    void find_stiffness(Record& r, I64 k, double x) const {
        const double h = r.length, n = static_cast<double>(s.run_links[r.run]), per_length = 1.0 / h;
        const Slope<double> shape = shape_of(x, n);
        const double bending = m.run_curved[r.run] ? m.bending_stiffness[r.run] * per_length * per_length : 0.0;
        r.kink = {bending, per_length / shape.value, m.contact_compliance[k], m.line_mass[r.run] * r.speed * r.speed};
        r.steepening = -shape.slope / shape.value * per_length;
        r.has_body = m.contact_body[k] >= 0;
        r.side = m.contact_unilateral[k] ? (m.contact_below[k] ? -1 : 1) : 0;
        const double EA = m.axial_stiffness[r.run];
        const bool is_held = EA > 0.0 && !(r.has_body && m.contact_slides[k]);
        r.along = is_held ? 1.0 / (AXIAL_GIVE * h / EA + 2.0 * m.contact_compliance[k]) : 0.0;
        for (int axis = 0; axis < AXES; axis++) r.given[axis] = m.contact_force[axis * stride_of(m.contacts) + k];
    }

    // Call visit(number, node) for the links that bear a kink.
    void visit_links(const Record& r, auto visit) const {
        for (I64 j = 0; j < BELOW && r.state != Touching::NO; j++)
            if (r.part[j] > 0.0) visit(j, r.link[j]);
    }
    void count_links(Record& r) const {
        visit_links(r, [&](I64 j, I64 link) {
            w.link_contacts[link]++;
            r.own[j] = r.state == Touching::LEFT ? 2.0 * r.part[j] * r.K : 0.0;
            w.link_kink[link] += r.own[j];
        });
    }
    bool is_sharing(const Record& r) const {
        bool shares = false;
        visit_links(r, [&](I64, I64 link) { shares = shares || w.link_contacts[link] > 1; });
        return shares && r.state == Touching::YES;
    }

    // K of a contact with those of others as they are.
    void find_kink(I64 k) const {
        Record& r = record(k);
        if (r.state != Touching::YES) return;
        double x[Element::UNKNOWNS];
        gather_at(r, k, s.position, x);
        visit_links(r, [&](I64 j, I64 link) { r.others[j] = w.link_kink[link] - r.own[j]; });
        Element::find(r, x);
        visit_links(r, [&](I64 j, I64 link) {
            const double own = 2.0 * r.part[j] * r.K;
            w.link_kink[link] += own - r.own[j];
            r.own[j] = own;
        });
    }

  public:
    // Note what contacts before each one add to its links, and clear the arrays of links.
    void release(bool shares) const {
        const auto clear = [&](I64, I64 link) { w.link_kink[link] = 0.0, w.link_contacts[link] = 0; };
        for (I64 k = 0; k < m.contacts; k++) visit_links(record(k), clear);
        for (I64 k = 0; k < m.contacts && shares; k++) {
            Record& r = record(k);
            visit_links(r, [&](I64 j, I64 link) {
                r.before[j] = w.link_kink[link];
                w.link_kink[link] += 2.0 * r.part[j] * r.K;
            });
        }
        for (I64 k = 0; k < m.contacts && shares; k++) visit_links(record(k), clear);
    }
};

}  // namespace RW_VARIANT
